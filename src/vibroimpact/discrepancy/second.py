"""A second effect: pairs proposed by adding what each effect changes, simulated at the point
proposed, those that come nearest looked at closely.
"""

from dataclasses import dataclass

import numpy as np

from . import priors
from .candidates import Pair, candidate_named
from .features import compressed, uncompressed
from .path_scores import gains_of
from .screening import direct_scores, linear_score, simulate_path

PAIRS, LEAST_PAIRS = 4, 2
FIRSTS = 3
# of an effect of several parameters, where one of a coarse design may be far off in the other
POINTS = 2
# pairs without the best finalist that are simulated; with it, and of the stiffness and damping of
# one contact, all are
WITHOUT_FIRST = 6
# of what the best adds to a single effect: pairs beyond the first two that add less are not looked
# at closely
NEAR = 0.5


@dataclass(frozen=True)
class Told:
    """A linear effect that the lowest record tells of, as the first of pairs: unit (parameter,)
    normalised, mean (record, feature) and log likelihood `low` there.
    """

    candidate: object
    unit: np.ndarray
    mean: np.ndarray
    low: float

    def own(self, null):
        """Return the Null as it is."""
        return null


def told(bench, null, prepared, first_seed=24000):
    """Return [Told] of the linear effect that comes nearest to a lowest record that is not quite
    linear, nothing elsewhere.

    A mass and a stop that is met now and then: no single effect is near, and what looks best, a
    friction that stills the tube, belongs to neither.
    """
    row = next(
        (
            row
            for row in prepared.linear
            if "+" not in row["name"] and not candidate_named(row["name"]).effect.measured
        ),
        None,
    )
    if row is None or not prepared.nonlinear_low or prepared.adopted is not None:
        return []
    candidate, unit = candidate_named(row["name"]), np.array(row["unit"])
    path = simulate_path(
        bench, candidate, unit, prepared.scales, null.records, first_seed=first_seed
    )
    return (
        []
        if path is None
        else [Told(candidate, unit, path.features[0], linear_score(bench, path.readings[0]))]
    )


def pairs(bench, null, measured, found, paths, prepared, first_seed=25000):
    """Return [(Pair, unit (parameter,), gain)], best first, by direct simulation where `proposed`
    looks best.

    found: Finalists, best first; paths {Candidate: Path}. With the best of found, and with what the
    lowest record tells, every effect is tried, and with any of them the rest of one law. Two
    effects that act on one contact change each other: a larger gap and a damped contact add to
    nothing, and together explain what neither does.
    """

    def simulated(first, pair, unit):
        path = simulate_path(
            bench, pair, unit, prepared.scales, null.records, first_seed=first_seed
        )
        return _Simulated(
            first,
            pair,
            unit,
            (
                -np.inf
                if path is None
                else float(gains_of(bench, null, measured, path, first.own(null))[0])
            ),
        )

    firsts, best = [*found[:FIRSTS], *told(bench, null, prepared)], set(found[0].candidate.ids)
    order = proposed(
        bench, null, measured, firsts, paths, prepared.nonlinear_low or not prepared.linear_stage
    )
    leads = [
        isinstance(first, Told) or best <= set(pair.ids) or of_one_law(pair)
        for first, pair, unit in order
    ]
    leading, others = (
        [row for row, leading in zip(order, leads, strict=True) if leading is wanted]
        for wanted in (True, False)
    )
    rows = _one_each([simulated(*row) for row in leading + others[:WITHOUT_FIRST]])
    for number, row in enumerate(rows[:LEAST_PAIRS]):
        rows[number] = max(
            [
                row,
                *(
                    simulated(row.first, pair, row.unit)
                    for pair in _at_other_places(row.pair, paths)
                ),
            ],
            key=lambda row: row.gain,
        )
    rows = sorted((row for row in rows if np.isfinite(row.gain)), key=lambda row: -row.gain)
    single = max(
        gains_of(bench, null, measured, first.path, first.own(null)).max()
        for first in found[:FIRSTS]
    )
    return [
        (row.pair, row.unit, row.gain)
        for place, row in enumerate(rows[:PAIRS])
        if place < LEAST_PAIRS or row.gain - single > NEAR * (rows[0].gain - single)
    ]


