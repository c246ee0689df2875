"""The information on several stiffnesses in words, from the covariance of their logarithms.

A combination of stiffnesses, a product of powers, is an eigenvector of the covariance of ln k. Its
variance is the eigenvalue. A value that is not known alone may still be known in combination.
"""

from collections.abc import Sequence

import numpy as np

KNOWN = 0.25  # largest standard deviation of ln of a combination that counts as known
LEAST_POWER = 0.3  # smallest power that a stiffness must have to be part of a combination
SHOWN_POWER = 0.15


def what_is_known(names: Sequence[str], covariance: np.ndarray, index: int) -> str:
    """Return a sentence on a stiffness that is not known alone.

    names: (direction,) of the stiffnesses.
    covariance: (direction, direction) of ln k.
    index: of the stiffness.
    """
    variances, vectors = np.linalg.eigh(covariance)
    variances = np.maximum(variances, 0.0)  # a round-off below 0
    for variance, vector in zip(variances, vectors.T, strict=True):
        partners = np.flatnonzero(np.abs(vector) > SHOWN_POWER).tolist()
        if np.sqrt(variance) < KNOWN and abs(vector[index]) > LEAST_POWER and len(partners) > 1:
            vector = vector * np.sign(vector[index])
            product = " ".join(f"k({names[i]})^{vector[i]:.2f}" for i in partners)
            return f"only the product {product} is known, within {np.sqrt(variance):.0%}"
    scatter = np.sqrt(covariance[index, index])
    size = f"a factor of {np.exp(scatter):.3g}" if scatter < 5.0 else "more than a factor of 100"
    return f"a change of k by {size} is within the scatter of the data"
