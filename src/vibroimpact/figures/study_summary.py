"""The summary of a study on two pages of A4, for the file: the answer, then what stands behind it."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages
from matplotlib.figure import Figure

from vibroimpact.reports.equivalent_answer import Answer
from vibroimpact.reports.study_content import StudyContent
from vibroimpact.reports.study_statistics import SEVERAL
from vibroimpact.reports.study_tables import Table, answer_table, spread_evenly
from vibroimpact.reports.study_words import load_label, place_in_words

from .style import BLACK, BLUE, GAP_COLOURS, GAP_MARKERS, GREY, PALE, label_of, shown, tidy_log_axis

A4_IN = (8.27, 11.69)
LEFT, RIGHT, TOP, BOTTOM = 0.075, 0.94, 0.955, 0.045  # of the page
LINE = 0.0135  # height of a line of text, of the page
MOST_ROWS = 24  # of the table of answers
MOST_CURVES = 6


class Sheet:
    """One page that is filled from top to bottom.

    figure: of matplotlib.
    y: height that is free below, as a fraction of the page.
    """

    def __init__(self) -> None:
        self.figure = Figure(figsize=A4_IN)
        FigureCanvasPdf(self.figure)
        self.y = TOP

    def text(self, words: str, size: float = 9.0, columns: int = 108, **style) -> None:
        """Write a paragraph, wrapped at a number of columns."""
        lines = textwrap.wrap(words, columns) or [""]
        height = LINE * size / 9.0
        for line in lines:
            self.figure.text(LEFT, self.y, line, fontsize=size, va="top", **style)
            self.y -= 1.12 * height
        self.y -= 0.35 * LINE

    def heading(self, words: str) -> None:
        """Write a heading with a rule below it."""
        self.y -= 0.6 * LINE
        self.figure.text(LEFT, self.y, words, fontsize=11, weight="bold", va="top")
        self.y -= 1.5 * LINE
        self.figure.add_artist(
            _rule(self.y, 0.8, GREY),
        )
        self.y -= 0.7 * LINE

    def table(self, table: Table, size: float = 7.2) -> None:
        """Write a table over the whole width; columns are as wide as their longest text needs."""
        longest = [
            max(
                [*(len(row[at]) for row in table.rows), *map(len, _heading_lines(title))],
                default=1,
            )
            for at, title in enumerate(table.columns)
        ]
        widths = np.array([count + 2.0 for count in longest])
        scale = min((RIGHT - LEFT) / widths.sum(), 0.0098 * size / 7.2)
        edges = LEFT + scale * np.concatenate([[0.0], np.cumsum(widths)])
        numeric, step = table.numeric(), LINE * size / 8.2
        headings = [_heading_lines(title) for title in table.columns]
        most = max(map(len, headings))
        for at, lines in enumerate(headings):
            for index, line in enumerate([""] * (most - len(lines)) + lines):
                self._cell(edges, at, numeric[at], line, index * step, size, weight="bold")
        self.y -= most * step + 0.15 * step
        self.figure.add_artist(_rule(self.y, 0.6, BLACK, edges[-1]))
        self.y -= 0.25 * step
        for row in table.rows:
            for at, cell in enumerate(row):
                self._cell(edges, at, numeric[at], cell, 0.0, size)
            self.y -= 1.12 * step
        self.figure.add_artist(_rule(self.y, 0.4, GREY, edges[-1]))
        self.y -= 0.8 * LINE

    def _cell(self, edges, at, numeric, text, below, size, **style):
        margin = 0.5 * (edges[1] - edges[0]) / max(len(edges), 1)
        place = edges[at + 1] - margin if numeric else edges[at]
        self.figure.text(
            place,
            self.y - below,
            text,
            fontsize=size,
            va="top",
            ha="right" if numeric else "left",
            **style,
        )

    def axes(self, height: float, columns: int = 1) -> list[Axes]:
        """Return axes side by side below what is on the page.

        height: of the axes, as a fraction of the page.
        """
        gap = 0.085
        width = (RIGHT - LEFT - 0.03 - gap * (columns - 1)) / columns
        self.y -= height
        made = [
            self.figure.add_axes((LEFT + 0.03 + at * (width + gap), self.y, width, height))
            for at in range(columns)
        ]
        self.y -= 0.055
        return made

    def footer(self, words: str) -> None:
        """Write a line at the foot of the page."""
        self.figure.text(LEFT, BOTTOM - 0.012, words, fontsize=7, color=GREY, va="top")


def _heading_lines(title: str) -> list[str]:
    return textwrap.wrap(title, 12, break_long_words=False) or [""]


def _rule(y, width, colour, right=RIGHT):
    from matplotlib.lines import Line2D

    return Line2D([LEFT, right], [y, y], color=colour, linewidth=width)


def study_summary(content: StudyContent, path: str | Path) -> None:
    """Write the two pages of a study as PDF."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    pages = [_first_page(content), _second_page(content)]
    try:
        with PdfPages(temporary, metadata={"Title": content.name, "CreationDate": None}) as pdf:
            for number, page in enumerate(pages, start=1):
                page.footer(
                    f"{content.name}: page {number} of {len(pages)}. Made by vibroimpact"
                    f" {content.provenance.version}; the page index.html beside this file has"
                    " every value."
                )
                pdf.savefig(page.figure)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _first_page(content: StudyContent) -> Sheet:
    """Return the page with what was run and the answer."""
    page = Sheet()
    page.figure.text(LEFT, page.y, content.name, fontsize=17, weight="bold", va="top")
    page.y -= 2.4 * LINE
    page.text(content.run())
    for sentence in content.headline() or content.contact():
        page.text(sentence, weight="bold" if content.answers else "normal")
    if content.answers:
        page.heading("Equivalent support against load")
        _equivalent_figure(page, content)
        _answer_table(page, content)
    elif content.statistics.supports:
        page.heading("Contact against load")
        _contact_figure(page, content)
    return page


