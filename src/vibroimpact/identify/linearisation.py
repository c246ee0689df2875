"""Two stiffnesses to compare the identified ones with: Gaussian statistical linearisation, and the
secant stiffness of the simulation.

Neither looks at a response's spectrum: the first predicts from the load alone, the second uses the
contact forces themselves.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import erfc

TOLERANCE = 1.0e-6
PASSES = 200


@dataclass(frozen=True)
class Linearisation:
    """k (N/m) per support; frequency (Hz) and damping_ratio of the first mode with the linearised
    contacts; whether it settled.
    """

    k: float
    frequency: float
    damping_ratio: float
    settled: bool


def statistical_linearisation(model, load_rms_N, gap_m, band_Hz):
    """Return the Linearisation of the contacts under a force of flat PSD in band_Hz (Hz) with RMS
    load_rms_N (N), radial gap gap_m (m).

    Each contact point and direction that the force moves gets the stiffness k erfc(g / (sigma sqrt
    2)) of a two-sided stop under a Gaussian motion of standard deviation sigma (E[df/du] of the
    stop's force f), and sigma that of the linear tube with those stiffnesses: solved by relaxed
    iteration. k sums f u over a support's points as the secant stiffness does. Circular obstacles
    are taken as two stops per direction, since the force moves one direction only. Source: Roberts
    and Spanos, Random vibration and statistical linearization, 1990.
    """
    drive = model.drive_shapes[:, 0]
    modes = np.sort(
        np.concatenate([block for block, _ in model.blocks if np.any(drive[block] != 0.0)])
    )
    shapes = model.contact_shapes[modes].reshape(len(modes), -1)
    rows = np.flatnonzero((shapes != 0.0).any(axis=0))
    shapes, point = shapes[:, rows], rows // 2
    gap = gap_m * model.gap_factor[point]
    stiffness = np.zeros(rows.size)
    force_psd = load_rms_N**2 / (band_Hz[1] - band_Hz[0])
    settled, relaxation, change_before = False, 0.7, np.inf
    for _ in range(PASSES):
        variance, frequency, ratio = _contact_variance(
            model, modes, shapes, stiffness, drive[modes], force_psd, band_Hz
        )
        wanted = model.contact_stiffness[point] * erfc(gap / np.sqrt(2.0 * variance))
        change = np.max(np.abs(wanted - stiffness)) / (np.max(wanted) + 1.0e-9)
        if change < TOLERANCE:
            settled = True
            break
        relaxation = (
            max(0.05, 0.6 * relaxation) if change > change_before else min(1.0, 1.1 * relaxation)
        )
        change_before = change
        stiffness = stiffness + relaxation * (wanted - stiffness)
    total = np.sum(stiffness * variance) / np.sum(model.contact_weight[point] * variance)
    return Linearisation(float(total), float(frequency), float(ratio), settled)


def _contact_variance(model, modes, shapes, stiffness, drive, force_psd, band_Hz):
    """Return (variance (contact,) m² of the contacts, first frequency Hz, its damping ratio) of the
    linear tube with these contacts.

    The damping matrix's part that couples the modes of the tube on its contacts is left out: it is
    of second order in the damping.
    """
    square, vectors = np.linalg.eigh(
        np.diag(model.omega[modes] ** 2) + (shapes * stiffness) @ shapes.T
    )
    omega = np.sqrt(square)
    decay = 0.5 * (vectors**2).T @ model.damping[modes]
    poles = -decay + 1j * np.sqrt(square - decay**2)
    gains = (shapes.T @ vectors) * (vectors.T @ drive)
    variance = force_psd * band_power(poles, gains, band_Hz)
    return variance, omega[0] / (2.0 * np.pi), decay[0] / omega[0]


def band_power(poles, gains, band_Hz):
    """Return (output,) the integral over band_Hz (in Hz) of |sum_r gains_r / (s - p_r)(s - p_r*)|²
    at s = 2 pi i f.

    poles: (mode,) rad/s with positive imaginary and negative real parts; gains: (output, mode). In
    partial fractions: with R_r the residue of the response H at p_r and B_r = R_r H(-p_r), |H|² =
    sum_r 2 Re[B_r/(s - p_r)] + 2 Re[B_r/(-s - p_r)], integrated in closed form.
    """
    residues = gains / (2j * poles.imag)
    mirrored = np.sum(
        gains[:, None, :] / ((-poles[:, None] - poles) * (-poles[:, None] - poles.conj())), axis=-1
    )
    low, high = 2j * np.pi * np.asarray(band_Hz)
    forward = -1j * (np.log(high - poles) - np.log(low - poles))
    backward = 1j * (np.log(-high - poles) - np.log(-low - poles))
    return np.sum(2.0 * (residues * mirrored * (forward + backward)).real, axis=-1) / (2.0 * np.pi)


def secant_stiffness(force_displacement, displacement_square, weight, support):
    """Return (k in N/m per support, its standard error): E[f u] / E[u²] over a record, summed over
    a support's points.

    force_displacement (contact_point, direction) N m, displacement_square (contact_point,
    direction) m², both means over the record; weight (contact_point,) share of the support's
    stiffness; support (contact_point,) its number. The direction with the larger motion counts, the
    others' forces belong to another motion. The standard error is the scatter over the supports,
    NaN for a single one.
    """
    direction = int(np.argmax(displacement_square.sum(axis=0)))
    work = np.bincount(support, force_displacement[:, direction])
    square = np.bincount(support, weight * displacement_square[:, direction])
    each = work / square
    error = np.std(each, ddof=1) / np.sqrt(each.size) if each.size > 1 else np.nan
    return float(work.sum() / square.sum()), float(error)
