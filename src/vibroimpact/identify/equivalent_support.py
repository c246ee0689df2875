"""From a pole to the equivalent support: the (k, c) whose linear tube has that pole.

A complex lambda is a pole of the tube with support s = k + lambda c exactly when s = -1/mu for an
eigenvalue mu of the contact compliance G at lambda. So no search is needed: the imaginary part of s
gives c, the rest k. The first mode's eigenvalue is the one with a positive k, the smallest if there
are several: supports that stiffen other modes down to this pole are negative. Its inverse is
`linear.poles.first_pole`.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.family import DrivenModes
from vibroimpact.identify.linear.poles import pole_of


@dataclass(frozen=True)
class EquivalentSupport:
    """The support of a pole.

    k: N/m. It is infinite when the pole is beyond that of the tube clamped at its supports, which
        no finite support gives.
    c: N s/m.
    jacobian: (2, 2) d(k, c) / d(frequency in Hz, damping ratio).
    """

    k: float
    c: float
    jacobian: np.ndarray


def free_pole(modes: DrivenModes) -> complex:
    """Return the pole in rad/s of the first mode without support."""
    omega = modes.omega[modes.first]
    return pole_of(omega / (2.0 * np.pi), 0.5 * modes.damping[modes.first] / omega)


def equivalent_support(
    modes: DrivenModes, frequency: float, damping_ratio: float
) -> EquivalentSupport:
    """Return the EquivalentSupport of a pole of the first mode.

    frequency: undamped, in Hz.
    """
    pole = pole_of(frequency, damping_ratio)
    values, vectors = np.linalg.eig(modes.compliance(pole))
    stiffness = -1.0 / np.where(values == 0.0, np.finfo(float).tiny, values)
    damping = stiffness.imag / pole.imag
    static = stiffness.real - damping * pole.real
    above_free = np.abs(pole) > np.abs(free_pole(modes))
    stiffening = above_free and np.any(static > 0.0)
    size = np.abs(stiffness)
    chosen = int(np.argmin(np.where(static > 0.0, size, np.inf) if stiffening else size))
    k, c = float(static[chosen]), float(damping[chosen])
    vector = vectors[:, chosen]
    # G is complex symmetric, so that the left eigenvector is the right one without conjugation.
    modal = modes.contact @ vector
    slope = -np.sum(modal**2 * (2.0 * pole + modes.damping) * modes.receptance(pole) ** 2)
    slope = slope / np.sum(vector**2) / values[chosen] ** 2
    by_frequency = pole / frequency
    by_ratio = (
        2.0 * np.pi * frequency * (-1.0 - 1j * damping_ratio / np.sqrt(1.0 - damping_ratio**2))
    )
    columns = []
    for pole_change in (by_frequency, by_ratio):
        change = slope * pole_change
        c_change = (change.imag - c * pole_change.imag) / pole.imag
        columns.append((change.real - c_change * pole.real - c * pole_change.real, c_change))
    # Above the free frequency a negative k is possible only as a small part of a heavily damped
    # support.
    beyond_clamped = above_free and not stiffening and abs(k) > abs(c) * pole.imag
    return EquivalentSupport(float("inf") if beyond_clamped else k, c, np.array(columns).T)
