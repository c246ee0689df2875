"""Values of many cases against one quantity: median over seeds (and supports), range as a bar."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Series


def over_seeds(rows, x_column, y_column, curve, tags=(), **look: Any) -> list[Series]:
    """Return the Series of the median of y_column for each value of x_column, with its range.

    rows: list of {column: value}, SI; values that are not finite are left out (unresolved). The
        list is empty without any.
    tags: further recorded columns, constant at each x.
    """
    usable = [row for row in rows if np.isfinite(row[y_column])]
    if not usable:
        return []
    places = sorted({row[x_column] for row in usable})
    groups = [[row for row in usable if row[x_column] == place] for place in places]
    values = [np.array([row[y_column] for row in group], dtype=float) for group in groups]
    middle, low, high = (
        np.array([pick(group) for group in values]) for pick in (np.median, np.min, np.max)
    )
    beside = {tag: np.array([group[0][tag] for group in groups]) for tag in tags}
    beside["values"] = np.array([len(group) for group in values])
    columns = {"x_column": x_column, "y_column": y_column}
    return [Series(curve, np.array(places), middle, beside, low, high, **{**columns, **look})]


def medians(rows, x_column, y_column):
    """Return (x (place,) ascending, median of y_column (place,)) of the finite values."""
    usable = [row for row in rows if np.isfinite(row[y_column])]
    places = sorted({row[x_column] for row in usable})
    return np.array(places), np.array(
        [np.median([row[y_column] for row in usable if row[x_column] == place]) for place in places]
    )
