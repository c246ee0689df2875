"""Contact, wear and stress of each support against load, and the energy balance of every case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Bars, Item, Mark, Panel, Series
from vibroimpact.reports.figures.study.checks import RESIDUALS, residual_items
from vibroimpact.reports.figures.study.equivalent import look_of_gap
from vibroimpact.reports.figures.style import BLACK, BLUE, RED
from vibroimpact.reports.study_statistics import SEVERAL, StudyStatistics

from .page_plot import Frames, PagePlot, key_of

MOST_CURVES = 12  # more supports are shown by the largest value of all
# quantity -> (axis, title, sentences)
AGAINST_LOAD = {
    "contact_fraction": (
        Axis("contact_fraction", low=0.0),
        "Time in contact",
        "Share of the time that each support is touched, against load. It is zero until the gap is"
        " bridged; towards high load the tube rests on its supports more and more.",
    ),
    "impact_rate": (
        Axis("impact_rate_per_s", True),
        "Impacts per second",
        "Contacts begun per second at each support, against load. The rate levels off once the"
        " tube touches in every cycle of its motion.",
    ),
    "force": (
        Axis("force_N", True),
        "Support force",
        "RMS (solid) and largest (dotted) force of each support against load, median and range"
        " over seeds. The largest force grows slowly with the length of the record; the RMS"
        " does not.",
    ),
    "wear_work_rate": (
        Axis("wear_work_rate_W", True),
        "Wear work rate",
        "Normal force times sliding speed, mean over time, of each support against load. With a"
        " wear coefficient it gives the volume that is worn off per second.",
    ),
}
NAMES = {"force": "support_force"}  # of the plots that are not named after their quantity
FORCES = {"rms_force": (", RMS", "-"), "peak_force": (", peak", ":")}
STRESSES = (("stress_rms", "RMS", BLUE, "o"), ("stress_peak", "peak", RED, "^"))
LEAST_RESIDUAL = 1.0e-12  # of the input work: less is round-off


def contact_plots(statistics: StudyStatistics, loads: Axis, caveat: str) -> list[PagePlot]:
    """Return the plots of contact, impacts, forces and wear against load, by gap.

    caveat: on the wear work rate, may be empty.
    """
    known = {name for name in AGAINST_LOAD if math.isfinite(statistics.largest(name)[0])}
    if not statistics.supports or not known:
        return []
    plots = []
    for name in [name for name in AGAINST_LOAD if name in known | {"force"}]:
        axis, title, caption = AGAINST_LOAD[name]
        frames = {
            key_of(at): Panel(loads, axis, _of_supports(statistics, gap, name))
            for at, gap in enumerate(statistics.gaps)
        }
        more = f" {caveat}".rstrip() if name == "wear_work_rate" else ""
        empty = "No contact at any load of this gap."
        plots.append(_by_gap(NAMES.get(name, name), title, caption + more, frames, empty))
    return plots


def _by_gap(name, title, caption, frames, empty="Nothing to show here."):
    return PagePlot(name, title, caption, frames, ("gap",), empty, cursor=True, height=340)


def _of_supports(statistics, gap, name):
    """Return the curves of a quantity of all supports."""
    places = statistics.supports if len(statistics.supports) <= MOST_CURVES else [SEVERAL]
    found = []
    for quantity, (word, line) in FORCES.items() if name == "force" else [(name, ("", "-"))]:
        for index, place in enumerate(places):
            shown_as = "largest of the supports" if place == SEVERAL else place
            look = look_of_gap(index) | {"line": line, "label": shown_as + word}
            log = AGAINST_LOAD[name][0].log
            found += _curve(statistics, quantity, gap, place, log=log, **look)
    return found


def _curve(statistics, quantity, gap, place, log, **look: Any) -> list[Series]:
    """Return the median over seeds against load with its range, in a list, empty without values."""
    rows = [statistics.spread(quantity, gap, load, place) for load in statistics.loads]
    middle, low, high = np.array(rows, dtype=float).reshape(-1, 3).T
    if not np.any(np.isfinite(middle) & ((middle > 0.0) | (not log))):
        return []
    return [Series(quantity, statistics.loads, middle, {}, low, high, **look)]


def stress_plots(
    statistics: StudyStatistics, loads: Axis, places: Frames, limit_Pa: float
) -> list[PagePlot]:
    """Return the plots of the largest stress against load and of the stress by section.

    places: (key of the frame, (gap, load)).
    limit_Pa: above which a case is flagged.
    """
    if not statistics.sections:
        return []
    limit = Mark("limit", "y", limit_Pa, label="limit", colour=BLACK, line="--", width=1.0)
    frames = {}
    for at, gap in enumerate(statistics.gaps):
        items: list[Item] = []
        for quantity, label, colour, marker in STRESSES:
            look = {"label": label, "colour": colour, "marker": marker}
            items += _curve(statistics, quantity, gap, SEVERAL, log=True, **look)
        frames[key_of(at)] = Panel(loads, Axis("stress_Pa", True), [*items, limit])
    caption = (
        "RMS and largest bending stress of the most stressed section against load, median and range"
        " over seeds. A case whose peak passes the dashed limit is flagged; the model itself stays"
        " linear elastic."
    )
    return [
        _by_gap("stress", "Largest bending stress", caption, frames),
        _stress_by_section(statistics, places),
    ]


def _stress_by_section(statistics, places):
    names = statistics.sections
    sections = Axis("section", names=[name.replace("_", " ") for name in names])
    frames = {}
    for key, (gap, load) in places:
        bars = []
        for quantity, label, colour, _ in STRESSES:
            middle = [statistics.spread(quantity, gap, load, name).median for name in names]
            bars.append(Bars(quantity, range(len(names)), middle, label=label, colour=colour))
        frames[key] = Panel(sections, Axis("stress_Pa"), bars)
    return PagePlot(
        "stress_sections",
        "Bending stress by section",
        (
            "RMS and largest bending stress of each section at the chosen gap and load, median over"
            " seeds. The highest bar is the most stressed section."
        ),
        frames,
        ("gap", "load"),
        more={"legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0}},
    )


def energy_plots(
    statistics: StudyStatistics, loads: Axis, limits: Mapping[str, float]
) -> list[PagePlot]:
    """Return the plot of the energy residuals of all gaps in a list, empty if none was recorded.

    limits: {quantity: largest accepted value}.
    """
    found = {}
    for quantity in RESIDUALS:
        rows = [
            (load, statistics.spread(quantity, gap, load).high, gap)
            for gap in statistics.gaps
            for load in statistics.loads
        ]
        rows = [row for row in rows if row[1] >= LEAST_RESIDUAL]
        if rows:
            levels, values, gaps = zip(*rows, strict=True)
            found[quantity] = (levels, values, {"gap_m": gaps})
    if not found:
        return []
    caption = (
        "Energy that the simulation fails to account for, over the work of the drive: the worst"
        " seed of every load and gap. Markers below the dashed line of their colour are within"
        f" the error of the time step. Less than {LEAST_RESIDUAL:g}, as without contact,"
        " is left out."
    )
    title = "Open energy balance, case by case"
    frames = {"": Panel(loads, Axis("residual", True), residual_items(found, limits))}
    return [PagePlot("energy", title, caption, frames, wide=True, height=380)]
