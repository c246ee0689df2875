"""The answer to "which k and c": per group of supports and direction, with its basis."""

from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.identify.estimate import method_name
from vibroimpact.study.reasons import NOT_MOVED


class EquivalentError(Exception):
    """A question that has no answer; the message states the reason and the remedy."""


@dataclass(frozen=True)
class Span:
    """A value with an interval; all NaN if it is not resolved."""

    value: float = np.nan
    low: float = np.nan
    high: float = np.nan

    @property
    def resolved(self) -> bool:
        """Whether there is a value."""
        return bool(np.isfinite(self.value))


@dataclass(frozen=True)
class MethodAnswer:
    """The values of one method: k in N/m and c in N s/m per support."""

    method: str
    k: Span
    c: Span


@dataclass(frozen=True)
class GroupAnswer:
    """The equivalent support of a group of supports along one direction.

    group, supports: name of the group, and of the supports that each have this k and c.
    direction: transverse direction, such as "y".
    k, c: recommended values, N/m and N s/m per support.
    agreement_k, agreement_c: of the compared methods, one of method_agreement.VERDICTS; "" for an
        estimate.
    reason_k, reason_c: why there is no value, or a remark on it; mostly "".
    bound: N/m, the upper bound of k if it does not differ from 0; NaN otherwise.
    flag: the doubts about the values of the study, or "".
    anyway: the one method whose value was asked for if there is no recommended one, or "".
    secant_k, secant_c: of the contact forces themselves, NaN if not known.
    methods: the values of each method.
    how: the origin of the values, a sentence.
    agreeing: the nearest range of load over gap, in N/m, over which the methods agree on k; of the
        load in N if the model is not homogeneous; None if they agree nowhere.
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
    bound: float = np.nan
    flag: str = ""
    anyway: str = ""
    secant_k: float = np.nan
    secant_c: float = np.nan
    methods: tuple[MethodAnswer, ...] = ()
    how: str = ""
    agreeing: tuple[float, float] | None = None

    @property
    def moved(self) -> bool:
        """Whether the force of the study moves the supports in this direction."""
        return self.reason_k != NOT_MOVED

    @property
    def bounded(self) -> bool:
        """Whether the answer is an upper bound of k."""
        return bool(np.isfinite(self.bound)) and not self.k.resolved

    @property
    def parts(self) -> tuple[tuple[str, Span, str, str], ...]:
        """The (name, value, agreement, reason) of k and of c."""
        return (
            ("k", self.k, self.agreement_k, self.reason_k),
            ("c", self.c, self.agreement_c, self.reason_c),
        )


@dataclass(frozen=True)
class Answer:
    """The equivalent supports of a structure at one load and gap.

    study: name of the study, or of the configuration that was estimated.
    kind: "study" or "estimate".
    load_rms_N, gap_m: those asked for, N RMS and m.
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
        """Return a sentence for every k and c without a value along moved directions.

        An upper bound of k is an answer.
        """
        sentences = []
        for group in self.groups:
            missing = {
                name: f"{'no recommended value' if word == 'differ' else 'not resolved'}: {reason}"
                for name, span, word, reason in group.parts
                if group.moved and not span.resolved and not group.bounded
            }
            if len(missing) == 2 and missing["c"] == missing["k"]:
                missing = {"k and c": missing["k"]}
            sentences += [
                f"{name} of '{group.group}' along {group.direction}: {text}"
                for name, text in missing.items()
            ]
        return sentences

    @property
    def warnings(self) -> list[str]:
        """Return a sentence for every value that the methods dispute, and for every flag."""
        sentences = []
        for group in self.groups:
            place = f"of '{group.group}' along {group.direction}"
            sentences += [f"the case {place} has a flag: {group.flag}"] if group.flag else []
            for name, span, agreement, reason in group.parts:
                if not span.resolved or not reason:
                    continue
                taken = group.anyway and agreement in ("differ", "unresolved")
                value = f"{name} {place}"
                if taken:
                    value += f" is that of the {method_name(group.anyway)} alone, taken anyway"
                sentences.append(f"{value}: {reason}")
        return sentences

    @property
    def disputed(self) -> bool:
        """Whether methods differ on a value that is missing for this reason."""
        return any(
            agreement == "differ" and not span.resolved
            for group in self.groups
            for _, span, agreement, _ in group.parts
        )

    def anyway(self, method: str) -> "Answer":
        """Return the answer with the values of one method if there is no recommended one."""
        return replace(self, groups=tuple(_with_values_of(group, method) for group in self.groups))


def _with_values_of(group: GroupAnswer, method: str) -> GroupAnswer:
    """Return a group's answer with the values of a method if it has none and no bound."""
    own = next((item for item in group.methods if item.method == method), None)
    if own is None or group.bounded or (group.k.resolved and group.c.resolved):
        return group
    k = group.k if group.k.resolved else own.k
    c = group.c if group.c.resolved or not k.resolved else own.c
    return replace(group, k=k, c=c, anyway=method)
