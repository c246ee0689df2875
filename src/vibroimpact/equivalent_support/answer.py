"""The answer to "which k and c": per group of supports and direction, with what it rests on."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

# Reason of a direction in which a study says nothing because its force does not move it.
NOT_MOVED = "the force does not move the supports in this direction"


class EquivalentError(Exception):
    """A question that has no answer; the message says why and what to do."""


@dataclass(frozen=True)
class Span:
    """A value with an interval; all NaN where it is not resolved."""

    value: float = np.nan
    low: float = np.nan
    high: float = np.nan

    @property
    def resolved(self) -> bool:
        """Whether there is a value."""
        return bool(np.isfinite(self.value))


@dataclass(frozen=True)
class MethodAnswer:
    """What one method says: k in N/m and c in N s/m per support."""

    method: str
    k: Span
    c: Span


@dataclass(frozen=True)
class GroupAnswer:
    """The equivalent support of a group of supports along one direction.

    group, supports: name of the group, and of the supports that each have this k and c.
    direction: transverse direction, such as "y".
    k, c: recommended values, N/m and N s/m per support.
    agreement_k, agreement_c: of the compared methods: "agree", "spread", or "unresolved" where not
        all of them resolve the value; "" for an estimate.
    reason_k, reason_c: why there is no value, or "".
    secant_k, secant_c: of the contact forces themselves, NaN where not known.
    methods: what each method says.
    how: where the values come from, a sentence.
    agreeing: the nearest range of load over gap, in N/m, over which the methods agree on k; of the
        load in N where the model is not homogeneous; None where they agree nowhere.
    """

    group: str
    supports: tuple[str, ...]
    direction: str
    k: Span
    c: Span
    agreement_k: str = ""
    agreement_c: str = ""
    reason_k: str = ""
    reason_c: str = ""
    secant_k: float = np.nan
    secant_c: float = np.nan
    methods: tuple[MethodAnswer, ...] = ()
    how: str = ""
    agreeing: tuple[float, float] | None = None

    @property
    def moved(self) -> bool:
        """Whether the force of the study moves the supports in this direction."""
        return self.reason_k != NOT_MOVED


@dataclass(frozen=True)
class Answer:
    """The equivalent supports of a structure at one load and gap.

    study: name of the study, or of the configuration that was estimated.
    kind: "study" or "estimate".
    load_rms_N, gap_m: what was asked, N RMS and m.
    homogeneous: whether k depends on load over gap alone.
    notes: sentences that belong to the values.
    """

    study: str
    kind: str
    load_rms_N: float
    gap_m: float
    groups: tuple[GroupAnswer, ...]
    homogeneous: bool = True
    notes: tuple[str, ...] = field(default=())

    @property
    def unresolved(self) -> list[str]:
        """Return a sentence for every k and c that is not resolved where the force moves."""
        sentences = []
        for group in self.groups:
            missing = {
                name: reason
                for name, span, reason in (
                    ("k", group.k, group.reason_k),
                    ("c", group.c, group.reason_c),
                )
                if group.moved and not span.resolved
            }
            if len(missing) == 2 and missing["c"] == missing["k"]:
                missing = {"k and c": missing["k"]}
            sentences += [
                f"{name} of '{group.group}' along {group.direction}: not resolved: {reason}"
                for name, reason in missing.items()
            ]
        return sentences
