"""Finalists: candidates refined by stars of runs round the best that was simulated, and judged by what is simulated there and nothing else."""

from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.contraction import IntegrationError
from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.branches import deviations, pair_deviations, searched_by, with_branch
from vibroimpact.discrepancy.candidates import Pair, other_places
from vibroimpact.discrepancy.neighbourhood import NEAR, NEW, apart, around, box_round, images, near, nearest, unknown, within_simulated
from vibroimpact.discrepancy.null import free_at
from vibroimpact.discrepancy.screening import LAW_TURNS, Path, calibrate, direct_scores, linear_score, null_scores, path_emulator, simulate_path
from vibroimpact.discrepancy.survivors import of_survivors

STEPS = (0.12, 0.04, 0.012)  # of the searched range: how far to either side a round looks, closer only when the best no longer moves
ENOUGH = 2  # this close is close enough where no parameter is known better, and nothing was gained
INSIDE = 0.7  # of a star's radius: an optimum farther out is at its edge, and may lie beyond
ROUNDS = 6  # at most
START_STEP, STARTS = 0.12, 3
SAME_PLACE = 100.0  # of log likelihood: two seeds of one law differ by as much
PLACED_STEP = 0.06  # as strong at another place is not the same to a parameter
PLACED_FROM = 0.5  # of the gain that makes a closer look worth its runs: from there on other places are tried
HOPELESS = 0.5  # of that gain: below it, nothing more is simulated round it
FEW_SEEDS = 4  # of what is not worth a closer look
SAFER = 4  # of what was simulated, best first, until one is not thrown off
CLEARLY = 5.0  # of log likelihood: less is the scatter of a few seeds
MOVED = 0.06  # of the searched range: farther from where it was told, what is free is told anew
IMAGED = 2  # rounds that try other signs as well


@dataclass(frozen=True)
class Finalist:
    """A candidate after direct simulation: unit (parameter,) normalised; interval (parameter, 2); scores (record,) and low: log likelihoods by direct
    simulation; mean (record, feature) over `features` (record, seed, feature); path: all that was simulated; profile: see screening.Calibrated; free: see
    null.free_at; parts (part,): log likelihood, the lowest record's included, of each effect of a pair without the other, nothing of a single one; nuisance: Nuisance
    told beside it, None for that of the bare model."""

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
        """Return the Null with what the damping of unseen modes changes of this finalist left free, and its own seeds' scatter."""
        return null.freed(self.free).scattered(deviations(null, self.features, self.path, self.unit, self.candidate.periodic))


def started(bench, null, candidate, unit, scales, first_seed=2000):
    """Return the Path round normalised parameters of a candidate that was not screened: a pair, or an effect at another place."""
    return simulate_path(bench, candidate, around(unit, START_STEP, candidate.periodic), scales, null.records, first_seed=first_seed)


def own(bench, null, measured, candidate, path, unit, scales, fit, first_seed=2000, starts=STARTS):
    """Return the Path of a candidate at the points of a Path that was moved here, from another campaign or shorter records, so many that look best, and at unit."""
    order = np.argsort(_scores(bench, null, measured, path, fit))[::-1][:starts]
    points = path.parameters[order]
    if not any(np.allclose(unit, point, atol=NEW) for point in points):
        points = np.vstack([unit, points[: starts - 1]])
    return simulate_path(bench, candidate, points, scales, null.records, first_seed=first_seed)


def placed(bench, null, measured, candidate, path, places, scales, fit, first_seed=2500):
    """Return (candidate, its Path), or one of places [candidate] where the best point of its Path comes nearer to what was measured."""
    scores = _scores(bench, null, measured, path, fit)
    return _nearest_place(bench, null, measured, places, path.parameters[np.argmax(scores)], scales, fit, first_seed, scores.max()) or (candidate, path)


