"""From gains to probabilities, and from probabilities to a conclusion.

A hypothesis counts by its gain on stretches that took no part. Nothing is missing if the best gain
is no larger than right models reach. Something else is missing if the holding force stays above its
floor with the best hypothesis.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any

import numpy as np
from scipy.special import expit

from vibroimpact.diagnosis.verdict.content import Conclusion
from vibroimpact.diagnosis.verdict.misfit import makes_worse

from . import constants
from .search import Hypothesis, Search

EXACT_ALIASES = {  # effects that no measurement of this kind can separate
    "gap@all": ("sensor_gain@force_and_responses", "sensor_gain"),
    "sensor_gain@force_and_responses": ("gap@all", "gap"),
}
SHOWN = 12
LEAST_SHOWN = 1.0e-3
LEAST_APART = -100.0  # gain of a hypothesis that could not be run


@dataclass(frozen=True, eq=False)
class Decision:
    """A conclusion and its probabilities.

    ranked: hypotheses, one per set of effects, with their probabilities, most probable first.
    nothing, something_else: probabilities. best: the most probable hypothesis, None if there is
    none. rest: log power over the floor that the best leaves. share: of the log power over the
    floor, that the best explains. by_free_runs: whether only spectra of free runs show it, see
    free_search. surely_off: whether the spectra of a record are off with the best by more than
    chance, see FreeRuns.surely_off.
    """

    verdict: Conclusion
    ranked: tuple[tuple[Hypothesis, float], ...]
    nothing: float
    something_else: float
    rest: float
    share: float
    by_free_runs: bool = False
    surely_off: bool = False

    @property
    def best(self) -> Hypothesis | None:
        """Return the most probable hypothesis."""
        return self.ranked[0][0] if self.ranked else None

    @property
    def leading(self) -> list[tuple[Hypothesis, float]]:
        """Return the most probable hypotheses that make NAMED of the probability of all."""
        total, out = sum(chance for _, chance in self.ranked), []
        for each in self.ranked:
            out.append(each)
            if sum(chance for _, chance in out) >= constants.NAMED * total:
                break
        return out


def decide(
    search: Search,
    level: float,
    floor: float,
    needed: Callable[[float], float] = constants.needed_gain,
) -> Decision:
    """Return the Decision on a Search.

    level: mean log power of the holding force with the best hypothesis. floor: the same of a model
    that lacks nothing else, NaN if unknown. needed: the gain that one more effect must bring, given
    the gain without it.
    """
    distinct: dict[tuple[str, ...], Hypothesis] = {}
    for each in sorted(search.hypotheses, key=attrgetter("worth"), reverse=True):
        if not _superfluous(each, search.hypotheses, needed):
            distinct.setdefault(each.ids, each)
    hypotheses = list(distinct.values())[:SHOWN]
    best = hypotheses[0].worth if hypotheses else 0.0
    rest = level - floor if np.isfinite(floor) else 0.0
    unexplained = float(expit((rest - constants.REST) / constants.REST_WIDTH))
    sure = max((each.sure_gain for each in hypotheses), default=0.0)
    no_effect = float(expit(constants.NULL_WIDTHS * (1.0 - sure / constants.NULL_GAIN)))
    nothing = no_effect * (1.0 - unexplained)
    share = max(best, 0.0) / max(best + max(rest, 0.0), 1.0e-12)
    some = (1.0 - no_effect) * (1.0 - unexplained)
    width = constants.RIVAL + constants.RIVAL_SHARE * max(best, 0.0)
    chances = [
        (each, some * own) for each, own in zip(hypotheses, _odds(hypotheses, width), strict=True)
    ]
    chances.sort(key=lambda pair: -pair[1])
    ranked = tuple(pair for pair in chances if pair[1] > LEAST_SHOWN) or tuple(chances[:1])
    return Decision(
        _verdict(no_effect, unexplained, share, ranked), ranked, nothing, unexplained, rest, share
    )


def _odds(hypotheses: Sequence[Hypothesis], width: float) -> list[float]:
    """Return the probabilities of rivals, if one of them is right: the mean of two, by the fitted
    stretches and by the others. If the two contradict each other, neither decides.
    """
    if not hypotheses:
        return []
    by_stretches = np.array([[each.gain, max(each.apart, LEAST_APART)] for each in hypotheses])
    odds = np.exp((by_stretches - by_stretches.max(axis=0)) / width)
    return np.mean(odds / odds.sum(axis=0), axis=1).tolist()


def gains(search: Search) -> bool:
    """Return whether some hypothesis of a Search gains more than nothing does."""
    return any(each.sure_gain > constants.NULL_GAIN for each in search.hypotheses)


def far_off(misfit: Mapping[str, float | None]) -> bool:
    """Return whether spectra of free runs are far above their floor after completion, or missing;
    misfit: {after_dB, floor_dB}.
    """
    return _above_floor(misfit) > constants.FREE_EXCESS_DB


def counted(decision: Decision, misfits: Mapping[str, Any]) -> Mapping[str, float | None]:
    """Return the distances of free runs that a Decision is judged by, of {fit, holdout}: of the
    held-out records or, if nothing was added, of the records that are farther off: then none of
    them took part.
    """
    known = [own for own in misfits.values() if own and own["before_dB"] is not None]
    if decision.verdict == "none" and known:
        return max(known, key=_above_floor)
    return misfits["holdout"] or misfits["fit"]


def _above_floor(misfit: Mapping[str, float | None]) -> float:
    """Return by how much spectra are above their floor after completion, dB; inf if missing."""
    after, floor = misfit["after_dB"], misfit["floor_dB"]
    return np.inf if after is None or floor is None else after - floor


def beside_spectra(
    decision: Decision,
    misfit: Mapping[str, float | None],
    parts: Sequence[Mapping[str, float | None]] = (),
    farther: bool = True,
) -> Decision:
    """Return the Decision given the distances of free runs.

    "none" becomes "unknown" if spectra are far above their floor: some laws act on a motion that a
    held run lacks, such as whirling. An effect that makes spectra worse, or that leaves most of a
    large excess in most records, is refuted; if there was no excess, nothing is missing. An effect
    that leaves spectra off by more than chance explains only a part.

    misfit: {before_dB, after_dB, floor_dB, closed_fraction} of held-out records, None if unknown.
    parts: the same of each record and channel: in a record, or across the force, whirling may be
    chance. farther: whether a record is farther off after completion by more than chance.
    """
    before, after, floor = misfit["before_dB"], misfit["after_dB"], misfit["floor_dB"]
    if before is None or after is None or floor is None:
        return decision
    closed = misfit["closed_fraction"]
    if decision.verdict == "none" and far_off(misfit):
        return replace(
            decision,
            verdict="unknown",
            nothing=decision.something_else,
            something_else=decision.nothing,
        )
    if decision.verdict in ("none", "unknown"):
        return decision
    if makes_worse(misfit) and farther:
        return refuted(decision, in_favour_of_nothing=closed is None)
    far = after - floor > 2.0 * constants.FREE_EXCESS_DB and (closed or 0.0) < constants.PARTLY
    far = far and _most_stay_off(parts or [misfit])
    if decision.verdict == "partly_explained":
        return decision
    return refuted(decision) if far else _in_part(decision) if decision.surely_off else decision


def _in_part(decision: Decision) -> Decision:
    """Return the Decision whose hypotheses explain the discrepancy in part, or in full by another
    law.
    """
    ranked = tuple((each, constants.RIGHT_BESIDE * chance) for each, chance in decision.ranked)
    moved = sum(chance for _, chance in decision.ranked) - sum(chance for _, chance in ranked)
    return replace(
        decision,
        verdict="partly_explained",
        ranked=ranked,
        something_else=decision.something_else + moved,
    )


def _most_stay_off(parts: Sequence[Mapping[str, float | None]]) -> bool:
    """Return whether most parts whose spectra are far off before or after completion keep most of
    their excess.
    """
    off = stay = 0
    for row in parts:
        before, after, floor = row["before_dB"], row["after_dB"], row["floor_dB"]
        if before is None or after is None or floor is None:
            continue
        if max(before, after) - floor > constants.FREE_EXCESS_DB:
            off += 1
            stay += (row["closed_fraction"] or 0.0) < constants.PARTLY
    return 2 * stay > off


def refuted(decision: Decision, in_favour_of_nothing: bool = False) -> Decision:
    """Return the Decision whose best hypothesis is refuted: its probability goes to something else,
    or to nothing.
    """
    chance = decision.ranked[0][1]
    left = replace(decision, ranked=decision.ranked[1:])
    if in_favour_of_nothing and decision.something_else < 0.5:
        return replace(left, verdict="none", nothing=decision.nothing + chance)
    return replace(left, verdict="unknown", something_else=decision.something_else + chance)


def _superfluous(
    hypothesis: Hypothesis, others: Sequence[Hypothesis], needed: Callable[[float], float]
) -> bool:
    """Return whether some effects of a hypothesis alone gain about as much."""
    own = {term.effect_id for term in hypothesis.point.terms}
    return any(
        {term.effect_id for term in other.point.terms} < own
        and hypothesis.sure_gain_over(other) < needed(other.worth)
        for other in others
    )


def _verdict(
    no_effect: float, unexplained: float, share: float, ranked: Sequence[tuple[Hypothesis, float]]
) -> Conclusion:
    """Return the conclusion from probabilities."""
    if unexplained >= 0.5:
        part = share >= constants.PARTLY and no_effect < 0.5
        return "partly_explained" if part else "unknown"
    if no_effect >= 0.5:
        return "none"
    return conclusion(ranked)


def conclusion(ranked: Sequence[tuple[Hypothesis, float]]) -> Conclusion:
    """Return whether the first of hypotheses is named, given (hypothesis, probability)."""
    total = sum(chance for _, chance in ranked)
    return "named" if ranked[0][1] >= constants.NAMED * total else "ambiguous"


def ambiguity(decision: Decision) -> tuple[list[list[str]], list[float]]:
    """Return (sets of effect ids that explain equally well, their probabilities); an effect and its
    exact alias have equal parts of one probability.
    """
    found: dict[tuple[str, ...], tuple[list[str], float]] = {}
    for hypothesis, chance in decision.leading:
        alike = [hypothesis.point.ids, *_aliases(hypothesis)]
        for ids in alike:
            known, before = found.get(tuple(sorted(ids)), (ids, 0.0))
            found[tuple(sorted(ids))] = known, before + chance / len(alike)
    return [ids for ids, _ in found.values()], [chance for _, chance in found.values()]


def _aliases(hypothesis):
    """Yield the ids with one effect exchanged for its exact alias."""
    for number, term in enumerate(hypothesis.point.terms):
        if term.name in EXACT_ALIASES:
            ids = list(hypothesis.point.ids)
            ids[number] = EXACT_ALIASES[term.name][1]
            yield ids
