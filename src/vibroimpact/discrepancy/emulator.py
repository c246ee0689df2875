"""The mean of an effect's features between the parameters that were simulated: a Gaussian process shared by all features."""

import numpy as np
from scipy import linalg

LENGTH = 0.45  # of the searched range, in each parameter
NUGGET = 0.02  # seed scatter of a simulated mean, as a share of the effect's own variance


class Emulator:
    """Deviations (point, feature) of the features at normalised parameters (point, parameter), each from 0 to 1."""

    def __init__(self, parameters, deviations, periodic=()):
        self.parameters, self.deviations, self.periodic = np.atleast_2d(parameters), np.asarray(deviations), periodic
        self.mean = self.deviations.mean(axis=0)
        kernel = self._kernel(self.parameters, self.parameters) + NUGGET * np.eye(len(self.parameters))
        self.factor = linalg.cho_factor(kernel, lower=True)
        self.weights = linalg.cho_solve(self.factor, self.deviations - self.mean)

    def __call__(self, parameters):
        """Return (deviation (feature,), share of the variance that is not known) at normalised parameters (parameter,)."""
        against = self._kernel(np.atleast_2d(parameters), self.parameters)[0]
        unknown = max(0.0, 1.0 - against @ linalg.cho_solve(self.factor, against))
        return self.mean + against @ self.weights, unknown

    def _kernel(self, a, b):
        distance = a[:, None, :] - b[None, :, :]
        for number in self.periodic:
            distance[..., number] -= np.round(distance[..., number])
        return np.exp(-0.5 * np.sum((distance / LENGTH) ** 2, axis=-1))
