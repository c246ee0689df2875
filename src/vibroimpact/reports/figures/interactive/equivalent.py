"""Equivalent k and c against load: the recommended values, and those of every method."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np

from vibroimpact.reports.equivalent_answer import Answer, Value, places_of
from vibroimpact.reports.figures.plot import Axis, Panel, Series, extent
from vibroimpact.reports.figures.study.equivalent import PREDICTED, look_of
from vibroimpact.reports.figures.style import GREY
from vibroimpact.study.equivalent_table import VALUES
from vibroimpact.study.method_agreement import COMPARED, COMPARED_OF
from vibroimpact.study.reasons import UNITS

from .page_plot import PagePlot, unit_of

WORDS = {"k": "stiffness", "c": "damping"}
BOUNDS = {"k": " Grey triangles: upper bounds of k, at which the tube hardly touches.", "c": ""}


def equivalent_plots(
    answers: Sequence[Answer], summary: Sequence[dict], loads: Axis
) -> list[PagePlot]:
    """Return the plots of k and of c against load, by gap, group and direction.

    answers: in their order.
    summary: rows of consistency_summary.csv.
    loads: of all plots of the page.
    """
    return [_against_load(quantity, answers, summary, loads) for quantity in VALUES]


def _against_load(quantity, answers, summary, loads):
    gaps, pairs = places_of(answers)
    found: dict[tuple, list[Series]] = {}
    look: dict[str, Any] = {"label": "upper bound", "colour": GREY, "line": "", "marker": "v"}
    for gap, pair in product(gaps, pairs):
        place = (gap, *pair)
        own = [row for row in answers if row.place == place]
        rows = [row for row in summary if (row["gap_m"], row["group"], row["direction"]) == place]
        found[gap, pair] = [*_recommended(quantity, own, unit_of(loads.label))]
        found[gap, pair] += _methods(quantity, rows)
        bounded = [row for row in own if row.bounded]
        if quantity == "k" and bounded:
            loads_of, bounds = [row.load_rms_N for row in bounded], [row.bound for row in bounded]
            look["hover"] = [row.k.reason for row in bounded]
            found[gap, pair].append(Series("upper bound", loads_of, bounds, **look))
    axis = Axis(VALUES[quantity])
    if quantity == "k":
        # Predictions go down to nothing at low loads; they would flatten the rest.
        items = [item for own in found.values() for item in own]
        low, _ = extent([y for item in items if item.curve not in PREDICTED for y in item.y], True)
        axis = Axis(VALUES["k"], True, low, extent([y for item in items for y in item.y], True)[1])
    return PagePlot(
        f"equivalent_{quantity}",
        f"Equivalent {WORDS[quantity]} {quantity}",
        (
            f"Black with its band: the recommended {quantity}, median of the compared methods, and"
            f" its range over seeds; markers: each method with its own range.{BOUNDS[quantity]}"
            " If there is no black line no value is recommended; the table below says why."
        ),
        {key: Panel(loads, axis, own) for key, own in found.items()},
        ("gap", "place"),
        empty=f"No method resolves {quantity} at any load of this gap.",
        cursor=True,
        height=460,
    )


def _recommended(quantity: str, own: Sequence[Answer], load_unit: str) -> Iterator[Series]:
    """Yield the curve of the recommended value with its band, if there is one."""
    values: list[Value] = [getattr(row, quantity) for row in own]
    if any(value.resolved for value in values):
        yield Series(
            "recommended",
            [row.load_rms_N for row in own],
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
                for row, value in zip(own, values, strict=True)
            ],
        )


def _methods(quantity: str, rows: Sequence[dict]) -> Iterator[Series]:
    """Yield the curve of each method that has values, the compared methods last: on top."""
    for method in sorted({row["method"]: 0 for row in rows}, key=COMPARED.__contains__):
        table = [
            row
            for row in rows
            if row["method"] == method
            and np.isfinite(row[f"{quantity}_median"])
            and (quantity != "k" or row["k_median"] > 0.0)
        ]
        if not table:
            continue
        middle, low, high = (
            [row[f"{quantity}_{part}"] for row in table] for part in ("median", "low", "high")
        )
        predicted = method in PREDICTED
        ends: Any = (None, None) if predicted else (low, high)
        hidden = not predicted and method not in COMPARED_OF[quantity]
        look = look_of(method) | {"size": None, "hidden": hidden}
        yield Series(method, [row["load_rms_N"] for row in table], middle, {}, *ends, **look)
