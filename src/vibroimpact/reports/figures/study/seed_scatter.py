"""Values of many cases against one quantity: median over seeds (and supports), range as a bar."""

from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Series


def over_seeds(rows, x_column, y_column, curve, tags=(), **look: Any) -> list[Series]:
    """Return the Series of the median of y_column for each value of x_column, with its range.

    rows: list of {column: value}, SI; values that are not finite are left out (unresolved). The
        list is empty without any.
    tags: further recorded columns, constant at each x.
    """
    places, values, groups = grouped(rows, x_column, y_column)
    if not places:
        return []
    middle, low, high = spread(values)
    beside = {tag: np.array([group[0][tag] for group in groups]) for tag in tags}
    beside["values"] = np.array([len(group) for group in groups])
    return [Series(curve, np.array(places), middle, beside, low, high, **look)]


def medians(rows, x_column, y_column):
    """Return (x (place,) ascending, median of y_column (place,)) of the finite values."""
    places, values, _ = grouped(rows, x_column, y_column)
    return np.array(places), spread(values)[0]


def grouped(rows, x_column, y_column):
    """Return (ascending values of x_column, [values of y_column], [rows]) of finite values."""
    usable = [row for row in rows if np.isfinite(row[y_column])]
    places = sorted({row[x_column] for row in usable})
    groups = [[row for row in usable if row[x_column] == place] for place in places]
    return places, [[row[y_column] for row in group] for group in groups], groups


def spread(values):
    """Return (median, smallest, largest) (place,) of [values of a place]."""
    return tuple(np.array([pick(own) for own in values]) for pick in (np.median, np.min, np.max))
