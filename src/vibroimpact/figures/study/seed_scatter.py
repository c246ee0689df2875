"""Values of many cases against one quantity: median over seeds (and supports), range as a bar."""

from __future__ import annotations

import numpy as np


def over_seeds(sheet, axes, rows, x_column, y_column, curve, tags=(), **style):
    """Draw the median of y_column for each value of x_column, with a bar over the range.

    rows: list of {column: value}, SI; values that are not finite are left out (unresolved).
    tags: further recorded columns, constant at each x.

    Returns the errorbar container, or None without any value.
    """
    usable = [row for row in rows if np.isfinite(row[y_column])]
    if not usable:
        return None
    places = sorted({row[x_column] for row in usable})
    groups = [[row for row in usable if row[x_column] == place] for place in places]
    values = [np.array([row[y_column] for row in group], dtype=float) for group in groups]
    middle, low, high = (
        np.array([pick(group) for group in values]) for pick in (np.median, np.min, np.max)
    )
    beside = {tag: np.array([group[0][tag] for group in groups]) for tag in tags}
    beside["values"] = np.array([len(group) for group in values])
    return sheet.bars(
        axes,
        (x_column, np.array(places)),
        (y_column, middle),
        curve,
        low,
        high,
        tags=beside,
        **style,
    )


def medians(rows, x_column, y_column):
    """Return (x (place,) ascending, median of y_column (place,)) of the finite values."""
    usable = [row for row in rows if np.isfinite(row[y_column])]
    places = sorted({row[x_column] for row in usable})
    return np.array(places), np.array(
        [np.median([row[y_column] for row in usable if row[x_column] == place]) for place in places]
    )
