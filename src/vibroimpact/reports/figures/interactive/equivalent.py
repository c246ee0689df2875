"""Equivalent k and c against load by every method, and the agreement of the methods."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from vibroimpact.identify.method_names import method_name
from vibroimpact.reports.equivalent_answer import COMPARED, Answer, Value, number_or_nan, places_of
from vibroimpact.reports.figures.plot import Axis, Cells, Panel, Series, Span, extent
from vibroimpact.reports.figures.study.equivalent import COLUMNS, PREDICTED, look_of
from vibroimpact.reports.figures.style import GREY, ORANGE, PALE, RED
from vibroimpact.reports.study_tables import agreement_in_words
from vibroimpact.study.method_agreement import AGREEMENT

from .page_plot import PagePlot, key_of, unit_of

UNITS = {"k": "N/m", "c": "N s/m"}
WORDS = {"k": "stiffness", "c": "damping"}
BOUNDS = {"k": " Grey triangles: upper bounds of k, at which the tube hardly touches.", "c": ""}
CONTROLS = ("gap", "place")
# Kind of a cell: (sign, colour, in words), in the order of the colour scale.
CELLS = {
    "unresolved": ("–", PALE, "not resolved"),
    "bounded": ("<", PALE, "the tube hardly touches, k has an upper bound"),
    "differ": ("✗", RED, "differ, none recommended"),
    "spread": ("≠", ORANGE, "over 25 % apart"),
    "partial": ("(✓)", "#CFE6F5", "not all resolve it, those that do agree"),
    "agree": ("✓", "#9CC9E8", "agree"),
}


def load_axis(title: str, loads: Sequence[float]) -> Axis:
    """Return the logarithmic axis of all loads of a study, the same in every plot of its page."""
    return Axis("load_rms_N", True, *extent(loads, log=True), label=title)


def equivalent_plots(
    answers: Sequence[Answer], summary: Sequence[dict], load_label: str
) -> list[PagePlot]:
    """Return the plots of k and c against load, and of the agreement of the methods.

    answers: in their order.
    summary: rows of consistency_summary.csv with group and direction.
    load_label: of the axis.
    """
    loads = load_axis(load_label, [row.load_rms_N for row in answers])
    plots = [_against_load(quantity, answers, summary, loads) for quantity in COLUMNS]
    plots.append(_ratios(answers, summary, loads))
    return [*plots, *(_agreement(quantity, answers, load_label) for quantity in COLUMNS)]


def _against_load(quantity, answers, summary, loads):
    frames = {}
    for key, chosen, rows in _by_place(answers, summary):
        recommended = [*_recommended(quantity, chosen, unit_of(loads.label))]
        bounds = _bounds(chosen) if quantity == "k" else []
        methods = [item for method in _methods(rows) for item in _method(quantity, method, rows)]
        frames[key] = Panel(loads, Axis(COLUMNS[quantity]), [*recommended, *methods, *bounds])
    if quantity == "k":
        axis = _stiffness_axis(frames)
        frames = {key: Panel(loads, axis, panel.items) for key, panel in frames.items()}
    return PagePlot(
        f"equivalent_{quantity}",
        f"Equivalent {WORDS[quantity]} {quantity}",
        (
            f"Black with its band: the recommended {quantity}, median of the compared methods, and"
            f" its range over seeds; markers: each method with its own range.{BOUNDS[quantity]}"
            " If there is no black line no value is recommended; the table below says why."
        ),
        frames,
        CONTROLS,
        empty=f"No method resolves {quantity} at any load of this gap.",
        cursor=True,
        height=460,
    )


def _stiffness_axis(frames):
    """Return the axis of k, from the smallest identified value up.

    Predictions go down to nothing at low loads; they would flatten the rest.
    """
    items = [item for panel in frames.values() for item in panel.items]
    found = [np.asarray(item.y, float) for item in items if item.curve not in PREDICTED]
    known = np.concatenate([np.zeros(0), *found])
    known = known[np.isfinite(known) & (known > 0.0)]
    if not known.size:
        return Axis(COLUMNS["k"], True)
    top = max(float(np.nanmax(item.y)) for item in items)
    return Axis(COLUMNS["k"], True, 0.6 * known.min(), 1.6 * top)


def _by_place(answers, summary) -> Iterator[tuple[str, list[Answer], list[dict]]]:
    """Yield (key of the frame, Answers, summary rows) of each gap, group and direction."""
    gaps, pairs = places_of(answers)
    for at, gap in enumerate(gaps):
        for index, pair in enumerate(pairs):
            place = (gap, *pair)
            yield (
                key_of(at, index),
                [row for row in answers if row.place == place],
                [row for row in summary if (row["gap_m"], row["group"], row["direction"]) == place],
            )


def _methods(rows):
    """Return the methods of summary rows, those that are compared last: they are drawn on top."""
    known = list(dict.fromkeys(row["method"] for row in rows))
    return sorted(known, key=lambda method: method in COMPARED["k"])


def _recommended(quantity: str, chosen: Sequence[Answer], load_unit: str) -> Iterator[Series]:
    """Yield the curve of the recommended value with its band, if there is one."""
    values: list[Value] = [getattr(row, quantity) for row in chosen]
    if any(value.resolved for value in values):
        yield Series(
            "recommended",
            [row.load_rms_N for row in chosen],
            [value.value for value in values],
            low=[value.low for value in values],
            high=[value.high for value in values],
            band=True,
            label="recommended",
            marker="o",
            width=2.4,
            size=2.5,
            hover=[
                f"recommended {quantity} = {value.value:.3g} {UNITS[quantity]}"
                f"<br>{value.low:.3g} to {value.high:.3g} {UNITS[quantity]} over seeds<br>"
                f"at {row.load_rms_N:.3g} {load_unit}; methods: {value.agreement}"
                for row, value in zip(chosen, values, strict=True)
            ],
        )


def _bounds(chosen: Sequence[Answer]) -> list[Series]:
    """Return the upper bounds of k, an empty list without any."""
    rows = [row for row in chosen if row.bounded]
    if not rows:
        return []
    loads, bounds = [row.load_rms_N for row in rows], [row.bound for row in rows]
    reasons = [row.k.reason for row in rows]
    look: dict[str, Any] = {"label": "upper bound", "colour": GREY, "line": "", "marker": "v"}
    return [Series("upper bound", loads, bounds, hover=reasons, **look)]


def _method(quantity, method, rows):
    """Return the curve of one method in a list, empty if it has no value at any load."""
    chosen = [
        row
        for row in rows
        if row["method"] == method
        and np.isfinite(number_or_nan(row[f"{quantity}_median"]))
        and (quantity != "k" or row["k_median"] > 0.0)
    ]
    if not chosen:
        return []
    middle, low, high = (
        [row[f"{quantity}_{part}"] for row in chosen] for part in ("median", "low", "high")
    )
    predicted = method in PREDICTED
    ends = (None, None) if predicted else (low, high)
    look = look_of(method) | {"label": method_name(method), "size": None}
    look["hidden"] = not predicted and method not in COMPARED[quantity]
    return [Series(method, [row["load_rms_N"] for row in chosen], middle, {}, *ends, **look)]


def _ratios(answers, summary, loads):
    """Return the plot of each compared method's k and c over the recommended value."""
    found = {}
    for key, chosen, rows in _by_place(answers, summary):
        found[key] = [
            item
            for quantity in COLUMNS
            for method in COMPARED[quantity]
            for item in _ratio(quantity, method, rows, chosen)
        ]
    values = [value for items in found.values() for item in items for value in item.y]
    agree = Span("y", 1.0 - AGREEMENT, 1.0 + AGREEMENT, PALE, 0.4)
    low, high = min([0.9 - AGREEMENT, *values]) - 0.05, max([1.1 + AGREEMENT, *values]) + 0.05
    axis = Axis("method_ratio", False, low, high)
    return PagePlot(
        "agreement_ratio",
        "Each method over the recommended value",
        (
            "k (solid) and c (dotted, open) of the compared methods divided by the recommended"
            f" value. They agree inside the shaded band, within {100 * AGREEMENT:.0f} %. Pole and"
            " deflection shape read the main peak; the broadband PSD reads the whole band."
        ),
        {key: Panel(loads, axis, [*items, agree]) for key, items in found.items()},
        CONTROLS,
        empty="No value to compare at this gap.",
        wide=True,
        cursor=True,
        height=400,
    )


