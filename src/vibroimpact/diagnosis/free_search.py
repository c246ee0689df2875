"""Effects that only free motion shows.

Friction keeps a tube from whirling; held to a motion that does not whirl, a model without friction
does not whirl either, and the holding force shows nothing. If the spectra of free runs stay far
above their floor, effects that the holding force does not contradict run free as well, in addition
to the best hypothesis. This compares statistics of chaotic motion: it finds a place, but hardly a
value.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from operator import attrgetter

import numpy as np

from vibroimpact.config.problems import ConfigError
from vibroimpact.diagnosis.verdict.content import NINETY_SD
from vibroimpact.diagnosis.verdict.misfit import excess

from .bench import Bench, effective_lines, holding_lines, misfit
from .catalogue import far_terms
from .comparison import Comparison
from .constants import FREE_RIVAL_DB, LEAST_GAIN, NULL_GAIN, PARTLY
from .coordinates import Coordinate, effect_coordinates, to_point, to_vector
from .decision import LEAST_APART, Decision, conclusion, far_off
from .explanations import Point
from .free_runs import FreeRuns
from .gauss_newton import Fit
from .screening import Screened
from .search import Hypothesis, Search, changes, jackknife

RUN_FREE, PER_EFFECT = 30, 4  # points, in all and of one effect
SCANNED = 2  # of the nearest, whose first value is changed by FACTORS
RECORDS = 2  # those whose spectra are farthest off
FACTORS = (0.1, 0.3, 3.0, 10.0)
# Of the first value, where the holding force opposes a point: the largest that it allows is tried.
WEAKER = (0.3, 0.1, 0.03, 0.01)
OPPOSED = 0.5  # in mean log power: more than a weaker value mends


@dataclass(frozen=True, eq=False)
class _Trial:
    """A Point that ran free: the distance of its spectra from the measured ones in dB, the share
    that its last term closes, and the half width of the interval of the first value of that term,
    as a coordinate, NaN if not known.
    """

    point: Point
    away: float
    closed: float
    reach: float = np.nan


_AWAY = attrgetter("away")


def free_search(
    comparison: Comparison,
    searched: Search,
    decision: Decision,
    runs: FreeRuns,
    log: Callable[[str], None] = lambda text: None,
) -> tuple[Decision, FreeRuns]:
    """Return (Decision, FreeRuns): the given ones if free runs show nothing more.

    runs: of the model as given, and of the best hypothesis or of the fitted nuisances of nothing
    if known. One more effect is sought in addition to the best hypothesis, if spectra are surely
    off with it. If there is none, it is sought in addition to nothing, unless the fitted nuisances
    bring the spectra to their floor: whether a tube whirls can depend on a degree of the direction
    of the force, or on 0.3 % of a frequency.
    """
    given, nothing = runs.as_given, decision.verdict in ("none", "unknown") or decision.best is None
    if nothing and not far(given):
        return decision, given
    if nothing and runs.after is runs.before:
        runs = runs.completed(searched.nothing.point)
    if nothing and not far(runs):
        log("the fitted nuisances bring the spectra of free runs to their floor")
        return decision, runs if decision.verdict == "none" else given
    if not nothing and not (decision.surely_off and far(runs)):
        return decision, runs
    base, chance = (searched.nothing, 1.0) if nothing else decision.ranked[0]
    best = _closest(comparison, searched, base, runs, log)
    if not best:
        return decision, given if nothing else runs
    closed = chance * best[0].closed
    found = [_hypothesis(comparison, searched.nothing, base, each) for each in best]
    odds = np.array([-each.away / FREE_RIVAL_DB for each in best])
    odds += np.array([max(each.worth, LEAST_APART) / NULL_GAIN for each in found])
    weight = np.exp(odds - odds.max())
    pairs = zip(found, map(float, closed * weight / weight.sum()), strict=True)
    ranked = tuple(sorted(pairs, key=lambda pair: -pair[1]))
    decision = replace(
        decision,
        verdict=conclusion(ranked),
        ranked=ranked,
        nothing=0.0,
        by_free_runs=True,
    )
    runs = runs.completed(ranked[0][0].point)
    return replace(decision, surely_off=bool(runs.surely_off())), runs


def _closest(
    comparison: Comparison,
    searched: Search,
    base: Hypothesis,
    runs: FreeRuns,
    log: Callable[[str], None],
) -> list[_Trial]:
    """Return the trials, one of each set of effects, that bring the spectra of free runs with a
    base near the measured ones, the nearest first; runs: with the base.
    """
    records = _farthest(runs)
    away = runs.distance(records)["after_dB"]
    trials = _run(_candidates(comparison, searched, base), runs, records)
    scanned = [
        point for trial in trials[:SCANNED] for point in _scan(comparison, trial.point, FACTORS)
    ]
    trials = sorted([*trials, *_run(scanned, runs, records)], key=_AWAY)
    trials = _not_contradicted(comparison, base, trials)
    best: dict[tuple[str, ...], _Trial] = {}
    for trial in trials:
        if trial.closed >= PARTLY:
            best.setdefault(tuple(trial.point.ids), trial)
    for ids, trial in list(best.items()):  # what an effect adds to others must be seen
        if any(set(k) < set(ids) and o.away < trial.away + FREE_RIVAL_DB for k, o in best.items()):
            del best[ids]
    for trial in list(best.values())[:3]:
        log(f"{trial.point.name}: spectra {away:.1f} dB off without it, {trial.away:.1f} with it")
    return [replace(trial, reach=_reach(comparison, trial, trials)) for trial in best.values()]


def far(runs: FreeRuns) -> bool:
    """Return whether spectra after completion are known, and far off on the fitted records."""
    told = runs.distance(runs.signals.fit())
    return told["after_dB"] is not None and far_off(told)


def _farthest(runs: FreeRuns) -> list[int]:
    """Return the fitted records whose spectra after completion are farthest above their floor."""
    beyond = {}
    for record in map(int, runs.signals.fit()):
        told = runs.distance([record])
        if told["after_dB"] is not None and told["floor_dB"] is not None:
            beyond[record] = told["after_dB"] - told["floor_dB"]
    return sorted(beyond, key=lambda record: -beyond[record])[:RECORDS]


def _candidates(comparison: Comparison, searched: Search, base: Hypothesis) -> list[Point]:
    """Return points with one term more than a base: as they were fitted, and of each effect in turn
    the best ones of the screening, far from neutral ones first, or where the holding force opposes
    these, as strong as it allows. An effect that it does not show is strong, if it is there.
    """
    known, sizes = {term.effect_id for term in base.point.terms}, comparison.sizes
    fitted = [
        each.point
        for each in searched.hypotheses
        if len(each.point.terms) > len(known) and {*base.ids} <= {*each.ids}
    ]
    bench = comparison.screened()
    [before] = holding_lines(bench, [base.point])
    lines = effective_lines(bench, before)
    queues: dict[str, list[Screened]] = {}
    screened = searched.screened.get(base.point.name, ())
    for each in screened or searched.screened.get(searched.nothing.point.name, ()):
        effect = each.point.terms[-1].effect_id
        if each.gain > -OPPOSED * lines and effect not in known:
            queues.setdefault(effect, []).append(each)

    def later(screened: Screened) -> tuple[bool, bool]:
        """Return whether the last term is no trial far from doing nothing, and whether it acts at
        some supports only: what acts at all of them changes free motion most.
        """
        term = screened.point.terms[-1]
        return term not in far_terms(term.effect, term.location, sizes), term.location != "all"

    ordered = [sorted(own, key=later) for own in queues.values()]
    turns = zip_longest(*(own[:PER_EFFECT] for own in ordered))
    chosen = [each for turn in turns for each in turn if each is not None][:RUN_FREE]
    points = [base.point.beside(each.point.terms[-1]) for each in chosen]
    opposed = [each.gain < -LEAST_GAIN * lines for each in chosen]
    weaker = [
        _scan(comparison, point, WEAKER)
        for point, less in zip(points, opposed, strict=True)
        if less
    ]
    found = iter(holding_lines(bench, [own for each in weaker for own in each]))
    highest, allowed = _highest(bench, before), []
    for ladder in weaker:
        good = [own for own in ladder if misfit(bench, next(found)) < highest]
        allowed += good[:1]
    return [*fitted, *(p for p, less in zip(points, opposed, strict=True) if not less), *allowed]


def _highest(bench: Bench, lines: np.ndarray) -> float:
    """Return the misfit above which an addition contradicts the holding force; lines: of the
    base.
    """
    return misfit(bench, lines) + LEAST_GAIN * effective_lines(bench, lines)


def _run(points: Sequence[Point], known: FreeRuns, records: Sequence[int]) -> list[_Trial]:
    """Return the trials of points on records, the one nearest to the measured spectra first."""
    given = known.distance(records)
    away, scatter = given["after_dB"] or 0.0, given["floor_dB"] or 0.0
    out = []
    for point in points:
        try:
            told = known.completed(point, records).distance(records)
        except (ConfigError, ValueError):
            continue  # its values make no model
        if (after := told["after_dB"]) is not None and (floor := told["floor_dB"]) is not None:
            # a floor that grows, as when one run whirls and another does not, closes nothing
            closed = 1.0 - excess(after, min(floor, scatter)) / max(excess(away, scatter), 1.0e-9)
            out.append(_Trial(point, after, closed))
    return sorted(out, key=_AWAY)


def _not_contradicted(
    comparison: Comparison, base: Hypothesis, trials: Sequence[_Trial]
) -> list[_Trial]:
    """Return the trials with which the holding force is no larger than with their base."""
    bench = comparison.fitted()
    before, *after = holding_lines(bench, [base.point, *(t.point for t in trials)])
    highest = _highest(bench, before)
    return [t for t, own in zip(trials, after, strict=True) if misfit(bench, own) < highest]


def _coordinates(comparison: Comparison, point: Point) -> tuple[list[Coordinate], np.ndarray, int]:
    """Return the coordinates of all terms, their values, and the number of the one of the first
    parameter of the last term.
    """
    rows = effect_coordinates(point.terms, comparison.sizes)
    places = [(row.kind, row.index) for row in rows]
    return rows, to_vector(point, rows), places.index(("term", len(point.terms) - 1))


def _scan(comparison: Comparison, point: Point, factors: Sequence[float]) -> list[Point]:
    """Return a Point with the first parameter of its last term multiplied by factors."""
    (rows, x, at), out = _coordinates(comparison, point), []
    for factor in factors:
        moved = x.copy()
        value = factor * rows[at].to_value(x[at])
        moved[at] = np.clip(rows[at].from_value(value), rows[at].low, rows[at].high)
        out.append(to_point(moved, rows, point))
    return out


def _hypothesis(
    comparison: Comparison, nothing: Hypothesis, base: Hypothesis, own: _Trial
) -> Hypothesis:
    """Return the Hypothesis of a trial in addition to a base, compared with nothing."""
    rows, x, at = _coordinates(comparison, own.point)
    known = len(effect_coordinates(base.point.terms, comparison.sizes))
    deviation = np.ones(len(rows))
    if known:
        deviation[:known] = base.fit.deviation[:known]
    deviation[at] = own.reach / NINETY_SD
    fitted, apart = comparison.fitted(), comparison.apart()
    before, after = holding_lines(fitted, [nothing.point, own.point])
    value = misfit(fitted, after)
    gain = (misfit(fitted, before) - value) / effective_lines(fitted, before)
    told = jackknife(*changes(apart, *holding_lines(apart, [nothing.point, own.point])))
    fit = Fit(own.point, tuple(rows), x, after, value, np.diag(1.0 / deviation**2))
    return Hypothesis(fit, gain, *told)


def _reach(comparison: Comparison, own: _Trial, trials: Sequence[_Trial]) -> float:
    """Return the half width of the interval of the first value of the last term of a trial: up to
    the nearest worse values on both sides of all that are as good.
    """
    rows, own_x, at = _coordinates(comparison, own.point)
    x = own_x[at]
    tried = [
        (to_vector(trial.point, rows)[at], trial.away - own.away < FREE_RIVAL_DB)
        for trial in trials
        if trial.point.name == own.point.name
    ]
    alike = [value for value, good in tried if good]
    below = max((value for value, _ in tried if value < min(alike)), default=min(alike))
    above = min((value for value, _ in tried if value > max(alike)), default=max(alike))
    return float(max(x - below, above - x, rows[at].step))
