"""Laws at places as hypotheses: started, raced, fitted, and added as long as each gains on the
levels that were set aside for the choice.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from ..search import Hypothesis, Search
from .fit import Fitted
from .linear_models import Family, LinearModels, linear_errors, stiffness_unit
from .local_laws import Scales
from .trial import LocalTerm, Records, Trial

FREE_STARTS = 6  # drawn participations of a place that no channel shows
FREE_VALUES = 2  # start values tried with each
SEED = 2012
RACE_PASSES, PASSES = 2, 20
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
    """The input of a search.

    places: {name: {channel: coefficient}}. ranking: {place: Family}, fitted to the levels of
    `fitted`. candidates, additions: terms without values. fitted, tried: Records that candidates
    are fitted to, and those that choose between them.
    """

    places: Mapping[str, Mapping[str, float]]
    ranking: Mapping[str, Family]
    candidates: Sequence[LocalTerm]
    additions: Sequence[LocalTerm]
    linear: LinearModels
    fitted: Records
    tried: Records

    @cached_property
    def reference(self) -> list[np.ndarray]:
        """Return the (level, channel) errors of one linear model, of `fitted` and of `tried`."""
        return [each.errors(Trial(self.linear.joint)) for each in (self.fitted, self.tried)]


def search_laws(setting: Setting, most: int, log: Log) -> Search:
    """Return the Search of candidates, and of additions to the best of them.

    most: 1 for single laws; otherwise laws are added as long as each gains. Gains are those over
    one linear model of all levels.
    """
    as_given: Any = SimpleNamespace(point=Trial(setting.linear.base))
    nothing = Hypothesis(as_given, 0.0, 0.0, 0.0)
    found = _raced([_alone(term, setting) for term in setting.candidates], setting, log)
    best = leading(found, nothing)
    others = [term for term in setting.additions if term.name not in _names(best)]
    while best is not nothing and others and most > 1:
        known = cast(Trial, best.point)
        own = _raced([_beside(known, term, setting) for term in others], setting, log)
        found += own
        further = leading(own, nothing)
        if further.apart < best.apart + LEAST_GAIN:
            break
        # laws that gained next to nothing are not tried again; others may gain next to this one
        gained = [_names(each)[-1] for each in own if each.apart > best.apart + SOME_GAIN]
        left = set(gained) - set(_names(further))
        others, best = [term for term in others if term.name in left], further
    ran = {effect for each in found for effect in each.point.ids}
    failed = {term.effect_id for term in setting.candidates} - ran
    ranked = sorted(found, key=lambda each: -each.gain)
    return Search(nothing, tuple(ranked), failed=tuple(sorted(failed)))


def leading(found: Sequence[Hypothesis], nothing: Hypothesis) -> Hypothesis:
    """Return the hypothesis with the largest gain on the levels set aside; if the same laws at
    other places gain about as much, the one stated first: the two sides of a joint move nearly
    together.
    """

    def laws(hypothesis: Any) -> list[str]:
        return [term.law for term in hypothesis.point.terms]

    best = max(found, key=lambda each: each.apart, default=nothing)
    alike = (each for each in found if each.apart > best.apart - LEAST_GAIN)
    return next((each for each in alike if laws(each) == laws(best)), nothing)


def _names(hypothesis: Hypothesis) -> list[str]:
    """Return the names of its terms."""
    return [term.name for term in hypothesis.point.terms]


def _raced(candidates: Sequence[Sequence[Trial]], setting: Setting, log: Log) -> list[Hypothesis]:
    """Return the Hypotheses of the candidates that have starts with a bounded motion, with their
    gains over the linear model of all levels.

    All starts are raced for a few passes; those that come near the best one are fitted.
    """
    raced, found = [], []
    for starts in filter(None, candidates):
        tried = [Fitted(start, setting.fitted, RACE_PASSES) for start in starts]
        tried.sort(key=lambda each: each.cost)
        raced.append([each for each in tried[:2] if each.cost < CLOSE * tried[0].cost])
    costs = sorted(each[0].cost for each in raced)[:FINALISTS]
    for each in raced:
        own = each[0]
        if own.cost <= min(costs[-1], RACED_ON * costs[0]):
            finals = [Fitted(start.point, setting.fitted, PASSES) for start in each]
            own = min(finals, key=lambda final: final.cost)
        gains = []
        for records, before in zip((setting.fitted, setting.tried), setting.reference, strict=True):
            after = records.errors(records.with_offsets(own.point), 3)
            gains.append(float(np.log(np.mean(before**2)) - np.log(np.mean(after**2))))
        change = np.log(before**2) - np.log(after**2)
        spread = float(change.std() / np.sqrt(change.size))
        found.append(Hypothesis(cast(Any, own), gains[0], gains[1], spread))
        log(f"{own.point.name}: {gains[0]:.3f}, apart {gains[1]:.3f}")
    return found


def left_and_floor(setting: Setting, searched: Search) -> tuple[float, float]:
    """Return (log power of the error of the best hypothesis on the levels set aside, that of a
    right model): the error of the linear model at the lowest level, or a little.

    Records without period show a share of a change by level wrongly: they start as if the force had
    repeated for ever, until that is forgotten.
    """
    best = max(searched.hypotheses, key=attrgetter("worth"), default=None)
    left = np.log(np.mean(setting.reference[1] ** 2)) - (0.0 if best is None else best.apart)
    modes, fitted_to = setting.linear.base, setting.fitted
    missed = float(np.mean(linear_errors(modes, fitted_to.levels[0], fitted_to.band_Hz) ** 2))
    apart = float(np.mean(setting.tried.errors(Trial(modes)) ** 2))
    memory = 1.0 / np.min(modes.damping[~modes.residual])  # s, in which energy falls by e
    longs = [level for level in setting.tried.levels if level.periods == 0]
    unsettled = max((min(memory * level.frequency[1], 1.0) for level in longs), default=0.0)
    return float(left), float(np.log(max(missed, LITTLE**2) + unsettled * apart))


def _alone(term: LocalTerm, setting: Setting) -> list[Trial]:
    """Return [Trial]: the start of a law by itself, the best of its start values on the modes of
    the lowest level, of the place's family, or of all levels; empty if none is bounded.
    """
    family, linear, records = setting.ranking[term.place], setting.linear, setting.fitted
    moved = [family.motion(number, own) for number, own in enumerate(records.frequencies)]
    sizes, along = _scales(records, moved), family.modes.shapes @ family.row
    # a quarter of the stiffness whose removal would leave the structure none there
    softest = float(0.25 / np.sum(along**2 / family.modes.omega**2))
    changed = float(np.max(np.abs(family.k + 1j * sizes.omega * family.c)))
    values = term.effect.starts(replace(sizes, stiffness=min(changed, softest)))
    terms = [replace(term, values=own) for own in values]
    models = (linear.base, family.modes, linear.joint)
    return _best([Trial(modes, (own,)) for modes in models for own in terms], records)


def _beside(known: Trial, term: LocalTerm, setting: Setting) -> list[Trial]:
    """Return [Trial]: starts of a law added to fitted ones, on their modes and on those of the
    lowest level, or, at a place that no channel shows, with drawn participations.

    Only a few passes show which of them leads further.
    """
    modes, records, out = known.modes, setting.fitted, []
    places = [(term, modes), (term, setting.linear.base)]
    if term.row is None:
        # of either sign, in proportion to the frequency: a spring there makes the same relative
        # change of every frequency
        drawn = np.random.default_rng(SEED)
        size = np.where(modes.residual, 0.0, modes.omega / np.median(modes.omega))
        signs = [drawn.choice([-1.0, 1.0], size.size) for _ in range(FREE_STARTS)]
        places = [(replace(term, participation=size * own), modes) for own in signs]
    for own, base in places:
        along = own.along(modes)
        driven = along * modes.shapes[:, modes.drive]
        moved = [driven @ modes.receptance(frequency) for frequency in records.frequencies]
        sizes = replace(_scales(records, moved), stiffness=stiffness_unit(modes, along))
        tried = term.effect.starts(sizes)[: FREE_VALUES if term.row is None else None]
        terms = [(*known.terms, replace(own, values=values)) for values in tried]
        out += _best([replace(known, modes=base, terms=each) for each in terms], records)
    return out


def _best(trials: Sequence[Trial], records: Records) -> list[Trial]:
    """Return [the trial with the least squared error], empty if none has a bounded motion."""
    costs = [records.cost(trial) for trial in trials]
    return [trials[int(np.argmin(costs))]] if np.isfinite(min(costs)) else []


def _scales(records: Records, motion: Sequence[np.ndarray]) -> Scales:
    """Return the Scales of a relative displacement, without a stiffness.

    motion [(excited line,)]: its response per unit force, by level. omega: the median of the power
    of the last level's response, all channels together.
    """
    rms = []
    for level, lines, own in zip(records.levels, records.excited, motion, strict=True):
        rms.append(float(np.sqrt(2.0 * np.sum(np.abs(own * level.force[lines]) ** 2))))
    power = np.cumsum(np.sum(np.abs(level.response[:, lines]) ** 2, axis=0))
    middle = level.frequency[lines[np.searchsorted(power, 0.5 * power[-1])]]
    return Scales(0.0, min(rms), max(rms), float(2.0 * np.pi * middle))
