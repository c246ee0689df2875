"""What only free motion shows.

Friction keeps a tube from whirling; held to a motion that does not whirl, a model without friction
does not whirl either, and the holding force tells nothing. Where the spectra of free runs stay far
above their floor, the points that screening found best beside what is known run free as well. This
compares statistics of chaotic motion: a place can be told, a value hardly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .bench import effective_lines, holding_lines, misfit
from .comparison import Comparison
from .constants import CLOSED, FREE_RIVAL_DB
from .coordinates import effect_coordinates, to_point, to_vector
from .decision import Decision, conclusion, far_off
from .explanations import Point
from .free_runs import FreeRuns, distance, with_after
from .gauss_newton import Fit
from .search import Hypothesis, Search, difference

RUN_FREE, PER_EFFECT = 12, 4  # points, and those of one effect
RECORDS = 3  # those whose spectra are farthest off
FACTORS = (0.1, 0.3, 3.0, 10.0)  # of the first value of an effect, that are tried


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

    runs: of the model as given. Beside a hypothesis that is named nothing more is looked for.
    """
    told = distance(runs, comparison.signals, comparison.signals.fit())
    named = decision.verdict not in ("none", "unknown")
    if named or told["after_dB"] is None or not far_off(told):
        return decision, runs
    records = _farthest(comparison, runs)
    away = distance(runs, comparison.signals, records)["after_dB"]
    trials = _run(comparison, _candidates(searched), runs, records)
    for trial in trials[:3]:
        log(f"{trial.point.name}: spectra {away:.1f} dB off without it, {trial.away:.1f} with it")
    if not trials or trials[0].closed < CLOSED:
        return decision, runs
    best: dict[tuple[str, ...], _Trial] = {}
    for trial in trials:
        if trial.away - trials[0].away < FREE_RIVAL_DB * np.log(10.0):
            best.setdefault(tuple(sorted(trial.point.ids)), trial)
    weight = np.exp([(trials[0].away - trial.away) / FREE_RIVAL_DB for trial in best.values()])
    chance = trials[0].closed * weight / weight.sum()
    found = [
        _hypothesis(comparison, searched.nothing, trial, runs, records) for trial in best.values()
    ]
    ranked = tuple(zip(found, map(float, chance), strict=True))
    decision = replace(
        decision,
        verdict=conclusion(ranked),
        ranked=ranked,
        nothing=0.0,
        something_else=1.0 - trials[0].closed,
    )
    runs = with_after(runs, comparison.structure, comparison.signals, found[0].point)
    return decision, runs


def _farthest(comparison: Comparison, runs: FreeRuns) -> list[int]:
    """Return the fitted records whose spectra after completion are farthest above their floor."""
    excess = {}
    for record in map(int, comparison.signals.fit()):
        told = distance(runs, comparison.signals, [record])
        if told["after_dB"] is not None and told["floor_dB"] is not None:
            excess[record] = told["after_dB"] - told["floor_dB"]
    return sorted(excess, key=lambda record: -excess[record])[:RECORDS]


def _candidates(searched: Search) -> list[Point]:
    """Return the points that screening found best, with the nuisances of nothing."""
    chosen: dict[str, Point] = {}
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
    out = []
    for point in points:
        runs = with_after(known, comparison.structure, comparison.signals, point, records)
        told = distance(runs, comparison.signals, records)
        if told["after_dB"] is not None:
            out.append(_Trial(point, told["after_dB"], told["closed_fraction"] or 0.0))
    return sorted(out, key=lambda trial: trial.away)


def _hypothesis(
    comparison: Comparison,
    nothing: Hypothesis,
    trial: _Trial,
    known: FreeRuns,
    records: Sequence[int],
) -> Hypothesis:
    """Return the Hypothesis of a trial. The interval of its first value holds what is no worse."""
    rows = effect_coordinates(trial.point.terms, comparison.sizes)
    x = to_vector(trial.point, rows)
    last = next(
        number
        for number, row in enumerate(rows)
        if row.kind == "term" and row.index == len(trial.point.terms) - 1
    )
    row, value = rows[last], trial.point.terms[-1].values[0]
    others = []
    for factor in FACTORS:
        moved = x.copy()
        moved[last] = np.clip(row.from_value(factor * value), row.low, row.high)
        others.append(to_point(moved, rows, trial.point))
    alike = [
        to_vector(other.point, rows)[last]
        for other in _run(comparison, others, known, records)
        if other.away - trial.away < FREE_RIVAL_DB
    ]
    deviation = np.ones(len(rows))
    deviation[last] = max(np.ptp([x[last], *alike]), row.step)
    lines = [
        holding_lines(bench, [nothing.point, trial.point])
        for bench in (comparison.fitted(), comparison.apart())
    ]
    fitted = comparison.fitted()
    before, after = (misfit(fitted, own) for own in lines[0])
    gain = (before - after) / effective_lines(fitted, lines[0][0])
    apart, error = difference(comparison.apart(), *lines[1])
    fit = Fit(trial.point, tuple(rows), x, lines[0][1], after, np.diag(1.0 / deviation**2))
    return Hypothesis(fit, gain, apart, error)
