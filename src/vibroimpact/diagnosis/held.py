"""Held runs of points: the lines of the holding force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.held_run import HeldLane, HeldRecords, hold

from .explanations import Point, Structure
from .stretches import Stretch

FORGET_S = 0.7  # of a stretch: until the unknown start is forgotten
BANDS = 18


@dataclass(frozen=True, eq=False)
class Bench:
    """What points are compared on."""

    structure: Structure
    stretches: tuple[Stretch, ...]
    schedule: Schedule
    band: tuple[float, float]
    strength: float

    def with_strength(self, strength: float) -> "Bench":
        from dataclasses import replace

        return replace(self, strength=strength)


def run(bench: Bench, points: Sequence[Point], free: np.ndarray | None = None) -> HeldRecords:
    """Return the HeldRecords of points on all stretches: (point, stretch) flattened."""
    lanes = []
    for point in points:
        model, chain = bench.structure.model(point), bench.structure.measuring(point)
        for stretch in bench.stretches:
            motion = delayed(stretch.motion, chain.delay, bench.schedule.steps_per_second)
            strength = np.full(motion.shape[1], bench.strength)
            if free is not None:
                strength[free] = 0.0
            lanes.append(
                HeldLane(
                    model,
                    stretch.gap,
                    stretch.force,
                    motion,
                    strength,
                    1.0 / chain.gain,
                    1.0 / chain.force_gain,
                )
            )
    return hold(lanes, bench.schedule)


def delayed(motion, delay, rate):
    """Return motion (step, channel) as it was before the delays (channel,) in s."""
    if not delay.any():
        return motion
    out = motion.copy()
    at = np.arange(len(motion))
    for channel in np.flatnonzero(delay):
        out[:, channel] = np.interp(at + delay[channel] * rate, at, motion[:, channel])
    return out


def lines(bench: Bench, points: Sequence[Point]) -> np.ndarray:
    """Return (point, stretch, sensor, line) complex: lines of the holding force in N, times the gain
    of the sensor, so that the residual is one of what was measured; of a point that could not be
    run NaN.
    """
    force = run(bench, points).force
    rate = bench.schedule.sampling_frequency
    force = force[..., int(FORGET_S * rate) :]
    window = np.hanning(force.shape[-1])
    frequency = np.fft.rfftfreq(force.shape[-1], 1.0 / rate)
    inside = (frequency >= bench.band[0]) & (frequency <= bench.band[1])
    out = np.fft.rfft(force * window, axis=-1)[..., inside].astype(np.complex64)
    out = out.reshape(len(points), len(bench.stretches), *out.shape[1:])
    gain = np.stack([bench.structure.measuring(point).gain for point in points])
    return out * gain[:, None, :, None].astype(np.float32)


def bands(count: int) -> list[tuple[int, int]]:
    """Return (first, end) of logarithmic bands of a number of lines."""
    edges = np.unique(np.r_[0, np.geomspace(4, count, BANDS).astype(int)])
    return list(zip(edges[:-1], edges[1:], strict=True))


def moving(bench: Bench) -> np.ndarray:
    """Return (stretch, sensor) bool: which sensors move there."""
    return np.stack([stretch.moving for stretch in bench.stretches])


def log_power(one: np.ndarray, edges: list[tuple[int, int]]) -> np.ndarray:
    """Return (.., stretch, sensor, band): log mean power of lines (.., stretch, sensor, line)."""
    power = np.abs(one) ** 2
    return np.log(np.stack([power[..., i:j].mean(axis=-1) for i, j in edges], axis=-1))
