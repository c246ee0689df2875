"""Newmark's average acceleration as a linear map of one mode, as a textbook has it (Newmark 1959,
beta = 1/4, gamma = 1/2).
"""

import numpy as np


def newmark_map(omega, damping, dt):
    """Return (6, mode): v1 = c0 v0 + c1 q0 + c2 f, q1 = c3 q0 + c4 v0 + c5 f, with f the sum of the
    modal forces at both ends of the step.

    omega (mode,) rad/s, damping (mode,) 1/s (2 zeta omega), dt s. From q1 = q0 + dt/2 (v0 + v1) and
    v1 = v0 + dt/2 (a0 + a1), the accelerations a = f - damping v - omega² q eliminated.
    """
    half = 0.5 * dt
    scale = 1.0 / (1.0 + half * damping + (half * omega) ** 2)
    from_v = (1.0 - half * damping - (half * omega) ** 2) * scale
    from_q = -dt * omega**2 * scale
    from_f = half * scale
    return np.stack(
        [from_v, from_q, from_f, 1.0 + half * from_q, half * (1.0 + from_v), half * from_f]
    )
