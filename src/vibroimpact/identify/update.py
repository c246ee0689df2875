"""From a pole to the equivalent support: the (k, c) whose linear tube has that pole.

A complex lambda is a pole of the tube with support s = k + lambda c exactly when s = -1/mu for an eigenvalue mu of the contact
compliance G at lambda. So no search is needed: the eigenvalue that belongs to the first mode is followed along the straight line from
the pole of the free tube (where s = 0) to the wanted one, and its end gives s; the imaginary part of s gives c.
The slow twin, which checks every candidate by continuation in c, is `linear.support_from_pole`.
"""

from dataclasses import dataclass

import numpy as np

CONTINUATION_STEPS = 6


@dataclass(frozen=True)
class SupportFromPole:
    """k (N/m) and c (N s/m) of a pole, and jacobian (2, 2): d(k, c) / d(frequency in Hz, damping ratio).

    k is infinite when the pole lies beyond the one of the tube held at its supports: no finite support has it.
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
    """Return the SupportFromPole of a pole given by its undamped frequency (Hz) and damping ratio, for the followed mode of DrivenModes."""
    pole = pole_of(frequency, damping_ratio)
    mu, vector = _follow(modes, pole)
    stiffness = -1.0 / mu
    c = stiffness.imag / pole.imag
    k = stiffness.real - c * pole.real
    slope = _compliance_slope(modes, pole, vector) / mu**2
    columns = []
    for pole_change in (pole / frequency, 2.0 * np.pi * frequency * (-1.0 - 1j * damping_ratio / np.sqrt(1.0 - damping_ratio**2))):
        change = slope * pole_change
        c_change = (change.imag - c * pole_change.imag) / pole.imag
        columns.append((change.real - c_change * pole.real - c * pole_change.real, c_change))
    beyond_clamped = np.abs(pole) > np.abs(free_pole(modes)) and mu.real > 0.0 and abs(stiffness.real) > abs(stiffness.imag)
    return SupportFromPole(float("inf") if beyond_clamped else float(k), float(c), np.array(columns).T)


def _follow(modes, pole):
    """Return (mu, vector (contact,)) at the pole of the eigenvalue of G that is infinite at the free pole."""
    start = free_pole(modes)
    places = start + np.linspace(0.0, 1.0, CONTINUATION_STEPS + 1)[1:] * (pole - start)
    values, vectors = np.linalg.eig(modes.compliance(places))
    chosen = int(np.argmax(np.abs(values[0])))
    for here in range(1, len(places)):
        likeness = np.abs(vectors[here - 1][:, chosen].conj() @ vectors[here])
        chosen = int(np.argmax(likeness))
    return values[-1, chosen], vectors[-1][:, chosen]


def _compliance_slope(modes, pole, vector):
    """Return d mu / d lambda: G is complex symmetric, so the left eigenvector is the right one, without conjugation."""
    modal = modes.contact @ vector
    slope = -np.sum(modal**2 * (2.0 * pole + modes.damping) * modes.receptance(pole) ** 2)
    return slope / np.sum(vector**2)
