"""Checks of the simulation: energy balance, contact statistics and stress against load."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.integration.energy_limit import ENERGY_LIMIT
from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series, Text
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED, gap_label
from vibroimpact.reports.study_statistics import EACH, RESIDUALS, SEVERAL, StudyStatistics
from vibroimpact.reports.wear_life import centred_sentence
from vibroimpact.study.cases import case_from_id

from .equivalent import looks_of_gaps
from .seed_scatter import spread

LOOKS = {
    # variable of a record -> (colour, marker)
    "potential_energy_residual": (ORANGE, "s"),
    "energy_residual": (BLUE, "o"),
    "fixed_point_residual": (GREY, "x"),
}
# Largest accepted residual with the potential energy, at the paper's step; of order 2 in the step,
# up to the limit beyond which the numbers of a run are of no use.
PAPER_RATE, PAPER_LOSS = 51200, 3.0e-3
# With the work: an identity of Newmark's scheme; trapezoidal sums with the exact step.
ROUND_OFF, SUMS = 1.0e-9, 3.0e-4
TERMS = {
    "input_work": ("work of the drive", BLACK, "-"),
    "dissipated": ("dissipated by damping", RED, "--"),
    "kinetic": ("kinetic", BLUE, "-"),
    "elastic": ("elastic, tube", GREEN, "-"),
    "contact_potential": ("elastic, contacts", PINK, "-"),
}
FLOOR = 1.0e-12  # of the input work: less, as exact zeros without contact, is drawn here


def file_of_energies(paths: Sequence[str | Path]) -> str | Path:
    """Return the record whose energies are drawn: largest load and gap, first seed."""

    def order(path):
        case = case_from_id(Path(path).stem)
        return case.load_rms_N, case.gap_m, -case.seed

    return max(paths, key=order)


def limits(integration):
    """Return {variable of RESIDUALS: largest accepted value} for a scheme and step.

    The bound of the contact iteration has no limit.
    """
    steps = integration.steps_per_second
    work = ROUND_OFF if integration.scheme == "newmark" else SUMS
    return {
        "potential_energy_residual": min(PAPER_LOSS * (PAPER_RATE / steps) ** 2, ENERGY_LIMIT),
        "energy_residual": work,
    }


def residuals(statistics: StudyStatistics, accepted: Mapping[str, float]) -> list[Item]:
    """Return the points of the energy residuals of all cases and the Marks of their limits.

    accepted: {key of RESIDUALS: largest accepted value}.
    """
    items: list[Item] = []
    for variable, name in RESIDUALS.items():
        cases = statistics.of_cases(variable)
        cases.sort(key=lambda case: (case.load_rms_N, case.gap_m, case.seed))
        if not cases:
            continue
        values, gaps, loads, seeds = map(np.array, zip(*cases, strict=True))
        hover = [
            f"{value:.2g} of the input work<br>{load:.3g} RMS, gap {1e3 * gap:.3g} mm, seed {seed}"
            for value, gap, load, seed in cases
        ]
        colour, marker = LOOKS[variable]
        look: dict[str, Any] = {"colour": colour, "marker": marker, "line": "", "size": 3.5}
        look |= {"label": name, "hover": hover}
        tags = {"gap_m": gaps, "seed": seeds}
        items.append(Series(variable, loads, np.maximum(values, FLOOR), tags, **look))
        if variable in accepted:
            curve, look = f"limit of {variable}", {"colour": colour, "line": "--", "width": 1.0}
            items.append(Mark(curve, "y", accepted[variable], **look))
    return items


def energy_balance(config, statistics, record):
    """Return the Plot of the residuals of all cases and of the energies of one case.

    statistics: StudyStatistics. record: Dataset of the case, with its energies.
    """
    load, gap, seed = (record.attrs[name] for name in ("load_rms_N", "gap_m", "seed"))
    work = (
        "an identity of Newmark's scheme, closed but for round-off"
        if config.integration.scheme == "newmark"
        else "closed as far as trapezoidal sums of work and damping go with the exact modal step"
    )
    caption = (
        "Left: energy balance of every case against load, relative to the work of the drive: with"
        f" the work of the contact forces ({work}), with the potential energy of the contacts in"
        " its place (it measures the time step: the loss at each crossing of the gap), and the"
        " bound of the error left in the implicit contact forces; dashed: accepted at"
        f" {config.integration.steps_per_second:g} steps per second. Values below {FLOOR:g}, as"
        " the zeros without contact, are drawn there. Right: energies during the case of the"
        f" largest load ({load:g} N, gap {gap_label(config, gap)}, seed {seed});"
        " negative times are the start-up before the record."
    )
    time, largest = record["energy_time"].values, float(np.abs(record["energy"]).max())
    energies = []
    for term, (name, colour, line) in TERMS.items():
        values = np.abs(record["energy"].sel(energy_term=term).values)
        energies.append(Series(term, time, values, label=name, colour=colour, line=line))
    panels = {
        "residuals": Panel(
            Axis("load_rms_N", True),
            Axis("residual", True, 0.2 * FLOOR, 1.0e4),  # room for the legend
            residuals(statistics, limits(config.integration)),
            f"residuals of {statistics.cases} cases",
            legend="upper left",
        ),
        "energies": Panel(
            Axis("time_s"),
            Axis("energy_J", True, 1e-6 * largest, 1e3 * largest),
            energies,
            f"energies at {load:g} N RMS",
            legend="upper left",
        ),
    }
    title = "Energy balance of the simulations"
    return Plot("energy_balance", title, caption, panels, size=(7.6, 4.4))


STATISTICS = (
    # panel, variable of a record, column, title
    ("fraction", "contact_fraction", "contact_fraction", "time in contact"),
    ("rate", "impact_rate", "impact_rate_per_s", "impact rate"),
    ("velocity", "impact_velocity_rms", "impact_velocity_m_per_s", "impact velocity, RMS"),
    ("force", "rms_force", "force_N", "support force: RMS, peak (open)"),
    ("wear", "wear_work_rate", "wear_work_rate_W", "wear work rate"),
    ("stress", "stress_peak", "stress_Pa", "largest bending stress"),
)


def contact_statistics(config, model, statistics):
    """Return the Plot of contact statistics and peak stress against load, for every gap.

    statistics: StudyStatistics.
    """
    imperfection = config.integration.imperfection
    caveat = centred_sentence(imperfection, model.centre_offset, min(statistics.gaps))
    caption = (
        "Contact against load, for every gap: fraction of time in contact, impacts per second, RMS"
        " radial velocity at impact, RMS and peak force, wear work rate (normal force times sliding"
        " speed), per support, and the largest bending stress anywhere in the tube with the limit"
        " above which a case is flagged (dashed). Median over seeds and supports, bars from the"
        f" smallest to the largest value. {caveat}"
    ).rstrip()
    panels = {}
    for panel, variable, column, title in STATISTICS:
        items: list[Item] = []
        for gap, look in looks_of_gaps(config, statistics.gaps):
            place = SEVERAL if panel == "stress" else EACH
            look |= {"width": 0.9}
            items += against_load(statistics, variable, gap, place, **look)
            if panel == "force":
                look |= {"line": ":", "hollow": True, "label": ""}
                items += against_load(statistics, "peak_force", gap, place, **look)
        if panel == "stress":
            limit = config.record.stress_limit_Pa
            items.append(Mark("limit", "y", limit, line="--", width=1.0, colour=BLACK))
        if panel == "wear" and caveat:
            words = f"centred to {imperfection:g} of the gap:\nhardly any sliding in plane"
            items.append(Text(words, 0.03, 0.97, "xy", align=("left", "top")))
        axes = Axis("load_rms_N", True), Axis(column, panel != "fraction")
        panels[panel] = Panel(*axes, items, title, "no contact")
    names = list(panels)
    title, look = "Contact, wear and stress against load", {"share": "x", "legend": 3}
    rows = [names[:3], names[3:]]
    return Plot("contact_statistics", title, caption, panels, rows, (9.6, 6.0), **look)


def against_load(
    statistics: StudyStatistics, quantity: str, gap_m: float, place: str, **look: Any
) -> list[Series]:
    """Return the median of a quantity against load with its range, in a list, empty without values.

    place: as of StudyStatistics.values. Zeros (no contact) are left out, but those of a share.
    """
    found = {}
    for load in statistics.loads:
        values = statistics.values(quantity, gap_m, load, place)
        found[load] = [each for each in values if each > 0.0 or quantity == "contact_fraction"]
    found = {load: values for load, values in found.items() if values}
    if not found:
        return []
    middle, low, high = spread([*found.values()])
    tags = {"gap_m": gap_m, "values": [len(values) for values in found.values()]}
    return [Series(quantity, [*found], middle, tags, low, high, **look)]
