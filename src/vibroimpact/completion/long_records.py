"""Records without period by their lines: what is left of the response when the transient at both ends of the record is taken away.

Of a record of finite length Y = G F + T + noise at its lines, F and Y the transforms of force and response, G the response per force and T
what motion before the record and motion left at its end add: as smooth a function of frequency as G. Both are fitted as polynomials over a
few lines on either side and T is taken away: Y - T is the response to the force repeated for ever, and the record is one period of it.
Source: Pintelon, Schoukens, System Identification, 2nd ed. 2012, section 7.2 (local polynomial method). Departure: a response that is not
linear has a transient that the force decides as well; it stays as distortion, the smaller the longer the record is.
"""

import numpy as np
from scipy.fft import next_fast_len
from scipy.signal import coherence

from vibroimpact.multisine import LevelLines

HALF_WIDTH, ORDER = 7, 2  # lines on either side; degree of both polynomials
FEWEST_LINES = 4 * (2 * HALF_WIDTH + 1)
SEGMENTS = 12  # of the coherence


def long_record_lines(name, split, force, response, sampling_frequency, longest=None):
    """Return LevelLines of one record without period, its last `longest` samples: force (time,), response (channel, time), Hz.

    noise is the scatter about the local polynomials: noise and distortion. periods is 0. Raises ValueError for a record too short.
    """
    size = min(force.size, longest or force.size)
    size = size if next_fast_len(size, real=True) == size else _fast_below(size)
    if size < 2 * FEWEST_LINES:
        raise ValueError(f"{name}: {force.size} samples are too short for a record without period: {2 * FEWEST_LINES} are the least")
    driven = np.fft.rfft(force[-size:] - force[-size:].mean()) / size
    lines = np.fft.rfft(response[:, -size:], axis=-1) / size
    transient, scatter = _local_polynomials(driven, lines)
    frequency = np.fft.rfftfreq(size, 1.0 / sampling_frequency)
    return LevelLines(name, split, float(np.sqrt(np.mean(force[-size:] ** 2))), frequency, driven, lines - transient, np.zeros(frequency.size), scatter, 0)


def mean_coherences(force, response, sampling_frequency, band_Hz):
    """Return (channel,) mean coherence of force (time,) and response (channel, time) over a band, by Welch's method with Hann windows."""
    size = int(2 * force.size / (SEGMENTS + 1))
    frequency, values = coherence(force, response, sampling_frequency, nperseg=size)
    return values[:, (frequency >= band_Hz[0]) & (frequency <= band_Hz[1])].mean(axis=-1)


def _fast_below(size):
    return next(count for count in range(size, 0, -1) if next_fast_len(count, real=True) == count)


def _local_polynomials(driven, lines):
    """Return (transient (channel, line), scatter (channel, line)) of lines (channel, line) under a force (line,), line by line."""
    count, width = driven.size, 2 * HALF_WIDTH + 1
    first = np.clip(np.arange(count) - HALF_WIDTH, 0, count - width)  # at the ends the stretch is not centred
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
