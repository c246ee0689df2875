"""Effects that only free motion shows.

Friction keeps a tube from whirling; held to a motion that does not whirl, a model without friction
does not whirl either, and the holding force shows nothing. If the spectra of free runs stay far
above their floor, the best points of the screening run free as well. This compares statistics of
chaotic motion: it finds a place, but hardly a value.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.diagnosis.verdict.misfit import excess

from .bench import effective_lines, holding_lines, misfit
from .comparison import Comparison
from .completed import NINETY_SD
from .constants import FREE_RIVAL_DB, LEAST_GAIN, PARTLY
from .coordinates import Coordinate, effect_coordinates, to_point, to_vector
from .decision import Decision, conclusion, far_off
from .explanations import Point
from .free_runs import FreeRuns, distance, with_after
from .gauss_newton import Fit
from .measurement.signals import Signals
from .search import Hypothesis, Search, changes, jackknife

RUN_FREE, PER_EFFECT = 12, 4  # points, in all and of one effect
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
    """Return (Decision, FreeRuns): the given ones if free runs show nothing more.

    runs: of the model as given, and of its fitted nuisances if known. Nothing is sought unless the
    verdict is none or unknown, nor if the fitted nuisances bring the spectra to their floor:
    whether a tube whirls can depend on a degree of the force, or on 0.3 % of a frequency.
    """
    if decision.verdict not in ("none", "unknown"):
        return decision, runs
    signals, given = comparison.signals, replace(runs, after=runs.before)
    if not far(given, signals):
        return decision, given
    if runs.after is runs.before:
        runs = with_after(runs, comparison.structure, signals, searched.nothing.point)
    if not far(runs, signals):
        log("the fitted nuisances bring the spectra of free runs to their floor")
        return decision, runs if decision.verdict == "none" else given
    records = _farthest(comparison, runs)
    away = distance(runs, signals, records)["after_dB"]
    trials = _run(comparison, _candidates(searched), runs, records)
    scanned = [point for trial in trials[:SCANNED] for point in _scan(comparison, trial.point)]
    trials = sorted([*trials, *_run(comparison, scanned, runs, records)], key=_away)
    trials = _not_contradicted(comparison, searched, trials)
    best: dict[tuple[str, ...], _Trial] = {}
    for trial in trials:
        if trial.closed >= PARTLY:
            best.setdefault(tuple(trial.point.ids), trial)
    for trial in list(best.values())[:3]:
        log(f"{trial.point.name}: spectra {away:.1f} dB off without it, {trial.away:.1f} with it")
    if not best:
        return decision, given
    closed = next(iter(best.values())).closed
    weight = np.exp([(trials[0].away - trial.away) / FREE_RIVAL_DB for trial in best.values()])
    found = [_hypothesis(comparison, searched.nothing, each, trials) for each in best.values()]
    ranked = tuple(zip(found, map(float, closed * weight / weight.sum()), strict=True))
    decision = replace(
        decision,
        verdict=conclusion(ranked),
        ranked=ranked,
        nothing=0.0,
        something_else=1.0 - closed,
        by_free_runs=True,
    )
    return decision, with_after(runs, comparison.structure, signals, found[0].point)


def far(runs: FreeRuns, signals: Signals) -> bool:
    """Return whether spectra after completion are known, and far off on the fitted records."""
    told = distance(runs, signals, signals.fit())
    return told["after_dB"] is not None and far_off(told)


def _farthest(comparison: Comparison, runs: FreeRuns) -> list[int]:
    """Return the fitted records whose spectra after completion are farthest above their floor."""
    beyond = {}
    for record in map(int, comparison.signals.fit()):
        told = distance(runs, comparison.signals, [record])
        if told["after_dB"] is not None and told["floor_dB"] is not None:
            beyond[record] = told["after_dB"] - told["floor_dB"]
    return sorted(beyond, key=lambda record: -beyond[record])[:RECORDS]


def _candidates(searched: Search) -> list[Point]:
    """Return the points that were fitted, and those that screening found best, with the nuisances
    of nothing.
    """
    chosen = {each.point.name: each.point for each in searched.hypotheses}
    per_effect: dict[str, int] = {}
    for each in searched.screened:
        name, effect = each.point.name, each.point.terms[-1].effect_id
        if name in chosen or per_effect.get(effect, 0) >= PER_EFFECT or not np.isfinite(each.gain):
            continue
        per_effect[effect] = per_effect.get(effect, 0) + 1
        chosen[name] = searched.nothing.point.beside(each.point.terms[-1])
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
            # a floor that grows, as when one run whirls and another does not, closes nothing
            closed = 1.0 - excess(after, min(floor, scatter)) / max(excess(away, scatter), 1.0e-9)
            out.append(_Trial(point, after, closed))
    return sorted(out, key=_away)


def _not_contradicted(
    comparison: Comparison, searched: Search, trials: Sequence[_Trial]
) -> list[_Trial]:
    """Return the trials with which the holding force is no larger than without."""
    bench = comparison.fitted()
    before, *after = holding_lines(bench, [searched.nothing.point, *(t.point for t in trials)])
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
    comparison: Comparison, nothing: Hypothesis, own: _Trial, trials: Sequence[_Trial]
) -> Hypothesis:
    """Return the Hypothesis of a trial, compared with nothing."""
    rows = effect_coordinates(own.point.terms, comparison.sizes)
    x, at = to_vector(own.point, rows), _first_value(own.point, rows)
    deviation = np.ones(len(rows))
    deviation[at] = _reach(x[at], at, own, trials, rows) / NINETY_SD
    fitted, apart = comparison.fitted(), comparison.apart()
    before, after = holding_lines(fitted, [nothing.point, own.point])
    value = misfit(fitted, after)
    gain = (misfit(fitted, before) - value) / effective_lines(fitted, before)
    told = jackknife(*changes(apart, *holding_lines(apart, [nothing.point, own.point])))
    fit = Fit(own.point, tuple(rows), x, after, value, np.diag(1.0 / deviation**2))
    return Hypothesis(fit, gain, *told)


def _reach(
    x: float, at: int, own: _Trial, trials: Sequence[_Trial], rows: Sequence[Coordinate]
) -> float:
    """Return the half width of the interval of a value x: up to the nearest worse values on both
    sides of all that are as good.
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
