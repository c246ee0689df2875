"""Periodic records by the lines of their spectrum: mean over periods, noise, and distortion.

A multisine repeats, and so does the steady response of a structure to it. The mean over periods is
the response at every line, without leakage or window. The scatter between periods is noise. A
response at lines that the force does not excite is distortion, which no linear structure makes.
Source: Pintelon and Schoukens, System Identification, 2nd ed. 2012, chapter 4.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

USUAL_PERIODS = (8192, 16384, 4096, 32768, 2048, 65536, 1024)  # samples, tried first
SHORTEST_PERIOD = 64  # samples
MOST_PERIODS = 200  # in one record
FRACTIONS = (2, 3, 5, 7)  # of a period, tried for a shorter one
# Largest relative difference of the force between two periods of a periodic record.
REPEATS = 0.05
EXCITED = 0.05  # of the largest line in the band; a line below it is not excited


class PeriodError(ValueError):
    """A record that is not periodic; the message states the periods tried and the remedy."""


@dataclass(frozen=True, eq=False)
class LevelLines:
    """One record of whole periods by its spectral lines.

    Amplitudes c belong to c exp(i omega t); the mean square of a signal is |c_0|² + 2 sum |c|².

    name: of the record.
    split: "fit" or "holdout".
    load_rms: RMS of the force.
    frequency: (line,) Hz from 0.
    force, response: (line,) and (channel, line), means over periods.
    noise: (channel, line), standard deviation of the mean response from the scatter between
        periods; NaN for a single period.
    periods: number of periods averaged.
    """

    name: str
    split: str
    load_rms: float
    frequency: np.ndarray
    force: np.ndarray
    response: np.ndarray
    noise: np.ndarray
    periods: int

    def inside(self, band_Hz: Sequence[float]) -> np.ndarray:
        """Return (line,) bool: the lines of a band, its ends included."""
        return (self.frequency >= band_Hz[0]) & (self.frequency <= band_Hz[1])

    def excited(self, band_Hz: Sequence[float]) -> np.ndarray:
        """Return (line,) bool: the lines of a band at which the force is not negligible.

        The mean (line 0) is left out.
        """
        inside = self.inside(band_Hz) & (self.frequency > 0.0)
        size = np.abs(self.force)
        return inside & (size > EXCITED * size[inside].max())

    def rms(self, band_Hz: Sequence[float]) -> np.ndarray:
        """Return (channel,) RMS of the mean response over a band."""
        return np.sqrt(line_power(self.response, self.frequency, self.inside(band_Hz)))


def line_power(lines: np.ndarray, frequency: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Return (...) the mean square that complex amplitudes (..., line) carry.

    frequency: (line,) Hz.
    inside: (line,) bool, the lines that count.
    """
    weight = np.where(frequency == 0.0, 1.0, 2.0) * inside
    return np.sum(weight * np.abs(lines) ** 2, axis=-1)


def level_lines(
    name: str,
    split: str,
    force: np.ndarray,
    response: np.ndarray,
    sampling_frequency: float,
    period_samples: int = 0,
    transient_periods: int = 1,
) -> LevelLines:
    """Return the LevelLines of one record.

    Whole periods are counted from the end of the record.

    name, split: see LevelLines.
    force, response: (time,) and (channel, time).
    sampling_frequency: Hz.
    period_samples: length of a period; 0 for find_period.
    transient_periods: periods left out at the start, as far as one remains.

    Raises PeriodError.
    """
    period = period_samples or find_period(force, name)
    count = force.size // period
    if count == 0:
        raise PeriodError(f"{name}: {force.size} samples are less than a period of {period}")
    drop = min(transient_periods, count - 1)
    cut = slice(force.size - (count - drop) * period, force.size)
    driven = np.fft.rfft(force[cut].reshape(-1, period), axis=-1) / period
    lines = np.fft.rfft(response[:, cut].reshape(len(response), -1, period), axis=-1) / period
    return LevelLines(
        name=name,
        split=split,
        load_rms=float(np.sqrt(np.mean(force[cut] ** 2))),
        frequency=np.fft.rfftfreq(period, 1.0 / sampling_frequency),
        force=driven.mean(axis=0),
        response=lines.mean(axis=1),
        noise=_scatter(lines),
        periods=count - drop,
    )


def find_period(force: np.ndarray, name: str = "record") -> int:
    """Return the number of samples after which the force (time,) repeats.

    Usual lengths are tried first, then whole fractions of the record, then any length. A record of
    exactly one period of a usual length counts as periodic. Raises PeriodError.
    """
    fractions = [force.size // count for count in range(20, 1, -1) if force.size % count == 0]
    for period in (*USUAL_PERIODS, *fractions):
        if 2 * period <= force.size and _repeats(force, period):
            return _shortest(force, period)
    likely = _likeliest_lag(force)
    if likely and _repeats(force, likely):
        return _shortest(force, likely)
    if force.size in USUAL_PERIODS:
        return force.size
    raise PeriodError(
        f"{name}: the force does not repeat within {force.size} samples: give the number of samples"
        " of a period, or use the methods for records without period"
    )


def _likeliest_lag(force: np.ndarray) -> int:
    """Return the lag in samples, up to half the length, of the force's largest autocorrelation.

    It is 0 for a force that is too short or constant.
    """
    shortest = max(SHORTEST_PERIOD, force.size // MOST_PERIODS)
    if force.size < 2 * shortest + 2 or np.ptp(force) == 0.0:
        return 0
    centred = force - force.mean()
    power = np.abs(np.fft.rfft(centred, 2 * force.size)) ** 2
    correlation = np.fft.irfft(power)[: force.size // 2 + 1]
    overlap = np.arange(force.size, force.size - correlation.size, -1)
    correlation /= overlap
    return shortest + int(np.argmax(correlation[shortest:]))


def _shortest(force: np.ndarray, period: int) -> int:
    """Return the shortest whole fraction of a period after which the force repeats as well."""
    for count in FRACTIONS:
        while period % count == 0 and period // count >= SHORTEST_PERIOD:
            if not _repeats(force, period // count):
                break
            period //= count
    return period


def _repeats(force: np.ndarray, period: int) -> bool:
    """Return True when the last two periods of the force agree and are not zero."""
    last, before = force[-period:], force[-2 * period : -period]
    return np.ptp(last) > 0.0 and np.std(last - before) < REPEATS * np.std(last)


def _scatter(lines: np.ndarray) -> np.ndarray:
    """Return (channel, line) the standard deviation of the mean of lines (channel, period, line).

    It is NaN for one period.
    """
    count = lines.shape[1]
    if count < 2:
        return np.full(lines[:, 0].shape, np.nan)
    return np.sqrt(np.var(lines, axis=1, ddof=1) / count)
