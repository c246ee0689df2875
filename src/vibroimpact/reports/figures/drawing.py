"""Plots drawn with matplotlib: PNG and PDF, with the CSV of the plotted data."""

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize

from .plot import Axis, Bars, ColourBar, Look, Map, Mark, Panel, Plot, Series, Signs, Span, Text
from .sheet import Sheet, edges
from .style import ORDERED, label_of, shown, tidy_log_axis


def save_plots(plots: Iterable[Plot | Sheet], folder: str | Path) -> list[Path]:
    """Write the files of plots into a folder; return the pictures of those that have a table."""
    pictures = []
    for plot in plots:
        sheet = drawn(plot)
        sheet.save(folder)
        if sheet.tables:
            pictures.append(Path(folder) / f"{sheet.name}.png")
    return pictures


def drawn(plot: Plot | Sheet) -> Sheet:
    """Return the Sheet of a plot; a picture that only matplotlib draws is one already."""
    if isinstance(plot, Sheet):
        return plot
    rows = [list(row) for row in plot.rows or [list(plot.panels)]]
    grid: dict[str, Any] = {"width_ratios": plot.widths, "height_ratios": plot.heights}
    grid |= {f"share{letter}": letter in plot.share for letter in "xy"}
    sheet = Sheet(plot.name, plot.title, plot.caption, rows, plot.size, **grid)
    for key, panel in plot.panels.items():
        _draw_panel(sheet, sheet.axes[key], panel)
    _label_outside(sheet, rows, plot.share)
    if plot.legend:
        _legend_below(sheet, plot)
    for bar in plot.colour_bars:
        _colour_bar(sheet, bar)
    sheet.figure.align_ylabels()
    return sheet


def _label_outside(sheet: Sheet, rows: list[list[str]], share: str) -> None:
    """Leave labels of shared axes to the lowest panel of a column and the first of a row, and the
    same label of panels side by side to the left one.
    """
    lowest = {_named(column)[-1] for column in zip(*rows, strict=True)}
    first = {_named(row)[0] for row in rows}
    labels = {name: axes.get_ylabel() for name, axes in sheet.axes.items()} | {".": ""}
    for left, right in (pair for row in rows for pair in pairwise(row)):
        if left != right and labels[left] == labels[right] and right != ".":
            sheet.axes[right].set_ylabel("")
    for letter, side, outer in (("x", "labelbottom", lowest), ("y", "labelleft", first)):
        for name, axes in sheet.axes.items() if letter in share else ():
            shown_outside: dict[str, Any] = {side: name in outer}
            axes.tick_params(**shown_outside)
            if name not in outer:
                axes.set(**{f"{letter}label": ""})


def _named(panels: Iterable[str]) -> list[str]:
    return [name for name in panels if name != "."]


def _draw_panel(sheet: Sheet, axes: Axes, panel: Panel) -> None:
    axes.set_title(panel.title)
    right = None
    if panel.right is not None:  # its own vertical scale, behind the other
        own = [item.curve for item in panel.items if isinstance(item, Series) and item.right]
        right = axes.twinx()
        right.set_label(" ".join([str(axes.get_label()), *own]))
        right.grid(False)
        axes.set_zorder(right.get_zorder() + 1)
        axes.patch.set_visible(False)
    for item in panel.items:
        on_right = isinstance(item, Series) and item.right
        DRAW[type(item)](sheet, right if on_right else axes, panel, item)
    empty = panel.is_empty()
    if empty and panel.note:
        sheet.note(axes, panel.note, panel.x.column, panel.y.column)
    _finish_axis(axes, "x", panel.x, empty)
    _finish_axis(axes, "y", panel.y, empty)
    if right is not None and panel.right is not None:
        _finish_axis(right, "y", panel.right, empty)
    if panel.blank:
        axes.set_axis_off()
    if panel.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if panel.legend and axes.get_legend_handles_labels()[1]:
        look: Any = {"loc": panel.legend, "title": panel.legend_title or None}
        axes.legend(**look, ncols=panel.legend_columns)


def _finish_axis(axes: Axes, letter: str, axis: Axis, empty: bool) -> None:
    """Give an axis its label, scale, names and limits."""
    label = axis.label or ("" if axis.names else label_of(axis.column))
    values: dict[str, Any] = {"label": "" if axis.bare else label}
    which: Any = letter
    if axis.bare:
        axes.tick_params(axis=which, labelbottom=False, labelleft=False)
    if axis.names:
        count = len(axis.names)
        values |= {"ticks": range(count), "ticklabels": axis.names, "lim": (count - 0.5, -0.5)}
        axes.grid(False, axis=which)
    elif axis.log and not empty:
        values["scale"] = "log"
    ends = [None if end is None else shown(axis.column, end) for end in (axis.low, axis.high)]
    if ends != [None, None]:
        values["lim"] = ends
    axes.set(**{f"{letter}{key}": value for key, value in values.items()})
    if axis.names:
        axes.tick_params(axis=which, labelsize=8)


def _style(item: Look) -> dict[str, Any]:
    """Return the keywords of matplotlib for a line."""
    style = {
        "label": item.label or None,
        "color": item.colour,
        "linestyle": item.line or "none",
        "marker": item.marker or None,
        "linewidth": item.width,
        "markersize": item.size,
        "markerfacecolor": "white" if item.hollow else None,
        "markeredgewidth": 0.0 if item.marker == "." else None,
        "alpha": item.alpha,
        "zorder": item.order,
    }
    return {key: value for key, value in style.items() if value is not None}


