"""A plot of a page: a figure of plotly.js for each position of the controls of the page."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from vibroimpact.reports.figures.plot import Axis, Bars, Look, Mark, Panel, Series, Span
from vibroimpact.reports.figures.style import GREY, label_of, shown

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
POINTS, PX = 4.5, 1.6  # usual size of a marker; pixels per point
DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}
GRID = "#E6E6E6"
BAND = 0.18  # opacity
PLAIN_DECADES = 4.0
Place = tuple[float, float]  # gap in m, load
EMPTY_WIDTH = 36  # characters of a line in a plot without traces, which a phone shows uncut
SHARED_POINTS = 20  # from it on, x values that recur are written once


@dataclass(frozen=True)
class Control:
    """A control of the page.

    name: as plots call it: gap, place or load.
    label: in words.
    values: text of each position.
    keys: what each position chooses.
    numbers: the value of each position, for the mark on axes of load; empty for none.
    """

    name: str
    label: str
    values: Sequence[str]
    keys: Sequence[Any]
    numbers: Sequence[float] = ()


@dataclass(frozen=True)
class PagePlot:
    """One plot of the page: a panel for each position of its controls.

    name: of its element.
    title, caption: its content in words.
    frames: {(a key of each control): Panel}.
    controls: names of the controls that choose the frame, in the order of the keys.
    empty: sentence for a position without a panel.
    wide: whether it has the whole width of the page.
    cursor: whether the load of the slider is marked on the axis.
    height: in pixels.
    more: further keys of the layout.
    """

    name: str
    title: str
    caption: str
    frames: Mapping[tuple, Panel]
    controls: tuple[str, ...] = ()
    empty: str = "Nothing to show here."
    wide: bool = False
    cursor: bool = False
    height: int = 360
    more: Mapping[str, Any] = field(default_factory=dict)

    def has_traces(self) -> bool:
        """Whether anything is drawn at any position of the controls."""
        return not all(panel.is_empty() for panel in self.frames.values())

    def drawn(self, controls: Sequence[Control] = ()) -> dict[str, Any]:
        """Return the input of the page's script, as plain values; controls: those of the page."""
        by_name = {control.name: list(control.keys) for control in controls}
        keys = [by_name[name] for name in self.controls]
        kept = {
            ",".join(str(own.index(key)) for own, key in zip(keys, chosen, strict=True)): panel
            for chosen, panel in self.frames.items()
            if not panel.is_empty()
        }
        frames = {key: traces_of(panel) for key, panel in kept.items()}
        ranges = {key: _range(panel.y) for key, panel in kept.items() if _range(panel.y)}
        alike = len({tuple(ends) for ends in ranges.values()}) < 2 and len(ranges) == len(kept)
        layout = _layout(next(iter(self.frames.values())), frames, self.height)
        if alike and ranges:
            layout["yaxis"]["range"] = next(iter(ranges.values()))
        shared: dict[tuple, str] = {}
        for trace in [trace for traces in frames.values() for trace in traces]:
            if len(trace["x"]) > SHARED_POINTS:
                name = shared.setdefault(tuple(trace["x"]), f"x{len(shared)}")
                trace["x"] = f"@{name}"
        return {
            "name": self.name,
            "layout": {**layout, **self.more},
            "shared": {name: list(values) for values, name in shared.items()},
            "frames": frames,
            "controls": self.controls,
            "empty": "<br>".join(textwrap.wrap(self.empty, EMPTY_WIDTH)),
            "cursor": self.cursor,
            "ranges": {} if alike else ranges,
        }


def unit_of(title: str) -> str:
    """Return the unit of an axis title, such as N RMS of "Load (N RMS)"; empty for none."""
    return title[title.rfind(" (") + 2 : -1] if title.endswith(")") else ""


def numbers(values: ArrayLike) -> list[float | None]:
    """Return values as a list with DIGITS significant digits, None if not finite."""
    return [
        float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None
        for value in np.ravel(np.asarray(values, dtype=float))
    ]


