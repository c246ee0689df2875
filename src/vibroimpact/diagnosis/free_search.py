"""What only free motion shows.

Friction keeps a tube from whirling; held to a motion that does not whirl, a model without friction
does not whirl either, and the holding force tells nothing. Where the spectra of free runs stay off
by more than chance, the points that screening found best beside what is named run free as well.
This compares statistics of chaotic motion: a place can be told, a value hardly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from vibroimpact.verdict.misfit import excess

from .bench import effective_lines, holding_lines, misfit
from .comparison import Comparison
from .completed import NINETY_SD
from .constants import FREE_RIVAL_DB, LEAST_GAIN, PARTLY
from .coordinates import Coordinate, effect_coordinates, to_point, to_vector
from .decision import Decision, conclusion
from .explanations import Point
from .free_runs import FreeRuns, distance, surely_off, with_after
from .gauss_newton import Fit
from .measurement.signals import Signals
from .search import Hypothesis, Search, difference

RUN_FREE, PER_EFFECT = 12, 4  # points, and those of one effect
SCANNED = 2  # of them, whose first value is changed by FACTORS
RECORDS = 2  # those whose spectra are farthest off
FACTORS = (0.1, 0.3, 3.0, 10.0)


@dataclass(frozen=True, eq=False)
class _Trial:
    """A Point that ran free: the distance of its spectra from the measured ones in dB, and the
    share that its last term closes.
    """

    point: Point
    away: float
    closed: float


def free_search(
    comparison: Comparison,
    searched: Search,
    decision: Decision,
    runs: FreeRuns,
    log: Callable[[str], None] = lambda text: None,
) -> tuple[Decision, FreeRuns]:
    """Return (Decision, FreeRuns): those given where free runs show nothing more.

    runs: after completion with what is named, of the model as given where nothing is. It is looked
    for one effect more, where records stay off by more than chance.
    """
    base = _base(searched, decision)
    if base is None:
        return decision, runs
    structure, signals = comparison.structure, comparison.signals
    point = base.point if base.point.terms else Point()
    records = surely_off(runs, structure, signals, point, signals.fit())[:RECORDS]
    if not records:
        return decision, runs
    away = distance(runs, signals, records)["after_dB"]
    trials = _run(comparison, _candidates(searched, base), runs, records)
    scanned = [point for trial in trials[:SCANNED] for point in _scan(comparison, trial.point)]
    trials = sorted([*trials, *_run(comparison, scanned, runs, records)], key=_away)
    trials = _not_contradicted(comparison, base, trials)
    best: dict[tuple[str, ...], _Trial] = {}
    for trial in trials:
        if trial.closed >= PARTLY:
            best.setdefault(tuple(trial.point.ids), trial)
    for trial in list(best.values())[:3]:
        log(f"{trial.point.name}: spectra {away:.1f} dB off without it, {trial.away:.1f} with it")
    if not best:
        return decision, runs
    after = with_after(runs, structure, signals, next(iter(best.values())).point)
    if base.point.terms and _farther(after, runs, signals):
        return decision, runs
    return _decided(comparison, searched, base, decision, trials, list(best.values())), after


def _base(searched: Search, decision: Decision) -> Hypothesis | None:
    """Return the Hypothesis beside which one more effect is looked for: what is named, or nothing;
    None where the verdict leaves open what it would stand beside.
    """
    if decision.verdict == "named":
        return decision.best
    return searched.nothing if decision.verdict in ("none", "unknown") else None


def _farther(after: FreeRuns, before: FreeRuns, signals: Signals) -> bool:
    """Return whether the spectra that took no part are farther off than before."""
    records = signals.holdout() if len(signals.holdout()) else signals.fit()
    now, was = (distance(runs, signals, records)["after_dB"] for runs in (after, before))
    return now is None or was is None or now > was


def _decided(
    comparison: Comparison,
    searched: Search,
    base: Hypothesis,
    decision: Decision,
    trials: Sequence[_Trial],
    best: Sequence[_Trial],
) -> Decision:
    """Return the Decision on the best trials, one of each effect, the nearest first."""
    closed = best[0].closed
    weight = np.exp([(best[0].away - trial.away) / FREE_RIVAL_DB for trial in best])
    found = [_hypothesis(comparison, searched.nothing, base, each, trials) for each in best]
    ranked = tuple(zip(found, map(float, closed * weight / weight.sum()), strict=True))
    return replace(
        decision,
        verdict=conclusion(ranked),
        ranked=ranked,
        nothing=0.0,
        something_else=1.0 - closed,
        by_free_runs=True,
    )


def _candidates(searched: Search, base: Hypothesis) -> list[Point]:
    """Return the points that were fitted with one term more than the base, and those that screening
    found best beside it, with its nuisances.
    """
    known, count = [term.effect_id for term in base.point.terms], len(base.point.terms)
    chosen = {
        each.point.name: each.point
        for each in searched.hypotheses
        if [term.effect_id for term in each.point.terms[:count]] == known
        and len(each.point.terms) > count
    }
    per_effect: dict[str, int] = {}
    for each in searched.screened.get(base.point.name, ()):
        term = each.point.terms[-1]
        tried, effect = base.point.beside(term), term.effect_id
        if each.point.name in chosen or per_effect.get(effect, 0) >= PER_EFFECT:
            continue
        if np.isfinite(each.gain):
            per_effect[effect] = per_effect.get(effect, 0) + 1
            chosen[each.point.name] = tried
    return list(chosen.values())[:RUN_FREE]


def _run(
    comparison: Comparison, points: Sequence[Point], known: FreeRuns, records: Sequence[int]
) -> list[_Trial]:
    """Return the trials of points on records, the one nearest to the measured spectra first."""
    given = distance(known, comparison.signals, records)
    away, scatter = given["after_dB"] or 0.0, given["floor_dB"] or 0.0
    out = []
    for point in points:
        runs = with_after(known, comparison.structure, comparison.signals, point, records)
        told = distance(runs, comparison.signals, records)
        if (after := told["after_dB"]) is not None and (floor := told["floor_dB"]) is not None:
            # a floor that grows, as where one run whirls and another does not, closes nothing
            closed = 1.0 - excess(after, min(floor, scatter)) / max(excess(away, scatter), 1.0e-9)
            out.append(_Trial(point, after, closed))
    return sorted(out, key=_away)


def _not_contradicted(
    comparison: Comparison, base: Hypothesis, trials: Sequence[_Trial]
) -> list[_Trial]:
    """Return the trials with which the holding force is no larger than without."""
    bench = comparison.fitted()
    before, *after = holding_lines(bench, [base.point, *(t.point for t in trials)])
    highest = misfit(bench, before) + LEAST_GAIN * effective_lines(bench, before)
    return [t for t, own in zip(trials, after, strict=True) if misfit(bench, own) < highest]


def _away(trial: _Trial) -> float:
    """Return the distance of a trial's spectra."""
    return trial.away


