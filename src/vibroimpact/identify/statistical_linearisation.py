"""Gaussian statistical linearisation: contact stiffness predicted from the load alone."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import erfc

from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.reduction.modal_model import ModalModel

TOLERANCE = 1.0e-6
PASSES = 200


@dataclass(frozen=True)
class Linearisation:
    """The linearised contacts.

    k: N/m per support, over all supports and directions that the force moves.
    work, square: (contact_point, 2) N m and m², whose sums over the points of a group give its k;
        0 if the force moves nothing.
    frequency, damping_ratio: of the first mode (Hz) with the linearised contacts.
    settled: whether the iteration converged.
    """

    k: float
    work: np.ndarray
    square: np.ndarray
    frequency: float
    damping_ratio: float
    settled: bool

    def stiffness_of(self, direction: SupportDirection) -> float:
        """Return k in N/m per support of a group in one direction, NaN for an oblique one."""
        squared = direction.along**2
        if not np.all((squared == 0.0) | (squared == 1.0)):
            return np.nan
        place = (direction.rows, np.argmax(squared, axis=1))
        return float(np.sum(self.work[place]) / np.sum(self.square[place]))


@lru_cache(maxsize=32)
def statistical_linearisation(
    model: ModalModel, load_rms_N: float, gap_m: float, band_Hz: tuple[float, float]
) -> Linearisation:
    """Return the Linearisation of the contacts under a random force of flat PSD.

    Each contact point and direction that the force moves gets the stiffness
    k erfc(g / (sigma sqrt 2)). It is E[df/du] of the force f of a two-sided stop under a Gaussian
    motion of standard deviation sigma, and sigma is that of the linear tube with these stiffnesses.
    The two are solved by relaxed iteration. k sums f u over a support's points as the secant
    stiffness does. A circular obstacle counts as two stops per direction, because the force moves
    one direction only. Source: Roberts and Spanos, Random vibration and statistical linearization,
    1990.

    load_rms_N: RMS of the force in N.
    gap_m: radial gap in m.
    band_Hz: band of the force in Hz.
    """
    drive = model.drive_shapes[:, 0]
    driven = [block for block, _ in model.blocks if np.any(drive[block] != 0.0)]
    modes = np.sort(np.concatenate(driven))
    shapes = model.contact_shapes[modes].reshape(len(modes), -1)
    rows = np.flatnonzero((shapes != 0.0).any(axis=0))
    shapes, point = shapes[:, rows], rows // 2
    own_gap = model.contact_laws.gap[point]
    gap = np.where(np.isnan(own_gap), gap_m * model.gap_factor[point], own_gap)
    stiffness = np.zeros(rows.size)
    force_psd = load_rms_N**2 / (band_Hz[1] - band_Hz[0])
    settled, relaxation, change_before = False, 0.7, np.inf
    for _ in range(PASSES):
        held = np.diag(model.omega[modes] ** 2) + (shapes * stiffness) @ shapes.T
        power, omega, decay = power_in_band(
            held, model.damping[modes], shapes, drive[modes], band_Hz
        )
        variance = force_psd * power
        wanted = model.contact_stiffness[point] * erfc(gap / np.sqrt(2.0 * variance))
        change = np.max(np.abs(wanted - stiffness)) / (np.max(wanted) + 1.0e-9)
        if change < TOLERANCE:
            settled = True
            break
        slower, faster = max(0.05, 0.6 * relaxation), min(1.0, 1.1 * relaxation)
        relaxation = slower if change > change_before else faster
        change_before = change
        stiffness = stiffness + relaxation * (wanted - stiffness)
    work, square = (np.zeros(2 * model.contact_shapes.shape[1]) for _ in range(2))
    work[rows] = stiffness * variance
    square[rows] = model.contact_weight[point] * variance
    total = np.sum(work[rows]) / np.sum(square[rows])
    pole = float(omega[0] / (2.0 * np.pi)), float(decay[0] / omega[0])
    return Linearisation(float(total), work.reshape(-1, 2), square.reshape(-1, 2), *pole, settled)


def power_in_band(
    stiffness: np.ndarray,
    damping: np.ndarray,
    outputs: np.ndarray,
    drive: np.ndarray,
    band_Hz: Sequence[float],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (power (output,) under a force of unit PSD in a band, omega, decay (mode,) in rad/s).

    The power is NaN if a mode is overdamped. The part of the damping matrix that couples the modes
    is neglected: it is of second order in the damping.

    stiffness (mode, mode) 1/s², damping (mode,) 1/s, outputs (mode, output), drive (mode,): on
        mass-orthonormal modes.
    """
    square, vectors = np.linalg.eigh(stiffness)
    decay = 0.5 * (vectors**2).T @ damping
    if np.any(square <= decay**2):
        return np.full(outputs.shape[1], np.nan), np.full(len(decay), np.nan), decay
    poles = -decay + 1j * np.sqrt(square - decay**2)
    gains = (outputs.T @ vectors) * (vectors.T @ drive)
    return band_power(poles, gains, band_Hz), np.sqrt(square), decay


def band_power(poles: np.ndarray, gains: np.ndarray, band_Hz: Sequence[float]) -> np.ndarray:
    """Return (output,) the integral over a band of |sum_r gains_r / (s - p_r)(s - p_r*)|².

    s = 2 pi i f, and the integral is over f in Hz. In partial fractions, with R_r the residue of
    the response H at p_r and B_r = R_r H(-p_r), |H|² = sum_r 2 Re[B_r/(s - p_r)] +
    2 Re[B_r/(-s - p_r)], which is integrated in closed form.

    poles: (mode,) rad/s with positive imaginary and negative real parts.
    gains: (output, mode).
    """
    residues = gains / (2j * poles.imag)
    negative = -poles[:, None]
    mirrored = np.sum(gains[:, None, :] / ((negative - poles) * (negative - poles.conj())), axis=-1)
    low, high = 2j * np.pi * np.asarray(band_Hz)
    forward = -1j * (np.log(high - poles) - np.log(low - poles))
    backward = 1j * (np.log(-high - poles) - np.log(-low - poles))
    return np.sum(2.0 * (residues * mirrored * (forward + backward)).real, axis=-1) / (2.0 * np.pi)
