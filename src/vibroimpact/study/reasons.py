"""Why a study has no stiffness or damping for a case, or a remark on it: one sentence in
a reader's words.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from vibroimpact.identify.estimate import method_name
from vibroimpact.io.display_units import display_unit

from .method_agreement import AGREEMENT, FEWEST, WEAK, Span

NOT_MOVED = "the force does not move the supports in this direction"
HARDLY = 0.05  # share of time in contact below which a tube hardly touches
COUNTS = {1: "one", 2: "two", 3: "three"}
UNITS = {"k": "N/m", "c": "N s/m"}


def in_unit(value: float, quantity: str = "k") -> str:
    """Return k (N/m) or c (N s/m) with 3 digits and its unit."""
    unit, factor = display_unit(UNITS[quantity], [value])
    return f"{factor * value:.3g} {unit}"


def bound_text(bound: float, touching: float) -> str:
    """Return that k is below a bound in N/m, and the share of time in contact, NaN if unknown."""
    text = f"k < {in_unit(bound)}: "
    if np.isnan(touching):
        return text + "too soft to tell from no support"
    if touching == 0.0:
        return text + "the tube touches nothing"
    share = f"{100.0 * touching:.2g} % of the time"
    if touching < HARDLY:
        return f"{text}the tube hardly touches, {share}"
    return f"{text}too soft to tell from no support, though the tube touches {share}"


def reason(
    quantity: str, methods: Mapping[str, dict], spans: Mapping[str, Span], agreement: str
) -> str:
    """Return why there is no k or c, or a remark on it; empty if the methods agree.

    methods: {method: row of consistency_summary.csv}; spans: of the compared ones.
    """
    if agreement == "agree":
        return _weakness(methods, spans) if quantity == "k" else ""
    found = {name: span for name, span in spans.items() if np.isfinite(span[0])}
    values = ", ".join(
        f"{method_name(name)} {in_unit(span[0], quantity)}" for name, span in found.items()
    )
    if agreement == "differ":
        return f"the methods differ: {values}"
    if agreement == "spread":
        return f"the methods are more than 25 % apart: {values}"
    silent = [name for name in spans if name not in found]
    why = ""
    if silent:
        row = methods[silent[0]]
        none = np.isfinite(row.get("k_bound", np.nan))
        told = "does not tell k from none" if none else row.get("reason") or "no value"
        why = f"{method_name(silent[0])}: {told}"
    if agreement == "partial":
        verb = "resolves" if len(found) == 1 else "resolve"
        every = COUNTS[len(spans)]
        return f"{COUNTS[len(found)]} of {every} methods {verb} {quantity}; {why}"
    if found:
        return f"only {values}, and {COUNTS[FEWEST[quantity]]} methods must resolve it; {why}"
    return f"no method resolves {quantity}; {why}"


def _weakness(methods: Mapping[str, dict], spans: Mapping[str, Span]) -> str:
    """Return that most of the compared methods resolve k weakly, or nothing."""
    weak = [name for name in spans if str(methods[name].get("reason", "")).startswith(WEAK)]
    if 2 * len(weak) <= len(spans):
        return ""
    return f"{len(weak)} of {len(spans)} methods are {methods[weak[0]]['reason']}"


def agreement_sentence(
    quantity: str, kinds: Sequence[str], cases: str, apart: float = AGREEMENT
) -> str:
    """Return how often the methods agree on k or c, and the state of the other cases.

    kinds: of each case its verdict, or "bounded" for an upper bound of k.
    cases: such as "pairs of load and gap".
    apart: largest relative distance of a method from the recommended value if they agree.
    """
    count = {kind: kinds.count(kind) for kind in dict.fromkeys(kinds)}
    every = sum(count.get(kind, 0) for kind in ("agree", "spread", "differ"))
    several = "both methods" if quantity == "c" else "the methods"
    parts = [
        f"{count.get('agree', 0)} of {every} {cases} that {several} resolve agree on {quantity}"
        f" within {100.0 * apart:.0f} %"
        if every
        else f"{several} resolve {quantity} in none of {len(kinds)} {cases}"
    ]
    partly = (
        "one of two methods resolves c" if quantity == "c" else "two of three methods resolve k"
    )
    parts += [
        f"in {count[kind]} {text}"
        for kind, text in (
            ("spread", "they are more than 25 % apart"),
            ("differ", "they differ and nothing is recommended"),
            ("bounded", f"the tube hardly touches{' and there is no c' * (quantity == 'c')}"),
            ("partial", partly),
            ("unresolved", f"{quantity} is not resolved"),
        )
        if kind in count
    ]
    return "; ".join(parts)
