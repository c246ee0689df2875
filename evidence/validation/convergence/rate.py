"""The order at which a sequence converges, from the sequence alone."""

import numpy as np


def successive_changes(values):
    """Return (size - 1,) |values[n] - values[n + 1]|.

    With halved sizes it falls at the order of the error, whatever the limit is.
    """
    return np.abs(np.diff(np.asarray(values, dtype=float)))


def fitted_order(sizes, errors):
    """Return the slope of log(errors) against log(sizes), by least squares.

    Raises ValueError for fewer than 2 points or an error of 0.
    """
    sizes, errors = np.asarray(sizes, dtype=float), np.asarray(errors, dtype=float)
    if sizes.size < 2 or np.any(errors <= 0.0):
        raise ValueError(
            f"an order needs 2 or more sizes with errors above 0, got errors {errors.tolist()} at"
            f" sizes {sizes.tolist()}"
        )
    return float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def extrapolated(values, order, ratio=2.0):
    """Return the limit of a sequence from its last two members (Richardson).

    ratio: of successive sizes.
    """
    return values[-1] + (values[-1] - values[-2]) / (ratio**order - 1.0)
