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

import numpy as np
from scipy.fft import next_fast_len

from vibroimpact.reduction.modal_structure import IdentifiedModes
from vibroimpact.spectra.periodic_lines import LevelLines

HALF_WIDTH, ORDER = 4, 2  # lines on either side; degree of both polynomials
END_TERMS = 3  # of the polynomial in s that the ends of a record add to the free decay
FEWEST_LINES = 4 * (2 * HALF_WIDTH + 1)


def long_record_lines(
    name: str,
    split: str,
    force: np.ndarray,
    response: np.ndarray,
    sampling_frequency: float,
    modes: IdentifiedModes | None = None,
    band_Hz: tuple[float, float] = (0.0, np.inf),
) -> LevelLines:
    """Return LevelLines of one record without period: force (time,), response (channel, time), Hz;
    of its last samples, a length quick to transform.

    modes: known ones, whose free decay is the transient over a band; None for local polynomials.
    noise is the scatter about the local polynomials: noise and distortion. periods is 0. Raises
    ValueError for a record too short.
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
    if modes is not None:
        inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])
        part = frequency[inside], driven[inside], lines[:, inside]
        transient = np.zeros_like(lines)
        transient[:, inside] = _free_decay(modes, *part)
    return LevelLines(
        name,
        split,
        float(np.sqrt(np.mean(force[-size:] ** 2))),
        frequency,
        driven,
        lines - transient,
        np.zeros(frequency.size),
        scatter,
        0,
    )


def quick_length(size: int) -> int:
    """Return the largest number of samples up to size that is quick to transform."""
    return next(count for count in range(size, 0, -1) if next_fast_len(count, real=True) == count)


def _free_decay(modes, frequency, driven, lines):
    """Return (channel, line) the transient in lines (channel, line) under a force (line,).

    By channel, in least squares: the response is that of the modes to the force with residues of
    their own, and their free decay, (a + b s) / (s² + 2 zeta omega s + omega²) each, with a
    polynomial for what the ends of the record add.
    """
    laplace, receptance = 2j * np.pi * frequency, modes.receptance(frequency)
    ends = [(frequency / frequency[-1] * 1j) ** power for power in range(END_TERMS)]
    decay = np.concatenate([receptance, laplace * receptance, ends])
    out = np.empty_like(lines)
    for channel, observed in enumerate(modes.sensor_factors(frequency)):
        columns = np.concatenate([receptance * observed * driven, decay]).T
        columns /= np.linalg.norm(columns, axis=0)
        matrix = np.vstack([columns.real, columns.imag])
        wanted = np.concatenate([lines[channel].real, lines[channel].imag])
        values = np.linalg.lstsq(matrix, wanted, rcond=1.0e-10)[0]
        out[channel] = columns[:, modes.modes :] @ values[modes.modes :]
    return out


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
