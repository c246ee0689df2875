"""Periodic records by their lines: the mean over periods, the scatter between them, and what no
linear structure can make.

A multisine repeats, and so does the steady response of a structure to it. The mean over periods is
the response at every line of the spectrum without leakage or window; the scatter between periods is
noise; what is left at lines that the force does not excite, or as scatter of the response per force
from line to line, is distortion. Source: Pintelon, Schoukens, System Identification, 2nd ed. 2012,
ch. 4.
"""

from dataclasses import dataclass

import numpy as np

USUAL_PERIODS = (8192, 16384, 4096, 32768, 2048, 65536, 1024)  # samples, tried first
SHORTEST_PERIOD, MOST_PERIODS = 64, 200  # samples; in one record
FRACTIONS = (2, 3, 5, 7)  # of a period that are tried for a shorter one
# relative difference of the force between periods, at most, for the record to be called periodic
REPEATS = 0.05
EXCITED = 0.05  # of the largest line in the band: a line below it is not excited


class PeriodError(ValueError):
    """A record that is not periodic; the message says what was tried and the remedy."""


@dataclass(frozen=True, eq=False)
class LevelLines:
    """One record of whole periods by its lines: name, split ("fit" or "holdout"), load_rms of the
    force; frequency (line,) Hz from 0.

    force (line,) and response (channel, line): complex amplitudes c of c exp(i omega t), the mean
    square of a signal being |c_0|² + 2 sum
    |c|²; force_noise (line,) and noise (channel, line): standard deviation of those means, from the
    scatter between periods (NaN where
    there is one period only); periods: how many were averaged.
    """

    name: str
    split: str
    load_rms: float
    frequency: np.ndarray
    force: np.ndarray
    response: np.ndarray
    force_noise: np.ndarray
    noise: np.ndarray
    periods: int

    def inside(self, band_Hz):
        """Return (line,) bool: the lines of a band, its ends included."""
        return (self.frequency >= band_Hz[0]) & (self.frequency <= band_Hz[1])

    def excited(self, band_Hz):
        """Return (line,) bool: the lines of a band, the mean left out, at which the force is not
        negligible.
        """
        inside = self.inside(band_Hz) & (self.frequency > 0.0)
        size = np.abs(self.force)
        return inside & (size > EXCITED * size[inside].max())

    def rms(self, band_Hz):
        """Return (channel,) RMS of the mean response over a band."""
        return np.sqrt(line_power(self.response, self.frequency, self.inside(band_Hz)))


def line_power(lines, frequency, inside):
    """Return (...) mean square carried by complex line amplitudes (..., line) at the lines `inside`
    (line,).
    """
    weight = np.where(frequency == 0.0, 1.0, 2.0) * inside
    return np.sum(weight * np.abs(lines) ** 2, axis=-1)


def level_lines(
    name, split, force, response, sampling_frequency, period_samples=0, transient_periods=1
):
    """Return the LevelLines of one record: force (time,), response (channel, time),
    sampling_frequency Hz.

    period_samples: 0 to find it (find_period). Whole periods are counted from the end; the first
    transient_periods are left out as far as one period remains. Raises PeriodError.
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
        name,
        split,
        float(np.sqrt(np.mean(force[cut] ** 2))),
        np.fft.rfftfreq(period, 1.0 / sampling_frequency),
        driven.mean(axis=0),
        lines.mean(axis=1),
        _scatter(driven, 0),
        _scatter(lines, 1),
        count - drop,
    )


def find_period(force, name="record"):
    """Return the number of samples after which the force (time,) repeats: of the usual ones, the
    whole fractions of its length, then any.

    A record shorter than two periods of a usual length that is exactly that long counts as one
    period. Raises PeriodError.
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


def _likeliest_lag(force):
    """The lag in samples at which the force agrees best with itself, up to half its length; 0 for a
    force too short or constant.
    """
    shortest = max(SHORTEST_PERIOD, force.size // MOST_PERIODS)
    if force.size < 2 * shortest + 2 or np.ptp(force) == 0.0:
        return 0
    centred = force - force.mean()
    likeness = np.fft.irfft(np.abs(np.fft.rfft(centred, 2 * force.size)) ** 2)[
        : force.size // 2 + 1
    ]
    likeness /= np.arange(
        force.size, force.size - likeness.size, -1
    )  # by the number of samples that overlap
    return shortest + int(np.argmax(likeness[shortest:]))


def _shortest(force, period):
    """The shortest whole fraction of a period after which the force repeats as well."""
    for count in FRACTIONS:
        while (
            period % count == 0
            and period // count >= SHORTEST_PERIOD
            and _repeats(force, period // count)
        ):
            period //= count
    return period


def _repeats(force, period):
    """Whether the last two periods of the force agree, and are not both nothing."""
    last, before = force[-period:], force[-2 * period : -period]
    return np.ptp(last) > 0.0 and np.std(last - before) < REPEATS * np.std(last)


def _scatter(lines, axis):
    """Standard deviation of the mean over periods along an axis; NaN for one period."""
    count = lines.shape[axis]
    if count < 2:
        return np.full(np.delete(lines.shape, axis), np.nan)
    return np.sqrt(np.var(lines, axis=axis, ddof=1) / count)


def distortion(level, band_Hz):
    """Return what lines without force tell of the nonlinearity, {name: value or sentence}.

    excited_lines; detection_lines: lines of the band without force; odd_fraction and even_fraction
    (channel,): RMS at odd and at even detection lines over the RMS at excited lines, noise taken
    off. `told` is a sentence.
    """
    inside, excited = level.inside(band_Hz) & (level.frequency > 0.0), level.excited(band_Hz)
    number, silent = np.arange(level.frequency.size), inside & ~excited
    reference = np.sqrt(line_power(level.response, level.frequency, excited))
    found = {"excited_lines": int(excited.sum()), "detection_lines": int(silent.sum())}
    if silent.sum() < 4:
        return found | {
            "told": (
                "every line of the band is excited: distortion can not be told from the linear"
                " response line by line; the scatter of the response per force about a fitted curve"
                " bounds it"
            )
        }
    for name, parity in (("odd_fraction", 1), ("even_fraction", 0)):
        lines = silent & (number % 2 == parity)
        power = line_power(level.response, level.frequency, lines) - line_power(
            np.nan_to_num(level.noise), level.frequency, lines
        )
        found[name] = (
            (np.sqrt(np.maximum(power, 0.0)) / reference).tolist() if lines.any() else None
        )
    return found | {
        "told": (
            "distortion read at the lines that the force leaves out: odd ones from odd, even ones"
            " from even nonlinearities"
        )
    }
