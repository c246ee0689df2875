"""From a pole to the equivalent support: the (k, c) whose linear tube has that pole.

A complex lambda is a pole of the tube with support s = k + lambda c exactly when s = -1/mu for an
eigenvalue mu of the contact compliance G at lambda. So no search is needed: the imaginary part of s
gives c, the rest k. Of the eigenvalues the first mode's is the one with a positive k, the smallest
if there are several: supports that stiffen the other modes down to this pole are negative. The slow
twin, which follows the first mode of every candidate from c = 0, is `linear.support_from_pole`.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class SupportFromPole:
    """k (N/m) and c (N s/m) of a pole, and jacobian (2, 2): d(k, c) / d(frequency in Hz, damping
    ratio).

    k is infinite when the pole lies beyond the one of the tube held at its supports: no finite
    support has it.
    """

    k: float
    c: float
    jacobian: np.ndarray


def pole_of(frequency, damping_ratio):
    """Return the complex pole in rad/s of an undamped frequency (Hz) and a damping ratio."""
    return 2.0 * np.pi * frequency * (-damping_ratio + 1j * np.sqrt(1.0 - damping_ratio**2))


def frequency_of(pole):
    """Return (undamped frequency in Hz, damping ratio) of a complex pole in rad/s."""
    return np.abs(pole) / (2.0 * np.pi), -np.real(pole) / np.abs(pole)


def free_pole(modes):
    """Return the pole in rad/s of the followed mode of DrivenModes without support."""
    omega = modes.omega[modes.first]
    return pole_of(omega / (2.0 * np.pi), 0.5 * modes.damping[modes.first] / omega)


def support_from_pole(modes, frequency, damping_ratio):
    """Return the SupportFromPole of a pole given by its undamped frequency (Hz) and damping ratio,
    for the followed mode of DrivenModes.
    """
    pole = pole_of(frequency, damping_ratio)
    values, vectors = np.linalg.eig(modes.compliance(pole))
    stiffness = -1.0 / np.where(values == 0.0, np.finfo(float).tiny, values)
    damping = stiffness.imag / pole.imag
    static = stiffness.real - damping * pole.real
    above_free = np.abs(pole) > np.abs(free_pole(modes))
    stiffening = above_free and np.any(static > 0.0)
    chosen = int(
        np.argmin(
            np.where(static > 0.0, np.abs(stiffness), np.inf) if stiffening else np.abs(stiffness)
        )
    )
    k, c = float(static[chosen]), float(damping[chosen])
    slope = _compliance_slope(modes, pole, vectors[:, chosen]) / values[chosen] ** 2
    columns = []
    for pole_change in (
        pole / frequency,
        2.0 * np.pi * frequency * (-1.0 - 1j * damping_ratio / np.sqrt(1.0 - damping_ratio**2)),
    ):
        change = slope * pole_change
        c_change = (change.imag - c * pole_change.imag) / pole.imag
        columns.append((change.real - c_change * pole.real - c * pole_change.real, c_change))
    # Above the free frequency a negative k is possible only as a small part of a heavily damped
    # support.
    beyond_clamped = above_free and not stiffening and abs(k) > abs(c) * pole.imag
    return SupportFromPole(float("inf") if beyond_clamped else k, c, np.array(columns).T)


def _compliance_slope(modes, pole, vector):
    """Return d mu / d lambda: G is complex symmetric, so the left eigenvector is the right one,
    without conjugation.
    """
    modal = modes.contact @ vector
    slope = -np.sum(modal**2 * (2.0 * pole + modes.damping) * modes.receptance(pole) ** 2)
    return slope / np.sum(vector**2)
