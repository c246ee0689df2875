"""Checks of the simulation: energy balance, contact statistics and stress against load."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.integration.energy_limit import ENERGY_LIMIT
from vibroimpact.reports.centred_wear import centred_sentence
from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series, Text
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, PINK, RED, gap_label
from vibroimpact.study.cases import case_from_id

from .cases_of_gap import CasesOnDemand
from .equivalent import looks_of_gaps
from .seed_scatter import over_seeds

RESIDUALS = {
    # variable of a record -> (name, colour, marker)
    "potential_energy_residual": ("with the contact's potential energy", ORANGE, "s"),
    "energy_residual": ("with the work of the contact forces", BLUE, "o"),
    "fixed_point_residual": ("contact iteration (bound)", GREY, "x"),
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


def case_of_energies(cases):
    """Return the Case whose energies are drawn: largest load and gap, first seed."""
    return max(cases, key=lambda case: (case.load_rms_N, case.gap_m, -case.seed))


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


def residual_items(found, accepted) -> list[Item]:
    """Return the points of energy residuals of cases and the Marks of their limits.

    found: {key of RESIDUALS: (loads, values, {further column: values})}.
    accepted: {key of RESIDUALS: largest accepted value}.
    """
    items: list[Item] = []
    for variable, (loads, values, tags) in found.items():
        name, colour, marker = RESIDUALS[variable]
        look: dict[str, Any] = {"colour": colour, "marker": marker, "line": "", "size": 3.5}
        hover = [
            f"{value:.2g} of the input work<br>{load:.3g} RMS, gap {1e3 * gap:.3g} mm"
            for load, value, gap in zip(loads, values, tags["gap_m"], strict=True)
        ]
        items.append(Series(variable, loads, values, tags, label=name, hover=hover, **look))
        if variable in accepted:
            curve, look = f"limit of {variable}", {"colour": colour, "line": "--", "width": 1.0}
            items.append(Mark(curve, "y", accepted[variable], **look))
    return items


def energy_balance(config, records):
    """Return the Plot of the residuals of all cases and of the energies of one case.

    records: {Case: Dataset} of statistics.
    """
    case, accepted = case_of_energies(records), limits(config.integration)
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
        f" largest load ({case.load_rms_N:g} N, gap"
        f" {gap_label(config, case.gap_m)}, seed {case.seed});"
        " negative times are the start-up before the record."
    )
    loads = [key.load_rms_N for key in records]
    tags = {name: np.array([getattr(key, name) for key in records]) for name in ("gap_m", "seed")}
    found = {}
    for variable in RESIDUALS:
        values = [float(dataset[variable]) for dataset in records.values()]
        found[variable] = (loads, np.maximum(values, FLOOR), tags)
    residuals = Panel(
        Axis("load_rms_N", True),
        Axis("residual", True, 0.2 * FLOOR, 1.0e4),  # room for the legend
        residual_items(found, accepted),
        f"residuals of {len(records)} cases",
        legend="upper left",
    )
    panels = {"residuals": residuals, "energies": _energies(records[case], case)}
    title = "Energy balance of the simulations"
    return Plot("energy_balance", title, caption, panels, size=(7.6, 4.4))


def _energies(record, case):
    """Return the Panel of the energy terms of a case over time."""
    time, largest = record["energy_time"].values, float(np.abs(record["energy"]).max())
    items = []
    for term, (name, colour, line) in TERMS.items():
        values = np.abs(record["energy"].sel(energy_term=term).values)
        items.append(Series(term, time, values, label=name, colour=colour, line=line))
    axis = Axis("energy_J", True, 1e-6 * largest, 1e3 * largest)  # room for the legend
    title = f"energies at {case.load_rms_N:g} N RMS"
    return Panel(Axis("time_s"), axis, items, title, legend="upper left")


STATISTICS = (
    # panel, variable of a record, column, title
    ("fraction", "contact_fraction", "contact_fraction", "time in contact"),
    ("rate", "impact_rate", "impact_rate_per_s", "impact rate"),
    ("velocity", "impact_velocity_rms", "impact_velocity_m_per_s", "impact velocity, RMS"),
    ("force", "rms_force", "force_N", "support force: RMS, peak (open)"),
    ("wear", "wear_work_rate", "wear_work_rate_W", "wear work rate"),
    ("stress", "stress_peak", "stress_Pa", "largest bending stress"),
)
# Variables that are read of every record.
VARIABLES = (*RESIDUALS, *(variable for _, variable, _, _ in STATISTICS), "peak_force")


def records_shown(paths, read):
    """Return {Case: Dataset} of record files with the variables drawn here.

    A file is read by read(path, names) when its case is used.
    """
    drawn = case_of_energies(CasesOnDemand(paths, None))

    def read_one(path):
        whole = case_from_id(Path(path).stem) == drawn
        return read(path, (*VARIABLES, "energy") if whole else VARIABLES)

    return CasesOnDemand(paths, read_one)


def contact_statistics(config, model, records):
    """Return the Plot of contact statistics and peak stress against load, for every gap.

    records: {Case: Dataset} of statistics.
    """
    imperfection = config.integration.imperfection
    gaps = sorted({case.gap_m for case in records}, reverse=True)
    caveat = centred_sentence(imperfection, model.centre_offset, min(gaps))
    caption = (
        "Contact against load, for every gap: fraction of time in contact, impacts per second, RMS"
        " radial velocity at impact, RMS and peak force, wear work rate (normal force times sliding"
        " speed), per support, and the largest bending stress anywhere in the tube with the limit"
        " above which a case is flagged (dashed). Median over seeds and supports, bars from the"
        f" smallest to the largest value. {caveat}"
    ).rstrip()
    items = {
        panel: _of_gaps(config, records, gaps, variable, column)
        for panel, variable, column, _ in STATISTICS
    }
    limit = config.record.stress_limit_Pa
    items["stress"].append(Mark("limit", "y", limit, line="--", width=1.0, colour=BLACK))
    if caveat:
        words = f"centred to {imperfection:g} of the gap:\nhardly any sliding in plane"
        items["wear"].append(Text(words, 0.03, 0.97, "xy", align=("left", "top")))
    loads = Axis("load_rms_N", True)
    panels = {
        panel: Panel(loads, Axis(column, panel != "fraction"), items[panel], title, "no contact")
        for panel, _, column, title in STATISTICS
    }
    names = list(panels)
    title, look = "Contact, wear and stress against load", {"share": "x", "legend": 3}
    rows = [names[:3], names[3:]]
    return Plot("contact_statistics", title, caption, panels, rows, (9.6, 6.0), **look)


def _of_gaps(config, records, gaps, variable, column) -> list[Item]:
    """Return a statistic of all gaps; with the RMS of the forces goes their peak, hollow."""
    items: list[Item] = []
    for gap, look in looks_of_gaps(config, gaps):
        look |= {"width": 0.9}
        for name, more in ((variable, {}), ("peak_force", {"line": ":", "hollow": True})):
            if name == variable or variable == "rms_force":
                rows = _rows(records, gap, name, column)
                look |= more | ({"label": ""} if more else {})
                items += over_seeds(rows, "load_rms_N", column, name, tags=("gap_m",), **look)
    return items


def _rows(records, gap, variable, column):
    """Return one row per case and support, or per case for the stress.

    Zeros (no contact) are left out of logarithmic panels.
    """
    rows = []
    for case, dataset in records.items():
        if case.gap_m != gap:
            continue
        values = dataset[variable].max() if variable == "stress_peak" else dataset[variable]
        rows += [
            {"gap_m": gap, "load_rms_N": case.load_rms_N, column: float(value)}
            for value in np.ravel(values)
            if value > 0.0 or variable == "contact_fraction"
        ]
    return rows
