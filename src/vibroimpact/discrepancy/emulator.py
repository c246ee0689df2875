"""The mean of an effect's features between the parameters that were simulated: a Gaussian process shared by all features."""

import numpy as np
from scipy import linalg

LENGTHS = (0.12, 0.2, 0.3, 0.45, 0.7)  # of the searched range; the one that predicts left-out points best is taken


class Emulator:
    """Deviations (point, feature) of the features at normalised parameters (point, parameter), each from 0 to 1; noise (point,): variance of a
    simulated mean as a share of the effect's own."""

    def __init__(self, parameters, deviations, noise, periodic=()):
        self.parameters, self.periodic = np.atleast_2d(parameters), periodic
        self.deviations, self.mean = deviations, deviations.mean(axis=0)
        centred = deviations - self.mean
        best = np.inf
        for length in LENGTHS:
            kernel = self._kernel(self.parameters, self.parameters, length) + np.diag(noise + 1.0e-4)
            inverse = linalg.inv(kernel)
            left_out = inverse @ centred / np.diag(inverse)[:, None]
            error = float(np.sum(left_out**2))
            if error < best:
                best, self.length, self.weights, self.inverse = error, length, inverse @ centred, inverse

    def __call__(self, parameters):
        """Return (deviation (feature,), share of the variance that is not known) at normalised parameters (parameter,)."""
        against = self._kernel(np.atleast_2d(parameters), self.parameters, self.length)[0]
        return self.mean + against @ self.weights, max(0.0, 1.0 - against @ self.inverse @ against)

    def _kernel(self, a, b, length):
        distance = a[:, None, :] - b[None, :, :]
        for number in self.periodic:
            distance[..., number] = np.sin(np.pi * distance[..., number]) / np.pi  # the chord of a circle that is 1 round
        return np.exp(-0.5 * np.sum((distance / length) ** 2, axis=-1))
