"""Contact, wear and stress of each support against load, and the energy balance of every case."""

from collections.abc import Mapping
from itertools import product
from typing import Any

from vibroimpact.reports.figures.plot import Axis, Bars, Item, Mark, Panel
from vibroimpact.reports.figures.study.checks import FLOOR, against_load, residuals
from vibroimpact.reports.figures.study.equivalent import look_of_gap
from vibroimpact.reports.figures.style import BLACK, BLUE, RED
from vibroimpact.reports.study_statistics import SEVERAL, StudyStatistics

from .page_plot import PagePlot

MOST_CURVES = 12  # more supports are shown by the largest value of all
# name of the plot -> (quantities, axis, title, sentences)
AGAINST_LOAD: dict[str, tuple[tuple[str, ...], Axis, str, str]] = {
    "contact_fraction": (
        ("contact_fraction",),
        Axis("contact_fraction", low=0.0),
        "Time in contact",
        "Share of the time that each support is touched, against load. It is zero until the gap is"
        " bridged; towards high load the tube rests on its supports more and more.",
    ),
    "impact_rate": (
        ("impact_rate",),
        Axis("impact_rate_per_s", True),
        "Impacts per second",
        "Contacts begun per second at each support, against load. The rate levels off once the"
        " tube touches in every cycle of its motion.",
    ),
    "support_force": (
        ("rms_force", "peak_force"),
        Axis("force_N", True),
        "Support force",
        "RMS (solid) and largest (dotted) force of each support against load, median and range"
        " over seeds. The largest force grows slowly with the length of the record; the RMS"
        " does not.",
    ),
    "wear_work_rate": (
        ("wear_work_rate",),
        Axis("wear_work_rate_W", True),
        "Wear work rate",
        "Normal force times sliding speed, mean over time, of each support against load. With a"
        " wear coefficient it gives the volume that is worn off per second.",
    ),
}
FORCES = {"rms_force": (", RMS", "-"), "peak_force": (", peak", ":")}
STRESSES = (("stress_rms", "RMS", BLUE, "o"), ("stress_peak", "peak", RED, "^"))


def contact_plots(statistics: StudyStatistics, loads: Axis, caveat: str) -> list[PagePlot]:
    """Return the plots of contact, impacts, forces and wear against load, by gap.

    caveat: on the wear work rate, may be empty.
    """
    places = statistics.supports if len(statistics.supports) <= MOST_CURVES else [SEVERAL]
    plots = []
    for name, (quantities, axis, title, caption) in AGAINST_LOAD.items():
        if not statistics.supports or not set(quantities) & statistics.quantities:
            continue
        frames: dict[tuple, Panel] = {}
        for gap in statistics.gaps:
            items: list[Item] = []
            for quantity, (index, place) in product(quantities, enumerate(places)):
                word, line = FORCES.get(quantity, ("", "-"))
                shown_as = "largest of the supports" if place == SEVERAL else place
                look = look_of_gap(index) | {"line": line, "label": shown_as + word}
                items += against_load(statistics, quantity, gap, place, **look)
            frames[(gap,)] = Panel(loads, axis, items)
        caption += f" {caveat}".rstrip() if name == "wear_work_rate" else ""
        empty = "No contact at any load of this gap."
        mark: dict[str, Any] = {"cursor": True, "height": 340}
        plots.append(PagePlot(name, title, caption, frames, ("gap",), empty, **mark))
    return plots


def stress_plots(
    statistics: StudyStatistics, loads: Axis, slider: list[float], limit_Pa: float
) -> list[PagePlot]:
    """Return the plots of the largest stress against load and of the stress by section.

    slider: loads of the stress by section.
    limit_Pa: above which a case is flagged.
    """
    if not statistics.sections:
        return []
    limit = Mark("limit", "y", limit_Pa, label="limit", colour=BLACK, line="--", width=1.0)
    names = statistics.sections
    words = [name.replace("_", " ") for name in names]
    sections = Axis("section", label="Section", names=words)
    frames: dict[tuple, Panel] = {}
    by_section: dict[tuple, Panel] = {}
    for gap in statistics.gaps:
        items: list[Item] = []
        for quantity, label, colour, marker in STRESSES:
            look = {"label": label, "colour": colour, "marker": marker}
            items += against_load(statistics, quantity, gap, SEVERAL, **look)
        frames[(gap,)] = Panel(loads, Axis("stress_Pa", True), [*items, limit])
        for load in slider:
            bars = []
            for quantity, label, colour, _ in STRESSES:
                middle = [statistics.spread(quantity, gap, load, name).median for name in names]
                bars.append(Bars(quantity, range(len(names)), middle, label=label, colour=colour))
            by_section[gap, load] = Panel(sections, Axis("stress_Pa"), bars)
    caption = (
        "RMS and largest bending stress of the most stressed section against load, median and range"
        " over seeds. A case whose peak passes the dashed limit is flagged; the model itself stays"
        " linear elastic."
    )
    of_sections = (
        "RMS and largest bending stress of each section at the chosen gap and load, median over"
        " seeds. The highest bar is the most stressed section."
    )
    above: dict[str, Any] = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0}
    title, more = "Bending stress by section", {"legend": above}
    mark: dict[str, Any] = {"cursor": True, "height": 340}
    return [
        PagePlot("stress", "Largest bending stress", caption, frames, ("gap",), **mark),
        PagePlot("stress_sections", title, of_sections, by_section, ("gap", "load"), more=more),
    ]


def energy_plots(
    statistics: StudyStatistics, loads: Axis, limits: Mapping[str, float]
) -> list[PagePlot]:
    """Return the plot of the energy residuals of all cases in a list.

    limits: {quantity: largest accepted value}.
    """
    caption = (
        "Energy that the simulation fails to account for, over the work of the drive, of every"
        " case. Markers below the dashed line of their colour are within the error of the time"
        f" step. Less than {FLOOR:g}, as without contact, is drawn there."
    )
    panel = Panel(loads, Axis("residual", True), residuals(statistics, limits))
    title = "Open energy balance, case by case"
    return [PagePlot("energy", title, caption, {(): panel}, wide=True, height=380)]
