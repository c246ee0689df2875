"""Records without period by their lines: what is left of the response when the transient at both
ends of the record is taken away.

Of a record of finite length Y = G F + T + noise at its lines, F and Y the transforms of force and
response, G the response per force and T what motion before the record and motion left at its end
add: as smooth a function of frequency as G. Both are fitted as polynomials over a few lines on
either side and T is taken away: Y - T is the response to the force repeated for ever, and the
record is one period of it. Once modes are known T is fitted again, as the free decay of these modes
over the whole band, which a few lines at a sharp resonance do not tell. Source: Pintelon,
Schoukens, System Identification, 2nd ed. 2012, section 7.2 (local polynomial method). Departure: a
response that is not linear has a transient that the force decides as well; it stays as distortion,
the smaller the longer the record is.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.fft import next_fast_len

from vibroimpact.reduction.modal_structure import IdentifiedModes
from vibroimpact.spectra.periodic_lines import LevelLines

HALF_WIDTH, ORDER = 4, 2  # lines on either side; degree of both polynomials
FEWEST_LINES = 4 * (2 * HALF_WIDTH + 1)
END_TERMS = 3  # of the polynomial in s


def long_record_lines(
    name: str,
    split: str,
    force: np.ndarray,
    response: np.ndarray,
    sampling_frequency: float,
    settled: bool = False,
) -> LevelLines:
    """Return LevelLines of one record without period: force (time,), response (channel, time), Hz;
    of its last samples, a length quick to transform.

    settled: the transient has been taken away already (settled_response). noise is the scatter
    about the local polynomials: noise and distortion. periods is 0. Raises ValueError for a record
    too short.
    """
    size = quick_length(force.size)
    if size < 2 * FEWEST_LINES:
        raise ValueError(
            f"{name}: {force.size} samples are too short for a record without period:"
            f" {2 * FEWEST_LINES} are the least"
        )
    driven = np.fft.rfft(force[-size:] - force[-size:].mean()) / size
    lines = np.fft.rfft(response[:, -size:], axis=-1) / size
    transient, scatter = _local_polynomials(driven, lines)
    frequency = np.fft.rfftfreq(size, 1.0 / sampling_frequency)
    lines = lines if settled else lines - transient
    return LevelLines(
        name,
        split,
        float(np.sqrt(np.mean(force[-size:] ** 2))),
        frequency,
        driven,
        lines,
        np.zeros(frequency.size),
        scatter,
        0,
    )


def settled_response(
    force: np.ndarray,
    response: np.ndarray,
    sampling_frequency: float,
    modes: IdentifiedModes,
    band_Hz: Sequence[float],
) -> np.ndarray:
    """Return (channel, time) the response to the force repeated for ever, over the lines of a band:
    force (time,), response (channel, time).

    By channel, in least squares: the response is that of the modes (IdentifiedModes) to the force
    with residues of their own, and the modes' free decay, (a + b s) / (s² + 2 zeta omega s +
    omega²) each, with a polynomial for what the ends of the record add.
    """
    size = force.size
    frequency = np.fft.rfftfreq(size, 1.0 / sampling_frequency)
    driven, lines = np.fft.rfft(force - force.mean()) / size, np.fft.rfft(response, axis=-1) / size
    inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
    laplace, receptance = 2j * np.pi * frequency[inside], modes.receptance(frequency[inside])
    ends = laplace / (2.0 * np.pi * band_Hz[1])
    decay = np.concatenate(
        [receptance, laplace * receptance, [ends**power for power in range(END_TERMS)]]
    )
    for channel, observed in enumerate(modes.sensor_factors(frequency[inside])):
        columns = np.concatenate([receptance * observed * driven[inside], decay]).T
        scale = np.linalg.norm(columns, axis=0)
        parts, wanted = columns / scale, lines[channel, inside]
        values = np.linalg.lstsq(
            np.vstack([parts.real, parts.imag]),
            np.concatenate([wanted.real, wanted.imag]),
            rcond=1.0e-10,
        )[0]
        lines[channel, inside] -= parts[:, modes.modes :] @ values[modes.modes :]
    return np.fft.irfft(lines * size, size)


def quick_length(size: int) -> int:
    """Return the largest number of samples up to size that is quick to transform."""
    return next(count for count in range(size, 0, -1) if next_fast_len(count, real=True) == count)


def _local_polynomials(driven, lines):
    """Return (transient (channel, line), scatter (channel, line)) of lines (channel, line) under a
    force (line,), line by line.
    """
    count, width = driven.size, 2 * HALF_WIDTH + 1
    first = np.clip(
        np.arange(count) - HALF_WIDTH, 0, count - width
    )  # at the ends the stretch is not centred
    rows = first[:, None] + np.arange(width)
    away = (rows - np.arange(count)[:, None]) / HALF_WIDTH
    powers = away[:, :, None] ** np.arange(ORDER + 1)
    columns = np.concatenate([powers * driven[rows][:, :, None], powers.astype(complex)], axis=2)
    size = np.maximum(np.linalg.norm(columns, axis=1, keepdims=True), np.finfo(float).tiny)
    wanted = lines.T[rows]  # (line, stretch, channel)
    inverse = np.linalg.pinv(columns / size, rcond=1.0e-8)
    values = inverse @ wanted
    rest = wanted - (columns / size) @ values
    scatter = np.sqrt(np.sum(np.abs(rest) ** 2, axis=1) / (width - 2 * (ORDER + 1)))
    return (values[:, ORDER + 1] / size[:, 0, ORDER + 1][:, None]).T, scatter.T