def placed_again(bench, null, measured, found, scales, fit, first_seed=15000):
    """Return (candidate, Path) of the other place, now that it is known how strong a Finalist is, that comes as near as it or nearer, None where there is none.

    Places a hand apart differ by less than the points of the design that they were screened at. Of a pair the second effect is moved.
    """
    own, at = found.own(null), around(found.unit, PLACED_STEP, found.candidate.periodic)
    if isinstance(found.candidate, Pair):
        at = at[np.all(at[:, : found.candidate.split] == found.unit[: found.candidate.split], axis=1)]
    best = _scores(bench, own, measured, found.path, fit).max() - SAME_PLACE
    return _nearest_place(bench, own, measured, other_places(found.candidate, bench.values), at, scales, fit, first_seed, best)


def _nearest_place(bench, null, measured, places, at, scales, fit, first_seed, best):
    """Return (candidate, Path) of the one of places [candidate] where one of at (point, parameter) scores highest, None where none scores above `best`."""
    kept = None
    for other in places:
        there = simulate_path(bench, other, at, scales, null.records, first_seed=first_seed)
        score = -np.inf if there is None else _scores(bench, null, measured, there, fit).max()
        if score > best:
            best, kept = score, (other, there)
    return kept


def refine(bench, null, measured, candidate, path, scales, fit, rounds=ROUNDS, least=-np.inf, seeds=priors.FINAL_SEEDS, first_seed=3000):
    """Return the Finalist of a candidate whose Path has been screened, None where it can not be simulated.

    fit (record,) bool: the records its parameters are fitted to; least: gain of log likelihood below which a closer look is
    not worth its runs.
    """
    looked = _searched(bench, null, measured, candidate, path, scales, fit, rounds, least, first_seed)
    looked = _with_other_signs(bench, null, measured, candidate, looked, scales, fit, least, first_seed + 20000)
    path, found, free, simulated = looked.path, looked.found, looked.free, looked.path.parameters[np.argmax(looked.scores)]
    found = replace(found, unit=within_simulated(found.unit, path, simulated, candidate.periodic))
    if looked.losing:
        units, free, seeds = [simulated], np.zeros((0, *null.mean.shape)), min(seeds, FEW_SEEDS)
    else:
        units = _to_judge(candidate, found.unit, simulated, scales)
        again = _free(bench, null, candidate, found.unit, scales, first_seed + 4000)
        near_enough = len(free) and len(again) and apart(found.unit, looked.at, candidate.periodic).max() <= MOVED
        free = with_branch(0.5 * (free + again) if near_enough else again, null, measured, path, found.unit, candidate.periodic)
    own = null.freed(free)
    law, best, judgement = law_at(bench, own, candidate, path, simulated), -np.inf, None
    common = own.scattered(pair_deviations(null, path, found.unit, candidate.periodic))  # one for all points that are judged
    safer = path.parameters[np.argsort(_scores(bench, null, measured, path, fit))[::-1][:SAFER]]
    for number, unit in enumerate([*units, *safer]):
        if number >= len(units) and judgement is not None:
            break
        try:
            row = judged(bench, own, measured, candidate, unit, path, found, free, scales, seeds, first_seed + 5000)
        except IntegrationError:
            continue  # where few runs stayed, of more of them too many may be thrown off: the next best
        score = direct_scores(bench, common, measured, row.mean, law)[fit].sum() + row.low
        if judgement is None or score > best + CLEARLY:
            judgement, best = row, score
    return judgement


@dataclass(frozen=True)
class _Searched:
    """Where stars of runs led: path, of all that was simulated; found: Calibrated; scores (point,) of the path; free: null.free_at of `at` (parameter,); losing: whether it was given up."""

    path: Path
    found: object
    scores: np.ndarray
    free: np.ndarray
    at: np.ndarray
    losing: bool


def _with_other_signs(bench, null, measured, candidate, looked, scales, fit, least, first_seed):
    """Return the _Searched of a candidate, its search gone on where another sign of its best point is better: far from the optimum, signs are told from nothing."""
    best = looked.path.parameters[np.argmax(looked.scores)]
    points = [] if looked.losing else unknown(images(best, candidate.signed), looked.path, candidate.periodic)
    other = simulate_path(bench, candidate, points, scales, null.records, first_seed=first_seed) if len(points) else None
    if other is None:
        return looked
    own, path = null.freed(looked.free), looked.path.joined(other)
    scores = scores_along(bench, own, measured, candidate, path, fit)
    if np.argmax(scores) < len(looked.path.parameters):
        return looked
    return _searched(bench, null, measured, candidate, path, scales, fit, len(STEPS), least, first_seed + 500, level=1)


