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
    nothing: probability. best: the most probable hypothesis, None if there is none. rest: log power
    over the floor that the best leaves. share: of the log power over the floor, that the best
    explains. by_free_runs: whether only spectra of free runs show it, see free_search. surely_off:
    whether the spectra of a record are off with the best by more than chance, see
    FreeRuns.surely_off.
    """

    verdict: Conclusion
    ranked: tuple[tuple[Hypothesis, float], ...]
    nothing: float
    rest: float
    share: float
    by_free_runs: bool = False
    surely_off: bool = False

    @property
    def best(self) -> Hypothesis | None:
        """Return the most probable hypothesis."""
        return self.ranked[0][0] if self.ranked else None

    @property
    def open(self) -> float:
        """Return the probability that is left: of other effects of the catalogue, not found, or of
        an effect that it lacks.
        """
        return max(1.0 - self.nothing - sum(chance for _, chance in self.ranked), 0.0)

    @property
    def something_else(self) -> float:
        """Return the probability of an effect that the catalogue lacks."""
        return constants.LACKING * self.open

    @property
    def rivals(self) -> list[Hypothesis]:
        """Return the hypotheses that are not far less probable than the best."""
        least = constants.RIVAL_CHANCE * self.ranked[0][1] if self.ranked else 0.0
        return [each for each, chance in self.ranked[: constants.RIVALS_RUN] if chance >= least]

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
    some = (1.0 - no_effect) * (1.0 - constants.LACKING * unexplained)
    width = constants.RIVAL + constants.RIVAL_SHARE * max(best, 0.0)
    chances = [
        (each, some * own) for each, own in zip(hypotheses, _odds(hypotheses, width), strict=True)
    ]
    chances.sort(key=lambda pair: -pair[1])
    ranked = tuple(pair for pair in chances if pair[1] > LEAST_SHOWN) or tuple(chances[:1])
    found = Decision("none", ranked, nothing, rest, share)
    if found.open >= 0.5:
        part = share >= constants.PARTLY and no_effect < 0.5
        return replace(found, verdict="partly_explained" if part else "unknown")
    return found if no_effect >= 0.5 else replace(found, verdict=conclusion(ranked))


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
    after, floor = misfit["after_dB"], misfit["floor_dB"]
    return after is None or floor is None or after - floor > constants.FREE_EXCESS_DB


def counted(misfits: Mapping[str, Any]) -> Mapping[str, float | None]:
    """Return the distances of free runs that an effect is judged by, of {fit, holdout}."""
    return misfits["holdout"] or misfits["fit"]


def share_right(misfit: Mapping[str, float | None], added: bool) -> float:
    """Return the share of explanations that are right, of those beside which spectra of free runs
    look alike: by what these are above their floor, over the floor, and by the share of their
    excess that an effect closes.

    misfit: {after_dB, floor_dB, closed_fraction}. added: whether an effect is.
    """
    after, floor, closed = (misfit[key] for key in ("after_dB", "floor_dB", "closed_fraction"))
    if after is None or floor is None:
        return constants.RIGHT_UNSEEN
    over = (after - floor) / (floor + constants.SPECTRA_DB)
    if added:
        half, width = constants.CLOSED_HALF
        part = min(max(closed or 0.0, 1.0 - over), 1.0)
        return float(expit((part - half) / width))
    half, width = constants.OVER_HALF
    return constants.RIGHT_UNSEEN * float(expit((half - over) / width))


def weighed(decision: Decision, shares: Sequence[float]) -> Decision:
    """Return the Decision whose rivals share their probability by what each had, times a share."""
    count = len(shares)
    chances = np.array([chance for _, chance in decision.ranked[:count]])
    weight = chances * np.maximum(shares, np.finfo(float).tiny)
    new = map(float, chances.sum() * weight / weight.sum())
    pairs = [(each, chance) for (each, _), chance in zip(decision.ranked, new, strict=False)]
    ranked = tuple(sorted([*pairs, *decision.ranked[count:]], key=lambda pair: -pair[1]))
    named = decision.verdict in ("named", "ambiguous")
    return replace(
        decision, ranked=ranked, verdict=conclusion(ranked) if named else decision.verdict
    )


def beside_spectra(
    decision: Decision, misfits: Mapping[str, Any], farther: bool = True
) -> Decision:
    """Return the Decision given the distances of free runs.

    Probabilities are those of explanations beside which spectra look alike. If spectra are far off
    as given, something is missing: some laws act on a motion that a held run lacks,
    such as whirling. An effect that makes spectra worse is refuted; if there was no excess, nothing
    is missing.

    misfits: {fit, holdout}, each {before_dB, after_dB, floor_dB, closed_fraction} or None. farther:
    whether a record is farther off after completion by more than chance.
    """
    told = counted(misfits)
    if decision.verdict == "unknown":
        return decision
    right = share_right(told, decision.verdict != "none")
    if decision.verdict == "none":
        known = (own for own in misfits.values() if own and own["before_dB"] is not None)
        right = 0.0 if any(map(far_off, known)) else right
    elif told["before_dB"] is not None and makes_worse(told) and farther:
        return refuted(decision, in_favour_of_nothing=told["closed_fraction"] is None)
    ranked = tuple((each, right * chance) for each, chance in decision.ranked)
    found = replace(decision, ranked=ranked, nothing=right * decision.nothing)
    if found.open < 0.5:
        return found
    part = decision.verdict != "none" and (told["closed_fraction"] or 0.0) >= constants.PARTLY
    return replace(found, verdict="partly_explained" if part else "unknown")


def refuted(decision: Decision, in_favour_of_nothing: bool = False) -> Decision:
    """Return the Decision whose best hypothesis is refuted: its probability is open, or goes to
    nothing.
    """
    chance = decision.ranked[0][1]
    left = replace(decision, ranked=decision.ranked[1:])
    if in_favour_of_nothing and decision.open < 0.5:
        return replace(left, verdict="none", nothing=decision.nothing + chance)
    return replace(left, verdict="unknown")


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