def _ratio(quantity, method, rows, chosen):
    """Return the ratio of one method in a list, empty without values."""
    centre = {row.load_rms_N: getattr(row, quantity).value for row in chosen}
    ratios = {
        row["load_rms_N"]: number_or_nan(row[f"{quantity}_median"])
        / centre.get(row["load_rms_N"], np.nan)
        for row in rows
        if row["method"] == method
    }
    ratios = {load: ratio for load, ratio in ratios.items() if np.isfinite(ratio)}
    if not ratios:
        return []
    look = look_of(method) | {"label": f"{quantity}, {method_name(method)}", "size": None}
    if quantity == "c":
        look |= {"line": ":", "hollow": True}
    return [Series(method, list(ratios), list(ratios.values()), **look)]


def _agreement(quantity, answers, load_label):
    """Return the plot of the agreement by gap and load: one cell per case, with its reason."""
    gaps, pairs = places_of(answers)
    down, frames = Axis("gap_m", names=[f"{gap * 1e3:.3g}" for gap in gaps]), {}
    for index, pair in enumerate(pairs):
        own = [row for row in answers if (row.group, row.direction) == pair]
        chosen = {(row.gap_m, row.load_rms_N): row for row in own}
        loads = sorted({load for _, load in chosen})
        rows = [[(gap, load, chosen.get((gap, load))) for load in loads] for gap in gaps]
        names = [f"{load:.3g}" for load in loads]
        across = Axis("load_rms_N", label=load_label, names=names)
        frames[key_of(index)] = Panel(across, down, [_cells(quantity, rows)])
    seen = {_kind(quantity, row) for row in answers}
    legend = ", ".join(
        f"{sign} {words}" for kind, (sign, _, words) in CELLS.items() if kind in seen
    )
    return PagePlot(
        f"agreement_{quantity}",
        f"Do the methods agree on {quantity}?",
        (
            f"A cell per load and gap: {legend}. The pointer over a cell shows the value, or the"
            " reason why there is none."
        ),
        frames,
        ("place",),
        height=150 + 40 * len(gaps),
    )


def _cells(quantity, rows):
    """Return the Cells of rows of (gap, load, Answer or None)."""

    def about(gap, load, cell):
        return f"load {load:.3g}, gap {gap * 1e3:.3g} mm<br>{_reason(quantity, cell)}"

    kinds = [[_kind(quantity, cell) for _, _, cell in row] for row in rows]
    return Cells(
        [[list(CELLS).index(kind) for kind in row] for row in kinds],
        [colour for _, colour, _ in CELLS.values()],
        [[CELLS[kind][0] for kind in row] for row in kinds],
        [[about(*cell) for cell in row] for row in rows],
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