def _searched(bench, null, measured, candidate, path, scales, fit, rounds, least, first_seed, level=0):
    """Return the _Searched of a candidate, its first star one of STEPS[level]; other arguments as of `refine`."""
    centre, at, free, own = path.parameters[np.argmax(_scores(bench, null, measured, path, fit))], None, None, null
    gain = gains_of(bench, null, measured, path).max()
    losing = gain < min(least, HOPELESS * least)
    for number in range(rounds):
        looked_at = [*around(centre, STEPS[level], candidate.periodic), *(images(centre, candidate.signed) if number < IMAGED else [])]
        points = [] if losing else unknown(looked_at, path, candidate.periodic)
        fresh = simulate_path(bench, candidate, points, scales, null.records, first_seed=first_seed + 500 * number) if len(points) else None
        known = len(path.parameters)
        path = path if fresh is None else path.joined(fresh)
        before, gain = gain, gains_of(bench, null, measured, path, own).max()
        # rounds to come may bring as much as the last; what began with a star has had none
        losing = losing or fresh is not None and gain + (rounds - 1 - number) * max(0.0, gain - before) < least
        if not losing and (at is None or apart(centre, at, candidate.periodic).max() > MOVED):
            at = path.parameters[nearest(path, centre, candidate.periodic)]
            free = _free(bench, null, candidate, at, scales, first_seed + 400 + 50 * number)
            gain = gains_of(bench, null, measured, path, searched_by(null, measured, path, at, candidate.periodic, free)).max()
        own = own if free is None else searched_by(null, measured, path, at, candidate.periodic, free)
        found = _calibrated_near(bench, own, measured, candidate, path, fit)
        scores = scores_along(bench, own, measured, candidate, path, fit)
        better = scores.max() > scores[:known].max() + CLEARLY
        stayed = np.all(apart(found.unit, centre, candidate.periodic) <= INSIDE * STEPS[level])
        if stayed or number and not better:
            level += 1  # it stayed within what was looked at, or led nowhere: look closer
        centre = found.unit if stayed or better or not number else path.parameters[np.argmax(scores)]
        if losing or level == len(STEPS) or level >= ENOUGH and stayed and not better and np.ptp(found.interval, axis=1).min() > STEPS[level]:
            break
    return _Searched(path, _with_whole_interval(bench, own, measured, candidate, path, fit, found), scores, free, at, losing)


def with_parts(bench, null, measured, found, scales, first_seed=8000):
    """Return the Finalist of a pair with what each of the two explains without the other, by as many runs of its own: by fewer it would explain less."""
    own, parts = found.own(null), []
    for part, unit in found.candidate.parts(found.unit):
        alone = simulate_path(bench, part, unit, scales, null.records, found.features.shape[1], first_seed)
        parts.append(-np.inf if alone is None else float(direct_scores(bench, own, measured, alone.features[0]).sum() + linear_score(bench, alone.readings[0])))
    return replace(found, parts=np.array(parts))


def gain_of_part(bench, null, measured, found):
    """Return the gain of log likelihood over the null of the better one of the two effects of a Finalist of a pair, without the other."""
    return found.parts.max() - null_scores(bench, null, measured).sum() - linear_score(bench, None)


def _free(bench, null, candidate, unit, scales, first_seed):
    """Return null.free_at of a point, nothing where it can not be simulated."""
    try:
        return free_at(bench, candidate, unit, scales, null.records, first_seed)
    except IntegrationError:
        return np.zeros((0, *null.mean.shape))


def law_at(bench, null, candidate, path, unit):
    """Return (record, compressed feature) what a candidate changes at unit (parameter,), emulated: free of the scatter of any point's few seeds."""
    return path_emulator(bench, null, path, candidate)(unit)[0].reshape(null.mean.shape)


