"""Finalists: candidates refined by stars of runs round the best that was simulated, and judged by
what is simulated there and nothing else.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

from . import priors
from .branches import deviations, pair_deviations, with_branch
from .candidates import Pair, other_places
from .neighbourhood import NEW, apart, around, nearest, within_simulated
from .path_scores import law_at, scores_of
from .screening import Path, direct_scores, linear_score, null_scores, simulate_path
from .search import (
    CLEARLY,
    MOVED,
    ROUNDS,
    STEPS,
    free_of,
    from_elsewhere,
    searched,
    with_other_signs,
)
from .survivors import of_survivors

START_STEP, STARTS = 0.12, 3
SAME_PLACE = 100.0  # of log likelihood: two seeds of one law differ by as much
PLACED_STEP = 0.06  # as strong at another place is not the same to a parameter
PLACED_FROM = (
    0.5  # of the gain that makes a closer look worth its runs: from there on other places are tried
)
FEW_SEEDS = 4  # of what is not worth a closer look
# of what is left free of a Finalist, the first: the damping of unseen modes, and what parts its
# runs
SEARCHED = 2
SAFER = 4  # of what was simulated, best first, until one is not thrown off


@dataclass(frozen=True)
class Finalist:
    """A candidate after direct simulation: unit (parameter,) normalised; interval (parameter, 2);
    scores (record,) and low: log likelihoods by direct simulation; mean (record, feature) over
    `features` (record, seed, feature); path: all that was simulated; profile: see
    screening.Calibrated; free: see null.free_at; parts (part,): log likelihood, the lowest record's
    included, of each effect of a pair without the other, nothing of a single one; nuisance:
    Nuisance told beside it, None for that of the bare model.
    """

    candidate: object
    unit: np.ndarray
    interval: np.ndarray
    scores: np.ndarray
    low: float
    features: np.ndarray
    path: Path
    profile: list
    free: np.ndarray
    parts: np.ndarray = field(default_factory=lambda: np.zeros(0))
    nuisance: object = None

    @property
    def total(self):
        """Return the log likelihood, the lowest record's included."""
        return float(self.scores.sum() + self.low)

    @property
    def mean(self):
        """Return (record, feature) the mean over seeds."""
        return self.features.mean(axis=1)

    def own(self, null):
        """Return the Null with what the damping of unseen modes changes of this finalist left free,
        and its own seeds' scatter.
        """
        return null.freed(self.free).scattered(
            deviations(null, self.features, self.path, self.unit, self.candidate.periodic)
        )


def started(bench, null, candidate, unit, scales, first_seed=2000):
    """Return the Path round normalised parameters of a candidate that was not screened: a pair, or
    an effect at another place.
    """
    return simulate_path(
        bench,
        candidate,
        around(unit, START_STEP, candidate.periodic),
        scales,
        null.records,
        first_seed=first_seed,
    )


def own(bench, null, measured, candidate, path, unit, scales, fit, first_seed=2000, starts=STARTS):
    """Return the Path of a candidate at the points of a Path that was moved here, from another
    campaign or shorter records, so many that look best, and at unit.
    """
    order = np.argsort(scores_of(bench, null, measured, path, fit))[::-1][:starts]
    points = path.parameters[order]
    if not any(np.allclose(unit, point, atol=NEW) for point in points):
        points = np.vstack([unit, points[: starts - 1]])
    return simulate_path(bench, candidate, points, scales, null.records, first_seed=first_seed)


def placed(bench, null, measured, candidate, path, places, scales, fit, first_seed=2500):
    """Return (candidate, its Path), or one of places [candidate] where the best point of its Path
    comes nearer to what was measured.
    """
    scores = scores_of(bench, null, measured, path, fit)
    return _nearest_place(
        bench,
        null,
        measured,
        places,
        path.parameters[np.argmax(scores)],
        scales,
        fit,
        first_seed,
        scores.max(),
    ) or (candidate, path)


def placed_again(bench, null, measured, found, scales, fit, first_seed=15000):
    """Return (candidate, Path) of the other place, now that it is known how strong a Finalist is,
    that comes as near as it or nearer, None where there is none.

    Places a hand apart differ by less than the points of the design that they were screened at. Of
    a pair the second effect is moved.
    """
    own, at = found.own(null), around(found.unit, PLACED_STEP, found.candidate.periodic)
    if isinstance(found.candidate, Pair):
        at = at[
            np.all(at[:, : found.candidate.split] == found.unit[: found.candidate.split], axis=1)
        ]
    best = scores_of(bench, own, measured, found.path, fit).max() - SAME_PLACE
    return _nearest_place(
        bench,
        own,
        measured,
        other_places(found.candidate, bench.values),
        at,
        scales,
        fit,
        first_seed,
        best,
    )


def _nearest_place(bench, null, measured, places, at, scales, fit, first_seed, best):
    """Return (candidate, Path) of the one of places [candidate] where one of at (point, parameter)
    scores highest, None where none scores above `best`.
    """
    kept = None
    for other in places:
        there = simulate_path(bench, other, at, scales, null.records, first_seed=first_seed)
        score = -np.inf if there is None else scores_of(bench, null, measured, there, fit).max()
        if score > best:
            best, kept = score, (other, there)
    return kept


