"""Equivalent k and c against load by every method, and the agreement of the methods."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from vibroimpact.figures.style import BLACK, GREY, METHODS, ORANGE, PALE, shown
from vibroimpact.identify.method_names import method_name
from vibroimpact.reports.equivalent_answer import COMPARED, Answer, Value
from vibroimpact.reports.study_tables import agreement_in_words
from vibroimpact.study.method_agreement import AGREEMENT

from .plot import (
    Plot,
    axis,
    bars_between,
    in_unit,
    key_of,
    label,
    layout,
    load_axis,
    log_axis,
    numbers,
    points,
    unit_of,
)

COLUMNS = {"k": "k_N_per_m", "c": "c_N_s_per_m"}
UNITS = {"k": "N/m", "c": "N s/m"}
WORDS = {"k": "stiffness", "c": "damping"}
BOUNDS = {"k": " Grey triangles: what k is below where the tube hardly touches.", "c": ""}
PREDICTED = ("statistical_linearisation", "secant")
CONTROLS = ("gap", "place")
# Kind of a cell: (sign, colour, in words), in the order of the colour scale.
CELLS = {
    "unresolved": ("–", PALE, "not resolved"),
    "bounded": ("<", PALE, "the tube hardly touches, k has an upper bound"),
    "differ": ("✗", "#D55E00", "differ, none recommended"),
    "spread": ("≠", ORANGE, "over 25 % apart"),
    "partial": ("(✓)", "#CFE6F5", "not all resolve it, those that do agree"),
    "agree": ("✓", "#9CC9E8", "agree"),
}


def equivalent_plots(
    answers: Sequence[Answer], summary: Sequence[dict], load_label: str
) -> list[Plot]:
    """Return the Plots of k and c against load, and of the agreement of the methods.

    answers: in their order.
    summary: rows of consistency_summary.csv with group and direction.
    load_label: of the axis.
    """
    plots = [_against_load(quantity, answers, summary, load_label) for quantity in COLUMNS]
    plots.append(_ratios(answers, summary, load_label))
    return [*plots, *(_agreement(quantity, answers, load_label) for quantity in COLUMNS)]


def places_of(answers: Sequence[Answer]) -> tuple[list[float], list[tuple[str, str]]]:
    """Return (gaps in m, (group, direction) pairs) in the order of the controls of the page."""
    gaps = list(dict.fromkeys(row.gap_m for row in answers))
    return gaps, list(dict.fromkeys((row.group, row.direction) for row in answers))


def _against_load(quantity, answers, summary, load_label):
    column, frames = COLUMNS[quantity], {}
    for key, chosen, rows in _by_place(answers, summary):
        traces = [
            trace
            for method in _methods(rows)
            if (trace := _method(quantity, method, rows, unit_of(load_label))) is not None
        ]
        bounds = _bounds(chosen, unit_of(load_label)) if quantity == "k" else []
        frames[key] = [*_recommended(quantity, chosen, unit_of(load_label)), *traces, *bounds]
    return Plot(
        f"equivalent_{quantity}",
        f"Equivalent {WORDS[quantity]} {quantity}",
        (
            f"Black with its band: the recommended {quantity}, median of the compared methods, and"
            f" its range over seeds; markers: each method with its own range.{BOUNDS[quantity]}"
            " Where there is no black line no value is recommended; the table below says why."
        ),
        layout(
            load_axis(load_label, [row.load_rms_N for row in answers]),
            _stiffness_axis(frames) if quantity == "k" else axis(label(column)),
            height=460,
        ),
        frames,
        CONTROLS,
        empty=f"No method resolves {quantity} at any load of this gap.",
        cursor=True,
    )


def _stiffness_axis(frames):
    """Return the axis of k, from the smallest identified value up.

    Predictions go down to nothing at low loads; they would flatten the rest.
    """
    predicted = {method_name(method) for method in PREDICTED}
    identified = {
        key: [trace for trace in traces if trace.get("name") not in predicted]
        for key, traces in frames.items()
    }
    values = [
        value
        for traces in identified.values()
        for trace in traces
        for value in trace["y"]
        if value is not None and value > 0.0
    ]
    if not values:
        return log_axis(label("k_N_per_m"), frames)
    top = max(
        value for traces in frames.values() for trace in traces for value in trace["y"] if value
    )
    ends = numbers(np.log10([0.6 * min(values), 1.6 * top]))
    return log_axis(label("k_N_per_m"), identified, range=ends)


def _by_place(answers, summary):
    """Yield (key of the frame, Answers, summary rows) of each gap, group and direction."""
    gaps, pairs = places_of(answers)
    for at, gap in enumerate(gaps):
        for index, (group, direction) in enumerate(pairs):
            yield (
                key_of(at, index),
                [row for row in answers if row.place == (gap, group, direction)],
                [
                    row
                    for row in summary
                    if (row["gap_m"], row["group"], row["direction"]) == (gap, group, direction)
                ],
            )


def _methods(rows):
    """Return the methods of summary rows, those that are compared last: they are drawn on top."""
    known = list(dict.fromkeys(row["method"] for row in rows))
    return sorted(known, key=lambda method: method in COMPARED["k"])


def _recommended(quantity: str, chosen: Sequence[Answer], load_unit: str) -> list[dict[str, Any]]:
    """Return the band and the line of the recommended value."""
    column = COLUMNS[quantity]
    values: list[Value] = [getattr(row, quantity) for row in chosen]
    if not any(value.resolved for value in values):
        return []
    loads = numbers([row.load_rms_N for row in chosen])
    band = {
        "type": "scatter",
        "mode": "lines",
        "x": loads,
        "line": {"width": 0},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    line = points(
        "recommended",
        loads,
        in_unit(column, [value.value for value in values]),
        f"recommended {quantity} = %{{y:.3s}} {UNITS[quantity]}<br>%{{customdata}}",
        BLACK,
        "o",
        line={"color": BLACK, "width": 2.4},
        marker={"color": BLACK, "size": 4},
        customdata=[
            f"{value.low:.3g} to {value.high:.3g} {UNITS[quantity]} over seeds<br>"
            f"at {row.load_rms_N:.3g} {load_unit}; methods: {value.agreement}"
            for row, value in zip(chosen, values, strict=True)
        ],
    )
    return [
        {**band, "y": in_unit(column, [value.low for value in values])},
        {
            **band,
            "y": in_unit(column, [value.high for value in values]),
            "fill": "tonexty",
            "fillcolor": "rgba(0,0,0,0.10)",
        },
        line,
    ]


def _bounds(chosen: Sequence[Answer], load_unit: str) -> list[dict[str, Any]]:
    """Return the trace of the upper bounds of k in a list, empty without any."""
    rows = [row for row in chosen if row.bounded]
    if not rows:
        return []
    trace = points(
        "upper bound",
        numbers([row.load_rms_N for row in rows]),
        in_unit("k_N_per_m", [row.bound for row in rows]),
        f"%{{customdata}}, at %{{x:.3g}} {load_unit}",
        GREY,
        "v",
        customdata=[row.k.reason for row in rows],
    )
    return [trace | {"mode": "markers"}]


def _method(quantity, method, rows, load_unit):
    """Return the trace of one method, None where it has no value at any load."""
    column = COLUMNS[quantity]
    chosen = [
        row
        for row in rows
        if row["method"] == method
        and np.isfinite(_value(row[f"{quantity}_median"]))
        and (quantity != "k" or row["k_median"] > 0.0)
    ]
    if not chosen:
        return None
    colour, marker = METHODS[method][1:] if method in METHODS else (GREY, "o")
    middle, low, high = (
        shown(column, [row[f"{quantity}_{part}"] for row in chosen])
        for part in ("median", "low", "high")
    )
    predicted = method in PREDICTED
    more = {} if predicted else {"error_y": bars_between(middle, low, high)}
    if method not in COMPARED[quantity]:
        more["visible"] = "legendonly" if not predicted else True
    return points(
        method_name(method),
        numbers([row["load_rms_N"] for row in chosen]),
        numbers(middle),
        f"{method_name(method)}: {quantity} = %{{y:.3s}} {UNITS[quantity]}"
        f" at %{{x:.3g}} {load_unit}",
        colour,
        marker,
        line={"color": colour, "width": 1.2, "dash": "dot" if predicted else "solid"},
        **more,
    )


def _ratios(answers, summary, load_label):
    """Return the Plot of each compared method's k and c over the recommended value."""
    frames = {}
    for key, chosen, rows in _by_place(answers, summary):
        traces = []
        for quantity in COLUMNS:
            centre = {row.load_rms_N: getattr(row, quantity).value for row in chosen}
            for method in COMPARED[quantity]:
                traces += _ratio(quantity, method, rows, centre)
        frames[key] = traces
    return Plot(
        "agreement_ratio",
        "Each method over the recommended value",
        (
            "k (solid) and c (dotted, open) of the compared methods divided by the recommended"
            f" value. They agree inside the shaded band, within {100 * AGREEMENT:.0f} %. Pole and"
            " deflection shape read the main peak; the broadband PSD reads the whole band."
        ),
        layout(
            load_axis(load_label, [row.load_rms_N for row in answers]),
            axis("Method / recommended (-)", range=_around_one(frames)),
            height=400,
            shapes=[
                {
                    "type": "rect",
                    "xref": "paper",
                    "x0": 0,
                    "x1": 1,
                    "y0": 1.0 - AGREEMENT,
                    "y1": 1.0 + AGREEMENT,
                    "fillcolor": PALE,
                    "opacity": 0.4,
                    "line": {"width": 0},
                    "layer": "below",
                }
            ],
        ),
        frames,
        CONTROLS,
        empty="No value to compare at this gap.",
        wide=True,
        cursor=True,
    )


