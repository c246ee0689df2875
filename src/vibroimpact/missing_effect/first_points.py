"""Points at which an explanation is run before anything is known of it."""

import numpy as np
from scipy.stats import qmc

from vibroimpact.linear_stage.candidates import Candidate

# By the number of parameters.
FIRST = {
    1: ((0.75,), (0.3,), (0.1,), (0.55,)),
    2: ((0.8, 0.5), (0.3, 0.3), (0.5, 0.8), (0.7, 0.2)),
    3: ((0.7, 0.7, 0.7), (0.3, 0.3, 0.3), (0.3, 0.7, 0.5), (0.7, 0.3, 0.5)),
}
# Of a vector: first as large as may be seen in both directions, then smaller.
VECTOR = ((0.75, 0.75), (0.6, 0.4), (0.3, 0.7), (0.5, 0.35))
EVEN = 8  # of an effect whose place is searched too


def first_points(candidate: Candidate) -> np.ndarray:
    """Return (point, parameter): where an explanation is run first."""
    count = len(candidate.effect.parameters)
    if candidate.along:  # even ones, without the corner
        return qmc.Sobol(count, scramble=False).random(EVEN)[1:]
    vector = count == 2 and len(candidate.signed) == 2
    return np.array(VECTOR if vector else FIRST[count])