def _curves(answers: Sequence[Answer]) -> list[tuple[float, str, str]]:
    """Return the (gap, group, direction) that are drawn."""
    places = list(dict.fromkeys(row.place for row in answers))
    return [places[round(at)] for at in spread_evenly(range(len(places)), MOST_CURVES)]


def _equivalent_figure(page: Sheet, content: StudyContent) -> None:
    places = _curves(content.answers)
    for axes, quantity, column in zip(
        page.axes(0.27, 2), ("k", "c"), ("k_N_per_m", "c_N_s_per_m"), strict=True
    ):
        found = False
        for index, place in enumerate(places):
            rows = [row for row in content.answers if row.place == place]
            values = [getattr(row, quantity) for row in rows]
            loads = np.array([row.load_rms_N for row in rows])
            middle, low, high = (
                shown(column, [getattr(value, part) for value in values])
                for part in ("value", "low", "high")
            )
            found = found or bool(np.any(np.isfinite(middle)))
            axes.errorbar(
                loads,
                middle,
                np.maximum([middle - low, high - middle], 0.0),
                color=GAP_COLOURS[index % 6],
                marker=GAP_MARKERS[index % 6],
                capsize=2,
                linewidth=1.0,
                label=place_in_words(*place, several=content.several),
            )
        axes.set_xscale("log")
        if quantity == "k" and found:
            axes.set_yscale("log")
        if not found:
            axes.text(0.5, 0.5, f"{quantity} is not resolved", ha="center", transform=axes.transAxes)
        axes.set_ylabel(label_of(column))
        axes.set_xlabel(load_label(content.config))
        _tidy(axes)
    page.figure.axes[0].legend(loc="upper left", fontsize=7.5)


def _tidy(axes: Axes) -> None:
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_tick_params(labelsize=8)
        if axis.get_scale() == "log":
            tidy_log_axis(axis)


