"""How near what was measured lies to the points that were simulated of a candidate."""

import numpy as np

from .screening import LAW_TURNS, direct_scores, linear_score, null_scores, path_emulator


def law_at(bench, null, candidate, path, unit):
    """Return (record, compressed feature) what a candidate changes at unit (parameter,), emulated:
    free of the scatter of any point's few seeds.
    """
    return path_emulator(bench, null, path, candidate)(unit)[0].reshape(null.mean.shape)


def scores_along(bench, null, measured, candidate, path, fit):
    """Return (point,) the log likelihood of what was measured at the points of a candidate's path,
    to compare them with each other.

    What two laws may differ by is the same for all, that of the best: with its own, a stronger
    effect, or a point whose few seeds lie far off, would forgive itself more, and a clearance of
    1.24 nominal was read as 1.44.
    """
    emulator = path_emulator(bench, null, path, candidate)
    scores = scores_of(bench, null, measured, path, fit)
    for _ in range(LAW_TURNS):
        law = emulator(path.parameters[np.argmax(scores)])[0].reshape(null.mean.shape)
        scores = scores_of(bench, null, measured, path, fit, law)
    return scores


def scores_of(bench, null, measured, path, fit, law=None):
    """Return (point,) the log likelihood of what was measured at the points of a path; law: see
    screening.direct_scores.
    """
    return np.array(
        [
            direct_scores(bench, null, measured, mean, law)[fit].sum()
            + linear_score(bench, reading)
            for mean, reading in zip(path.features, path.readings, strict=True)
        ]
    )


def gains_of(bench, null, measured, path, own=None):
    """Return (point,) the gain of log likelihood over the null, of all records, at the points of a
    path; own: the Null of the path's candidate.
    """
    start = null_scores(bench, null, measured).sum() + linear_score(bench, None)
    return (
        scores_of(bench, null if own is None else own, measured, path, np.ones(len(measured), bool))
        - start
    )
