"""Points held to measured stretches: the lines of the holding force, and their power."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import fft

from vibroimpact.config.problems import ConfigError
from vibroimpact.diagnosis.run_cost import count_simulated
from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.held_run import HeldLane, hold
from vibroimpact.integration.preload import OUT_OF_REACH_M
from vibroimpact.reduction.modal_model import ModalModel

from .constants import FORGET_S, INDEPENDENT, MODEL_ERROR
from .explanations import Point, Structure
from .measurement.sensor_chain import Measuring
from .measurement.stretches import Stretch

BANDS = 18  # logarithmic, of a stretch's lines; each has a level of its own
FIRST_BAND = 4  # lines in the lowest
NUDGE, LOST = 1.0e-7, 1.0e-6  # relative change of frequencies; of the power of a held channel
END_S = 0.3  # of a run: before its end


@dataclass(frozen=True, eq=False)
class Bench:
    """The common ground of a comparison of Points: stretches, their Schedule, the band of the lines
    in Hz, and the strength of the dampers in N s/m. Modes above held_below_Hz are not held.
    """

    structure: Structure
    stretches: tuple[Stretch, ...]
    schedule: Schedule
    band: tuple[float, float]
    strength: float
    threads: int = 1
    held_below_Hz: float = np.inf

    def on(self, stretches: slice) -> Bench:
        """Return the Bench with some of its stretches."""
        return replace(self, stretches=self.stretches[stretches])

    @cached_property
    def measures_motion(self) -> np.ndarray:
        """Return (channel,) bool: which channels measure a motion, so that they can be held."""
        return np.any([np.any(stretch.motion, axis=0) for stretch in self.stretches], axis=0)

    @property
    def moving(self) -> np.ndarray:
        """Return (stretch, channel, 1) bool: which channels move there."""
        return np.stack([stretch.moving for stretch in self.stretches])[..., None]


def _runs(bench: Bench, points: Sequence[Point]) -> tuple[list[HeldLane], np.ndarray]:
    """Return (runs, (point, stretch) number of the run among them, -1 if the values of a Point make
    no model).
    """
    runs: list[HeldLane] = []
    index = np.full((len(points), len(bench.stretches)), -1)
    for number, point in enumerate(points):
        try:
            model, chain = bench.structure.held_model(point), bench.structure.measuring(point)
        except (ConfigError, ValueError):
            continue
        for place, stretch in enumerate(bench.stretches):
            index[number, place] = len(runs)
            runs.append(lane_of(bench, stretch, model, chain))
    return runs, index


def lane_of(
    bench: Bench, stretch: Stretch, model: ModalModel, chain: Measuring, free: Sequence[int] = ()
) -> HeldLane:
    """Return the run of a model, as a Measuring chain sees it, on a stretch; free: channels without
    a damper.
    """
    strength = np.where(bench.measures_motion, stretch.hold * bench.strength, 0.0)
    strength[list(free)] = 0.0
    return HeldLane(
        model,
        stretch.gap,
        stretch.force,
        undelayed(stretch.motion, chain.delay, bench.schedule.steps_per_second),
        strength,
        1.0 / chain.gain,
        1.0 / chain.force_gain,
    )


def settled(bench: Bench) -> np.ndarray:
    """Return (sample,) numbers of the samples of a run between its unknown start and its end, near
    which a filter knows less.
    """
    rate = bench.schedule.sampling_frequency
    return np.arange(round(FORGET_S * rate), bench.schedule.samples - round(END_S * rate))


def in_band(bench: Bench, series: np.ndarray, band: tuple[float, float], order: int) -> np.ndarray:
    """Return (.., sample): the settled samples of a series (.., sample) of a run within a band in
    Hz, differentiated `order` times in time.
    """
    rate, count = bench.schedule.sampling_frequency, series.shape[-1]
    inside = settled(bench)
    fade = np.interp(np.arange(count), [0, inside[0], inside[-1], count], [0.0, 1.0, 1.0, 0.0])
    frequency = np.fft.rfftfreq(count, 1.0 / rate)
    factor = (2j * np.pi * frequency) ** order
    factor = factor * ((frequency >= band[0]) & (frequency <= band[1]))
    smooth = np.sin(0.5 * np.pi * fade) ** 2
    lines = np.fft.rfft((series - series.mean(axis=-1, keepdims=True)) * smooth, axis=-1)
    return np.fft.irfft(lines * factor, count, axis=-1)[..., inside]


def undelayed(motion: np.ndarray, delay: np.ndarray, rate: float) -> np.ndarray:
    """Return motion (step, channel), rate steps a second, before delays (channel,) in s."""
    if not delay.any():
        return motion
    out, at = motion.copy(), np.arange(len(motion))
    for channel in np.flatnonzero(delay):
        out[:, channel] = np.interp(at + delay[channel] * rate, at, motion[:, channel])
    return out


def sampled_motion(bench: Bench, stretch: int, delay: np.ndarray) -> np.ndarray:
    """Return (channel, sample) m: the measured motion at the samples of the runs, before delays
    (channel,) in s.
    """
    schedule = bench.schedule
    ratio = round(schedule.steps_per_second / schedule.sampling_frequency)
    motion = undelayed(bench.stretches[stretch].motion, delay, schedule.steps_per_second)
    return motion[1 : 1 + schedule.samples * ratio : ratio].T


def holding_lines(bench: Bench, points: Sequence[Point]) -> np.ndarray:
    """Return (point, stretch, channel, line) complex: the spectrum of the holding force in N.

    It is multiplied by the gain of the channel, which makes it a residual of the measured values.
    NaN for a Point that could not be run.
    """
    shape = (len(bench.structure.names), len(compared_frequencies(bench)))
    out = np.full((len(points), len(bench.stretches), *shape), np.nan, np.complex64)
    runs, index = _runs(bench, points)
    if not runs:
        return out
    count_simulated(len(runs))
    out[index >= 0] = _lines_of(bench, runs)[index[index >= 0]]
    gain = np.stack([bench.structure.measuring(point).gain for point in points])
    return out * gain[:, None, :, None].astype(np.float32)


def _lines_of(bench: Bench, runs: Sequence[HeldLane]) -> np.ndarray:
    """Return (run, channel, line) complex: the spectrum of the holding force of runs."""
    first = int(FORGET_S * bench.schedule.sampling_frequency)
    force = hold(runs, bench.schedule, bench.threads, bench.held_below_Hz).force[..., first:]
    window = np.hanning(force.shape[-1]).astype(force.dtype)  # single precision, as the force
    return fft.rfft(force * window, axis=-1)[..., _inside(bench, _frequencies(bench))]


def with_model_error(bench: Bench) -> Bench:
    """Return the Bench whose stretches know the error of a right model: MODEL_ERROR of the lines
    that the contact of the model as given makes.
    """
    model, chain = bench.structure.held_model(Point()), bench.structure.measuring(Point())
    free = replace(model, contact_laws=model.contact_laws.with_columns(gap=OUT_OF_REACH_M))
    runs = [lane_of(bench, own, each, chain) for each in (model, free) for own in bench.stretches]
    touching, apart = np.split(_lines_of(bench, runs), 2)
    power = np.nan_to_num(MODEL_ERROR**2 * _power(touching - apart))
    pairs = zip(bench.stretches, power, strict=True)
    return replace(bench, stretches=tuple(replace(own, error=error) for own, error in pairs))


def _frequencies(bench: Bench) -> np.ndarray:
    """Return (frequency,) Hz of a run, once its start is forgotten."""
    rate = bench.schedule.sampling_frequency
    return np.fft.rfftfreq(bench.schedule.samples - int(FORGET_S * rate), 1.0 / rate)


def _inside(bench: Bench, frequency: np.ndarray) -> np.ndarray:
    """Return (frequency,) bool: in the band."""
    return (frequency >= bench.band[0]) & (frequency <= bench.band[1])


def compared_frequencies(bench: Bench) -> np.ndarray:
    """Return (line,) Hz: the frequencies of `holding_lines`."""
    frequency = _frequencies(bench)
    return frequency[_inside(bench, frequency)]


def holds(bench: Bench, modes: int) -> np.ndarray:
    """Return (stretch,) bool: whether the model as given is held there.

    If it is, two runs whose frequencies differ by NUDGE stay together. If the sensors are too few,
    impacts drive them apart.
    """
    lines = holding_lines(bench, [Point(), Point(frequency=(NUDGE,) * modes)])
    free = np.maximum(_power(_free_lines(bench)), np.finfo(float).tiny)
    number = counts(bench, lines[0])
    power = np.sum(number * _power(lines[1] - lines[0]) / free, axis=(1, 2))
    return np.nan_to_num(power / number.sum(axis=(1, 2)), nan=np.inf) < LOST


def _free_lines(bench: Bench) -> np.ndarray:
    """Return (stretch, channel, line): the holding force of a model that does not move."""
    rate, out = bench.schedule.sampling_frequency, []
    first = int(FORGET_S * rate)
    for number, stretch in enumerate(bench.stretches):
        motion = sampled_motion(bench, number, np.zeros(len(bench.structure.names)))
        speed = np.gradient(motion, axis=-1)[:, first:] * rate
        lines = fft.rfft(speed * np.hanning(speed.shape[-1]), axis=-1)
        out.append(stretch.hold * bench.strength * lines[:, _inside(bench, _frequencies(bench))])
    return np.stack(out)


def touches(bench: Bench) -> np.ndarray:
    """Return (stretch,) bool: whether the model as given, held there, touches a support."""
    runs, _ = _runs(bench, [Point()])
    first = int(FORGET_S * bench.schedule.sampling_frequency)
    found = hold(runs, bench.schedule, bench.threads, bench.held_below_Hz).support_force
    return (found[..., first:] != 0.0).any(axis=(1, 2))


def band_edges(lines: int) -> np.ndarray:
    """Return (band + 1,) numbers of the lines at which the bands of `lines` lines begin and end."""
    return np.unique(np.r_[0, np.geomspace(FIRST_BAND, lines, BANDS).astype(int)])


def _power(lines: np.ndarray) -> np.ndarray:
    """Return (.., band): the mean power of lines (.., line) in each band."""
    edges = band_edges(lines.shape[-1])
    return np.add.reduceat(np.abs(lines) ** 2, edges[:-1], axis=-1) / np.diff(edges)


def log_power(bench: Bench, lines: np.ndarray) -> np.ndarray:
    """Return (.., stretch, channel, band): the logarithm of the mean power of lines (.., stretch,
    channel, line) in each band and of the error of a right model.
    """
    shape = lines.shape[-2], len(band_edges(lines.shape[-1])) - 1
    error = np.stack([np.broadcast_to(own.error, shape) for own in bench.stretches])
    return np.log(np.maximum(_power(lines) + error, np.finfo(float).tiny))


def counts(bench: Bench, lines: np.ndarray) -> np.ndarray:
    """Return (stretch, channel, band): lines that count in each band, 0 of channels at rest."""
    return bench.moving * np.diff(band_edges(lines.shape[-1]))


def misfit(bench: Bench, lines: np.ndarray) -> float:
    """Return minus the log likelihood of holding lines (stretch, channel, line), up to a
    constant.

    Gaussian lines whose level in each band is the most likely one (Whittle, with the levels
    profiled), and no less than the error of a right model: the number of lines times `log_power`.
    A share INDEPENDENT of the lines counts. Infinite if a run failed.
    """
    value = float(np.sum(counts(bench, lines) * log_power(bench, lines)))
    return INDEPENDENT * value if np.isfinite(value) else np.inf


def mean_log_power(bench: Bench, lines: np.ndarray) -> float:
    """Return the mean over lines of the log power of their bands."""
    weight = counts(bench, lines)
    return float(np.sum(weight * log_power(bench, lines)) / weight.sum())


def effective_lines(bench: Bench, lines: np.ndarray) -> float:
    """Return the number of lines that count in `misfit`: it divides a gain to one of log power."""
    return INDEPENDENT * float(counts(bench, lines).sum())


def whitening(bench: Bench, lines: np.ndarray) -> np.ndarray:
    """Return (stretch, channel, line): one over the RMS of the lines of each band, 0 of channels at
    rest.
    """
    level = np.exp(-0.5 * log_power(bench, lines))
    return np.repeat(level, np.diff(band_edges(lines.shape[-1])), axis=-1) * bench.moving
