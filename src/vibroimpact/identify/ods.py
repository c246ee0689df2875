"""Shape identification: the stiffness whose linear tube has the operational deflection shape (ODS)
of the record.

The ODS is the first singular vector of the segment spectra over the band where the PSD is above
1/25 of its main peak (Thénint et al. 2012, §4.2). Departure from the paper: it is compared not with
the first mode's shape but with the linear tube's own ODS in the same band. In that band the other
modes still take a part in the motion; taken for a part of the first mode's shape it moves k by 1 to
16 % on exact spectra.

A shape carries no damping: c is not identified. The damping that the linear tube needs for its own
ODS (it sets how much the flanks of the band weigh against its top) is that of the width of the peak
that set the band.
"""

from dataclasses import dataclass

import numpy as np

# one-sigma error of a sensor's gain, from which the uncertainty of the model's shape follows
GAIN_ERROR = 0.02
STEP = 0.02  # of ln k, for derivatives
MATCH_STEPS = 12
LARGEST_CHANGE = 0.7  # of ln k in one step
SETTLED = 1.0e-4


@dataclass(frozen=True)
class DeflectionShape:
    """shape (line_point,) complex, of unit length; singular_values (value,) relative to the first;
    segment_shapes (segment, line_point) are the shapes of the record without one segment; band_Hz
    the band.
    """

    shape: np.ndarray
    singular_values: np.ndarray
    segment_shapes: np.ndarray
    band_Hz: tuple


@dataclass(frozen=True)
class ShapeMatch:
    """k (N/m) of the largest MAC, that MAC, model_error (relative, of 2 % sensor gains),
    segment_changes (segment,) of ln k when a segment is left out, damping_change of ln k when the
    peak's damping is one standard error higher; k_grid (k,) and mac_grid (k,): MAC with the first
    mode's shapes, as the paper has it.
    """

    k: float
    mac: float
    model_error: float
    segment_changes: np.ndarray
    damping_change: float
    k_grid: np.ndarray
    mac_grid: np.ndarray


def mac(shape, other):
    """Return the modal assurance criterion of two shapes (..., line_point): 1 when they differ by a
    complex factor only.
    """
    lengths = np.sum(np.abs(shape) ** 2, axis=-1) * np.sum(np.abs(other) ** 2, axis=-1)
    return np.abs(np.sum(shape.conj() * other, axis=-1)) ** 2 / np.maximum(
        lengths, np.finfo(float).tiny
    )


def deflection_shape(line_spectra, frequency, band_Hz):
    """Return the DeflectionShape of line_spectra (line_point, segment, frequency) over the bins of
    frequency (frequency,) in band_Hz.

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


def own_shape(response, part, k, c):
    """Return the linear tube's ODS (line_point,), of unit length, for support (k, c) over a part of
    the grid of its FamilyResponse.
    """
    motion = response.frf(k, c, part)
    return np.linalg.eigh(motion @ motion.conj().T)[1][:, -1]


def match_shape(measured, response, mode_shapes, member):
    """Return the ShapeMatch of a DeflectionShape with the family.

    response: FamilyResponse of the line's points on the spectra's bins; mode_shapes: (k (k,) N/m,
    first mode's shapes (k, line_point)), among which the search starts; member(ln k, errors = 0) ->
    (k in N/m, c in N s/m): the members compared, with about that k and the damping of the peak,
    plus so many of its standard errors. The best MAC is where the measured shape's part along the
    derivative of the member's shape vanishes: Gauss-Newton in ln k.
    """
    inside = (response.frequency >= measured.band_Hz[0]) & (
        response.frequency <= measured.band_Hz[1]
    )
    part = slice(int(np.argmax(inside)), int(inside.size - np.argmax(inside[::-1])))
    family = _Members(response, part, member)
    k_grid, shapes = mode_shapes
    macs = mac(measured.shape, shapes)
    limits = np.log(k_grid[[0, -1]])
    log_k = np.log(k_grid[np.argmax(macs)])
    for _ in range(MATCH_STEPS):
        middle, slope = family.shape_and_slope(log_k)
        strength = np.vdot(slope, slope).real
        change = np.vdot(slope, _aligned(measured.shape, middle)).real / strength
        ahead = float(np.clip(log_k + np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE), *limits))
        settled, log_k = abs(ahead - log_k) < SETTLED, ahead
        if settled:
            break
    shape = _aligned(measured.shape, middle)
    changes = (
        np.array(
            [
                np.vdot(slope, _aligned(other, shape) - shape).real
                for other in measured.segment_shapes
            ]
        )
        / strength
    )
    higher, lower = (
        _change_with_damping(family, member, log_k, errors, middle, slope, strength)
        for errors in (1.0, -1.0)
    )
    model_error = GAIN_ERROR * np.sqrt(np.sum(np.abs(slope * shape) ** 2)) / strength
    # The damping is as likely too high as too low, but k does not fall with the one as it rises
    # with the other: the mean is taken out.
    k = member(log_k)[0] * np.exp(-0.5 * (higher + lower))
    value = float(mac(measured.shape, middle))
    return ShapeMatch(
        float(k), value, float(model_error), changes, float(0.5 * (higher - lower)), k_grid, macs
    )


def _change_with_damping(family, member, log_k, errors, middle, slope, strength):
    """Return the change of ln k for the same measured shape when the peak's damping is so many
    standard errors higher.
    """
    moved = np.vdot(slope, _aligned(family.shape(log_k, errors), middle)).real / strength
    return np.log(abs(member(log_k, errors)[0] / member(log_k)[0])) - moved


class _Members:
    """The shapes of the members of the family over one band, by ln k."""

    def __init__(self, response, part, member):
        self._response, self._part, self._member = response, part, member

    def shape(self, log_k, errors=0.0):
        """Return the ODS (line_point,) of the member."""
        return own_shape(self._response, self._part, *self._member(log_k, errors))

    def shape_and_slope(self, log_k):
        """Return (ODS (line_point,) of the member, its derivative to ln k (line_point,) without the
        part along itself).
        """
        middle = self.shape(log_k)
        ends = [_aligned(self.shape(log_k + step), middle) for step in (-STEP, STEP)]
        low, high = (self._member(log_k + step)[0] for step in (-STEP, STEP))
        slope = (
            (ends[1] - ends[0]) / np.log(high / low)
            if low > 0.0
            else (ends[1] - ends[0]) / (2.0 * STEP)
        )
        return middle, slope - middle * np.vdot(middle, slope)


def _aligned(shape, other):
    """Return shape turned to the phase of other."""
    phase = np.vdot(shape, other)
    return shape * phase / np.abs(phase)
