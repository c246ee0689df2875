"""Convergence of runs with the step and with the number of modes."""

from __future__ import annotations

import numpy as np

from evidence.validation.convergence.statistics import ENERGY, LARGEST_SCATTER
from vibroimpact.reports.figures.plot import Axis, Item, Panel, Plot, Series
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PALE,
    PINK,
    RED,
    ordered_colours,
)

from .convergence import slope_line

LOAD_STYLES = ((BLUE, "o"), (RED, "s"), (GREEN, "^"), (ORANGE, "D"), (PINK, "v"), (BLACK, "P"))
AMPLITUDE_PER_DB = np.log(10.0) / 20.0  # relative change of an amplitude per dB of its PSD
STANDARD_ERRORS = 2.0  # half length of a bar
STEP_REMARK = (
    "Both schemes are compared with Newmark at the finest step. Stresses are sampled at 10 to 41"
    " kHz, depending on the step: the peak stress grows a little with that rate."
)
MODES_REMARK = (
    "All but the control, 'free modes alone', have constrained modes and attachment shapes; the"
    " control lacks the local bending at the supports."
)
AXIS_NAMES = {
    "step": ("Newmark", "steps/s"),
    "step_exact": ("exact", "steps/s"),
    "modes": ("free modes kept", "Hz"),
    "modes_alone": ("free modes alone", "Hz"),
}


def step(periods, table):
    """Return the Plot of period error of linear modes and energy residual of impacts.

    Both are drawn against the step. periods: rows of `period_rows`; table: rows of
    `statistics_rows`.
    """
    caption = (
        "Left: relative loss of frequency of linear out-of-plane modes in free vibration under"
        " Newmark's scheme, four steps (colour), against omega dt (the exact modal step has none);"
        " black: the trapezoidal rule, 1 - 2 atan(omega dt/2)/(omega dt), which is (omega dt)²/12"
        " for small steps. Right: what is missing in the energy balance of impacting runs when the"
        " contact's work is replaced by its potential energy (mean over seeds), of order 2 in the"
        " step."
    )
    linear: list[Item] = []
    for rate, colour in ordered_colours(
        sorted({row["steps_per_second"] for row in periods})
    ).items():
        own = [row for row in periods if row["steps_per_second"] == rate]
        steps, shifts = [row["omega_step"] for row in own], [row["shift"] for row in own]
        name, tags = f"1/{rate:g} s", {"mode_Hz": [row["mode_Hz"] for row in own]}
        look = {"colour": colour, "marker": "o", "line": "", "label": name}
        linear.append(Series(name, steps, shifts, tags, **look))
    every = [row["omega_step"] for row in periods]
    angle = np.geomspace(min(every), max(every), 30)
    exact = 1.0 - 2.0 * np.arctan(0.5 * angle) / angle
    linear.append(Series("exact", angle, exact, width=0.9, label="trapezoidal rule"))
    panels = {
        "linear": Panel(
            Axis("omega_step", True),
            Axis("period_shift", True),
            linear,
            "linear modes, Newmark",
            legend="upper left",
        ),
        "energy": Panel(
            Axis("step_s", True),
            Axis("energy_defect", True),
            [
                *_energies(table),
                *slope_line((1.0 / 25600, 2.0e-3), 2.0, (1.0 / 25600, 1.0 / 204800)),
            ],
            "energy balance of impacting runs",
            legend="upper left",
        ),
    }
    title = "Step: order 2 in linear motion and in the energy of impacts"
    return [Plot("validation_convergence_step", title, caption, panels, size=(7.6, 3.9))]


def _energies(table):
    """Return the energy residuals of impacting runs against the step, by load and scheme."""
    items = []
    loads = sorted({row["load_rms_N"] for row in table})
    for (colour, marker), load in zip(LOAD_STYLES, loads, strict=False):
        for axis, scheme, line in (("step", "Newmark", "-"), ("step_exact", "exact", "--")):
            own = [
                row
                for row in table
                if (row["axis"], row["statistic"], row["load_rms_N"]) == (axis, ENERGY, load)
            ]
            steps, residuals = [1.0 / row["value"] for row in own], [row["mean"] for row in own]
            tags = {"load_rms_N": load, "scheme": scheme}
            look = {"colour": colour, "marker": marker, "line": line}
            look["label"] = f"{scheme}, {load:g} N RMS"
            items.append(Series(f"{scheme} {load:g} N", steps, residuals, tags, **look))
    return items


