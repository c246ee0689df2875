"""An answer as a readable table, as rows of a CSV table, and as plain values for JSON."""

import csv
import io
from dataclasses import asdict
from typing import Any

from vibroimpact.io.records import plain_values
from vibroimpact.study.equivalent_table import VALUES
from vibroimpact.study.method_agreement import COMPARED
from vibroimpact.study.reasons import NOT_MOVED, UNITS

from .answer import Answer, GroupAnswer, Span

AGREEMENTS = {
    "spread": "more than 25 % apart",
    "differ": "they differ",
    "unresolved": "not resolved",
}
TEXTS = ("agreement_k", "agreement_c", "reason_k", "reason_c", "how")  # columns of a group
PARTIAL = {"k": "two of three resolve it", "c": "one of two resolves it"}


def as_text(answer: Answer) -> str:
    """Return an answer as text: per group the values, each method, and their origin."""
    what = "Estimate without a simulation for" if answer.kind == "estimate" else "Study"
    level = f" (load over gap {answer.load_rms_N / answer.gap_m:.3g} N/m)"
    head = (
        f"{what} '{answer.study}': equivalent support at {answer.load_rms_N:g} N RMS and a gap of"
        f" {1e3 * answer.gap_m:.4g} mm{level if answer.homogeneous else ''}"
    )
    moved = [group for group in answer.groups if group.moved]
    blocks = [head, *(_group_text(group, answer.homogeneous) for group in moved)]
    still = [
        f"'{group.group}' along {group.direction}" for group in answer.groups if not group.moved
    ]
    blocks += [f"No values for {', '.join(still)}: {NOT_MOVED}."] if still else []
    warnings = [f"WARNING: {sentence}." for sentence in answer.warnings]
    return "\n\n".join([*blocks, *warnings, *answer.notes])


def _group_text(group: GroupAnswer, homogeneous: bool) -> str:
    """Return the block of one group."""
    place = f"Group '{group.group}' ({', '.join(group.supports)}), along {group.direction}"
    lines = [f"{place}; values per support"]
    for name, span, agreement, reason in group.parts:
        words = PARTIAL[name] if agreement == "partial" else AGREEMENTS.get(agreement, agreement)
        said = f"   methods: {words}" if agreement else ""
        if span.resolved:
            interval = f"{span.low:.3g} to {span.high:.3g}"
            value = f"{name} = {span.value:.4g} {UNITS[name]}"
            lines.append(f"  {value:26} {interval:24}{said}".rstrip())
        elif group.bounded:
            lines.append(f"  {reason}" if name == "k" else "  c   no value: k has only a bound")
        else:
            same = name == "c" and not group.k.resolved and reason == group.reason_k
            word = "no recommended value" if agreement == "differ" else "unresolved"
            lines.append(f"  {name}   {word}{', as k' if same else f': {reason}'}")
    if group.methods:
        lines += ["", f"  {'method':26} {'k [N/m]':34} c [N s/m]"]
        lines += [
            f"  {_marked(item.method):26} {_span_text(item.k):34} {_span_text(item.c)}".rstrip()
            for item in group.methods
        ]
        lines += ["  * compared: the recommended values come from these", ""]
    if group.how:
        lines.append(f"  {group.how[0].upper()}{group.how[1:]}.")
    if group.methods:
        lines.append(f"  {_agreement_text(group, homogeneous)}")
    return "\n".join(lines)


def _agreement_text(group: GroupAnswer, homogeneous: bool) -> str:
    """Return the range in which the methods agree on k."""
    if group.agreeing is None:
        return "The methods agree on k nowhere in the study."
    unit = "N/m of load over gap" if homogeneous else "N RMS"
    low, high = group.agreeing
    where = f"{f'from {low:.3g} to' if low < high else 'at'} {high:.3g} {unit}."
    if group.agreement_k == "agree":
        return f"The methods agree on k {where}"
    return f"The methods do not agree on k here; nearest, they do {where}"


def _marked(method: str) -> str:
    return f"{method} *" if method in COMPARED else method


def _span_text(span: Span) -> str:
    return f"{span.value:.4g} ({span.low:.3g} to {span.high:.3g})" if span.resolved else "-"


def table_rows(answer: Answer) -> list[dict[str, Any]]:
    """Return {column of the CSV: value} of every group and direction."""
    return [
        {name: getattr(answer, name) for name in ("study", "kind", "gap_m", "load_rms_N")}
        | {"group": group.group, "supports": " ".join(group.supports), "direction": group.direction}
        | {VALUES["k"]: group.k.value, "k_low": group.k.low, "k_high": group.k.high}
        | {VALUES["c"]: group.c.value, "c_low": group.c.low, "c_high": group.c.high}
        | {f"secant_{column}": getattr(group, f"secant_{name}") for name, column in VALUES.items()}
        | {name: getattr(group, name) for name in TEXTS}
        | {"k_bound": group.bound, "flag": group.flag, "anyway": group.anyway}
        for group in answer.groups
    ]


def as_csv(answer: Answer) -> str:
    """Return an answer as CSV: one row per group and direction."""
    text, rows = io.StringIO(), table_rows(answer)
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().rstrip("\n")


def as_plain(answer: Answer) -> dict[str, Any]:
    """Return an answer as JSON knows values, with its warnings; unresolved values are null."""
    plain: dict[str, Any] = plain_values(asdict(answer) | {"warnings": answer.warnings})
    return plain