def scores_along(bench, null, measured, candidate, path, fit):
    """Return (point,) the log likelihood of what was measured at the points of a candidate's path, to compare them with each other.

    What two laws may differ by is the same for all, that of the best: with its own, a stronger effect, or a point whose few seeds lie far off, would forgive
    itself more, and a clearance of 1.24 nominal was read as 1.44.
    """
    emulator, scores = path_emulator(bench, null, path, candidate), _scores(bench, null, measured, path, fit)
    for _ in range(LAW_TURNS):
        law = emulator(path.parameters[np.argmax(scores)])[0].reshape(null.mean.shape)
        scores = _scores(bench, null, measured, path, fit, law)
    return scores


def _scores(bench, null, measured, path, fit, law=None):
    """Return (point,) the log likelihood of what was measured at the points of a path; law: see screening.direct_scores."""
    return np.array([direct_scores(bench, null, measured, mean, law)[fit].sum() + linear_score(bench, reading)
                     for mean, reading in zip(path.features, path.readings, strict=True)])  # fmt: skip


def gains_of(bench, null, measured, path, own=None):
    """Return (point,) the gain of log likelihood over the null, of all records, at the points of a path; own: the Null of the path's candidate."""
    start = null_scores(bench, null, measured).sum() + linear_score(bench, None)
    return _scores(bench, null if own is None else own, measured, path, np.ones(len(measured), bool)) - start


def _best_simulated(bench, null, measured, candidate, path, fit):
    """Return (parameter,) the point of a path that comes nearest to what was measured."""
    return path.parameters[np.argmax(scores_along(bench, null, measured, candidate, path, fit))]


def _calibrated_near(bench, null, measured, candidate, path, fit):
    """Return the Calibrated of the points near the best simulated one, looked for near it: what an effect changes elsewhere tells little, and where nothing was
    simulated an emulator forgives what it does not know."""
    best = _best_simulated(bench, null, measured, candidate, path, fit)
    return calibrate(bench, null, measured, candidate, path.of(near(path, best, candidate.periodic)), fit, box_round(best, candidate.periodic))


def _with_whole_interval(bench, null, measured, candidate, path, fit, found):
    """Return the Calibrated with the intervals of the whole path where those of the near points reach as far as the points."""
    best = _best_simulated(bench, null, measured, candidate, path, fit)
    wide = np.abs(found.interval - best[:, None]).max(axis=1) > NEAR - STEPS[-1]
    if not wide.any():
        return found
    whole = calibrate(bench, null, measured, candidate, path, fit).interval
    lower, upper = np.minimum(found.interval[:, 0], whole[:, 0]), np.maximum(found.interval[:, 1], whole[:, 1])
    return replace(found, interval=np.where(wide[:, None], np.stack([lower, upper], axis=1), found.interval))


def _to_judge(candidate, unit, simulated, scales):
    """Return the points to judge: the most probable one, the best simulated one, and the first with what is nearly neutral made so."""
    neutral = candidate.neutral_unit(scales)
    snapped = np.where(np.abs(unit - neutral) < STEPS[-1], neutral, unit)  # NaN, no such value, is near nothing
    points = []
    for point in (unit, simulated, snapped):
        if not any(np.allclose(point, other, atol=1.0e-3) for other in points):
            points.append(point)
    return points


def judged(bench, null, measured, candidate, unit, path, found, free, scales, seeds, first_seed):
    """Return the Finalist at normalised parameters (parameter,), by `seeds` runs of every record."""
    physical = candidate.physical(unit, scales)
    model = bench.model(bench.variant(candidate, physical))
    runs = bench.runs(null.records, seeds, first_seed)
    features = of_survivors(bench.features(model, runs, candidate.measuring(physical, bench.signals.names)).reshape(len(null.records), seeds, -1))
    own = null.scattered(deviations(null, features, path, unit, candidate.periodic))
    scores = direct_scores(bench, own, measured, features.mean(axis=1))
    reading = path.readings[nearest(path, unit, candidate.periodic)]
    interval = np.stack([np.minimum(found.interval[:, 0], unit), np.maximum(found.interval[:, 1], unit)], axis=1)
    return Finalist(candidate, unit, interval, scores, linear_score(bench, reading), features, path, found.profile, free)