def _answer_table(page: Sheet, content: StudyContent) -> None:
    places = list(dict.fromkeys(row.place for row in content.answers))
    room = int((page.y - BOTTOM - 7 * LINE) / (1.0 * LINE))
    rows = min(MOST_ROWS, room)
    chosen = [places[at] for at in map(round, spread_evenly(range(len(places)), max(rows // 4, 1)))]
    per_place = max(rows // len(chosen), 2)
    shown_rows: list[Answer] = []
    for place in chosen:
        of_place = [row for row in content.answers if row.place == place]
        shown_rows += [
            of_place[round(at)] for at in spread_evenly(range(len(of_place)), per_place)
        ]
    page.text(
        "Recommended values per support: median of the compared methods, and range over seeds and"
        " methods. Damping is in addition to the modal damping."
        + (
            f" {len(shown_rows)} of {len(content.answers)} values of load and gap are listed."
            if len(shown_rows) < len(content.answers)
            else ""
        ),
        size=8,
        columns=125,
    )
    page.table(answer_table(shown_rows, content.several, content.unit))


def _contact_figure(page: Sheet, content: StudyContent) -> None:
    statistics = content.statistics
    for axes, quantity, column, log in zip(
        page.axes(0.27, 2),
        ("contact_fraction", "rms_force"),
        ("contact_fraction", "force_N"),
        (False, True),
        strict=True,
    ):
        for index, gap in enumerate(statistics.gaps[:MOST_CURVES]):
            rows = [statistics.spread(quantity, gap, load, SEVERAL) for load in statistics.loads]
            middle, low, high = (shown(column, part) for part in np.array(rows).T)
            axes.errorbar(
                statistics.loads,
                middle,
                np.maximum([middle - low, high - middle], 0.0),
                color=GAP_COLOURS[index % 6],
                marker=GAP_MARKERS[index % 6],
                capsize=2,
                linewidth=1.0,
                label=f"gap {1e3 * gap:.3g} mm, largest of the supports",
            )
        axes.set_xscale("log")
        if log and any(line.get_ydata().max() > 0.0 for line in axes.lines[:1]):
            axes.set_yscale("log")
        axes.set_xlabel(load_label(content.config))
        axes.set_ylabel(label_of(column))
        _tidy(axes)
    page.figure.axes[0].legend(loc="upper left", fontsize=7.5)


def _second_page(content: StudyContent) -> Sheet:
    """Return the page with contact, stress, agreement and provenance."""
    page = Sheet()
    if content.statistics.supports:
        page.heading("Contact and wear")
        for gap, table in _few(content.contact_tables(_loads_per_gap(content)), 2):
            page.text(f"Gap {1e3 * gap:.3g} mm, medians over seeds", size=8)
            page.table(_shortened(table, 10))
    if content.statistics.sections:
        page.heading("Stress")
        for sentence in content.contact()[-1:]:
            page.text(sentence, size=8, columns=125)
        page.table(_shortened(content.stress(4), 8))
    if content.answers:
        page.heading("What is not resolved, and why")
        reasons = content.reasons()
        if reasons.rows:
            page.table(_cut(_shortened(reasons, 12), 60))
        else:
            page.text("Every value is resolved, and the methods agree on all of them.", size=8)
    if content.energy().rows:
        page.heading("Energy balance")
        page.table(content.energy())
    page.heading("Provenance")
    page.text(content.provenance.versions, size=7.5, columns=130)
    page.table(content.provenance.stage_table())
    return page


def _loads_per_gap(content: StudyContent) -> int:
    supports = max(len(content.statistics.supports), 1)
    return max(10 // supports, 1) if supports < 10 else 1


def _few(values: Sequence, most: int) -> list:
    """Return at most `most` of the values, the first and the last among them."""
    return [values[round(at)] for at in spread_evenly(range(len(values)), most)]


def _shortened(table: Table, most: int) -> Table:
    """Return a table with at most `most` of its rows."""
    return Table(table.columns, _few(table.rows, most))


def _cut(table: Table, most: int) -> Table:
    """Return a table whose cells are cut after a number of letters, with an ellipsis."""
    return Table(
        table.columns,
        [
            tuple(cell if len(cell) <= most else cell[: most - 1] + "…" for cell in row)
            for row in table.rows
        ],
    )
