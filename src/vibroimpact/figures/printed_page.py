"""A page of A4 that is filled from top to bottom with headings, paragraphs, tables and axes.

Texts are measured, so that they are wrapped and never clipped.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.lines import Line2D
from matplotlib.textpath import text_to_path

from vibroimpact.reports.study_tables import Table, spread_evenly

from .style import BLACK, GREY, PALE

WIDTH_PT, HEIGHT_PT = 595.3, 841.9
LEFT_PT, RIGHT_PT, TOP_PT, BOTTOM_PT = 51.0, 547.0, 800.0, 44.0
LEGEND_SIZE, LEGEND_HANDLE_PT = 7.0, 40.0
PADDING_PT = 9.0  # between the columns of a table
SIZES = (7.2, 6.6, 6.0)  # of the font of a table, the largest that fits
LEADING = 1.32  # line spacing over size of the font


@lru_cache(maxsize=4096)
def width_pt(words: str, size: float, weight: str = "normal") -> float:
    """Return the width of a text in points."""
    font = FontProperties(size=size, weight=weight)
    return float(text_to_path.get_text_width_height_descent(words, font, False)[0])


def wrapped(words: str, size: float, most_pt: float, weight: str = "normal") -> list[str]:
    """Return the lines of a text of which none is wider than most_pt, unless one word is."""
    lines: list[str] = []
    for word in words.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and width_pt(longer, size, weight) <= most_pt:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines or [""]


class PrintedPage:
    """A page of A4.

    figure: of matplotlib.
    y: height in points that the next line starts at; the page is full at BOTTOM_PT.
    """

    def __init__(self) -> None:
        self.figure = Figure(figsize=(WIDTH_PT / 72.0, HEIGHT_PT / 72.0))
        FigureCanvasPdf(self.figure)
        self.y = TOP_PT
        self._legend_y, self._legend_columns = TOP_PT, 1

    @property
    def room_pt(self) -> float:
        """The height that is free below, in points."""
        return self.y - BOTTOM_PT

    def write(self, words: str, x: float, y: float, size: float, **style: Any) -> None:
        """Write one line with its top at a place in points."""
        self.figure.text(
            x / WIDTH_PT, y / HEIGHT_PT, words, fontsize=size, va="top", parse_math=False, **style
        )

    def paragraph(self, words: str, size: float = 9.0, weight: str = "normal") -> None:
        """Write a paragraph over the width of the page."""
        for line in wrapped(words, size, RIGHT_PT - LEFT_PT, weight):
            self.write(line, LEFT_PT, self.y, size, weight=weight)
            self.y -= LEADING * size
        self.y -= 0.35 * size

    def heading(self, words: str) -> None:
        """Write a heading with a rule below it."""
        self.y -= 6.0
        self.write(words, LEFT_PT, self.y, 11.0, weight="bold")
        self.y -= 16.0
        self._rule(0.8, GREY)
        self.y -= 5.0

    def axes(self, height_pt: float, columns: int, labels: Sequence[str]) -> list[Axes]:
        """Return axes side by side, with room for their axis labels, and for a legend above.

        labels: of the legend, which `legend` writes.
        """
        widest = max(width_pt(label, LEGEND_SIZE) for label in labels) + LEGEND_HANDLE_PT
        self._legend_columns = max(int((RIGHT_PT - LEFT_PT) / widest), 1)
        self._legend_y = self.y
        self.y -= 11.0 * -(-len(labels) // self._legend_columns) + 4.0
        left, between, below = 38.0, 56.0, 34.0
        width = (RIGHT_PT - LEFT_PT - left - between * (columns - 1)) / columns
        self.y -= height_pt
        made = [
            self.figure.add_axes(
                (
                    (LEFT_PT + left + at * (width + between)) / WIDTH_PT,
                    self.y / HEIGHT_PT,
                    width / WIDTH_PT,
                    (height_pt - 4.0) / HEIGHT_PT,
                )
            )
            for at in range(columns)
        ]
        self.y -= below
        return made

    def legend(self, axes: Axes) -> None:
        """Write the legend of axes above them."""
        handles, labels = axes.get_legend_handles_labels()
        self.figure.legend(
            handles,
            labels,
            loc="upper left",
            bbox_to_anchor=(LEFT_PT / WIDTH_PT, (self._legend_y + 3.0) / HEIGHT_PT),
            ncols=self._legend_columns,
            fontsize=LEGEND_SIZE,
            frameon=False,
            borderaxespad=0.0,
            borderpad=0.0,
        )

    def table(self, table: Table, most_pt: float | None = None, total: int | None = None) -> None:
        """Write a table.

        most_pt: the height it may take; by default what is left of the page. Of a longer table rows
        are left out evenly, never the first or the last.
        total: number of rows of which the table is a selection. Where rows are left out, a note
        says how many.
        """
        size, widths, head, rows = _laid_out(table)
        step = LEADING * size
        room = min(self.room_pt, self.room_pt if most_pt is None else most_pt) - 20.0
        shown = _rows_that_fit(rows, room / step - max(map(len, head)))
        self._rows([head], widths, table.numeric(), size, "bold", last=True)
        self._rule(0.6, BLACK)
        self.y -= 2.0
        self._rows([rows[at] for at in shown], widths, table.numeric(), size)
        self._rule(0.4, PALE)
        self.y -= 3.0
        if len(shown) < max(len(rows), total or 0):
            note = (
                f"{len(shown)} of {total or len(rows)} rows; the page index.html has all of them."
            )
            self.write(note, LEFT_PT, self.y, 6.5, color=GREY)
            self.y -= step
        self.y -= 5.0

    def footer(self, words: str) -> None:
        """Write a line at the foot of the page."""
        self.write(words, LEFT_PT, BOTTOM_PT - 12.0, 7.0, color=GREY)

    def _rows(self, rows, widths, numeric, size, weight="normal", last=False):
        """Write rows of cells, each a list of lines; last: cells end at the foot of their row."""
        edges = LEFT_PT + np.concatenate([[0.0], np.cumsum(np.asarray(widths) + PADDING_PT)])
        for row in rows:
            most = max(map(len, row))
            for at, lines in enumerate(row):
                x = edges[at] + widths[at] if numeric[at] else edges[at]
                for index, line in enumerate(lines):
                    below = index + (most - len(lines) if last else 0)
                    self.write(
                        line,
                        x,
                        self.y - below * LEADING * size,
                        size,
                        ha="right" if numeric[at] else "left",
                        weight=weight,
                    )
            self.y -= most * LEADING * size

    def _rule(self, width: float, colour: str) -> None:
        y = self.y / HEIGHT_PT
        self.figure.add_artist(
            Line2D([LEFT_PT / WIDTH_PT, RIGHT_PT / WIDTH_PT], [y, y], color=colour, linewidth=width)
        )


def height_pt(table: Table) -> float:
    """Return the height of a table with all its rows, in points."""
    size, _, head, rows = _laid_out(table)
    return 20.0 + LEADING * size * sum(max(map(len, row)) for row in [head, *rows])


def _laid_out(table: Table) -> tuple[float, list[float], list, list]:
    """Return (size, widths, heading, rows) of a table, each cell as its lines."""
    size, widths = _size_and_widths(table)
    head = [
        wrapped(title, size, width, "bold")
        for title, width in zip(table.columns, widths, strict=True)
    ]
    rows = [
        [wrapped(cell, size, width) for cell, width in zip(row, widths, strict=True)]
        for row in table.rows
    ]
    return size, widths, head, rows


def _size_and_widths(table: Table) -> tuple[float, list[float]]:
    """Return (size of the font, widths of the columns in points) of a table that fits the page.

    A smaller font is preferred to wrapped cells; long texts are wrapped all the same.
    """
    for shrink in (False, True):
        for size in SIZES:
            widths = _column_widths(table, size, shrink)
            if sum(widths) + PADDING_PT * (len(widths) - 1) <= RIGHT_PT - LEFT_PT + 0.5:
                return size, widths
    return size, widths


def _column_widths(table: Table, size: float, shrink: bool) -> list[float]:
    """Return the widths of the columns; shrink: long texts get what the others leave."""
    widths, least = [], []
    for at, (title, numeric) in enumerate(zip(table.columns, table.numeric(), strict=True)):
        words = [width_pt(word, size, "bold") for word in title.split()]
        cells = [width_pt(row[at], size) for row in table.rows]
        if not numeric:
            words += [width_pt(word, size) for row in table.rows for word in row[at].split()]
        least.append(max([*words, *(cells if numeric else ())]))
        widths.append(max([min(width_pt(title, size, "bold"), 70.0), *cells, least[-1]]))
    over = sum(widths) + PADDING_PT * (len(widths) - 1) - (RIGHT_PT - LEFT_PT)
    while shrink and over > 0.0:
        slack = np.array(widths) - np.array(least)
        widest = int(np.argmax(slack))
        if slack[widest] <= 0.0:
            break
        taken = min(over, slack[widest])
        widths[widest] -= taken
        over -= taken
    return widths


def _rows_that_fit(rows: Sequence[list[list[str]]], lines: float) -> list[int]:
    """Return the indices of the rows that are shown on a number of lines."""
    heights = [max(map(len, row)) for row in rows]
    for most in range(len(rows), 0, -1):
        chosen = [round(at) for at in spread_evenly(range(len(rows)), most)]
        if sum(heights[at] for at in chosen) <= lines:
            return chosen
    return []
