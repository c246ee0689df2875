"""Shape identification: the stiffness whose linear tube has the measured deflection shape.

The operational deflection shape (ODS) is the first singular vector of the segment spectra over the
band where the PSD is above 1/25 of its main peak (Thénint et al. 2012, section 4.2).

Departure from the paper: it is compared not with the shape of the first mode but with the linear
tube's own ODS in the same band. Other modes take part in the motion of that band. Ascribed to the
first mode they change k by 1 to 16 % on exact spectra.

A shape carries no damping, so c is not identified. The linear tube's ODS needs a damping, which
weighs the flanks of the band against its top. It is that of the width of the peak that set the
band.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.family import FamilyResponse

# Relative standard error of a sensor's gain. The uncertainty of the model's shape follows from it.
GAIN_ERROR = 0.02
STEP = 0.02  # of ln k, for derivatives
MATCH_STEPS = 12
LARGEST_CHANGE = 0.7  # of ln k in one step
SETTLED = 1.0e-4


@dataclass(frozen=True)
class DeflectionShape:
    """The operational deflection shape of a record.

    shape: (line_point,) complex, of unit length.
    singular_values: (value,) relative to the first.
    segment_shapes: (segment, line_point), shapes of the record without one segment.
    band_Hz: the band.
    """

    shape: np.ndarray
    singular_values: np.ndarray
    segment_shapes: np.ndarray
    band_Hz: tuple


@dataclass(frozen=True)
class ShapeMatch:
    """The member of the family whose ODS agrees best.

    k: N/m, of the largest MAC.
    mac: that MAC.
    model_error: relative standard error of k for sensor gains with an error of GAIN_ERROR.
    segment_changes: (segment,) change of ln k when a segment is left out.
    damping_change: change of ln k when the peak's damping is one standard error higher.
    k_grid, mac_grid: (k,) MAC with the first mode's shapes, as in the paper.
    """

    k: float
    mac: float
    model_error: float
    segment_changes: np.ndarray
    damping_change: float
    k_grid: np.ndarray
    mac_grid: np.ndarray


def mac(shape: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the modal assurance criterion of shapes (..., line_point).

    It is 1 when they differ by a complex factor only.
    """
    lengths = np.sum(np.abs(shape) ** 2, axis=-1) * np.sum(np.abs(other) ** 2, axis=-1)
    return np.abs(np.sum(shape.conj() * other, axis=-1)) ** 2 / np.maximum(
        lengths, np.finfo(float).tiny
    )


def deflection_shape(
    line_spectra: np.ndarray, frequency: np.ndarray, band_Hz: Sequence[float]
) -> DeflectionShape:
    """Return the DeflectionShape over the bins of a band.

    line_spectra: (line_point, segment, frequency).
    frequency: (frequency,) Hz.

    Raises ValueError when the band holds no bin.
    """
    inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
    if not inside.any():
        raise ValueError(
            f"no bin of the shape line's spectra between {band_Hz[0]:.2f} and {band_Hz[1]:.2f} Hz"
        )
    part = line_spectra[:, :, inside].astype(complex)
    grams = np.einsum("asf,bsf->sab", part, part.conj(), optimize=True)
    values, vectors = np.linalg.eigh(grams.sum(axis=0))
    without = np.linalg.eigh(grams.sum(axis=0) - grams)[1][:, :, -1]
    singular = np.sqrt(np.maximum(values[::-1], 0.0))
    return DeflectionShape(vectors[:, -1], singular / singular[0], without, tuple(band_Hz))


def linear_ods(response: FamilyResponse, k: float, c: float) -> np.ndarray:
    """Return the ODS (line_point,) of the linear tube with support (k, c), of unit length.

    response: FamilyResponse of the line's points over the band.
    """
    motion = response.frf(k, c)
    return np.linalg.eigh((motion @ motion.conj().swapaxes(1, 2)).sum(axis=0))[1][:, -1]


def match_shape(
    measured: DeflectionShape,
    response: FamilyResponse,
    mode_shapes: tuple[np.ndarray, np.ndarray],
    member: Callable[..., tuple[float, float]],
) -> ShapeMatch:
    """Return the ShapeMatch of a DeflectionShape with the family.

    The MAC is largest if the part of the measured shape along the derivative of the member's
    shape vanishes: Gauss-Newton in ln k.

    response: FamilyResponse of the line's points on the bins of the spectra.
    mode_shapes: (k (k,) N/m, the first mode's shapes (k, line_point)), at which the search starts.
    member: function (ln k, errors = 0) -> (k in N/m, c in N s/m) of the member with about that k
        and the damping of the peak, plus `errors` of its standard errors.
    """
    low, high = measured.band_Hz
    inside = (response.frequency >= low) & (response.frequency <= high)
    first, after = int(np.argmax(inside)), int(inside.size - np.argmax(inside[::-1]))
    response = response.of(slice(first, after))
    k_grid, shapes = mode_shapes
    macs = mac(measured.shape, shapes)
    limits = np.log(k_grid[[0, -1]])
    log_k = np.log(k_grid[np.argmax(macs)])
    for _ in range(MATCH_STEPS):
        middle, slope = _shape_and_slope(response, member, log_k)
        strength = np.vdot(slope, slope).real
        change = np.vdot(slope, _phase_aligned(measured.shape, middle)).real / strength
        step = np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE)
        before, log_k = log_k, float(np.clip(log_k + step, *limits))
        if abs(log_k - before) < SETTLED:
            break
    shape = _phase_aligned(measured.shape, middle)
    pulls = [
        np.vdot(slope, _phase_aligned(other, shape) - shape).real
        for other in measured.segment_shapes
    ]
    changes = np.array(pulls) / strength

    def change_with_damping(errors: float) -> float:
        """Return the change of ln k when the peak's damping is `errors` standard errors higher."""
        moved = _phase_aligned(linear_ods(response, *member(log_k, errors)), middle)
        moved_k = np.vdot(slope, moved).real / strength
        return float(np.log(abs(member(log_k, errors)[0] / member(log_k)[0])) - moved_k)

    higher, lower = change_with_damping(1.0), change_with_damping(-1.0)
    model_error = GAIN_ERROR * np.sqrt(np.sum(np.abs(slope * shape) ** 2)) / strength
    # The damping is as likely too high as too low, but k does not respond to both alike: the mean
    # of the two changes is removed.
    k = member(log_k)[0] * np.exp(-0.5 * (higher + lower))
    return ShapeMatch(
        k=float(k),
        mac=float(mac(measured.shape, middle)),
        model_error=float(model_error),
        segment_changes=changes,
        damping_change=float(0.5 * (higher - lower)),
        k_grid=k_grid,
        mac_grid=macs,
    )


def _shape_and_slope(
    response: FamilyResponse, member: Callable[..., tuple[float, float]], log_k: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return (ODS (line_point,) of a member, its derivative by ln k (line_point,)).

    The derivative has no part along the shape itself.
    """
    middle = linear_ods(response, *member(log_k))
    below, above = member(log_k - STEP), member(log_k + STEP)
    ends = [_phase_aligned(linear_ods(response, *end), middle) for end in (below, above)]
    width = np.log(above[0] / below[0]) if below[0] > 0.0 else 2.0 * STEP
    slope = (ends[1] - ends[0]) / width
    return middle, slope - middle * np.vdot(middle, slope)


def _phase_aligned(shape: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return a shape in the phase of another."""
    phase = np.vdot(shape, other)
    return shape * phase / np.abs(phase)
