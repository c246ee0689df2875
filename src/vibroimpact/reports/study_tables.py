"""The tables of a study's page, as texts in the units that a reader expects."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from itertools import groupby

from .equivalent_answer import Answer, Value
from .number_text import digits
from .study_statistics import RESIDUALS, SEVERAL, Spread, StudyStatistics
from .study_words import stiffness_unit
from .table import Table

AGREEMENTS = {
    "agree": "agree",
    "spread": "over 25 % apart",
    "differ": "differ",
    "unresolved": "not resolved",
}
PARTIAL = {"k": "two of three", "c": "one of two"}
NUMBERS = re.compile(r"[-+]?\d[-+.e\d]*( (?=[kMG]?N))?[kMG]?")  # with the prefix of a unit
RESIDUAL_WORDS = {
    "energy_residual": "with the work of the contact forces",
    "potential_energy_residual": "with the contact's potential energy",
    "fixed_point_residual": "contact iteration, bound",
}
# Quantity -> (heading with its unit, units per SI unit).
SUPPORT_COLUMNS = {
    "contact_fraction": ("time in contact (%)", 100.0),
    "impact_rate": ("impacts (1/s)", 1.0),
    "rms_force": ("RMS force (N)", 1.0),
    "peak_force": ("peak force (N)", 1.0),
    "wear_work_rate": ("wear work rate (mW)", 1e3),
    "sliding_work": ("sliding work (J)", 1.0),
}
ELEMENT_COLUMNS = {
    "element_power": ("mean power (W)", 1.0),
    "slip_power": ("slip power (W)", 1.0),
    "slip_work": ("slip work (J)", 1.0),
}


def answer_table(answers: Sequence[Answer], several: bool, unit: str) -> Table:
    """Return recommended k and c with intervals over seeds and agreement, a row per answer.

    several: whether to name group and direction.
    unit: of the load.
    """
    stiffness, factor = stiffness_unit([row.k.value for row in answers])
    places = ("supports", "direction") if several else ()
    columns = (
        "gap (mm)",
        *places,
        f"load ({unit} RMS)",
        f"k ({stiffness})",
        "interval of k",
        "methods on k",
        "c (N s/m)",
        "interval of c",
        "methods on c",
    )
    rows = [
        (
            digits(1e3 * row.gap_m),
            *((row.group, row.direction) if several else ()),
            digits(row.load_rms_N),
            *_value_cells(row, "k", factor),
            *_value_cells(row, "c", 1.0),
        )
        for row in answers
    ]
    return Table(columns, rows)


def agreement_in_words(row: Answer, quantity: str) -> str:
    """Return the result of the methods on k or c, in a few words."""
    value: Value = getattr(row, quantity)
    if row.bounded:
        return "upper bound" if quantity == "k" else "no contact to tell"
    words = {**AGREEMENTS, "partial": PARTIAL[quantity]}
    return words.get(value.agreement, value.agreement)


def _value_cells(row: Answer, quantity: str, factor: float) -> tuple[str, str, str]:
    value: Value = getattr(row, quantity)
    agreement = agreement_in_words(row, quantity)
    if row.bounded and quantity == "k":
        return f"< {digits(factor * row.bound)}", "-", agreement
    if not value.resolved:
        return "-", "-", agreement
    return digits(factor * value.value), span(factor * value.low, factor * value.high), agreement


def span(low: float, high: float) -> str:
    """Return an interval as text."""
    return f"{digits(low)} to {digits(high)}"


def reason_table(
    answers: Sequence[Answer], statistics: StudyStatistics, several: bool, unit: str
) -> Table:
    """Return why values are not resolved or differ, a row per run of loads with the same reason.

    k and c share a row if they share the reason. The share of time in contact shows whether there
    was a support to see.
    """
    places = ("supports", "direction") if several else ()
    columns = ("gap (mm)", *places, f"loads ({unit} RMS)", "value", "why", "time in contact (%)")
    rows = []
    for place, group in groupby(answers, key=lambda row: row.place):
        curve = list(group)
        for quantity in ("k", "c"):
            for kind, run in groupby(curve, key=lambda row: _kind(row, quantity)):
                alike = list(run)
                loads = [row.load_rms_N for row in alike]
                if kind is None:
                    continue
                reasons = [getattr(row, quantity).reason for row in alike]
                rows.append(
                    (
                        digits(1e3 * place[0]),
                        *(place[1:] if several else ()),
                        digits(loads[0]) if len(loads) == 1 else span(loads[0], loads[-1]),
                        f"{kind[0]}: {kind[1]}",
                        _reason(reasons, loads[0], unit),
                        _touching(statistics, alike),
                    )
                )
    return Table(columns, rows)


def _kind(row: Answer, quantity: str) -> tuple[str, str, str] | None:
    """Return (k, c or both, agreement, reason without its numbers), by which loads share a row.

    None if there is no reason, or k has the same.
    """
    value: Value = getattr(row, quantity)
    both = not row.k.resolved and not row.c.resolved and row.k.reason == row.c.reason
    if not value.reason or (both and quantity == "c"):
        return None
    name = "k and c" if both and not row.bounded else quantity
    return name, agreement_in_words(row, quantity), NUMBERS.sub("#", value.reason)


def _reason(reasons: Sequence[str], load: float, unit: str) -> str:
    """Return the reason of a run of loads; that of its first load if the numbers change."""
    if len(set(reasons)) == 1:
        return reasons[0]
    return f"{reasons[0]} (at {digits(load)} {unit} RMS, likewise at the others)"


def _touching(statistics: StudyStatistics, alike: Sequence[Answer]) -> str:
    """Return the range of the time in contact: of the answers, or of all supports without it."""
    values = [
        100.0 * row.touching
        if math.isfinite(row.touching)
        else 100.0
        * statistics.spread("contact_fraction", row.gap_m, row.load_rms_N, SEVERAL).median
        for row in alike
    ]
    finite = [value for value in values if math.isfinite(value)]
    if not finite:
        return "-"
    low, high = digits(min(finite)), digits(max(finite))
    return low if low == high else f"{low} to {high}"


def contact_table(
    statistics: StudyStatistics, gap_m: float, loads: Sequence[float], unit: str
) -> Table:
    """Return contact and wear of one gap, a row per load and support, medians over seeds."""
    return _of_places(statistics, gap_m, loads, unit, SUPPORT_COLUMNS)


def element_table(
    statistics: StudyStatistics, gap_m: float, loads: Sequence[float], unit: str
) -> Table:
    """Return power and work of the local elements, a row per load and element, medians."""
    return _of_places(statistics, gap_m, loads, unit, ELEMENT_COLUMNS)


def _of_places(
    statistics: StudyStatistics,
    gap_m: float,
    loads: Sequence[float],
    unit: str,
    columns: Mapping[str, tuple[str, float]],
) -> Table:
    """Return the quantities of supports or elements that were recorded."""
    present = {name: about for name, about in columns.items() if name in statistics.quantities}
    supports = columns is SUPPORT_COLUMNS
    rows = [
        (
            digits(load),
            place,
            *(
                digits(factor * statistics.spread(quantity, gap_m, load, place).median)
                for quantity, (_, factor) in present.items()
            ),
        )
        for load in loads
        for place in (statistics.supports if supports else statistics.elements)
    ]
    titles = [title for title, _ in present.values()]
    return Table((f"load ({unit} RMS)", "support" if supports else "element", *titles), rows)


def stress_table(statistics: StudyStatistics, loads: Sequence[float], unit: str) -> Table:
    """Return the stress of the most stressed section, a row per gap and load, medians over seeds.

    The peak has its range over seeds.
    """
    columns = (
        "gap (mm)",
        f"load ({unit} RMS)",
        "RMS stress (MPa)",
        "peak stress (MPa)",
        "range over seeds",
        "most stressed section",
        "above the limit",
    )
    flagged = set(statistics.flagged())
    rows = []
    for gap in statistics.gaps:
        for load in loads:
            rms, peak = (
                _scaled(statistics.spread(quantity, gap, load, SEVERAL), 1e-6)
                for quantity in ("stress_rms", "stress_peak")
            )
            if not math.isfinite(peak.median):
                continue
            worst = max(
                statistics.sections,
                key=lambda name: statistics.spread("stress_peak", gap, load, name).median,
            )
            rows.append(
                (
                    digits(1e3 * gap),
                    digits(load),
                    digits(rms.median),
                    digits(peak.median),
                    span(peak.low, peak.high),
                    worst.replace("_", " "),
                    "yes" if (gap, load) in flagged else "no",
                )
            )
    return Table(columns, rows)


def _scaled(spread: Spread, factor: float) -> Spread:
    return Spread(*(factor * value for value in spread))


def energy_table(statistics: StudyStatistics, limits: Mapping[str, float], unit: str) -> Table:
    """Return the worst energy residual of all cases and the accepted one."""
    rows = []
    for quantity in RESIDUALS:
        value, gap, load = statistics.largest(quantity)
        if not math.isfinite(value):
            continue
        limit = limits.get(quantity)
        rows.append(
            (
                RESIDUAL_WORDS[quantity],
                f"{value:.2g}",
                "-" if limit is None else f"{limit:.2g}",
                "-" if limit is None else "yes" if value <= limit else "no",
                digits(load),
                digits(1e3 * gap),
            )
        )
    columns = (
        "energy balance",
        "worst residual / input work (-)",
        "accepted (-)",
        "within",
        f"at load ({unit} RMS)",
        "at gap (mm)",
    )
    return Table(columns, rows)


def timing_table(rows: Sequence[dict]) -> Table:
    """Return the time of the jobs by rule.

    rows: of study.timing.study_timing.
    """
    columns = ("rule", "jobs", "wall time (s)", "CPU time (s)", "largest memory (MB)")
    chosen = [row for row in rows if row["part"] == ""]
    return Table(
        columns,
        [
            (
                str(row["rule"]).replace("_", " "),
                str(row["jobs"]),
                f"{row['wall_s']:.1f}",
                f"{row['cpu_s']:.1f}",
                f"{row['max_rss_MB']:.0f}",
            )
            for row in chosen
        ],
    )


def spread_evenly(values: Sequence[float], most: int) -> list[float]:
    """Return at most `most` of the values, both ends among them, evenly spaced in their order."""
    if len(values) <= most:
        return list(values)
    return [values[round(at * (len(values) - 1) / (most - 1))] for at in range(most)]
