"""The summary of a study on two pages of A4, for the file: the answer, then what it rests on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages

from vibroimpact.io.whole_file import whole_file
from vibroimpact.reports.equivalent_answer import Answer
from vibroimpact.reports.study_content import MOST_LOADS, StudyContent
from vibroimpact.reports.study_statistics import SEVERAL
from vibroimpact.reports.study_tables import Table, answer_table, spread_evenly
from vibroimpact.reports.study_words import load_label, place_in_words

from .printed_page import LEFT_PT, PrintedPage, height_pt
from .style import GAP_COLOURS, GAP_MARKERS, label_of, shown, tidy_log_axis

MOST_CURVES = 6
# Heights in points.
FIGURE_PT, LEAST_PT, HEADING_PT, GAP_LINE_PT = 190.0, 99.0, 27.0, 14.0


def study_summary(content: StudyContent, path: str | Path) -> None:
    """Write the two pages of a study as PDF, whole or not at all."""
    pages = summary_pages(content)
    with (
        whole_file(path) as temporary,
        PdfPages(temporary, metadata={"Title": content.name, "CreationDate": None}) as pdf,
    ):
        for page in pages:
            pdf.savefig(page.figure)


def summary_pages(content: StudyContent) -> list[PrintedPage]:
    """Return the two pages of a study."""
    pages = [_first_page(content), _second_page(content)]
    for number, page in enumerate(pages, start=1):
        page.footer(
            f"{content.name}, page {number} of {len(pages)}. Made by vibroimpact"
            f" {content.provenance.version}; index.html beside this file has every value."
        )
    return pages


def _first_page(content: StudyContent) -> PrintedPage:
    """Return the page with what was run and the answer."""
    page = PrintedPage()
    page.write(content.name, LEFT_PT, page.y, 17.0, weight="bold")
    page.y -= 27.0
    page.paragraph(content.run())
    for sentence in [*content.warnings, *content.headline()]:
        page.paragraph(sentence, weight="bold")
    for sentence in content.contact():
        page.paragraph(sentence)
    if content.answers:
        page.heading("Equivalent support against load")
        _equivalent_figure(page, content)
        _answer_table(page, content)
    elif content.statistics.supports:
        page.heading("Contact against load")
        _contact_figure(page, content)
        _contact_tables(page, content, 0.5 * page.room_pt - 20.0)
    for gap, table in content.element_tables()[:1]:
        page.heading(f"Local elements{content.at_gap(gap)}")
        page.table(table)
    return page


def _second_page(content: StudyContent) -> PrintedPage:
    """Return the page with contact, stress, agreement and provenance."""
    page = PrintedPage()
    energy, stages = content.energy(), content.provenance.stage_table()
    fixed = (
        height_pt(stages) + 2.0 * HEADING_PT + (height_pt(energy) + HEADING_PT) * bool(energy.rows)
    )
    reasons = content.reasons() if content.answers else Table((), [])
    contact = content.contact_tables() if content.answers else []
    tables = [table for _, table in _ends(contact)] + [content.stress(), reasons]
    most = _shares([height_pt(table) if table.rows else 0.0 for table in tables], page, fixed)
    if contact:
        page.heading("Contact and wear")
        _contact_tables(page, content, most[0])
    if content.statistics.sections:
        page.heading("Stress")
        page.table(content.stress(_loads_that_fit(content.stress, most[-2])), most[-2])
    if content.answers:
        page.heading("What is not resolved, and why")
        if reasons.rows:
            page.table(reasons, most[-1])
        else:
            page.paragraph("Every value is resolved, and the methods agree on all of them.", 8.0)
    if energy.rows:
        page.heading("Energy balance")
        page.table(energy)
    page.heading("Provenance")
    page.paragraph(content.provenance.versions, size=7.2)
    page.table(stages)
    return page


def _shares(needed: Sequence[float], page: PrintedPage, fixed: float) -> list[float]:
    """Return the heights in points that tables may take: what they need, or a share of the page.

    The last table gets what it needs before the others, as far as each keeps LEAST_PT.
    """
    room = page.room_pt - fixed - 3.0 * HEADING_PT - GAP_LINE_PT * (len(needed) - 2)
    least = [min(need, LEAST_PT) for need in needed]
    *more, last = [need - low for need, low in zip(needed, least, strict=True)]
    last = max(min(last, room - sum(least)), 0.0)
    left = max(room - sum(least) - last, 0.0)
    share = min(left / sum(more), 1.0) if sum(more) > 0.0 else 0.0
    return [
        low + extra for low, extra in zip(least, [*(share * x for x in more), last], strict=True)
    ]


def _contact_tables(page: PrintedPage, content: StudyContent, most: float) -> None:
    """Write contact and wear of the first and the last gap; most: height of each in points."""
    loads = _loads_that_fit(lambda count: content.contact_tables(count)[0][1], most)
    for gap, table in _ends(content.contact_tables(loads)):
        page.paragraph(f"Medians over seeds{content.at_gap(gap)}:", size=8.0)
        page.table(table, most)


def _loads_that_fit(table: Callable[[int], Table], most_pt: float) -> int:
    """Return the number of loads, at least two, whose table takes at most a height.

    table: of a number of loads.
    """
    fitting = (n for n in range(MOST_LOADS, 2, -1) if height_pt(table(n)) <= most_pt + 0.5)
    return next(fitting, 2)


def _ends(values: Sequence) -> list:
    """Return the first and the last of some values."""
    return [values[round(at)] for at in spread_evenly(range(len(values)), 2)]


def _equivalent_figure(page: PrintedPage, content: StudyContent) -> None:
    places = list(dict.fromkeys(row.place for row in content.answers))
    places = [places[round(at)] for at in spread_evenly(range(len(places)), MOST_CURVES)]
    columns = {"k": "k_N_per_m", "c": "c_N_s_per_m"}
    labels = [place_in_words(*place, several=content.several) for place in places]
    drawn = page.axes(FIGURE_PT, 2, labels)
    for axes, (quantity, column) in zip(drawn, columns.items(), strict=True):
        for index, place in enumerate(places):
            rows = [row for row in content.answers if row.place == place]
            values = [getattr(row, quantity) for row in rows]
            spread = [[getattr(value, part) for value in values] for part in PARTS]
            loads = [row.load_rms_N for row in rows]
            _curve(axes, index, loads, shown(column, spread), labels[index])
        _finish(axes, content, column, quantity == "k", f"{quantity} is not resolved")
    page.legend(drawn[0])


PARTS = ("value", "low", "high")


def _contact_figure(page: PrintedPage, content: StudyContent) -> None:
    statistics = content.statistics
    panels = (("contact_fraction", "contact_fraction", False), ("rms_force", "force_N", True))
    gaps = statistics.gaps[:MOST_CURVES]
    labels = [f"gap {1e3 * gap:.3g} mm, largest of the supports" for gap in gaps]
    drawn = page.axes(FIGURE_PT, 2, labels)
    for axes, (quantity, column, log) in zip(drawn, panels, strict=True):
        for index, gap in enumerate(gaps):
            rows = [statistics.spread(quantity, gap, load, SEVERAL) for load in statistics.loads]
            values = shown(column, np.array(rows).T)
            _curve(axes, index, statistics.loads, values, labels[index])
        _finish(axes, content, column, log, "no contact")
    page.legend(drawn[0])


def _curve(axes: Axes, index: int, loads: Sequence[float], values: np.ndarray, label: str) -> None:
    """Draw the median, (3, load) values of which the others are the ends of bars."""
    middle, low, high = values
    axes.errorbar(
        loads,
        middle,
        np.maximum([middle - low, high - middle], 0.0),
        color=GAP_COLOURS[index % 6],
        marker=GAP_MARKERS[index % 6],
        capsize=2,
        linewidth=1.0,
        label=label,
    )


def _finish(axes: Axes, content: StudyContent, column: str, log: bool, empty: str) -> None:
    """Give axes their labels and scales, and a sentence where nothing is drawn."""
    values = [value for line in axes.lines for value in np.ravel(line.get_ydata())]
    axes.set_xscale("log")
    loads = content.statistics.loads
    axes.set_xlim(0.8 * loads[0], 1.25 * loads[-1])
    if not np.any(np.isfinite(values)):
        axes.text(0.5, 0.5, empty, ha="center", transform=axes.transAxes, fontsize=8.5)
    elif log and np.nanmax(values) > 0.0:
        axes.set_yscale("log", nonpositive="mask")
    axes.set_xlabel(load_label(content.config), fontsize=8.5)
    axes.set_ylabel(label_of(column), fontsize=8.5)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_tick_params(labelsize=7.5)
        if axis.get_scale() == "log":
            tidy_log_axis(axis)


def _answer_table(page: PrintedPage, content: StudyContent) -> None:
    """Write the recommended values, as many rows of each curve as the page holds."""
    page.paragraph(
        "Recommended values per support: median of the compared methods, and its interval over"
        " seeds. Damping is in addition to the modal damping and may be negative.",
        size=8.0,
    )
    places = list(dict.fromkeys(row.place for row in content.answers))
    rows = max(int(page.room_pt / 9.6) - 5, 4)
    places = [places[round(at)] for at in spread_evenly(range(len(places)), max(rows // 4, 1))]
    chosen: list[Answer] = []
    for place in places:
        curve = [row for row in content.answers if row.place == place]
        kept = spread_evenly(range(len(curve)), max(rows // len(places), 2))
        chosen += [curve[round(at)] for at in kept]
    table = answer_table(chosen, content.several, content.unit)
    page.table(table, total=len(content.answers))
