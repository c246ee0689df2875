"""The tables of a study's page, as texts in the units that a reader expects."""

import math
import re
from collections.abc import Sequence
from itertools import groupby, product

from .equivalent_answer import Answer, Value
from .number_text import digits, range_text, span
from .study_content import StudyContent
from .study_statistics import RESIDUALS, SEVERAL, StudyStatistics
from .study_words import stiffness_unit
from .table import Table, spread_evenly, table_of

AGREEMENTS = {
    "agree": "agree",
    "spread": "over 25 % apart",
    "differ": "differ",
    "unresolved": "not resolved",
}
PARTIAL = {"k": "two of three", "c": "one of two"}
NUMBERS = re.compile(r"[-+]?\d[-+.e\d]*( (?=[kMG]?N))?[kMG]?")  # with the prefix of a unit
TOUCHING = "time in contact (%)"
# Quantity -> (heading with its unit, units per SI unit).
SUPPORT_COLUMNS = {
    "contact_fraction": (TOUCHING, 100.0),
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
PLACE = ("supports", "direction")  # left out of the tables of a study with one place
PLACES = {"support": SUPPORT_COLUMNS, "element": ELEMENT_COLUMNS}
MOST_LOADS = 8  # of a table of statistics, per gap


def shown_loads(content: StudyContent) -> list[float]:
    """Return the loads that tables of statistics list."""
    return spread_evenly(content.statistics.loads, MOST_LOADS)


def answer_table(content: StudyContent, gap_m: float) -> Table:
    """Return recommended k and c at a gap, with intervals over seeds and agreement."""
    stiffness, factor = stiffness_unit([row.k.value for row in content.answers])
    rows = [
        {
            **_place_cells(row),
            f"load ({content.unit} RMS)": digits(row.load_rms_N),
            **_value_cells(row, "k", stiffness, factor),
            **_value_cells(row, "c", "N s/m", 1.0),
        }
        for row in content.answers
        if row.gap_m == gap_m
    ]
    return table_of(rows, () if content.several else PLACE)


def _place_cells(row: Answer) -> dict[str, str]:
    """Return the cells of gap, group of supports and direction."""
    return {"gap (mm)": digits(1e3 * row.gap_m), "supports": row.group, "direction": row.direction}


def agreement_in_words(row: Answer, quantity: str) -> str:
    """Return the result of the methods on k or c, in a few words."""
    value: Value = getattr(row, quantity)
    if row.bounded:
        return "upper bound" if quantity == "k" else "no contact to tell"
    words = {**AGREEMENTS, "partial": PARTIAL[quantity]}
    return words.get(value.agreement, value.agreement)


def _value_cells(row: Answer, quantity: str, unit: str, factor: float) -> dict[str, str]:
    """Return the cells of k or c in a unit: value, interval, agreement."""
    value: Value = getattr(row, quantity)
    shown, interval = "-", "-"
    if row.bounded and quantity == "k":
        shown = f"< {digits(factor * row.bound)}"
    elif value.resolved:
        shown = digits(factor * value.value)
        interval = span(factor * value.low, factor * value.high)
    return {
        f"{quantity} ({unit})": shown,
        f"interval of {quantity}": interval,
        f"methods on {quantity}": agreement_in_words(row, quantity),
    }


def reason_table(content: StudyContent) -> Table:
    """Return why values are not resolved or differ, a row per run of loads with the same reason.

    k and c share a row if they share the reason. The share of time in contact shows whether there
    was a support to see; it is left out of what was measured.
    """
    rows = []
    for _, group in groupby(content.answers, key=lambda row: row.place):
        curve = list(group)
        for quantity in ("k", "c"):
            for kind, run in groupby(curve, key=lambda row: _kind(row, quantity)):
                if kind is not None:
                    rows.append(_reason_row(content, quantity, kind, list(run)))
    left_out = () if content.statistics.supports else (TOUCHING,)
    return table_of(rows, left_out if content.several else (*PLACE, *left_out))


def _reason_row(
    content: StudyContent, quantity: str, kind: tuple[str, str, str], alike: Sequence[Answer]
) -> dict[str, str]:
    """Return the row of a run of loads with the same reason, that of its first load if the numbers
    change.
    """
    first, last = digits(alike[0].load_rms_N), digits(alike[-1].load_rms_N)
    reasons = [getattr(row, quantity).reason for row in alike]
    why = f"{reasons[0]} (at {first} {content.unit} RMS, likewise at the others)"
    return {
        **_place_cells(alike[0]),
        f"loads ({content.unit} RMS)": first if len(alike) == 1 else f"{first} to {last}",
        "value": f"{kind[0]}: {kind[1]}",
        "why": reasons[0] if len(set(reasons)) == 1 else why,
        TOUCHING: _touching(content.statistics, alike),
    }


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


def _touching(statistics: StudyStatistics, alike: Sequence[Answer]) -> str:
    """Return the range of the time in contact: of the answers, or of all supports without it."""
    values = []
    for row in alike:
        case = row.gap_m, row.load_rms_N, SEVERAL
        known = math.isfinite(row.touching)
        values.append(
            row.touching if known else statistics.spread("contact_fraction", *case).median
        )
    finite = [100.0 * value for value in values if math.isfinite(value)]
    return range_text(min(finite), max(finite)) if finite else "-"


def place_table(content: StudyContent, kind: str, gap_m: float) -> Table:
    """Return contact and wear, or power and work, of one gap, a row per load and place.

    kind: of the places, support or element. The values are medians over seeds of the quantities
    that were recorded.
    """
    statistics = content.statistics
    present = {name: of for name, of in PLACES[kind].items() if name in statistics.quantities}
    return table_of(
        {f"load ({content.unit} RMS)": digits(load), kind: place}
        | {
            title: digits(factor * statistics.spread(quantity, gap_m, load, place).median)
            for quantity, (title, factor) in present.items()
        }
        for load in shown_loads(content)
        for place in (statistics.supports if kind == "support" else statistics.elements)
    )


def stress_table(content: StudyContent) -> Table:
    """Return the stress of the most stressed section, a row per gap and load, medians over seeds.

    The peak has its range over seeds.
    """
    statistics, rows = content.statistics, []
    flagged = set(statistics.flagged())
    for gap, load in product(statistics.gaps, shown_loads(content)):
        rms, peak = (
            [1e-6 * value for value in statistics.spread(quantity, gap, load, SEVERAL)]
            for quantity in ("stress_rms", "stress_peak")
        )
        if not math.isfinite(peak[0]):
            continue
        medians = {
            name: statistics.spread("stress_peak", gap, load, name).median
            for name in statistics.sections
        }
        rows.append(
            {
                "gap (mm)": digits(1e3 * gap),
                f"load ({content.unit} RMS)": digits(load),
                "RMS stress (MPa)": digits(rms[0]),
                "peak stress (MPa)": digits(peak[0]),
                "range over seeds": span(*peak[1:]),
                "most stressed section": max(medians, key=lambda name: medians[name]).replace(
                    "_", " "
                ),
                "above the limit": "yes" if (gap, load) in flagged else "no",
            }
        )
    return table_of(rows)


def energy_table(content: StudyContent) -> Table:
    """Return the worst energy residual of all cases and the accepted one."""
    rows = []
    for quantity, words in RESIDUALS.items():
        value, gap, load, _ = content.statistics.largest(quantity)
        if math.isfinite(value):
            limit = content.limits.get(quantity)
            rows.append(
                {
                    "energy balance": words,
                    "worst residual / input work (-)": f"{value:.2g}",
                    "accepted (-)": "-" if limit is None else f"{limit:.2g}",
                    "within": "-" if limit is None else "yes" if value <= limit else "no",
                    f"at load ({content.unit} RMS)": digits(load),
                    "at gap (mm)": digits(1e3 * gap),
                }
            )
    return table_of(rows)


def timing_table(rows: Sequence[dict]) -> Table:
    """Return the time of the jobs by rule; rows: of study.timing.study_timing."""
    return table_of(
        {
            "rule": str(row["rule"]).replace("_", " "),
            "jobs": row["jobs"],
            "wall time (s)": f"{row['wall_s']:.1f}",
            "CPU time (s)": f"{row['cpu_s']:.1f}",
            "largest memory (MB)": f"{row['max_rss_MB']:.0f}",
        }
        for row in rows
        if row["part"] == ""
    )