@dataclass(frozen=True)
class _Simulated:
    """A pair at unit (parameter,), and its gain of log likelihood over the null; first: of
    `proposed`.
    """

    first: object
    pair: Pair
    unit: np.ndarray
    gain: float


def _one_each(rows):
    """Return [_Simulated], best first, of each two effects the best: with what the lowest record
    tells apart from the same two without it.
    """
    best = {}
    for row in sorted(rows, key=lambda row: -row.gain):
        best.setdefault((isinstance(row.first, Told), *sorted(row.pair.ids)), row)
    return list(best.values())


def _at_other_places(pair, paths):
    """Return [Pair] with the second effect at the other places where it was screened: a sum chose
    where it sits.
    """
    return [
        Pair(pair.first, other)
        for other in paths
        if other.effect_id == pair.second.effect_id and other != pair.second and not other.alone
    ]


def proposed(bench, null, measured, firsts, paths, hidden=False):
    """Return [(first, Pair, unit (parameter,))], best first: each of firsts, Finalists and Told,
    with every other effect where it looks best of its simulated points, at two of them where it has
    several parameters; hidden: a linear effect of each of its simulated values. No lowest record
    told of it, since something else bends that, and a sum tells it wrong: a press that held a tube
    of nine times the damping was fitted better with six tenths.

    The stiffness and damping of one contact multiply (k p (1 + alpha dp/dt)), so that no sum tells
    them: the second is tried at each of its simulated values as well. What two effects change is
    added in the compressed features; paths {Candidate: Path}.
    """
    best = {}
    for first in firsts:
        own, moved = first.own(null), compressed(first.mean - null.mean, bench.layout)
        for candidate, path in paths.items():
            if candidate.ids == first.candidate.ids or candidate.alone:
                continue
            rows = best.setdefault(
                (isinstance(first, Told), frozenset((*first.candidate.ids, *candidate.ids))), []
            )
            for unit, mean, reading in zip(
                path.parameters, path.features, path.readings, strict=True
            ):
                both = null.mean + uncompressed(
                    moved + compressed(mean - null.mean, bench.layout), bench.layout
                )
                score = direct_scores(bench, own, measured, both).sum() + min(
                    first.low, linear_score(bench, reading)
                )
                rows.append(
                    (
                        score,
                        first,
                        Pair(first.candidate, candidate),
                        np.concatenate([first.unit, unit]),
                    )
                )
    chosen = []
    for rows in best.values():
        rows.sort(key=lambda row: -row[0])
        second = rows[0][2].second.effect
        every = of_one_law(rows[0][2]) or (hidden and second.linear and not second.measured)
        chosen += (
            _of_each_value(rows) if every else rows[: POINTS if len(second.parameters) > 1 else 1]
        )
    return [row[1:] for row in sorted(chosen, key=lambda row: -row[0])]


def _of_each_value(rows):
    """Return those of rows (score, first, Pair, unit), best first, that are the best of each value
    of the second effect.
    """
    best = {}
    for row in rows:
        best.setdefault((row[2].second.effect_id, *np.round(row[3][row[2].split :], 6)), row)
    return list(best.values())


def of_one_law(pair):
    """Return whether a Pair is a stiffness and a damping of the contact itself."""
    quantities = {part.effect.quantity for part in (pair.first, pair.second)}
    return len(quantities) == 2 and all(quantities)


def least_added(gain, threshold):
    """Return what a second effect must add, in log likelihood, to the gain of the first; threshold:
    that of a name.
    """
    return max(threshold, priors.SECOND_SHARE * gain)


def needed(explained):
    """Return whether the best single effect leaves something: explained (record,) z of
    naming.explained.
    """
    return bool(np.min(explained) < priors.EXPLAINED_Z)
