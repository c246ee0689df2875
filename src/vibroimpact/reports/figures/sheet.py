"""A figure with its data: data drawn through a Sheet are also written to its CSV, in SI units."""

import textwrap
from collections.abc import Iterable, Iterator
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from vibroimpact.io.records import write_cells, write_text
from vibroimpact.io.whole_file import whole_file

from .style import label_of, shown, tidy_log_axes

Column = tuple[str, ArrayLike]  # name of a column, values (point,) in SI
NOTE_WIDTH = 26  # characters of a line in empty axes
TITLE_PER_IN = 10.0  # characters of a title
DIGITS = 7  # significant digits in the CSV
WIDTH_IN, PNG_DPI = 7.6, 160


class Sheet:
    """A figure with a title, a caption, and the table of the data it shows.

    name: stem of its files.
    title: text above the figure.
    caption: its content and how to read it, without reference to the paper.
    mosaic: rows of names of the axes, as matplotlib takes it; they are the table's column panel.
    size: (width, height) in inches.

    axes: {name: axes}. The table has the columns panel and curve, then one per plotted quantity,
    named with its SI unit; cells that do not apply are empty.
    """

    def __init__(
        self,
        name: str,
        title: str,
        caption: str,
        mosaic: Any = (("main",),),
        size: tuple[float, float] | None = None,
        **gridspec: Any,
    ):
        self.name, self.caption = name, caption
        self.tables: list[tuple[str, str, dict[str, np.ndarray]]] = []
        self.figure = Figure(figsize=size or (WIDTH_IN, 4.2), layout="constrained")
        self.axes: dict[str, Axes] = self.figure.subplot_mosaic(mosaic, **gridspec)
        for key, axes in self.axes.items():
            axes.set_label(key)
        wide = int(TITLE_PER_IN * self.figure.get_figwidth())
        self.figure.suptitle(textwrap.fill(title, wide), x=0.01, ha="left")

    def record(self, axes: Axes, curve: str, **values: ArrayLike) -> str:
        """Add rows to the table; return the text "rows FIRST:LAST" of their place in it.

        values: under the name of its column, an array of equal length or a single value, in SI.

        Artists carry the text as their gid.
        """
        lengths = {np.size(value) for value in values.values() if np.ndim(value)}
        if len(lengths) > 1:
            raise ValueError(
                f"{self.name}, {curve}: columns of different lengths {sorted(lengths)}"
            )
        length = lengths.pop() if lengths else 1
        table = {
            column: np.ravel(np.broadcast_to(value, length)) for column, value in values.items()
        }
        first = sum(length_of(other) for _, _, other in self.tables)
        self.tables.append((str(axes.get_label()), curve, table))
        return f"rows {first}:{first + length}"

    def line(
        self,
        axes: Axes,
        x: Column,
        y: Column,
        curve: str,
        low: ArrayLike | None = None,
        high: ArrayLike | None = None,
        tags: dict | None = None,
        band: bool = True,
        **style: Any,
    ) -> None:
        """Draw y over x, with its range from low to high if given: as a band, or as bars.

        x, y: (column, values) with values (point,) in SI, as low and high.
        tags: {column: value} that identify the curve, recorded with each point.
        """
        (x_column, x_values), (y_column, y_values) = x, y
        values: dict[str, ArrayLike] = {x_column: x_values, y_column: y_values}
        ends: dict[str, ArrayLike] = {}
        across, middle = shown(x_column, x_values), shown(y_column, y_values)
        bottom, top = middle, middle
        if low is not None and high is not None:
            ends = {f"{y_column}_low": low, f"{y_column}_high": high}
            bottom, top = shown(y_column, low), shown(y_column, high)
        values = {**ends, **values} if band else {**values, **ends}
        place = self.record(axes, curve, **(tags or {}), **values)
        if ends and not band:
            spread = np.maximum([middle - bottom, top - middle], 0.0)
            style = {"capsize": 2, "linewidth": 1, **style}
            axes.errorbar(across, middle, spread, **style).lines[0].set_gid(place)
        else:
            if ends:
                colour = style.get("color")
                axes.fill_between(across, bottom, top, color=colour, alpha=0.18, linewidth=0)
            axes.plot(across, middle, gid=place, **style)
        self._label(axes, x_column, y_column)

    def note(self, axes: Axes, text: str, x_column: str, y_column: str) -> None:
        """Write into empty axes why they are empty, and label them."""
        lines = textwrap.fill(text, NOTE_WIDTH)
        axes.text(0.5, 0.5, lines, transform=axes.transAxes, ha="center", va="center", fontsize=8)
        self._label(axes, x_column, y_column)

    def save(self, folder: str | Path) -> None:
        """Write name.png, name.pdf, name.csv and the caption as name.txt into a folder.

        The folder is created if it is missing.
        """
        folder = Path(folder)
        tidy_log_axes(self.figure)
        # The canvases are called directly: savefig would draw each file twice, and place the axes
        # again for the second one.
        self.figure.set_dpi(PNG_DPI)
        with whole_file(folder / f"{self.name}.png") as file:
            FigureCanvasAgg(self.figure).print_png(file, metadata={"Software": None})
        self.figure.set_layout_engine("none")
        with whole_file(folder / f"{self.name}.pdf") as file:
            about = {"CreationDate": None, "Title": self.name}
            FigureCanvasPdf(self.figure).print_pdf(file, metadata=about)
        write_cells(self.columns(), self.cells(), folder / f"{self.name}.csv")
        write_text(self.caption + "\n", folder / f"{self.name}.txt")

    def columns(self) -> list[str]:
        """Return the names of the table's columns."""
        return [
            "panel",
            "curve",
            *dict.fromkeys(column for _, _, table in self.tables for column in table),
        ]

    def cells(self) -> Iterator[tuple]:
        """Yield the rows of the table as tuples; cells that do not apply are empty texts."""
        columns = self.columns()
        for panel, curve, table in self.tables:
            values: list[Iterable] = [
                rounded(table[column]) if column in table else repeat("") for column in columns[2:]
            ]
            yield from zip(repeat(panel, length_of(table)), repeat(curve), *values)

    def rows(self) -> list[dict]:
        """Return the table as a list of {column: value}."""
        return [dict(zip(self.columns(), row, strict=True)) for row in self.cells()]

    def _label(self, axes, x_column, y_column):
        if not axes.get_xlabel():
            axes.set_xlabel(label_of(x_column))
        if not axes.get_ylabel():
            axes.set_ylabel(label_of(y_column))


def edges(centres: ArrayLike) -> np.ndarray:
    """Return (n + 1,) cell edges half-way between (n,) ascending centres.

    The outer cells are symmetric about their centres.
    """
    middle = np.asarray(centres, dtype=float)
    if middle.size == 1:
        return middle[0] + np.array([-0.5, 0.5])
    inner = 0.5 * (middle[1:] + middle[:-1])
    return np.concatenate([[2 * middle[0] - inner[0]], inner, [2 * middle[-1] - inner[-1]]])


def length_of(table: dict[str, np.ndarray]) -> int:
    """Return the number of rows of a table {column: (row,)}."""
    return len(next(iter(table.values())))


def rounded(values: ArrayLike) -> list:
    """Return a list of the values, numbers rounded to DIGITS significant digits.

    Further digits are noise and would triple the size of the file.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "f":
        return array.tolist()
    array = array.astype(float)
    usable = np.isfinite(array) & (array != 0.0)
    known: np.ndarray = array[usable]
    size = np.floor(np.log10(np.abs(known)))
    short, scale = size < DIGITS, 10.0 ** np.abs(DIGITS - 1 - size)
    array[usable] = np.where(short, np.round(known * np.where(short, scale, 1.0)) / scale, known)
    return array.tolist()