def traces_of(panel: Panel) -> list[dict[str, Any]]:
    """Return the traces of plotly.js of the items of a panel."""
    found: list[dict[str, Any]] = []
    for item in panel.items:
        if isinstance(item, Series):
            found += _series(panel, item)
        elif isinstance(item, Bars):
            found.append(_bars(panel, item))
        elif isinstance(item, Mark) and item.axis == "y" and panel.x.low and panel.x.high:
            ends = [panel.x.low, panel.x.high]
            line = Series(item.curve, ends, [item.value] * 2, label=item.label)
            found.append(_trace(panel, line) | {"mode": "lines", "line": _line(item)})
    return found


def _series(panel: Panel, item: Series) -> list[dict[str, Any]]:
    trace = _trace(panel, item)
    if item.low is None or item.high is None:
        return [trace]
    low, middle, high = (_in_unit(panel.y, values) for values in (item.low, item.y, item.high))
    if item.band:
        edge = {"type": "scatter", "mode": "lines", "x": trace["x"], "line": {"width": 0}}
        edge |= {"hoverinfo": "skip", "showlegend": False}
        red_green_blue = [str(int(item.colour[at : at + 2], 16)) for at in (1, 3, 5)]
        pale = f"rgba({','.join(red_green_blue)},{BAND})"
        filled = {"fill": "tonexty", "fillcolor": pale}
        return [{**edge, "y": numbers(low)}, {**edge, "y": numbers(high), **filled}, trace]
    ends = {
        "type": "data",
        "symmetric": False,
        "array": numbers(np.maximum(high - middle, 0.0)),
        "arrayminus": numbers(np.maximum(middle - low, 0.0)),
        "thickness": 1,
        "width": 3,
    }
    return [trace | {"error_y": ends}]


def _trace(panel: Panel, item: Series) -> dict[str, Any]:
    """Return the trace of a curve without its range."""
    y_axis = panel.right if item.right and panel.right is not None else panel.y
    x_unit, y_unit = (unit_of(_title(axis)) for axis in (panel.x, y_axis))
    parts = [name for name, has in (("lines", item.line), ("markers", item.marker)) if has]
    name = item.label or item.curve
    trace: dict[str, Any] = {
        "type": "scatter",
        "mode": "+".join(parts),
        "name": name,
        "x": numbers(_in_unit(panel.x, item.x)),
        "y": numbers(_in_unit(y_axis, item.y)),
        "hovertemplate": f"{name}: %{{y:.4g}} {y_unit} at %{{x:.4g}} {x_unit}<extra></extra>",
    }
    if item.line:
        trace["line"] = _line(item)
    if item.marker:
        symbol = SYMBOLS.get(item.marker, "circle") + "-open" * item.hollow
        size = PX * (item.size or POINTS)
        trace["marker"] = {"color": item.colour, "symbol": symbol, "size": size}
    if item.hover:
        trace |= {"customdata": list(item.hover), "hovertemplate": "%{customdata}<extra></extra>"}
    if item.moving is not None:
        trace["meta"] = {"re": trace["y"], "im": numbers(_in_unit(y_axis, item.moving))}
    trace |= {"showlegend": False} if not item.label else {}
    trace |= {"visible": "legendonly"} if item.hidden else {}
    return trace | ({"yaxis": "y2"} if item.right else {})


def _bars(panel: Panel, item: Bars) -> dict[str, Any]:
    return {
        "type": "bar",
        "name": item.label,
        "x": [panel.x.names[place] for place in np.asarray(item.places, int)],
        "y": numbers(_in_unit(panel.y, item.values)),
        "marker": {"color": item.colour},
        "hovertemplate": f"%{{x}} {item.label}: %{{y:.4g}} {unit_of(_title(panel.y))}"
        "<extra></extra>",
    }


