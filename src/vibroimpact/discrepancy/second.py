"""A second effect: pairs proposed by adding what each effect changes, simulated at the point proposed, those that come nearest looked at closely."""

import numpy as np

from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.candidates import Pair
from vibroimpact.discrepancy.features import compressed, uncompressed
from vibroimpact.discrepancy.finalists import gains_of
from vibroimpact.discrepancy.screening import direct_scores, linear_score, simulate_path

PAIRS, LEAST_PAIRS = 4, 2
FIRSTS = 3
WITHOUT_FIRST = 6  # pairs without the best finalist that are simulated; with it all are
NEAR = 0.5  # of what the best adds to a single effect: pairs beyond the first two that add less are not looked at closely


def pairs(bench, null, measured, found, paths, scales, first_seed=25000):
    """Return [(Pair, unit (parameter,), gain)], best first, by direct simulation where `proposed` looks best; arguments as of `proposed`, scales of normalised parameters.

    Two effects that act on one contact change each other: a larger gap and a damped contact add to nothing, and together explain what neither does.
    """
    rows, best = [], set(found[0].candidate.ids)
    order = proposed(bench, null, measured, found, paths)
    others = [row for row in order if not best <= set(row[1].ids)]
    for first, pair, unit in [row for row in order if best <= set(row[1].ids)] + others[:WITHOUT_FIRST]:
        path = simulate_path(bench, pair, unit, scales, null.records, first_seed=first_seed)
        if path is not None:
            rows.append((pair, unit, float(gains_of(bench, null, measured, path, first.own(null))[0])))
    rows.sort(key=lambda row: -row[2])
    single = max(gains_of(bench, null, measured, first.path, first.own(null)).max() for first in found[:FIRSTS])
    return [row for place, row in enumerate(rows[:PAIRS]) if place < LEAST_PAIRS or row[2] - single > NEAR * (rows[0][2] - single)]


def proposed(bench, null, measured, found, paths):
    """Return [(Finalist, Pair, unit (parameter,))], best first: the best finalists, each with every other effect where it looks best of its simulated points.

    What two effects change is added in the compressed features; found: Finalists, best first; paths {Candidate: Path}.
    """
    best = {}
    for first in found[:FIRSTS]:
        own, moved = first.own(null), compressed(first.mean - null.mean, bench.layout)
        for candidate, path in paths.items():
            if candidate.ids == first.candidate.ids or candidate.alone:
                continue
            for unit, mean, reading in zip(path.parameters, path.features, path.readings, strict=True):
                both = null.mean + uncompressed(moved + compressed(mean - null.mean, bench.layout), bench.layout)
                score = direct_scores(bench, own, measured, both).sum() + min(first.low, linear_score(bench, reading))
                key = frozenset((*first.candidate.ids, *candidate.ids))
                if key not in best or score > best[key][0]:
                    best[key] = (score, first, Pair(first.candidate, candidate), np.concatenate([first.unit, unit]))
    return [row[1:] for row in sorted(best.values(), key=lambda row: -row[0])]


def least_added(gain, threshold):
    """Return what a second effect must add, in log likelihood, to the gain of the first; threshold: that of a name."""
    return max(threshold, priors.SECOND_SHARE * gain)


def needed(explained):
    """Return whether the best single effect leaves something: explained (record,) z of naming.explained."""
    return bool(np.min(explained) < priors.EXPLAINED_Z)