def _first_value(point: Point, rows: Sequence[Coordinate]) -> int:
    """Return the number of the coordinate of the first parameter of the last term."""
    return next(
        number
        for number, row in enumerate(rows)
        if row.kind == "term" and row.index == len(point.terms) - 1
    )


def _scan(comparison: Comparison, point: Point) -> list[Point]:
    """Return a Point with other values of the first parameter of its last term."""
    rows = effect_coordinates(point.terms, comparison.sizes)
    x, at = to_vector(point, rows), _first_value(point, rows)
    out = []
    for factor in FACTORS:
        moved = x.copy()
        value = factor * rows[at].to_value(x[at])
        moved[at] = np.clip(rows[at].from_value(value), rows[at].low, rows[at].high)
        out.append(to_point(moved, rows, point))
    return out


def _hypothesis(
    comparison: Comparison,
    nothing: Hypothesis,
    base: Hypothesis,
    own: _Trial,
    trials: Sequence[_Trial],
) -> Hypothesis:
    """Return the Hypothesis of a trial, compared with nothing; of its base it keeps the fit."""
    last = len(own.point.terms) - 1
    every = effect_coordinates(own.point.terms, comparison.sizes)
    x, at = to_vector(own.point, every), _first_value(own.point, every)
    deviation = np.ones(len(every))
    deviation[at] = _reach(x[at], at, own, trials, every) / NINETY_SD
    new = np.array([row.index == last for row in every])
    rows = (*base.fit.rows, *(row for row in every if row.index == last))
    information = linalg.block_diag(base.fit.information, np.diag(1.0 / deviation[new] ** 2))
    fitted, apart = comparison.fitted(), comparison.apart()
    before, after = holding_lines(fitted, [nothing.point, own.point])
    value = misfit(fitted, after)
    gain = (misfit(fitted, before) - value) / effective_lines(fitted, before)
    told = difference(apart, *holding_lines(apart, [nothing.point, own.point]))
    fit = Fit(own.point, rows, np.r_[base.fit.x, x[new]], after, value, information)
    return Hypothesis(fit, gain, *told)


def _reach(
    x: float, at: int, own: _Trial, trials: Sequence[_Trial], rows: Sequence[Coordinate]
) -> float:
    """Return how far from a value x its interval reaches: to the next values on both sides that are
    worse, and to all that are not.
    """
    tried = [
        (to_vector(trial.point, rows)[at], trial.away - own.away < FREE_RIVAL_DB)
        for trial in trials
        if trial.point.name == own.point.name
    ]
    alike = [value for value, good in tried if good]
    below = max((value for value, _ in tried if value < min(alike)), default=min(alike))
    above = min((value for value, _ in tried if value > max(alike)), default=max(alike))
    return max(x - below, above - x, rows[at].step)