def statistics(table, axes_of_study, name, title, remark):
    """Return the Sheet of the differences of statistics from the finest value, a panel per load.

    table: rows of `statistics_rows`.
    axes_of_study: names of the axes drawn together, such as ("modes", "modes_alone").
    remark: the last sentence of the caption.
    """
    loads = sorted({row["load_rms_N"] for row in table})
    own = [
        row
        for row in table
        if row["axis"] in axes_of_study
        and row["statistic"] != ENERGY
        and np.isfinite(row["difference"])
    ]
    names = list(dict.fromkeys(row["statistic"] for row in own))
    caption = (
        "Means over seeds of response statistics, relative to the finest value of the axis; bars:"
        " two standard errors of the difference, taken seed by seed. Grey: the scatter of one"
        " record over seeds (one standard deviation). Levels of bands (of the PSD at bend_45.y)"
        f" are shown as amplitudes. Statistics whose scatter exceeds {LARGEST_SCATTER:.0%} of the"
        f" mean are left out: in-plane motion at its onset. {remark}"
    )
    sheet = Sheet(name, title, caption, [[f"load {load:g}"] for load in loads], size=(7.6, 6.6))
    curves = list(dict.fromkeys((row["axis"], row["value"]) for row in own))
    for load in loads:
        panel = sheet.axes[f"load {load:g}"]
        panel.set_title(f"{load:g} N RMS")
        _panel(sheet, panel, [row for row in own if row["load_rms_N"] == load], names, curves)
        panel.set_xticks(
            range(len(names)),
            [_short(text) for text in names] if load == loads[-1] else [""] * len(names),
            rotation=60,
            ha="right",
            rotation_mode="anchor",
        )
    sheet.figure.legend(
        *sheet.axes[f"load {loads[-1]:g}"].get_legend_handles_labels(),
        loc="outside lower center",
        ncols=3,
    )
    return [sheet]


def both_axes(table):
    """Return the Sheets of the response statistics, along the step and along the modes kept."""
    return [
        *statistics(
            table,
            ("step", "step_exact"),
            "validation_convergence_statistics_step",
            "Response statistics against the step",
            STEP_REMARK,
        ),
        *statistics(
            table,
            ("modes", "modes_alone"),
            "validation_convergence_statistics_modes",
            "Response statistics against the modes kept",
            MODES_REMARK,
        ),
    ]


def _panel(sheet, axes, rows, names, curves):
    """Draw the scatter of one record as bands and the differences as bars, grouped by statistic."""
    for place, text in enumerate(names):
        group = [row for row in rows if row["statistic"] == text and _shown(row)]
        if not group:
            continue
        scatter = np.mean([_relative(row, "scatter") for row in group])
        sheet.record(
            axes,
            "scatter of one record",
            statistic=text,
            statistic_difference_low=-scatter,
            statistic_difference_high=scatter,
        )
        axes.fill_between(
            [place - 0.42, place + 0.42], -1e2 * scatter, 1e2 * scatter, color=PALE, linewidth=0
        )
    for index, (axis, value) in enumerate(curves):
        own = [row for row in rows if (row["axis"], row["value"]) == (axis, value) and _shown(row)]
        middle, half = (
            np.array([_relative(row, key) for row in own])
            for key in ("difference", "standard_error")
        )
        colour, marker = LOAD_STYLES[index % len(LOAD_STYLES)]
        places = np.array([names.index(row["statistic"]) for row in own]) + 0.8 / (
            len(curves) + 1
        ) * (index - 0.5 * (len(curves) - 1))
        label = f"{AXIS_NAMES[axis][0]}: {value:g} {AXIS_NAMES[axis][1]}"
        sheet.line(
            axes,
            ("statistic_number", places),
            ("statistic_difference", middle),
            label,
            middle - STANDARD_ERRORS * half,
            middle + STANDARD_ERRORS * half,
            tags={"statistic": [row["statistic"] for row in own]},
            band=False,
            color=colour,
            marker=marker,
            linestyle="none",
            markersize=3.5,
            label=label,
        )
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set_xlim(-0.6, len(names) - 0.4)
    largest = 100.0 * max(
        (abs(_relative(row, "difference")) for row in rows if _shown(row)), default=0.0
    )
    axes.set_ylim(-max(14.0, 1.2 * largest), max(14.0, 1.2 * largest))


def _shown(row):
    """Return True when one record resolves the statistic."""
    return row["statistic"].endswith("_dB") or row["scatter"] <= LARGEST_SCATTER


def _relative(row, key):
    """Return a difference or scatter relative to the mean, that of a level as of an amplitude."""
    return row[key] * (AMPLITUDE_PER_DB if row["statistic"].endswith("_dB") else 1.0)


def _short(name):
    """Return a statistic's name without its unit, for the axis."""
    words = (
        name.removesuffix("_m_per_s")
        .removesuffix("_per_s")
        .removesuffix("_Pa")
        .removesuffix("_N")
        .removesuffix("_W")
        .removesuffix("_m")
    )
    if words.endswith("_dB"):
        return "PSD " + words.removeprefix("band_").removesuffix("_dB").replace("_", "-") + " Hz"
    return (
        words.replace("rms_displacement_", "RMS displ. ")
        .replace("rms_", "RMS ")
        .replace("_", " " if "." not in words else "_")
    )
