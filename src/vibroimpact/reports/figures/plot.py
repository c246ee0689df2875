"""A plot as data: panels with axes, and the items that are drawn in them.

`drawing` draws it with matplotlib, `interactive.page_plot` with plotly. Values are in SI units; a
column (see columns.COLUMNS) gives the label and the unit of an axis, and a name in the CSV.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Tags = Mapping[str, Any]  # further columns of the CSV: a value, or one per point


@dataclass(frozen=True)
class Axis:
    """An axis of a panel.

    column: of columns.COLUMNS.
    log: whether it is logarithmic.
    low, high: limits, None if the data set them.
    label: in the place of that of the column.
    names: of the places 0, 1, ... of bars and maps; the first is at the top.
    bare: whether it has neither label nor numbers, because a neighbour shows them.
    """

    column: str
    log: bool = False
    low: float | None = None
    high: float | None = None
    label: str = ""
    names: Sequence[str] = ()
    bare: bool = False


@dataclass(frozen=True, kw_only=True)
class Look:
    """How an item looks.

    label: in the legend, empty for none.
    line: "-", "--", ":", "-." or "" for none.
    marker: of matplotlib, empty for none.
    width, size: of line and marker in points, None for the usual ones.
    hollow: whether markers are white inside.
    order: items of a higher order cover others, None for the usual one.
    hidden: whether the reader of a page has to switch it on.
    """

    label: str = ""
    colour: str = "#000000"
    line: str = "-"
    marker: str = ""
    width: float | None = None
    size: float | None = None
    hollow: bool = False
    alpha: float | None = None
    order: float | None = None
    hidden: bool = False


@dataclass(frozen=True)
class Series(Look):
    """A curve or points of y over x, (point,) each.

    curve: its name in the CSV; an empty one is not in the CSV.
    low, high: (point,) of a range about y, None for none.
    band: whether the range is a band; bars else.
    right: whether it belongs to the axis on the right.
    hover: text of each point under the pointer, on a page.
    moving: y in quadrature, of a motion whose part in phase is y; a page can play it.
    """

    curve: str
    x: ArrayLike
    y: ArrayLike
    tags: Tags = field(default_factory=dict)
    low: ArrayLike | None = None
    high: ArrayLike | None = None
    band: bool = False
    right: bool = False
    hover: Sequence[str] = ()
    moving: ArrayLike | None = None


@dataclass(frozen=True)
class Bars(Look):
    """Bars of values (bar,) at places (bar,) of the other axis, which has names or a unit.

    start: values at which the bars begin. texts: at their ends.
    colours: one per bar, in the place of colour. thickness: in units of the places.
    """

    curve: str
    places: ArrayLike
    values: ArrayLike
    tags: Tags = field(default_factory=dict)
    start: ArrayLike | None = None
    texts: Sequence[str] = ()
    colours: Sequence[str] = ()
    thickness: float = 0.62


@dataclass(frozen=True)
class Mark(Look):
    """A line across a panel at one value of its x or y axis.

    curve: its name in the CSV; an empty one is not in the CSV.
    axis: "x" or "y".
    """

    curve: str
    axis: str
    value: float


@dataclass(frozen=True)
class Signs(Look):
    """Markers at values of the x axis, at a height that is a fraction of the panel."""

    curve: str
    values: ArrayLike
    height: float


@dataclass(frozen=True)
class Span:
    """A shaded range of the x or y axis, which is not in the CSV."""

    axis: str
    low: float
    high: float
    colour: str
    alpha: float = 1.0


@dataclass(frozen=True)
class Text:
    """Words at a place, which are not in the CSV.

    x, y: in units of the axes; a fraction of the panel if of_panel has their letter.
    shift: in points. align: (horizontal, vertical) of matplotlib.
    """

    words: str
    x: float
    y: float
    of_panel: str = ""
    shift: tuple[float, float] = (0.0, 0.0)
    align: tuple[str, str] = ("left", "bottom")
    colour: str = "#000000"
    size: float = 8.0
    rotation: float = 0.0


@dataclass(frozen=True)
class Map:
    """Values z (y, x) of a column as colours from low to high; a logarithmic y has even steps.

    y: values, or the names of the axis. edges (x + 1,): of the cells, halfway between x if None.
    log: whether the colours are logarithmic.
    """

    curve: str
    x: ArrayLike
    y: ArrayLike
    z: ArrayLike
    z_column: str
    low: float
    high: float
    log: bool = False
    edges: ArrayLike | None = None


Item = Series | Bars | Mark | Signs | Span | Text | Map


@dataclass(frozen=True)
class Panel:
    """Axes with their items, in the order in which they are drawn.

    note: why the panel is empty, shown if it holds no series, bars or map.
    right: a second vertical axis.
    legend: its place in the panel as matplotlib names it, empty for none.
    equal: whether both axes have one scale.
    blank: whether the axes are hidden, under a note that stands for the whole figure.
    """

    x: Axis
    y: Axis
    items: Sequence[Item]
    title: str = ""
    note: str = ""
    right: Axis | None = None
    legend: str = ""
    legend_title: str = ""
    legend_columns: int = 1
    equal: bool = False
    blank: bool = False

    def is_empty(self) -> bool:
        """Whether nothing is drawn but marks, spans and texts."""
        return not any(isinstance(item, (Series, Bars, Map)) for item in self.items)


@dataclass(frozen=True)
class ColourBar:
    """The colours of a column from low to high.

    curves: whether they are those of curves; those of maps else.
    ends: "min", "max" or "both" if values lie beyond.
    panels: that it stands below; right of all panels if empty.
    """

    column: str
    low: float
    high: float
    log: bool = False
    curves: bool = False
    ends: str = "neither"
    panels: Sequence[str] = ()


@dataclass(frozen=True)
class Plot:
    """A figure: one or several panels.

    name: stem of its files.
    title: above it. caption: its content and how to read it, without reference to the paper.
    panels: {name: Panel}.
    rows: of names of panels, "." for a gap; one row of all if empty.
    size: (width, height) in inches.
    share: axes that all panels share: "x", "y", "xy" or none; inner ones have no labels.
    legend: columns of a legend below all panels, 0 for none.
    widths, heights: relative, of the columns and rows of panels.
    """

    name: str
    title: str
    caption: str
    panels: Mapping[str, Panel]
    rows: Sequence[Sequence[str]] = ()
    size: tuple[float, float] = (7.6, 4.2)
    share: str = ""
    legend: int = 0
    widths: Sequence[float] | None = None
    heights: Sequence[float] | None = None
    colour_bars: Sequence[ColourBar] = ()


def in_rows(panels: Sequence[str], across: int) -> list[list[str]]:
    """Return the names of panels in rows of so many, the last one filled with gaps."""
    rows = [list(panels[first : first + across]) for first in range(0, len(panels), across)]
    return [row + ["."] * (across - len(row)) for row in rows]


def extent(values: ArrayLike, log: bool = False, margin: float = 0.05) -> tuple[float, float]:
    """Return the limits of an axis that holds all finite values, positive ones if log."""
    known = np.ravel(np.asarray(values, dtype=float))
    known = known[np.isfinite(known) & ((known > 0.0) | (not log))]
    if known.size == 0:
        return (0.1, 10.0) if log else (-1.0, 1.0)
    low, high = (np.log(known.min()), np.log(known.max())) if log else (known.min(), known.max())
    beyond = margin * (high - low) or (1.0 if log else 0.05 * abs(high) or 1.0)
    ends = np.array([low - beyond, high + beyond])
    low, high = np.exp(ends) if log else ends
    return float(low), float(high)
