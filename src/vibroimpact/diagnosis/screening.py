"""Screening: each effect of the catalogue at each place, near its neutral value by derivative, and
far from it by trial.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.effects.effect import Effect

from .bench import Bench, holding_lines
from .catalogue import far_terms, halfway, locations, neutral_term, parts
from .comparison import Comparison
from .coordinates import Coordinate, bounds, effect_coordinates, to_point, to_vector
from .explanations import Point, Term
from .nuisances import Nuisances
from .sensor_starts import sensor_terms

AT_A_TIME = 256  # points whose lines are held in memory
MODE = "mode_frequency_error"
TRIED = 12  # of the points that derivatives predict, on each stretch
KEPT, FEWEST_KEPT = 0.3, 40  # of the points: those that are tried on all stretches
AGAIN, MANY = 2, 30  # values at a place of an effect with MANY trials, when one more is sought
BETWEEN = 10  # effects whose best point is tried half way to the next ones
FARTHEST_STEP = 1.5  # of a coordinate, from the neutral value of the effect


@dataclass(frozen=True, eq=False)
class Screened:
    """A Point with one term more than the base, and how much its misfit is lower."""

    point: Point
    gain: float


@dataclass(frozen=True, eq=False)
class Screening:
    """Screened, best first, and the ids of effects without a trial or a derivative that could be
    run.
    """

    ranked: tuple[Screened, ...]
    failed: tuple[str, ...] = ()


def screen(
    at: Nuisances,
    effects: Sequence[Effect],
    comparison: Comparison,
    demanded: Sequence[Term] = (),
    before: Sequence[Screened] = (),
) -> Screening:
    """Return the Screening of effects at all places in addition to the terms of a base.

    at: the base, and the nuisances about it. demanded: terms to try; their effects are tried at
    their places alone. before: Screened in addition to nothing, best first: of an effect with MANY
    values far from neutral, only the AGAIN at each place that gained most are tried again.
    """
    structure, base, sizes = at.bench.structure, at.base, comparison.sizes
    placed = {effect.id: set[str]() for effect in effects}
    for term in demanded:
        placed[term.effect_id].add(term.location)
    tried_at = structure.values, structure.names, comparison.across, comparison.along
    anywhere = [
        (effect, location)
        for effect in effects
        if not placed[effect.id]
        for location in locations(effect, *tried_at)
        if effect.id != MODE or location in comparison.resonant
    ]
    known = [(effect, place) for effect in effects for place in sorted(placed[effect.id])]
    far = [term for each in anywhere for term in far_terms(*each, sizes)]
    terms = [*trials_again(far, before), *sensor_terms(at.bench, base), *demanded]
    wanted = {effect.id for effect in effects}
    trials = [base.beside(term) for term in terms if term.effect_id in wanted]
    neutral = [
        base.beside(least)
        for each in (*anywhere, *known)
        if (least := neutral_term(*each, sizes)) is not None
    ]
    near = _near(at, neutral, sizes)
    tried = ranked(at, trials + [point for own in near for point in own[:TRIED]])
    tried = _with_halfway(at, tried, comparison.along, {effect.id for effect, _ in known})
    ran = {_last(point) for own in near for point in own}
    ran |= {_last(each.point) for each in tried if np.isfinite(each.gain)}
    failed = {_last(point) for point in trials + neutral} - ran
    return Screening(tuple(tried), tuple(sorted(failed)))


def trials_again(far: Sequence[Term], before: Sequence[Screened]) -> list[Term]:
    """Return the terms but those of an effect with MANY, of which the AGAIN at each place remain
    that gained most before; all if there was none before.
    """
    count = Counter(term.effect_id for term in far)
    wanted, kept = set(far), defaultdict[str, list[Term]](list)
    for term in (each.point.terms[-1] for each in before):
        few = count[term.effect_id] <= MANY or len(kept[term.name]) < AGAIN
        if term in wanted and few:
            kept[term.name].append(term)
    return [term for own in kept.values() for term in own] or list(far)


def _near(at: Nuisances, neutral: Sequence[Point], sizes: Mapping[str, float]) -> list[list[Point]]:
    """Return the Points that derivatives predict on each stretch, best first."""
    out = []
    for number in range(len(at.bench.stretches)):
        points = [point for point in neutral if _first(at.bench, point) == number]
        found = predicted(at.on(slice(number, number + 1)), points, sizes)
        out.append([point for point, _ in found])
    return out


def _last(point: Point) -> str:
    """Return the id of the last effect of a Point."""
    return point.terms[-1].effect_id


def ranked(at: Nuisances, points: Sequence[Point]) -> list[Screened]:
    """Return Screened of points, best first: all are tried on the stretch that shows them best, see
    `_first`, and those that gain most there on the others.
    """
    gains = np.zeros(len(points))
    stretches = [at.on(slice(own, own + 1)) for own in range(len(at.bench.stretches))]
    first = np.array([_first(at.bench, point) for point in points], int)
    for number, own in enumerate(stretches):
        _add(gains, own, points, np.flatnonzero(first == number))
    order = np.argsort(-gains, kind="stable")
    kept, left = np.split(order, [max(round(KEPT * len(order)), FEWEST_KEPT)])
    for number, own in enumerate(stretches):
        _add(gains, own, points, kept[first[kept] != number])
    kept = kept[np.argsort(-gains[kept], kind="stable")]
    return [Screened(points[each], float(gains[each])) for each in (*kept, *left)]


def _first(bench: Bench, point: Point) -> int:
    """Return the number of the stretch on which the last term of a Point is tried first: the lowest
    for a linear structure, whose changes impacts hide, the highest for all others.
    """
    return 0 if point.terms[-1].effect.linear else len(bench.stretches) - 1


def _add(gains, at, points, which):
    """Add the gains of points number `which` on a stretch to gains (point,)."""
    gains[which] += gains_of(at, [points[each] for each in which])


def _with_halfway(
    at: Nuisances, ranked: Sequence[Screened], along: int, placed: Set[str]
) -> list[Screened]:
    """Return Screened with the terms half way to the neighbours of the best one of each effect: a
    gain may be as narrow as a quarter of a wave, or a few degrees, and lie between two trials.

    placed: ids of effects whose places are known.
    """
    tried: dict[tuple, Point] = {}
    leading = set(placed)
    for each in ranked:
        *before, last = each.point.terms
        if last.effect_id in leading or not np.isfinite(each.gain):
            continue
        for term in halfway(last, at.bench.structure.values, along):
            tried[term.name, term.values] = replace(each.point, terms=(*before, term))
            leading.add(last.effect_id)
        if len(leading) == BETWEEN + len(placed):
            break
    points = list(tried.values())
    gains = gains_of(at, points)
    found = [Screened(*pair) for pair in zip(points, map(float, gains), strict=True)]
    return sorted([*ranked, *found], key=lambda each: -each.gain)


def gains_of(at: Nuisances, points: Sequence[Point]) -> np.ndarray:
    """Return (point,): how much lower the objective of each point is than that of the base."""
    out: list[float] = []
    for first in range(0, len(points), AT_A_TIME):
        own = points[first : first + AT_A_TIME]
        found = holding_lines(at.bench, own)
        out += [at.now - at.objective(*pair) for pair in zip(found, own, strict=True)]
    return np.array(out)


def predicted(
    at: Nuisances, neutral: Sequence[Point], sizes: Mapping[str, float]
) -> list[tuple[Point, float]]:
    """Return [(Point, predicted gain)] of the best step of the last term of each Point, and of the
    nuisances beside it, best first.

    neutral: Points whose last term does nothing.
    """
    values = at.bench.structure.values
    rows_of = {point.name: _last_rows(point, sizes) for point in neutral}
    single = [
        point for point in neutral if parts(point.terms[-1], values) == [point.terms[-1].location]
    ]
    derivative = _derivatives(at, single, rows_of)
    out = []
    for point in neutral:
        term, rows = point.terms[-1], rows_of[point.name]
        own = [(term.effect_id, part) for part in parts(term, values)]
        if not all(key in derivative for key in own):
            continue
        total = sum(derivative[key] for key in own)
        if not np.isfinite(total).any():  # no step of any parameter could be run
            continue
        total, both = np.nan_to_num(total), [*rows, *at.rows]
        x = to_vector(point, both)
        moved = to_point(
            np.clip(x + at.best_step(total, FARTHEST_STEP), *bounds(both)), both, point
        )
        change = np.concatenate([total, at.columns])
        left = at.lines + np.tensordot(to_vector(moved, both) - x, change, 1)
        out.append((moved, at.now - at.objective(left, moved)))
    return sorted(out, key=lambda pair: -pair[1])


def _last_rows(point: Point, sizes: Mapping[str, float]) -> list[Coordinate]:
    """Return the coordinates of the parameters of the last term."""
    last = len(point.terms) - 1
    rows = effect_coordinates(point.terms, sizes)
    return [row for row in rows if row.index == last and row.kind == "term"]


def _derivatives(at, points, rows_of):
    """Return {(effect, location): (parameter, stretch, channel, line)} of the lines of the base."""
    moved, owners = [], []
    for point in points:
        rows = rows_of[point.name]
        x = to_vector(point, rows)
        for number, row in enumerate(rows):
            trial = x.copy()
            trial[number] += row.step
            moved.append(to_point(trial, rows, point))
            owners.append((point.terms[-1], row.step))
    out: dict[tuple[str, str], list[np.ndarray]] = {}
    for first in range(0, len(moved), AT_A_TIME):
        found = holding_lines(at.bench, moved[first : first + AT_A_TIME])
        for own, (term, step) in zip(found, owners[first : first + AT_A_TIME], strict=True):
            column = (own - at.lines) / step
            out.setdefault((term.effect_id, term.location), []).append(column)
    return {key: np.stack(found) for key, found in out.items()}
