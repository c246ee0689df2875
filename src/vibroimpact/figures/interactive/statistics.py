"""Contact, wear and stress of each support against load, and the energy balance of every case."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.figures.style import BLACK, BLUE, GAP_MARKERS, GREY, ORANGE, RED
from vibroimpact.reports.study_statistics import SEVERAL, StudyStatistics

from .plot import (
    Plot,
    axis,
    bars_between,
    colour_of,
    in_unit,
    key_of,
    label,
    layout,
    load_axis,
    log_axis,
    numbers,
    points,
    shown,
    unit_of,
)

MOST_CURVES = 12  # more supports are shown by their largest and the median one
# quantity -> (column of the axis, title, unit, logarithmic, sentences)
AGAINST_LOAD = {
    "contact_fraction": (
        "contact_fraction",
        "Time in contact",
        "%",
        False,
        "Share of the time that each support is touched, against load. It is zero until the gap is"
        " bridged; towards high load the tube rests on its supports more and more.",
    ),
    "impact_rate": (
        "impact_rate_per_s",
        "Impacts per second",
        "1/s",
        True,
        "Contacts begun per second at each support, against load. The rate levels off where the"
        " tube touches in every cycle of its motion.",
    ),
    "wear_work_rate": (
        "wear_work_rate_W",
        "Wear work rate",
        "W",
        True,
        "Normal force times sliding speed, mean over time, of each support against load. With a"
        " wear coefficient it gives the volume that is worn off per second.",
    ),
}
FORCES = {"rms_force": ("RMS", "solid"), "peak_force": ("peak", "dot")}
RESIDUALS = {
    "potential_energy_residual": ("with the contact's potential energy", ORANGE, "s"),
    "energy_residual": ("with the work of the contact forces", BLUE, "o"),
    "fixed_point_residual": ("contact iteration (bound)", GREY, "x"),
}
LEAST_RESIDUAL = 1.0e-12  # of the input work: less is round-off


def contact_plots(
    statistics: StudyStatistics, gaps: Sequence[float], load_label: str, caveat: str
) -> list[Plot]:
    """Return the Plots of contact, impacts, forces and wear against load, by gap.

    gaps: m, in the order of the control. caveat: on the wear work rate, may be empty.
    """
    if not statistics.supports:
        return []
    plots = [
        _against_load(statistics, gaps, quantity, load_label)
        for quantity in AGAINST_LOAD
        if math.isfinite(statistics.largest(quantity)[0])
    ]
    plots = [
        replace(plot, caption=f"{plot.caption} {caveat}".rstrip())
        if plot.name == "wear_work_rate"
        else plot
        for plot in plots
    ]
    forces = [_forces(statistics, gaps, load_label)] if plots else []
    return [*plots[:2], *forces, *plots[2:]]


def _curves(statistics, quantity, gap, column):
    """Yield (name, index, loads, (median, low, high) in the unit of the axis) of each support."""
    names = statistics.supports
    if len(names) > MOST_CURVES:
        names = [SEVERAL]
    for index, name in enumerate(names):
        rows = [statistics.spread(quantity, gap, load, name) for load in statistics.loads]
        values = np.array(rows, dtype=float).reshape(-1, 3)
        shown_as = "largest of the supports" if name == SEVERAL else name
        yield shown_as, index, statistics.loads, [shown(column, part) for part in values.T]


def _positive(log, values):
    """Return values with what a logarithmic axis can not show left out."""
    return np.where(values > 0.0, values, np.nan) if log else values


def _against_load(statistics, gaps, quantity, load_label):
    column, title, unit, log, caption = AGAINST_LOAD[quantity]
    frames = {}
    for at, gap in enumerate(gaps):
        frames[key_of(at)] = [
            points(
                name,
                numbers(loads),
                numbers(_positive(log, middle)),
                f"{name}: %{{y:.3g}} {unit} at %{{x:.3g}} {unit_of(load_label)}",
                colour_of(index),
                GAP_MARKERS[index % len(GAP_MARKERS)],
                error_y=bars_between(middle, low, high),
            )
            for name, index, loads, (middle, low, high) in _curves(
                statistics, quantity, gap, column
            )
            if np.any(np.isfinite(_positive(log, middle)))
        ]
    return Plot(
        quantity,
        title,
        caption,
        layout(load_axis(load_label, statistics.loads), _axis_of(column, log, frames), height=340),
        frames,
        ("gap",),
        empty="No contact at any load of this gap.",
        cursor=True,
    )


def _axis_of(column, log, frames):
    return log_axis(label(column), frames) if log else axis(label(column), rangemode="tozero")


def _forces(statistics, gaps, load_label):
    frames = {}
    for at, gap in enumerate(gaps):
        frames[key_of(at)] = [
            points(
                f"{name}, {word}",
                numbers(loads),
                numbers(_positive(True, middle)),
                f"{name}, {word}: %{{y:.4g}} N at %{{x:.3g}} {unit_of(load_label)}",
                colour_of(index),
                GAP_MARKERS[index % len(GAP_MARKERS)],
                error_y=bars_between(middle, low, high),
                line={"color": colour_of(index), "width": 1.2, "dash": dash},
            )
            for quantity, (word, dash) in FORCES.items()
            for name, index, loads, (middle, low, high) in _curves(
                statistics, quantity, gap, "force_N"
            )
            if np.any(np.isfinite(_positive(True, middle)))
        ]
    return Plot(
        "support_force",
        "Support force",
        (
            "RMS (solid) and largest (dotted) force of each support against load, median and range"
            " over seeds. The largest force grows slowly with the length of the record; the RMS"
            " does not."
        ),
        layout(
            load_axis(load_label, statistics.loads), log_axis(label("force_N"), frames), height=340
        ),
        frames,
        ("gap",),
        empty="No contact at any load of this gap.",
        cursor=True,
    )


def stress_plots(
    statistics: StudyStatistics,
    gaps: Sequence[float],
    places: Sequence[tuple[str, tuple[float, float]]],
    limit_Pa: float,
    load_label: str,
) -> list[Plot]:
    """Return the Plots of the largest stress against load and of the stress by section.

    places: (key of the frame, (gap, load)).
    limit_Pa: above which a case is flagged.
    """
    if not statistics.sections:
        return []
    frames = {}
    for at, gap in enumerate(gaps):
        frames[key_of(at)] = [
            *(
                _largest_stress(statistics, gap, quantity, unit_of(load_label))
                for quantity in ("rms", "peak")
            ),
            {
                "type": "scatter",
                "mode": "lines",
                "name": "limit",
                "x": numbers([statistics.loads[0], statistics.loads[-1]]),
                "y": in_unit("stress_Pa", [limit_Pa, limit_Pa]),
                "line": {"color": BLACK, "dash": "dash", "width": 1},
                "hovertemplate": "limit %{y:.4g} MPa<extra></extra>",
            },
        ]
    return [
        Plot(
            "stress",
            "Largest bending stress",
            (
                "RMS and largest bending stress of the most stressed section against load, median"
                " and range over seeds. A case whose peak passes the dashed limit is flagged; the"
                " model itself stays linear elastic."
            ),
            layout(
                load_axis(load_label, statistics.loads),
                log_axis(label("stress_Pa"), frames),
                height=340,
            ),
            frames,
            ("gap",),
            cursor=True,
        ),
        _stress_by_section(statistics, places),
    ]


def _largest_stress(statistics, gap, quantity, load_unit):
    rows = [
        statistics.spread(f"stress_{quantity}", gap, load, SEVERAL) for load in statistics.loads
    ]
    middle, low, high = (shown("stress_Pa", part) for part in np.array(rows, dtype=float).T)
    colour = {"rms": BLUE, "peak": RED}[quantity]
    word = {"rms": "RMS", "peak": "peak"}[quantity]
    return points(
        word,
        numbers(statistics.loads),
        numbers(_positive(True, middle)),
        f"{word}: %{{y:.4g}} MPa at %{{x:.3g}} {load_unit}",
        colour,
        "o" if quantity == "rms" else "^",
        error_y=bars_between(middle, low, high),
    )


def _stress_by_section(statistics, places):
    frames = {
        key: [
            {
                "type": "bar",
                "name": word,
                "x": [name.replace("_", " ") for name in statistics.sections],
                "y": in_unit(
                    "stress_Pa",
                    [
                        statistics.spread(quantity, gap, load, name).median
                        for name in statistics.sections
                    ],
                ),
                "marker": {"color": colour},
                "hovertemplate": f"%{{x}}: {word} %{{y:.4g}} MPa<extra></extra>",
            }
            for quantity, word, colour in (
                ("stress_rms", "RMS", BLUE),
                ("stress_peak", "peak", RED),
            )
        ]
        for key, (gap, load) in places
    }
    return Plot(
        "stress_sections",
        "Bending stress by section",
        (
            "RMS and largest bending stress of each section at the chosen gap and load, median over"
            " seeds. The highest bar is where the tube is stressed most."
        ),
        layout(
            axis("Section", type="category", tickangle=-50),
            axis(label("stress_Pa")),
            height=360,
            barmode="group",
            legend={"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 0},
        ),
        frames,
        ("gap", "load"),
    )


def energy_plot(
    statistics: StudyStatistics, limits: dict[str, float], load_label: str
) -> Plot | None:
    """Return the Plot of the energy residuals of all gaps; None where they were not recorded.

    limits: {quantity: largest accepted value}.
    """
    traces = []
    for quantity, (name, colour, marker) in RESIDUALS.items():
        rows = [
            (load, gap, statistics.spread(quantity, gap, load).high)
            for gap in statistics.gaps
            for load in statistics.loads
        ]
        rows = [row for row in rows if row[2] >= LEAST_RESIDUAL]
        if not rows:
            continue
        loads, shown_gaps, values = (list(part) for part in zip(*rows, strict=True))
        traces.append(
            points(
                name,
                numbers(loads),
                numbers(values),
                f"%{{y:.2g}} of the input work<br>%{{x:.3g}} {unit_of(load_label)},"
                " gap %{customdata} mm",
                colour,
                marker,
                mode="markers",
                customdata=[f"{gap * 1e3:.3g}" for gap in shown_gaps],
            )
        )
        if quantity in limits:
            traces.append(_limit(name, limits[quantity], loads, colour))
    if not traces:
        return None
    return Plot(
        "energy",
        "What is not accounted for, case by case",
        (
            "Energy that the simulation fails to account for, over the work of the drive: the worst"
            " seed of every load and gap. Markers below the dashed line of their colour are within"
            f" what the time step allows. Less than {LEAST_RESIDUAL:g}, as where nothing touches,"
            " is left out."
        ),
        layout(
            load_axis(load_label, statistics.loads),
            log_axis(label("residual"), {"": traces}),
            height=380,
        ),
        {"": traces},
        (),
        wide=True,
    )


def _limit(name, value, loads, colour):
    return {
        "type": "scatter",
        "mode": "lines",
        "name": f"limit {name}",
        "x": numbers([min(loads), max(loads)]),
        "y": numbers([value, value]),
        "line": {"color": colour, "dash": "dash", "width": 1},
        "hovertemplate": f"limit {value:.2g}<extra></extra>",
        "showlegend": False,
    }