def _around_one(frames):
    """Return the range of an axis that holds the band of agreement and all ratios."""
    values = [value for traces in frames.values() for trace in traces for value in trace["y"]]
    return [min([0.9 - AGREEMENT, *values]) - 0.05, max([1.1 + AGREEMENT, *values]) + 0.05]


def _ratio(quantity, method, rows, centre):
    """Return the trace of one method's ratio in a list, empty without values."""
    chosen = [
        row
        for row in rows
        if row["method"] == method
        and np.isfinite(_value(row[f"{quantity}_median"]) / centre.get(row["load_rms_N"], np.nan))
    ]
    if not chosen:
        return []
    colour, marker = METHODS[method][1:]
    trace = points(
        f"{quantity}, {method_name(method)}",
        numbers([row["load_rms_N"] for row in chosen]),
        numbers([row[f"{quantity}_median"] / centre[row["load_rms_N"]] for row in chosen]),
        f"{quantity} by {method_name(method)}: %{{y:.3f}} of the recommended value",
        colour,
        marker,
        line={"color": colour, "width": 1.2, "dash": "dot" if quantity == "c" else "solid"},
    )
    if quantity == "c":
        trace["marker"]["symbol"] += "-open"
    return [trace]


def _agreement(quantity, answers, load_label):
    """Return the Plot of the agreement by gap and load: one cell per case, with its reason."""
    gaps, pairs = places_of(answers)
    frames, kinds = {}, list(CELLS)
    for index, pair in enumerate(pairs):
        chosen = {
            (row.gap_m, row.load_rms_N): row
            for row in answers
            if (row.group, row.direction) == pair
        }
        loads = sorted({load for _, load in chosen})
        cells = [[chosen.get((gap, load)) for load in loads] for gap in gaps]
        frames[key_of(index)] = [
            {
                "type": "heatmap",
                "x": [f"{load:.3g}" for load in loads],
                "y": [f"{gap * 1e3:.3g}" for gap in gaps],
                "z": [[kinds.index(_kind(quantity, cell)) for cell in row] for row in cells],
                "text": [[CELLS[_kind(quantity, cell)][0] for cell in row] for row in cells],
                "customdata": [[_reason(quantity, cell) for cell in row] for row in cells],
                "texttemplate": "%{text}",
                "hovertemplate": "load %{x}, gap %{y} mm<br>%{customdata}<extra></extra>",
                "zmin": 0,
                "zmax": len(CELLS) - 1,
                "colorscale": [
                    [number / (len(CELLS) - 1), colour]
                    for number, (_, colour, _) in enumerate(CELLS.values())
                ],
                "showscale": False,
                "xgap": 2,
                "ygap": 2,
            }
        ]
    seen = {_kind(quantity, row) for row in answers}
    legend = ", ".join(
        f"{sign} {words}" for kind, (sign, _, words) in CELLS.items() if kind in seen
    )
    return Plot(
        f"agreement_{quantity}",
        f"Do the methods agree on {quantity}?",
        (
            f"A cell per load and gap: {legend}. The pointer over a cell shows the value, or the"
            " reason why there is none."
        ),
        layout(
            axis(load_label, type="category", tickangle=-60),
            axis("Gap (mm)", type="category", autorange="reversed"),
            height=150 + 40 * len(gaps),
        ),
        frames,
        ("place",),
    )


def _kind(quantity: str, row: Answer | None) -> str:
    """Return the kind of a cell, a key of CELLS."""
    if row is None:
        return "unresolved"
    agreement: str = getattr(row, quantity).agreement
    return "bounded" if row.bounded else agreement


def _reason(quantity: str, row: Answer | None) -> str:
    if row is None:
        return "not in the study"
    cell: Value = getattr(row, quantity)
    value = f"{quantity} = {cell.value:.3g} {UNITS[quantity]}, " if cell.resolved else ""
    words = cell.reason or agreement_in_words(row, quantity)
    return value + words


def _value(value: Any) -> float:
    return float(value) if isinstance(value, (int, float)) else np.nan
