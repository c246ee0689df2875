"""The measured stretches that runs are held to: force and motion at the integration step."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd

import numpy as np
from scipy import signal

from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.output_filter import LEAST_STAGES, PASS_FRACTION

from .sensed_motion import of_modes, orders
from .signals import Signals

FADE_S = 1.0  # at the ends of a record, before it is integrated
AHEAD = 400  # samples beyond the end of a stretch; the output filter needs 37
MOVING = 0.02  # of the speed of the sensor that moves most
NO_GAP_M = 1.0  # if a record has no clearance


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a record.

    record: its number. start_s: its start. gap: m. load: RMS of the record's first force.
    force (step, force_channel): N. motion (step, channel): m, as displacements; 0 of channels that
    measure no motion. Both begin one step before the start, in steps of the Schedule.
    moving (channel,) bool: whether a channel moves there. hold: of the strength of the dampers.
    error (channel, band): N², of the lines of a right model, see bench.with_model_error.
    """

    record: int
    start_s: float
    gap: float
    load: float
    force: np.ndarray
    motion: np.ndarray
    moving: np.ndarray
    hold: float = 1.0
    error: np.ndarray | float = 0.0


@dataclass(frozen=True)
class Rates:
    """Rates of the comparison: decimation of the records, sampling after it in Hz, and integration
    steps per sample.
    """

    decimation: int
    sampling: float
    steps_per_sample: int

    @property
    def steps_per_second(self) -> float:
        """Return the integration steps per second."""
        return self.sampling * self.steps_per_sample

    def schedule(self, duration_s: float, scheme: str, start_up_s: float = 0.0) -> Schedule:
        """Return the Schedule of a stretch, recorded from the end of its start-up on."""
        return Schedule(self.steps_per_second, self.sampling, start_up_s, duration_s, scheme)


def rates_of(
    sampling: float, steps_per_second: float, decimation: int = 1, stages: int = LEAST_STAGES
) -> Rates:
    """Return the Rates of records sampled at a frequency in Hz before decimation, with at least a
    number of integration steps per second. stages: of the output filter's decimation at least.
    """
    own = sampling / decimation
    stages = max(int(np.ceil(steps_per_second / (RATIO * own))), stages)
    return Rates(decimation, own, RATIO * stages)


def held_band(signals: Signals, rates: Rates, first_mode_Hz: float) -> tuple[float, float]:
    """Return (low, high) in Hz of the band in which motion is held: from below the first mode and
    the force to the anti-alias filter of the runs.
    """
    low = 0.6 * min(signals.band_Hz[0], first_mode_Hz)
    return max(low, 1.0), PASS_FRACTION * 0.5 * rates.sampling


def stretches_of(
    signals: Signals,
    places: Sequence[tuple[int, float]],
    duration_s: float,
    band: tuple[float, float],
    rates: Rates,
    scale: np.ndarray,
) -> list[Stretch]:
    """Return the Stretch at each (record, start in s) of `places`; band: of held_band, scale
    (channel,): of displacement_scale.
    """
    records = dict.fromkeys(record for record, _ in places)
    whole = {record: _fine(signals, record, band, rates, scale) for record in records}
    out = []
    for record, start in places:
        force, motion = (_cut(values, start, duration_s, rates) for values in whole[record])
        speed = np.diff(motion, axis=0).std(axis=0)
        moving = of_modes(signals.kinds) & (speed > MOVING * speed.max(initial=0.0))
        gap, load = float(signals.gap[record]), float(signals.load[record])
        gap = gap if np.isfinite(gap) else NO_GAP_M
        out.append(Stretch(int(record), float(start), gap, load, force, motion, moving))
    return out


def valid_samples(signals: Signals, record: int) -> int:
    """Return the number of samples of a record before the first that is missing."""
    valid = np.isfinite(signals.response[record]).all(axis=0)
    return int(np.argmin(valid)) if not valid.all() else valid.size


def _fine(signals, record, band, rates, scale):
    """Return (force (step, force_channel), motion (step, channel)) of a record at the step."""
    count = valid_samples(signals, record) // rates.decimation * rates.decimation
    response, force = signals.response[record][:, :count], signals.force[record][:, :count]
    frequency = np.fft.rfftfreq(count, 1.0 / signals.rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    omega = 2.0 * np.pi * np.where(inside, frequency, 1.0)
    held = of_modes(signals.kinds)[:, None]
    lines = np.fft.rfft(response * _fade(signals, count) * held, axis=-1)
    lines *= inside / (1j * omega) ** orders(signals.kinds)[:, None]
    up, down = rates.steps_per_sample, rates.decimation
    steps = count * up // down
    kept = min(lines.shape[1], steps // 2 + 1)
    motion = np.fft.irfft(lines[:, :kept], steps, axis=-1) * (steps / count) * scale[:, None]
    shared = gcd(up, down)
    fine = signal.resample_poly(force, up // shared, down // shared, axis=-1, padtype="line")
    return np.ascontiguousarray(fine[:, :steps].T), np.ascontiguousarray(motion.T)


def _fade(signals, count):
    """Return (sample,) the window of a record: whole at a start from rest."""
    fade, tail = np.ones(count), min(int(FADE_S * signals.rate), count // 4)
    ramp = 0.5 * (1.0 + np.cos(np.pi * np.arange(tail) / max(tail, 1)))
    fade[count - tail :] = ramp
    if not signals.from_rest:
        fade[:tail] = ramp[::-1]
    return fade


def _cut(values, start_s, duration_s, rates):
    """Return (step, channel) of a stretch of values (step, channel), 0 beyond the record's ends."""
    first = round(start_s * rates.sampling) * rates.steps_per_sample - 1
    count = round(duration_s * rates.steps_per_second) + AHEAD * rates.steps_per_sample
    piece = np.zeros((count, values.shape[1]))
    begin, end = max(first, 0), min(first + count, len(values))
    piece[begin - first : end - first] = values[begin:end]
    return piece