def _series(sheet: Sheet, axes: Axes, panel: Panel, item: Series) -> None:
    y_axis = panel.right if item.right and panel.right is not None else panel.y
    x, y, tags = (panel.x.column, item.x), (y_axis.column, item.y), dict(item.tags)
    if not item.curve:
        axes.plot(shown(*x), shown(*y), **_style(item))
    else:
        ends, look = (item.low, item.high), _style(item)
        sheet.line(axes, x, y, item.curve, *ends, tags, band=item.band, **look)


def _bars(sheet: Sheet, axes: Axes, panel: Panel, item: Bars) -> None:
    across = bool(panel.y.names)
    column = panel.x.column if across else panel.y.column
    place = sheet.record(axes, item.curve, **{column: item.values, **item.tags})
    start = np.zeros(np.shape(item.values)) if item.start is None else shown(column, item.start)
    colour = list(item.colours) or item.colour
    drawn = (axes.barh if across else axes.bar)(
        item.places,
        shown(column, item.values),
        item.thickness,
        start,
        color=colour,
        label=item.label or None,
        zorder=2,
    )
    for bar, text in zip(drawn, item.texts or [""] * len(drawn), strict=True):
        bar.set_gid(place)
        end = bar.get_x() + bar.get_width(), bar.get_y() + 0.5 * bar.get_height()
        axes.annotate(text, end, (3, 0), textcoords="offset points", va="center", fontsize=8)


def _mark(sheet: Sheet, axes: Axes, panel: Panel, item: Mark) -> None:
    axis, upright = (panel.x, True) if item.axis == "x" else (panel.y, False)
    if item.curve:
        sheet.record(axes, item.curve, **{axis.column: item.value})
    place = float(shown(axis.column, item.value))
    (axes.axvline if upright else axes.axhline)(place, **_style(item))


def _signs(sheet: Sheet, axes: Axes, panel: Panel, item: Signs) -> None:
    sheet.record(axes, item.curve, **{panel.x.column: item.values})
    axes.plot(
        shown(panel.x.column, item.values),
        np.full(np.size(item.values), item.height),
        transform=axes.get_xaxis_transform(),
        markeredgecolor="black",
        markeredgewidth=0.6,
        clip_on=False,
        **(_style(item) | {"linestyle": "none"}),
    )


def _span(sheet: Sheet, axes: Axes, panel: Panel, item: Span) -> None:
    column = (panel.x if item.axis == "x" else panel.y).column
    span = axes.axvspan if item.axis == "x" else axes.axhspan
    ends = (float(shown(column, end)) for end in (item.low, item.high))
    span(*ends, color=item.colour, alpha=item.alpha, linewidth=0, zorder=0)


def _text(sheet: Sheet, axes: Axes, panel: Panel, item: Text) -> None:
    frames: Any = tuple("axes fraction" if at in item.of_panel else "data" for at in "xy")
    x, y = (
        value if letter in item.of_panel else float(shown(axis.column, value))
        for letter, axis, value in (("x", panel.x, item.x), ("y", panel.y, item.y))
    )
    axes.annotate(
        item.words,
        (x, y),
        xycoords=frames,
        xytext=item.shift,
        textcoords="offset points",
        ha=item.align[0],
        va=item.align[1],
        color=item.colour,
        fontsize=item.size,
        rotation=item.rotation,
    )


def _map(sheet: Sheet, axes: Axes, panel: Panel, item: Map) -> None:
    """Draw a map; it is rasterised in PDF."""
    rows, columns = np.shape(item.z)
    table = {
        panel.y.column: np.repeat(item.y, columns),
        panel.x.column: np.tile(item.x, rows),
        item.z_column: np.ravel(item.z),
    }
    place = sheet.record(axes, item.curve, **table)
    across = edges(shown(panel.x.column, item.x)) if item.edges is None else item.edges
    values, up = shown(item.z_column, item.z), np.arange(rows + 1) - 0.5
    if panel.y.names:
        values = np.maximum(values, item.low)
    else:
        up = np.exp(edges(np.log(shown(panel.y.column, item.y))))
        axes.grid(False)
    norm = (LogNorm if item.log else Normalize)(item.low, item.high)
    axes.pcolormesh(across, up, values, norm=norm, rasterized=True, gid=place)


DRAW: dict[type, Any] = {
    Series: _series,
    Bars: _bars,
    Mark: _mark,
    Signs: _signs,
    Span: _span,
    Text: _text,
    Map: _map,
}


def _legend_below(sheet: Sheet, plot: Plot) -> None:
    """Add the legend of the panels without one of their own below all, each label once."""
    named: dict[str, Any] = {}
    for key in [key for key, panel in plot.panels.items() if not panel.legend]:
        for handle, label in zip(*sheet.axes[key].get_legend_handles_labels(), strict=True):
            named.setdefault(label, handle)
    if named:
        look: dict[str, Any] = {"loc": "outside lower center", "ncols": plot.legend}
        sheet.figure.legend([*named.values()], [*named], **look)


def _colour_bar(sheet: Sheet, bar: ColourBar) -> None:
    """Add a colour bar to the right of all panels, or below some."""
    norm = (LogNorm if bar.log else Normalize)(bar.low, bar.high)
    colours = ScalarMappable(norm, ORDERED if bar.curves else matplotlib.colormaps["viridis"])
    axes = [sheet.axes[name] for name in bar.panels or sheet.axes]
    place: dict[str, Any] = {"extend": bar.ends}
    if bar.panels:
        place = {"location": "bottom", "aspect": 14}
    drawn = sheet.figure.colorbar(colours, ax=axes, pad=0.02, label=label_of(bar.column), **place)
    if bar.panels:
        tidy_log_axis(drawn.ax.xaxis)
        drawn.ax.tick_params(labelsize=8)
