"""The time step of a linear mode as the kernel takes it, for each integration scheme.

Any one-step scheme that is linear in the state and in the force at both ends of the step,
    (q1, v1) = A (q0, v0) + g0 f0 + g1 f1,
is brought to a form that needs the force of the end only: with the state shifted by S f, S = A^-1
g0, it reads
x1 = A x0 + (g1 + S) f1. The kernel keeps `ahead`, the displacement at the end of the next step
without a force there, and
`change`, its increment over the shifted displacement; in exact arithmetic this is the scheme, and
small increments keep
their digits however small the step.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm


@dataclass(frozen=True)
class StepCoefficients:
    """The step of every mode, each (mode,) unless said otherwise.

    push: displacement at the end per modal force there (the compliance of a step); shift: q + shift
    f is the shifted displacement; decay, restore, kick: change = decay change + restore (q + shift
    f) + kick f; loss: damping / dt; speed (4,): v = speed[0] du + speed[1] m, then m = speed[2] du
    + speed[3] m: the velocity of a row with the memory m; A (2, 2, mode), S (2, mode): see the
    module.
    """

    mode_compliance: np.ndarray
    force_shift: np.ndarray
    decay: np.ndarray
    restoring: np.ndarray
    force_gain: np.ndarray
    damping_over_dt: np.ndarray
    velocity_weights: np.ndarray
    A: np.ndarray
    S: np.ndarray

    def start(self, q, v, f):
        """(ahead, change) of modes at displacement q, velocity v under the force f, each (mode,
        ...).
        """
        A, S = self._like(self.A, f), self._like(self.S, f)
        q, v = q + S[0] * f, v + S[1] * f
        change = (A[0, 0] - 1.0) * q + A[0, 1] * v
        return q + change, change

    def velocity(self, ahead, change, f):
        """Velocity (mode, ...) of modes in the kernel's state under the force f."""
        A, S = self._like(self.A, f), self._like(self.S, f)
        return (change - (A[0, 0] - 1.0) * (ahead - change)) / A[0, 1] - S[1] * f

    @staticmethod
    def _like(values, f):
        return values.reshape(values.shape + (1,) * (np.ndim(f) - 1))


def step_coefficients(
    scheme: str, omega: np.ndarray, damping: np.ndarray, dt: float
) -> StepCoefficients:
    """StepCoefficients of modes q'' + damping q' + omega² q = f.

    scheme "newmark": average acceleration (Newmark 1959, beta = 1/4, gamma = 1/2), no numerical
    dissipation, energy identity to round-off. scheme "exact": the exact solution for a force that
    is linear in the step; no error in a linear mode, whatever the step.
    """
    A, g0, g1, decay, restore = {"newmark": _newmark, "exact": _exact}[scheme](omega, damping, dt)
    S = np.stack([A[1, 1] * g0[0] - A[0, 1] * g0[1], A[0, 0] * g0[1] - A[1, 0] * g0[0]]) / decay
    kick = A[0, 1] * (g1[1] + S[1]) - (A[1, 1] - decay) * (g1[0] + S[0])
    speed = {"newmark": [2.0 / dt, -1.0, 2.0 / dt, -1.0], "exact": [1.5 / dt, -0.5, 1.0 / dt, 0.0]}[
        scheme
    ]
    return StepCoefficients(g1[0], S[0], decay, restore, kick, damping / dt, np.array(speed), A, S)


def _newmark(omega, damping, dt):
    """(A, g0, g1, det A, -det(I - A)): the acceleration eliminated by the equation of motion."""
    stiff, drag = (0.5 * dt * omega) ** 2, 0.5 * dt * damping
    scale = 1.0 / (1.0 + drag + stiff)
    vv, vq, vf = (1.0 - drag - stiff) * scale, -dt * omega**2 * scale, 0.5 * dt * scale
    A = np.array([[1.0 + 0.5 * dt * vq, 0.5 * dt * (1.0 + vv)], [vq, vv]])
    force = np.stack([0.5 * dt * vf, vf])
    return A, force, force, (1.0 - drag + stiff) * scale, dt * vq


def _exact(omega, damping, dt):
    """(A, g0, g1, det A, -det(I - A)) by the exponential of the system with the force and its slope
    as two more states, in time / dt.
    """
    system = np.zeros((omega.size, 4, 4))  # q, dt q', dt² f, dt² (f1 - f0)
    system[:, 0, 1] = system[:, 1, 2] = system[:, 2, 3] = 1.0
    system[:, 1, 0], system[:, 1, 1] = -((dt * omega) ** 2), -dt * damping
    step = np.moveaxis(expm(system), 0, -1) if omega.size else np.zeros((4, 4, 0))
    unit = np.array([1.0, 1.0 / dt])[:, None]  # of q and q'
    A = step[:2, :2] * unit[:, None] / unit[None]
    slope = step[:2, 3] * unit * dt**2
    poles = -0.5 * damping + np.sqrt((0.5 * damping) ** 2 - omega**2 + 0j)
    other = -0.5 * damping - np.sqrt((0.5 * damping) ** 2 - omega**2 + 0j)
    restore = -(
        np.expm1(poles * dt) * np.expm1(other * dt)
    ).real  # -(1 - tr A + det A), without the cancellation
    return A, step[:2, 2] * unit * dt**2 - slope, slope, np.exp(-damping * dt), restore