def refine(
    bench,
    null,
    measured,
    candidate,
    path,
    scales,
    fit,
    rounds=ROUNDS,
    least=-np.inf,
    seeds=priors.FINAL_SEEDS,
    first_seed=3000,
):
    """Return the Finalist of a candidate whose Path has been screened, None where it can not be
    simulated.

    fit (record,) bool: the records its parameters are fitted to; least: gain of log likelihood
    below which a closer look is not worth its runs.
    """
    looked = searched(
        bench, null, measured, candidate, path, scales, fit, rounds, least, first_seed
    )
    looked = from_elsewhere(
        bench, null, measured, candidate, looked, scales, fit, least, first_seed + 60000
    )
    looked = with_other_signs(
        bench, null, measured, candidate, looked, scales, fit, least, first_seed + 20000
    )
    path = looked.path
    found = looked.found
    free = looked.free
    simulated = looked.path.parameters[np.argmax(looked.scores)]
    found = replace(found, unit=within_simulated(found.unit, path, simulated, candidate.periodic))
    if looked.losing:
        units, free, seeds = [simulated], np.zeros((0, *null.mean.shape)), min(seeds, FEW_SEEDS)
    else:
        units = _to_judge(candidate, found.unit, simulated, scales)
        again = free_of(bench, null, candidate, found.unit, scales, first_seed + 4000)
        near_enough = (
            len(free)
            and len(again)
            and apart(found.unit, looked.at, candidate.periodic).max() <= MOVED
        )
        free = with_branch(
            0.5 * (free + again) if near_enough else again,
            null,
            measured,
            path,
            found.unit,
            candidate.periodic,
        )
    own = null.freed(free)
    law, best, judgement = law_at(bench, own, candidate, path, simulated), -np.inf, None
    common = own.scattered(
        pair_deviations(null, path, found.unit, candidate.periodic)
    )  # one for all points that are judged
    safer = path.parameters[np.argsort(scores_of(bench, null, measured, path, fit))[::-1][:SAFER]]
    for number, unit in enumerate([*units, *safer]):
        if number >= len(units) and judgement is not None:
            break
        try:
            row = judged(
                bench,
                own,
                measured,
                candidate,
                unit,
                path,
                found,
                free,
                scales,
                seeds,
                first_seed + 5000,
            )
        except IntegrationError:
            # where few runs stayed, of more of them too many may be thrown off: the next best
            continue
        score = direct_scores(bench, common, measured, row.mean, law)[fit].sum() + row.low
        if judgement is None or score > best + CLEARLY:
            judgement, best = row, score
    return judgement


def with_parts(bench, null, measured, found, scales, first_seed=8000):
    """Return the Finalist of a pair with what each of the two explains without the other, by as
    many runs of its own: by fewer it would explain less.
    """
    own, parts = found.own(null), []
    for part, unit in found.candidate.parts(found.unit):
        alone = simulate_path(
            bench, part, unit, scales, null.records, found.features.shape[1], first_seed
        )
        parts.append(
            -np.inf
            if alone is None
            else float(
                direct_scores(bench, own, measured, alone.features[0]).sum()
                + linear_score(bench, alone.readings[0])
            )
        )
    return replace(found, parts=np.array(parts))


def gain_of_part(bench, null, measured, found):
    """Return the gain of log likelihood over the null of the better one of the two effects of a
    Finalist of a pair, without the other.
    """
    return found.parts.max() - null_scores(bench, null, measured).sum() - linear_score(bench, None)


def _to_judge(candidate, unit, simulated, scales):
    """Return the points to judge: the most probable one, the best simulated one, and the first with
    what is nearly neutral made so.
    """
    neutral = candidate.neutral_unit(scales)
    snapped = np.where(
        np.abs(unit - neutral) < STEPS[-1], neutral, unit
    )  # NaN, no such value, is near nothing
    points = []
    for point in (unit, simulated, snapped):
        if not any(np.allclose(point, other, atol=1.0e-3) for other in points):
            points.append(point)
    return points


def judged(bench, null, measured, candidate, unit, path, found, free, scales, seeds, first_seed):
    """Return the Finalist at normalised parameters (parameter,), by `seeds` runs of every
    record.
    """
    physical = candidate.physical(unit, scales)
    model = bench.model(bench.variant(candidate, physical))
    runs = bench.runs(null.records, seeds, first_seed)
    features = of_survivors(
        bench.features(model, runs, candidate.measuring(physical, bench.signals.names)).reshape(
            len(null.records), seeds, -1
        )
    )
    own = null.scattered(deviations(null, features, path, unit, candidate.periodic))
    scores = direct_scores(bench, own, measured, features.mean(axis=1))
    reading = path.readings[nearest(path, unit, candidate.periodic)]
    interval = np.stack(
        [np.minimum(found.interval[:, 0], unit), np.maximum(found.interval[:, 1], unit)], axis=1
    )
    return Finalist(
        candidate,
        unit,
        interval,
        scores,
        linear_score(bench, reading),
        features,
        path,
        found.profile,
        free,
    )
