"""The mean of an effect's features between the parameters that were simulated: a Gaussian process
shared by all features.
"""

import numpy as np
from scipy import linalg

LENGTHS = (
    0.05,
    0.1,
    0.2,
    0.35,
    0.7,
    1.4,
)  # of the searched range; for each parameter the one that predicts left-out points best is taken
SWEEPS = 2  # over the parameters, one length after the other


class Emulator:
    """Deviations (point, feature) of the features at normalised parameters (point, parameter), each
    from 0 to 1; noise (point,): variance of a simulated mean as a share of the effect's own.
    """

    def __init__(self, parameters, deviations, noise, periodic=()):
        self.parameters, self.periodic = np.atleast_2d(parameters), periodic
        self.deviations, self.mean, self.noise = deviations, deviations.mean(axis=0), noise
        best = np.inf
        lengths = np.full(self.parameters.shape[1], 0.35)
        for number in list(range(len(lengths))) * (SWEEPS if len(lengths) > 1 else 1):
            for length in LENGTHS:
                tried = lengths.copy()
                tried[number] = length
                error, weights, inverse = self._fit(tried)
                if error < best:
                    best, lengths, self.weights, self.inverse = error, tried, weights, inverse
        self.lengths = lengths

    def _fit(self, lengths):
        """Return (sum of squares of the errors at left-out points, weights, inverse of the kernel)
        with lengths (parameter,).
        """
        inverse = linalg.inv(
            self._kernel(self.parameters, self.parameters, lengths) + np.diag(self.noise + 1.0e-4)
        )
        weights = inverse @ (self.deviations - self.mean)
        return float(np.sum((weights / np.diag(inverse)[:, None]) ** 2)), weights, inverse

    def __call__(self, parameters):
        """Return (deviation (feature,), share of the variance that is not known) at normalised
        parameters (parameter,).
        """
        against = self._kernel(np.atleast_2d(parameters), self.parameters, self.lengths)[0]
        return self.mean + against @ self.weights, max(0.0, 1.0 - against @ self.inverse @ against)

    def _kernel(self, a, b, lengths):
        distance = a[:, None, :] - b[None, :, :]
        for number in self.periodic:
            distance[..., number] = (
                np.sin(np.pi * distance[..., number]) / np.pi
            )  # the chord of a circle that is 1 round
        return np.exp(-0.5 * np.sum((distance / lengths) ** 2, axis=-1))
