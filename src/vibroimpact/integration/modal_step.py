"""The time step of a linear mode as the kernel takes it, for each integration scheme.

A one-step scheme that is linear in the state x = (q, v) and in the force at both ends of the step,

    x1 = A x0 + g0 f0 + g1 f1,

is brought to a form that needs the force at the end only. With the shifted state y = x + S f and
S = A^-1 g0 it reads

    y1 = A y0 + (g1 + S) f1.

The kernel stores ``q_next_free``, the displacement at the end of the next step without a force
there, and ``dq``, its increment over the shifted displacement. In exact arithmetic this is the
scheme; small increments keep their digits however small the step.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import expm


@dataclass(frozen=True)
class StepCoefficients:
    """The step of every mode, each (mode,) unless said otherwise.

    mode_compliance: displacement at the end of the step per modal force there.
    force_shift: S of the displacement; q + force_shift f is the shifted displacement.
    decay, restoring, force_gain: dq = decay dq + restoring (q + force_shift f) + force_gain f.
    damping_over_dt: damping / dt.
    velocity_weights (4,): velocity of a row v = w0 du + w1 m from its increment du and the memory
        m of the last step; then m = w2 du + w3 m.
    A (2, 2, mode), S (2, mode): see the module.
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

    def start(self, q: np.ndarray, v: np.ndarray, f: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(q_next_free, dq) of modes at displacement q, velocity v under the force f, each (mode,
        ...).
        """
        A, S = self._like(self.A, f), self._like(self.S, f)
        q, v = q + S[0] * f, v + S[1] * f
        dq = (A[0, 0] - 1.0) * q + A[0, 1] * v
        return q + dq, dq

    def velocity(self, q_next_free: np.ndarray, dq: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Velocity (mode, ...) of modes in the kernel's state under the force f."""
        A, S = self._like(self.A, f), self._like(self.S, f)
        return (dq - (A[0, 0] - 1.0) * (q_next_free - dq)) / A[0, 1] - S[1] * f

    @staticmethod
    def _like(values: np.ndarray, f: np.ndarray) -> np.ndarray:
        """values (..., mode) with the trailing axes of f added."""
        return values.reshape(values.shape + (1,) * (np.ndim(f) - 1))


def step_coefficients(
    scheme: str, omega: np.ndarray, damping: np.ndarray, dt: float
) -> StepCoefficients:
    """StepCoefficients of modes q'' + damping q' + omega² q = f.

    scheme: "newmark", average acceleration (Newmark 1959, beta = 1/4, gamma = 1/2): no numerical
        dissipation, energy identity to round-off. "exact", the exact solution for a force that is
        linear in the step: no error in a linear mode, whatever the step.
    omega (mode,): rad/s.
    damping (mode,): 1/s.
    dt: s.
    """
    A, g0, g1, decay, restoring = SCHEMES[scheme](omega, damping, dt)
    S = np.stack([A[1, 1] * g0[0] - A[0, 1] * g0[1], A[0, 0] * g0[1] - A[1, 0] * g0[0]]) / decay
    velocity_weights = {
        "newmark": [2.0 / dt, -1.0, 2.0 / dt, -1.0],
        "exact": [1.5 / dt, -0.5, 1.0 / dt, 0.0],
    }
    return StepCoefficients(
        mode_compliance=g1[0],
        force_shift=S[0],
        decay=decay,
        restoring=restoring,
        force_gain=A[0, 1] * (g1[1] + S[1]) - (A[1, 1] - decay) * (g1[0] + S[0]),
        damping_over_dt=damping / dt,
        velocity_weights=np.array(velocity_weights[scheme]),
        A=A,
        S=S,
    )


def step_matrices(
    scheme: str, omega: np.ndarray, damping: np.ndarray, dt: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A (2, 2, mode), g0 and g1 (2, mode) of the step x1 = A x0 + g0 f0 + g1 f1, see the module.

    scheme, omega, damping, dt: of step_coefficients.
    """
    return SCHEMES[scheme](omega, damping, dt)[:3]


Scheme = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _newmark(omega: np.ndarray, damping: np.ndarray, dt: float) -> Scheme:
    """(A, g0, g1, det A, -det(I - A)): the acceleration eliminated by the equation of motion."""
    stiff, drag = (0.5 * dt * omega) ** 2, 0.5 * dt * damping
    scale = 1.0 / (1.0 + drag + stiff)
    vv, vq, vf = (1.0 - drag - stiff) * scale, -dt * omega**2 * scale, 0.5 * dt * scale
    A = np.array([[1.0 + 0.5 * dt * vq, 0.5 * dt * (1.0 + vv)], [vq, vv]])
    force = np.stack([0.5 * dt * vf, vf])
    return A, force, force, (1.0 - drag + stiff) * scale, dt * vq


def _exact(omega: np.ndarray, damping: np.ndarray, dt: float) -> Scheme:
    """(A, g0, g1, det A, -det(I - A)) by the exponential of the system with the force and its slope
    as two more states, in time / dt.
    """
    modes = zip((-((dt * omega) ** 2)).tolist(), (-dt * damping).tolist(), strict=True)
    step = np.zeros((4, 4, omega.size))
    for mode, (stiff, drag) in enumerate(modes):
        step[..., mode] = _exponential(stiff, drag)
    unit = np.array([1.0, 1.0 / dt])[:, None]  # of q and q'
    A = step[:2, :2] * unit[:, None] / unit[None]
    slope = step[:2, 3] * unit * dt**2
    root = np.sqrt((0.5 * damping) ** 2 - omega**2 + 0j)
    poles, other = -0.5 * damping + root, -0.5 * damping - root
    # -(1 - tr A + det A), without the cancellation
    restoring = -(np.expm1(poles * dt) * np.expm1(other * dt)).real
    return A, step[:2, 2] * unit * dt**2 - slope, slope, np.exp(-damping * dt), restoring


@lru_cache(maxsize=4096)  # variants of a model share most modes
def _exponential(stiff: float, drag: float) -> np.ndarray:
    """Return (4, 4) the exponential of the system q, dt q', dt² f, dt² (f1 - f0)."""
    system = np.diag([1.0, 1.0, 1.0], 1)
    system[1, 0], system[1, 1] = stiff, drag
    return expm(system)


SCHEMES = {"newmark": _newmark, "exact": _exact}