def _line(item: Look) -> dict[str, Any]:
    return {"color": item.colour, "width": item.width or 1.2, "dash": DASHES[item.line]}


def _in_unit(axis: Axis, values: ArrayLike) -> np.ndarray:
    """Return values in the unit of an axis; those that a logarithmic one can not show are NaN."""
    found = shown(axis.column, values)
    return np.where(found > 0.0, found, np.nan) if axis.log else found


def _title(axis: Axis) -> str:
    return axis.label or label_of(axis.column)


def _layout(first: Panel, frames: Mapping[str, list[dict]], height: int) -> dict[str, Any]:
    """Return the layout of a plot with a legend below it."""
    layout = {
        "xaxis": _axis(first.x, frames, "x"),
        "yaxis": _axis(first.y, frames, "y"),
        "height": height,
        "margin": {"l": 60, "r": 14 if first.right is None else 70, "t": 32, "b": 50},
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
        "shapes": [_shape(first, item) for item in first.items if isinstance(item, Span)],
    }
    if first.right is not None:
        right = _axis(first.right, frames, "y")
        layout["yaxis2"] = right | {"overlaying": "y", "side": "right", "showgrid": False}
    return layout


def _axis(axis: Axis, frames: Mapping[str, list[dict]], letter: str) -> dict[str, Any]:
    """Return an axis with its title, a light grid and, if it is logarithmic, its ticks."""
    drawn: dict[str, Any] = {
        "title": {"text": _title(axis), "standoff": 8},
        "gridcolor": GRID,
        "zerolinecolor": GREY,
        "linecolor": GREY,
        "ticks": "outside",
        "automargin": True,
        "exponentformat": "power",
    }
    if axis.names:
        return drawn | {"type": "category", "tickangle": -60}
    if letter == "x" and _range(axis):
        drawn["range"] = _range(axis)
    if not axis.log:
        return drawn | ({"rangemode": "tozero"} if letter == "y" and axis.low == 0.0 else {})
    values = [
        value
        for traces in frames.values()
        for trace in traces
        for value in trace[letter]
        if value is not None and value > 0.0
    ]
    ends = [10.0**end for end in _range(axis)] or [min(values, default=1), max(values, default=10)]
    return drawn | {"type": "log", "zerolinecolor": GRID, **_log_ticks(*ends)}


def _log_ticks(low: float, high: float) -> dict[str, Any]:
    """Return the ticks of a logarithmic axis: up to four decades at 1, 2 and 5 in plain numbers,
    more at powers of ten only; less than one is left to plotly.js.
    """
    decades = float(np.log10(high / low))
    ticks: dict[str, Any] = {"dtick": "D2", "tickformat": "~g"}
    if decades < 1.0:
        ticks = {"nticks": 6, "tickformat": "~g"}
    elif decades > PLAIN_DECADES:
        ticks = {"dtick": int(np.ceil(decades / 6.0))}
    if decades <= PLAIN_DECADES and high >= 1e4:
        ticks["tickformat"] = "~s"
    return ticks


def _range(axis: Axis) -> list:
    """Return the ends of an axis as plotly.js takes them, empty if the data set one of them."""
    if axis.low is None or axis.high is None:
        return []
    ends = shown(axis.column, [axis.low, axis.high])
    return numbers(np.log10(ends) if axis.log else ends)


def _shape(panel: Panel, item: Span) -> dict[str, Any]:
    """Return the rectangle of a shaded range."""
    axis, across = (panel.x, "y") if item.axis == "x" else (panel.y, "x")
    low, high = shown(axis.column, [item.low, item.high])
    return {
        "type": "rect",
        f"{across}ref": "paper",
        f"{across}0": 0,
        f"{across}1": 1,
        f"{item.axis}0": float(low),
        f"{item.axis}1": float(high),
        "fillcolor": item.colour,
        "opacity": item.alpha,
        "line": {"width": 0},
        "layer": "below",
    }
