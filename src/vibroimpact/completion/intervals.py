"""90 % intervals of what is told of a law, from the slope of the fit and the scatter of its error,
which is no white noise.
"""

import numpy as np

from .local_laws import LAWS

CLUSTERS_PER_CHANNEL = (
    8  # stretches of lines within which the error is taken to be wholly dependent
)
NORMAL_90 = 1.645
STEP = 1.0e-4


def covariance(fit, minimum):
    """Return (value, value) covariance of a fit's values, robust to errors that go together within
    stretches of a channel's lines.

    Sandwich of White (1980) in the form for clusters: the error of a completed model is distortion
    that it does not follow, smooth over lines, and not the noise of the record.
    """
    bread = np.linalg.pinv(minimum.slope.T @ minimum.slope)
    count = sum(wanted.size for wanted in fit.wanted)
    meat = np.zeros_like(bread)
    first = 0
    for wanted in fit.wanted:
        for _ in range(len(wanted)):
            for part in np.array_split(
                np.arange(first, first + wanted.shape[1]), CLUSTERS_PER_CHANNEL
            ):
                rows = np.concatenate([part, part + count])  # real and imaginary parts
                pull = minimum.slope[rows].T @ minimum.error[rows]
                meat += np.outer(pull, pull)
            first += wanted.shape[1]
    return bread @ meat @ bread


def told_parameters(fit, minimum, trial):
    """Return [{name: {value, unit, low, high}}] per term: what is told of its law, with 90 %
    intervals by the delta method.
    """
    spread = covariance(fit, minimum)
    told = []
    for index, (term, place) in enumerate(zip(trial.terms, fit.law_places(), strict=True)):
        summary = LAWS[term.law].summary
        centre = summary(term.values)
        values, own = minimum.values[place], spread[place, place]
        slopes = []
        for number in range(values.size):
            moved = minimum.values.copy()
            moved[place.start + number] += STEP
            changed = summary(fit.trial(moved).terms[index].values)
            slopes.append([(changed[name][0] - centre[name][0]) / STEP for name in centre])
        slopes = np.array(slopes)
        error = NORMAL_90 * np.sqrt(np.maximum(np.einsum("vn,vw,wn->n", slopes, own, slopes), 0.0))
        told.append(
            {
                name: {"value": value, "unit": unit, "low": value - half, "high": value + half}
                for (name, (value, unit)), half in zip(centre.items(), error, strict=True)
            }
        )
    return told
