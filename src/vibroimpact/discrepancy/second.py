"""A second effect: pairs proposed by adding what each effect changes, those that look best simulated directly."""

import numpy as np

from vibroimpact.discrepancy import priors
from vibroimpact.discrepancy.candidates import Pair
from vibroimpact.discrepancy.features import compressed, uncompressed
from vibroimpact.discrepancy.screening import direct_scores, linear_score, null_scores

PAIRS, LEAST_PAIRS = 4, 2
FIRSTS = 3
NEAR = 0.5  # of what the best adds to a single effect: pairs beyond the first two that add less are not simulated


def pairs(bench, null, measured, found, paths):
    """Return [(Pair, unit (parameter,), gain)], best first: the best finalists, each with every other effect at its simulated points.

    What two effects change is added in the compressed features; found: Finalists, best first; paths {Candidate: Path}.
    """
    start, low = null_scores(bench, null, measured).sum(), linear_score(bench, None)
    best = {}
    for first in found[:FIRSTS]:
        own, moved = first.own(null), compressed(first.mean - null.mean, bench.layout)
        for candidate, path in paths.items():
            if candidate.ids == first.candidate.ids or candidate.alone:
                continue
            for unit, mean, reading in zip(path.parameters, path.features, path.readings, strict=True):
                both = null.mean + uncompressed(moved + compressed(mean - null.mean, bench.layout), bench.layout)
                gain = direct_scores(bench, own, measured, both).sum() - start + min(first.low, linear_score(bench, reading)) - low
                key = frozenset((*first.candidate.ids, *candidate.ids))
                if key not in best or gain > best[key][2]:
                    best[key] = (Pair(first.candidate, candidate), np.concatenate([first.unit, unit]), float(gain))
    ordered = sorted(best.values(), key=lambda row: -row[2])[:PAIRS]
    single = max(direct_scores(bench, first.own(null), measured, first.mean).sum() + first.low for first in found[:FIRSTS]) - start - low
    return [row for place, row in enumerate(ordered) if place < LEAST_PAIRS or row[2] - single > NEAR * (ordered[0][2] - single)]


def least_added(gain, threshold):
    """Return what a second effect must add, in log likelihood, to the gain of the first; threshold: that of a name."""
    return max(threshold, priors.SECOND_SHARE * gain)


def needed(explained):
    """Return whether the best single effect leaves something: explained (record,) z of naming.explained."""
    return bool(np.min(explained) < priors.EXPLAINED_Z)
