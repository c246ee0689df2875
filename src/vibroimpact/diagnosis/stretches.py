"""The measured stretches that runs are held to: force and motion at the integration step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd

import numpy as np
from scipy import signal

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.output_filter import LEAST_STAGES, PASS_FRACTION
from vibroimpact.observation.sensed_motion import of_modes, orders
from vibroimpact.observation.signals import Signals

SLOWEST_HZ = 2000.0  # the records are compared at this rate at least, or their own
FADE_S = 1.0  # at the ends of a record, before its lines are integrated
LEAD_STEPS = 4000  # beyond the end of a stretch: the output filter looks ahead


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a record.

    record: its number. start_s: where it begins. gap: m; load: RMS of the first force of the
    record. force (step, force_channel): N; motion (step, channel): m as displacements, of channels
    that are not held 0; both from one step before the start on, in steps of the Schedule.
    noise (channel,): share of the noise in the motion, as power.
    """

    record: int
    start_s: float
    gap: float
    load: float
    force: np.ndarray
    motion: np.ndarray
    moving: np.ndarray


@dataclass(frozen=True)
class Rates:
    """Rates of the comparison: decimation of the records, steps per sample of theirs, in Hz."""

    decimation: int
    steps_per_sample: int  # of the decimated records
    sampling: float

    @property
    def steps_per_second(self) -> float:
        """Return the integration steps per second."""
        return self.sampling * self.steps_per_sample


def rates_of(sampling: float, integration: ConfigPart) -> Rates:
    """Return the Rates of records sampled at a frequency in Hz."""
    decimation = max(int(sampling / SLOWEST_HZ), 1)
    rate = sampling / decimation
    stages = max(LEAST_STAGES, int(np.ceil(integration.steps_per_second / (RATIO * rate))))
    return Rates(decimation, RATIO * stages, rate)


def held_band(signals: Signals, rates: Rates, first_mode_Hz: float) -> tuple[float, float]:
    """Return (low, high) in Hz of the band that motion is held in."""
    low = 0.6 * min(signals.band_Hz[0], first_mode_Hz)
    return max(low, 1.0), PASS_FRACTION * 0.5 * rates.sampling


def displacement(
    signals: Signals, record: int, band: tuple[float, float], rates: Rates, scale: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (force (step, force_channel) N, motion (step, channel) m) of a whole record.

    scale (channel,): displacement per unit of a channel's own displacement-like quantity.
    """
    valid = np.isfinite(signals.response[record]).all(axis=0)
    count = int(np.flatnonzero(valid)[-1] + 1) // rates.decimation * rates.decimation
    response, force = signals.response[record][:, :count], signals.force[record][:, :count]
    fade = np.ones(count)
    tail = min(int(FADE_S * signals.rate), count // 4)
    ramp = 0.5 * (1.0 + np.cos(np.pi * np.arange(tail) / tail))
    fade[-tail:] = ramp
    if not signals.from_rest:
        fade[:tail] = ramp[::-1]
    frequency = np.fft.rfftfreq(count, 1.0 / signals.rate)
    inside = (frequency >= band[0]) & (frequency <= band[1])
    omega = 2.0 * np.pi * np.where(inside, frequency, 1.0)
    held = of_modes(signals.kinds)
    lines = np.fft.rfft(response * fade * held[:, None], axis=-1)
    lines *= inside / (1j * omega) ** orders(signals.kinds)[:, None]
    up, down = rates.steps_per_sample, rates.decimation
    steps = count * up // down
    wide = np.zeros((len(lines), steps // 2 + 1), complex)
    kept = min(lines.shape[1], wide.shape[1])
    wide[:, :kept] = lines[:, :kept]
    motion = np.fft.irfft(wide, steps, axis=-1) * (steps / count) * scale[:, None]
    shared = gcd(up, down)
    fine = signal.resample_poly(force, up // shared, down // shared, axis=-1, padtype="line")
    return np.ascontiguousarray(fine[:, :steps].T), np.ascontiguousarray(motion.T)


def cut(
    whole: tuple[np.ndarray, np.ndarray], start_s: float, duration_s: float, rates: Rates
) -> tuple[np.ndarray, np.ndarray]:
    """Return (force, motion) of a stretch, zeros beyond the record's ends."""
    rate = rates.steps_per_second
    first = int(round(start_s * rates.sampling)) * rates.steps_per_sample - 1
    count = int(round(duration_s * rate)) + LEAD_STEPS
    out = []
    for values in whole:
        piece = np.zeros((count, values.shape[1]))
        begin, end = max(first, 0), min(first + count, len(values))
        piece[begin - first : end - first] = values[begin:end]
        out.append(piece)
    return out[0], out[1]


def schedule_of(rates: Rates, duration_s: float, scheme: str) -> Schedule:
    """Return the Schedule of a stretch."""
    return Schedule(rates.steps_per_second, rates.sampling, 0.0, duration_s, scheme)


def stretches_of(
    signals: Signals,
    places: Sequence[tuple[int, float]],
    duration_s: float,
    band: tuple[float, float],
    rates: Rates,
    scale: np.ndarray,
) -> list[Stretch]:
    """Return the Stretch of each (record, start in s) of `places`."""
    whole = {record: displacement(signals, record, band, rates, scale) for record, _ in places}
    out = []
    for record, start in places:
        force, motion = cut(whole[record], start, duration_s, rates)
        speed = np.diff(motion, axis=0).std(axis=0)
        gap = float(signals.gap[record])
        out.append(
            Stretch(
                record,
                start,
                gap if np.isfinite(gap) else 1.0,
                float(signals.load[record]),
                force,
                motion,
                speed > 0.02 * speed.max(),
            )
        )
    return out
