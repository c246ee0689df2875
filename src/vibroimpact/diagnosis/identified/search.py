"""Laws at places as hypotheses: raced, fitted, and added as long as each gains on the levels that
were set aside for the name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from ..search import Hypothesis, Search
from .fit import Fitted, fitted
from .modes import LinearModels
from .places import Family, row_of
from .starts import alone, beside
from .trial import LocalTerm, Records, Trial, with_offsets
from .updated_model import location

RACE_PASSES, PASSES, FINAL_PASSES = 2, 20, 20
CLOSE = 1.5  # times the least cost of a candidate's starts: the second one is fitted as well
RACED_ON = 6.0  # times the least cost after the race: a candidate within it is fitted
FINALISTS = 4  # at most
LEAST_GAIN = 0.23  # log power on the levels set aside that one more law must bring: 1 dB
SOME_GAIN = 0.05
# Relative error that a right model of these laws leaves: their shape, and the time step.
LITTLE = 0.02

Log = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Setting:
    """What a search needs.

    places: {name: {channel: coefficient}}. ranking: {place: Family}. candidates, additions:
    "law.place". fitted, tried: Records that candidates are fitted to, and those that their names
    are tried on. reference: (level, channel) errors of one linear model of all levels, on both.
    """

    places: Mapping[str, Mapping[str, float]]
    ranking: Mapping[str, Family]
    candidates: Sequence[str]
    additions: Sequence[str]
    linear: LinearModels
    fitted: Records
    tried: Records
    reference: tuple[np.ndarray, np.ndarray] = field(init=False)

    def __post_init__(self) -> None:
        joint = Trial(self.linear.joint)
        both = (self.fitted, self.tried)
        errors = tuple(records.errors(records.predict(joint)) for records in both)
        object.__setattr__(self, "reference", errors)


def search_laws(setting: Setting, most: int, log: Log) -> Search:
    """Return the Search of candidates, and of additions beside the best of them.

    most: 1 for single laws; otherwise laws are added as long as each gains. Gains are those over
    one linear model of all levels.
    """
    as_given: Any = SimpleNamespace(point=Trial(setting.linear.base))
    nothing = Hypothesis(as_given, 0.0, 0.0, 0.0)
    found: dict[str, Hypothesis] = {}
    linear, records = setting.linear, setting.fitted
    terms = {name: _bare(setting, name) for name in (*setting.candidates, *setting.additions)}
    singles = {
        name: alone(terms[name], setting.ranking[terms[name].place], linear, records)
        for name in setting.candidates
    }
    _add(found, singles, setting, log)
    best = _leading(list(found.values()), nothing)
    others = [name for name in setting.additions if name not in _names(best)]
    while best is not nothing and others and most > 1:
        own: dict[str, Hypothesis] = {}
        known = cast(Trial, best.point)
        starts = {name: beside(known, terms[name], linear, records) for name in others}
        _add(own, starts, setting, log)
        found |= own
        further = _leading(list(own.values()), nothing)
        if further.apart < best.apart + LEAST_GAIN:
            break
        # what gained next to nothing is not tried again; the rest may show once this law is there
        gained = [_names(each)[-1] for each in own.values() if each.apart > best.apart + SOME_GAIN]
        others = [name for name in gained if name not in _names(further)]
        best = further
    ranked = sorted(found.values(), key=lambda each: -each.gain)
    ran = {effect for each in ranked for effect in each.point.ids}
    failed = {terms[name].effect_id for name in singles} - ran
    return Search(nothing, tuple(ranked), failed=tuple(sorted(failed)))


def _leading(found: Sequence[Hypothesis], nothing: Hypothesis) -> Hypothesis:
    """Return the hypothesis with the largest gain on the levels set aside; of the same laws at
    places that gain about as much, the one that was stated first: the two sides of a joint move
    nearly together.
    """
    if not found:
        return nothing
    best = max(found, key=lambda each: each.apart)
    laws = _laws(best)
    alike = [each for each in found if each.apart > best.apart - LEAST_GAIN]
    return next(each for each in alike if _laws(each) == laws)


def _laws(hypothesis: Any) -> list[str]:
    """Return the laws of its terms."""
    return [term.law for term in hypothesis.point.terms]


def _names(hypothesis: Hypothesis) -> list[str]:
    """Return the "law.place" of its terms."""
    return [term.name.replace("@", ".", 1) for term in hypothesis.point.terms]


def _bare(setting: Setting, name: str) -> LocalTerm:
    """Return the term of "law.place" without values."""
    law, _, place = name.partition(".")
    own = setting.places.get(place)
    row = None if own is None else row_of(own, setting.linear.base.names)
    return LocalTerm(law, place, row, location=location(place, own))


def _add(
    found: dict[str, Hypothesis],
    candidates: Mapping[str, Sequence[Trial]],
    setting: Setting,
    log: Log,
) -> None:
    """Add the Hypothesis of every candidate that has starts with a bounded motion.

    All starts are raced for a few passes; those that come near the best one are fitted.
    """
    raced = []
    for starts in candidates.values():
        tried = [fitted(start, setting.fitted, RACE_PASSES) for start in starts]
        tried.sort(key=lambda each: each.cost)
        raced += [[each for each in tried[:2] if each.cost < CLOSE * tried[0].cost]]
    costs = sorted(each[0].cost for each in raced if each)[:FINALISTS]
    for each in filter(None, raced):
        own = each[0]
        if own.cost <= min(costs[-1], RACED_ON * costs[0]):
            finals = [fitted(start.point, setting.fitted, PASSES) for start in each]
            own = min(finals, key=lambda final: final.cost)
        hypothesis = _hypothesis(setting, own)
        found[own.point.name] = hypothesis
        log(f"{own.point.name}: {hypothesis.gain:.3f}, apart {hypothesis.apart:.3f}")


def _hypothesis(setting: Setting, own: Fitted) -> Hypothesis:
    """Return the Hypothesis of a fit, its gains over the linear model of all levels."""
    gains, spread = [], 0.0
    for records, before in zip((setting.fitted, setting.tried), setting.reference, strict=True):
        after = records.errors(records.predict(with_offsets(own.point, records), 3))
        gains.append(float(np.log(np.mean(before**2)) - np.log(np.mean(after**2))))
        each = np.log(before**2) - np.log(after**2)
        spread = float(each.std() / np.sqrt(each.size))
    return Hypothesis(cast(Any, own), gains[0], gains[1], spread)


def left_and_floor(setting: Setting, searched: Search) -> tuple[float, float]:
    """Return (log power of the error that the best hypothesis leaves on the levels set aside, that
    of a right model): what the linear model misses at the lowest level, or a little.

    Of records without period a share of a change by level is shown wrongly: their start is that of
    a force repeated for ever, until it is forgotten.
    """
    best = max(searched.hypotheses, key=lambda each: min(each.gain, each.apart), default=None)
    reference = float(np.mean(setting.reference[1] ** 2))
    left = np.log(reference) - (0.0 if best is None else best.apart)
    lowest = replace(setting.fitted, levels=setting.fitted.levels[:1])
    base = Trial(setting.linear.base)
    missed = float(np.mean(lowest.errors(lowest.predict(base)) ** 2))
    apart = setting.tried.errors(setting.tried.predict(base))
    wrong = _unsettled(setting) * float(np.mean(apart**2))
    return float(left), float(np.log(max(missed, LITTLE**2) + wrong))


def _unsettled(setting: Setting) -> float:
    """Return the share of the power of a change by level that records without period show
    wrongly.
    """
    modes = setting.linear.base
    memory = 1.0 / np.min(modes.damping[~modes.residual])  # s, in which energy falls by e
    longs = [level for level in setting.tried.levels if level.periods == 0]
    return max((min(memory * level.frequency[1], 1.0) for level in longs), default=0.0)


def refitted(best: Hypothesis, records: Records, everything: Records) -> Hypothesis:
    """Return a Hypothesis fitted to all fitted levels, its offsets found at every level.

    Raises ValueError where it has no bounded motion at some level.
    """
    own = fitted(cast(Any, best.point), records, FINAL_PASSES)
    own = replace(own, point=with_offsets(own.point, everything))
    return replace(best, fit=cast(Any, own))
