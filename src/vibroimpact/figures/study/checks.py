"""Checks of the simulation: energy balance, contact statistics and stress against load."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GAP_COLOURS,
    GAP_MARKERS,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    gap_label,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.integration.energy_limit import ENERGY_LIMIT
from vibroimpact.reports.centred_wear import centred_sentence
from vibroimpact.study.cases import case_from_id

from .cases_of_gap import CasesOnDemand
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


def energy_balance(config, records):
    """Return the Sheet of the residuals of all cases and of the energies of one case.

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
        " its place (it measures the time step: what is lost at each crossing of the gap), and the"
        " bound of the error left in the implicit contact forces; dashed: accepted at"
        f" {config.integration.steps_per_second:g} steps per second. What is below {FLOOR:g}, as"
        " the zeros where nothing touches, is drawn there. Right: energies during the case of the"
        f" largest load ({case.load_rms_N:g} N, gap"
        f" {gap_label(case.gap_m, outer_width(config.structure.section))}, seed {case.seed});"
        " negative times are the start-up before the record."
    )
    sheet = Sheet(
        "energy_balance",
        "Energy balance of the simulations",
        caption,
        [["residuals", "energies"]],
        size=(7.6, 4.4),
    )
    axes = sheet.axes["residuals"]
    axes.set_title(f"residuals of {len(records)} cases")
    for variable, (name, colour, marker) in RESIDUALS.items():
        values = np.maximum([float(dataset[variable]) for dataset in records.values()], FLOOR)
        sheet.line(
            axes,
            ("load_rms_N", np.array([key.load_rms_N for key in records])),
            ("residual", values),
            variable,
            tags={
                "gap_m": np.array([key.gap_m for key in records]),
                "seed": np.array([key.seed for key in records]),
            },
            color=colour,
            marker=marker,
            linestyle="none",
            markersize=3.5,
            label=name,
        )
        if variable in accepted:
            sheet.mark(
                axes,
                "residual",
                accepted[variable],
                f"limit of {variable}",
                vertical=False,
                color=colour,
                linestyle="--",
                linewidth=1.0,
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(0.2 * FLOOR, 1.0e4)  # room for the legend
    sheet.legend(axes, loc="upper left")
    _energies(sheet, sheet.axes["energies"], records[case])
    sheet.axes["energies"].set_title(f"energies at {case.load_rms_N:g} N RMS")
    return [sheet]


def _energies(sheet, axes, record):
    """Draw the energy terms of a case over time."""
    time = record["energy_time"].values
    for term, (name, colour, dash) in TERMS.items():
        sheet.line(
            axes,
            ("time_s", time),
            ("energy_J", np.abs(record["energy"].sel(energy_term=term).values)),
            term,
            color=colour,
            linestyle=dash,
            label=name,
        )
    axes.set_yscale("log")
    largest = float(np.abs(record["energy"]).max())
    axes.set_ylim(1e-6 * largest, 1e3 * largest)  # room for the legend
    sheet.legend(axes, loc="upper left")


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
    return CasesOnDemand(
        paths,
        lambda path: read(
            path, (*VARIABLES, "energy") if case_from_id(Path(path).stem) == drawn else VARIABLES
        ),
    )


def contact_statistics(config, model, records):
    """Return the Sheet of contact statistics and peak stress against load, for every gap.

    records: {Case: Dataset} of statistics.
    """
    gaps = sorted({case.gap_m for case in records}, reverse=True)
    imperfection = config.integration.imperfection
    caveat = centred_sentence(imperfection, model.centre_offset, min(gaps))
    caption = (
        "Contact against load, for every gap: fraction of time in contact, impacts per second, RMS"
        " radial velocity at impact, RMS and peak force, wear work rate (normal force times sliding"
        " speed), per support, and the largest bending stress anywhere in the tube with the limit"
        " above which a case is flagged (dashed). Median over seeds and supports, bars from the"
        f" smallest to the largest value. {caveat}"
    ).rstrip()
    sheet = Sheet(
        "contact_statistics",
        "Contact, wear and stress against load",
        caption,
        [["fraction", "rate", "velocity"], ["force", "wear", "stress"]],
        size=(9.6, 6.0),
        sharex=True,
    )
    diameter = outer_width(config.structure.section)
    for index, gap in enumerate(gaps):
        colour, marker = (
            GAP_COLOURS[index % len(GAP_COLOURS)],
            GAP_MARKERS[index % len(GAP_MARKERS)],
        )
        style = {
            "color": colour,
            "marker": marker,
            "linewidth": 0.9,
            "label": f"gap {gap_label(gap, diameter)}",
        }
        for panel, variable, column, _ in STATISTICS:
            rows = _rows(records, gap, variable, column)
            over_seeds(
                sheet,
                sheet.axes[panel],
                rows,
                "load_rms_N",
                column,
                variable,
                tags=("gap_m",),
                **style,
            )
        over_seeds(
            sheet,
            sheet.axes["force"],
            _rows(records, gap, "peak_force", "force_N"),
            "load_rms_N",
            "force_N",
            "peak_force",
            tags=("gap_m",),
            color=colour,
            marker=marker,
            markerfacecolor="white",
            linewidth=0.9,
            linestyle=":",
        )
    sheet.mark(
        sheet.axes["stress"],
        "stress_Pa",
        config.record.stress_limit_Pa,
        "limit",
        vertical=False,
        color=BLACK,
        linestyle="--",
        linewidth=1.0,
    )
    for panel, _, column, title in STATISTICS:
        axes = sheet.axes[panel]
        axes.set_title(title)
        if not axes.get_xlabel():
            sheet.note(axes, "no contact", "load_rms_N", column)
        axes.set_xscale("log")
        if panel != "fraction" and axes.get_legend_handles_labels()[1]:
            axes.set_yscale("log")
    if caveat:
        sheet.axes["wear"].text(
            0.03,
            0.97,
            f"centred to {imperfection:g} of the gap:\nhardly any sliding in plane",
            transform=sheet.axes["wear"].transAxes,
            va="top",
            fontsize=8.0,
        )
    for panel in ("fraction", "rate", "velocity"):
        sheet.axes[panel].set_xlabel("")
    handles, labels = sheet.axes["stress"].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return [sheet]


def _rows(records, gap, variable, column):
    """Return one row per case and support, or per case for the stress.

    Zeros (no contact) are left out of logarithmic panels.
    """
    rows = []
    for case, dataset in records.items():
        if case.gap_m != gap:
            continue
        values = (
            [float(dataset[variable].max())]
            if variable == "stress_peak"
            else dataset[variable].values
        )
        rows += [
            {"gap_m": gap, "load_rms_N": case.load_rms_N, column: float(value)}
            for value in values
            if value > 0.0 or variable == "contact_fraction"
        ]
    return rows
