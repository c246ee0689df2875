"""An interactive plot: what plotly.js draws for each position of the controls of the page."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from plotly.offline import get_plotlyjs

from vibroimpact.figures.columns import COLUMNS
from vibroimpact.figures.style import GAP_COLOURS, GREY, shown

DIGITS = 4  # of the numbers on the page; more would double its size
SYMBOLS = {
    "o": "circle",
    "s": "square",
    "^": "triangle-up",
    "v": "triangle-down",
    "<": "triangle-left",
    ">": "triangle-right",
    "D": "diamond",
    "P": "cross",
    "x": "x",
    "+": "cross-thin-open",
}
GRID = "#E6E6E6"
PLAIN_DECADES = 4.0
EMPTY_WIDTH = 36  # characters of a line in a plot without traces, which a phone shows uncut


@dataclass(frozen=True)
class Control:
    """A control of the page.

    name: as plots call it: gap, place or load.
    label: in words.
    values: text of each position.
    numbers: the value of each position, for the mark on axes of load; empty for none.
    """

    name: str
    label: str
    values: Sequence[str]
    numbers: Sequence[float] = ()


@dataclass(frozen=True)
class Plot:
    """One plot of the page.

    name: of its element.
    title, caption: what it shows, in words.
    layout: for plotly.js.
    frames: {indices of the controls, such as "0,3": traces}.
    controls: names of the controls that choose the frame, in the order of the indices.
    shared: {name: list} that traces refer to as "@name".
    empty: sentence for a position without traces.
    wide: whether it has the whole width of the page.
    cursor: whether the load of the slider is marked on the axis.
    ranges: {key of a frame: range of the vertical axis}; empty where plotly.js finds them.
    """

    name: str
    title: str
    caption: str
    layout: dict[str, Any]
    frames: dict[str, list[dict]]
    controls: tuple[str, ...] = ()
    shared: dict[str, list] = field(default_factory=dict)
    empty: str = "Nothing to show here."
    wide: bool = False
    cursor: bool = False
    ranges: dict[str, list] = field(default_factory=dict)

    def has_traces(self) -> bool:
        """Whether anything is drawn at any position of the controls."""
        return any(self.frames.values())

    def drawn(self) -> dict[str, Any]:
        """Return what the page's script needs, as plain values."""
        return {
            "name": self.name,
            "layout": self.layout,
            "frames": self.frames,
            "controls": self.controls,
            "shared": self.shared,
            "empty": "<br>".join(textwrap.wrap(self.empty, EMPTY_WIDTH)),
            "cursor": self.cursor,
            "ranges": self.ranges,
        }


def plotly_library() -> str:
    """Return the source text of plotly.js, which the page holds once."""
    return get_plotlyjs()


def key_of(*indices: int) -> str:
    """Return the key of a frame."""
    return ",".join(map(str, indices))


def numbers(values: ArrayLike) -> list[float | None]:
    """Return values as a list with DIGITS significant digits, None for what is not finite."""
    return [
        float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None
        for value in np.ravel(np.asarray(values, dtype=float))
    ]


def in_unit(column: str, values: ArrayLike) -> list[float | None]:
    """Return SI values as a list in the unit of the axis of a column."""
    return numbers(shown(column, values))


def label(column: str) -> str:
    """Return the axis label of a column, with its unit."""
    return COLUMNS[column][0]


def unit_of(title: str) -> str:
    """Return the unit of an axis title, such as N RMS of "Load (N RMS)"; empty for none."""
    return title[title.rfind(" (") + 2 : -1] if title.endswith(")") else ""


def axis(title: str, **more: Any) -> dict[str, Any]:
    """Return an axis with a title and a light grid."""
    return {
        "title": {"text": title, "standoff": 8},
        "gridcolor": GRID,
        "zerolinecolor": GREY,
        "linecolor": GREY,
        "ticks": "outside",
        "automargin": True,
        "exponentformat": "power",
        **more,
    }


def log_axis(title: str, frames: dict[str, list[dict]], **more: Any) -> dict[str, Any]:
    """Return a logarithmic axis of the y values of frames.

    Up to four decades have ticks at 1, 2 and 5 in plain numbers, more have powers of ten only, and
    less than one is left to plotly.js.
    """
    values = [
        value
        for traces in frames.values()
        for trace in traces
        for value in trace["y"]
        if value is not None and value > 0.0
    ]
    decades = float(np.log10(max(values) / min(values))) if values else 1.0
    ticks: dict[str, Any] = {"dtick": "D2", "tickformat": "~g"}
    if decades < 1.0:
        ticks = {"nticks": 6, "tickformat": "~g"}
    elif decades > PLAIN_DECADES:
        ticks = {"dtick": int(np.ceil(decades / 6.0))}
    if decades <= PLAIN_DECADES and max(values, default=1.0) >= 1e4:
        ticks["tickformat"] = "~s"
    return axis(title, **{"type": "log", "zerolinecolor": GRID, **ticks, **more})


def load_axis(title: str, loads: Sequence[float]) -> dict[str, Any]:
    """Return the logarithmic axis of all loads of a study, the same in every plot."""
    low, high = np.log10([min(loads), max(loads)])
    margin = 0.04 * (high - low) or 0.3
    return axis(
        title, type="log", range=numbers([low - margin, high + margin]), tickformat="~g", dtick="D2"
    )


def layout(x: dict, y: dict, height: int = 360, **more: Any) -> dict[str, Any]:
    """Return the layout of a plot with a legend below it."""
    return {
        "xaxis": x,
        "yaxis": y,
        "height": height,
        "margin": {"l": 60, "r": 14, "t": 32, "b": 50},
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": "#222"},
        "paper_bgcolor": "white",
        "plot_bgcolor": "white",
        "legend": {
            "orientation": "h",
            "y": -0.24,
            "yanchor": "top",
            "x": 0,
            "font": {"size": 11},
            "traceorder": "normal",
        },
        "hovermode": "closest",
        **more,
    }


def points(
    name: str, x: Sequence, y: Sequence, hover: str, colour: str, symbol: str, **more: Any
) -> dict[str, Any]:
    """Return a trace of lines and markers.

    symbol: a marker as in style.METHODS.
    hover: template of the text under the pointer.
    """
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": x,
        "y": y,
        "line": {"color": colour, "width": 1.2},
        "marker": {"color": colour, "symbol": SYMBOLS.get(symbol, "circle"), "size": 7},
        "hovertemplate": hover + "<extra></extra>",
        **more,
    }


def bars_between(middle: ArrayLike, low: ArrayLike, high: ArrayLike) -> dict[str, Any]:
    """Return error bars from low to high, values in the unit of the axis."""
    middle, low, high = (np.asarray(values, dtype=float) for values in (middle, low, high))
    return {
        "type": "data",
        "symmetric": False,
        "array": numbers(np.maximum(high - middle, 0.0)),
        "arrayminus": numbers(np.maximum(middle - low, 0.0)),
        "thickness": 1,
        "width": 3,
    }


def colour_of(index: int) -> str:
    """Return the colour of the curve of a support or gap."""
    return GAP_COLOURS[index % len(GAP_COLOURS)]
