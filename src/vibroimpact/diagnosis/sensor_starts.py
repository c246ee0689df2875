"""Gain and delay of a sensor that is left free, from the prediction by the others."""

from __future__ import annotations

import numpy as np
from scipy import signal

from vibroimpact.integration.held_run import hold

from .bench import Bench, in_band, lane_of, sampled_motion
from .explanations import Point, Term

LONGEST_S = 0.01  # of a delay that is tried
FINER = 8  # of the lags, over the samples
GAINS = (0.2, 5.0)  # of a channel that is tried
TOLD = 0.5  # least correlation of a predicted with a measured velocity


def sensor_terms(bench: Bench, point: Point) -> list[Term]:
    """Return a sensor_delay and a sensor_gain of each channel that the others predict, on the first
    stretch of a Bench.

    The derivative at zero delay finds only a small one; the lag of the largest correlation finds
    any. Raises ConfigError or ValueError if the Point makes no model.
    """
    stretch = bench.stretches[0]
    names = bench.structure.names
    tried = np.flatnonzero(stretch.moving & np.any(stretch.motion, axis=0))
    if len(tried) < 2:
        return []
    model, chain = bench.structure.held_model(point), bench.structure.measuring(point)
    lanes = [lane_of(bench, stretch, model, chain, [int(channel)]) for channel in tried]
    records = hold(lanes, bench.schedule, bench.threads, bench.held_below_Hz)
    measured = in_band(bench, sampled_motion(bench, 0, np.zeros(len(names))), bench.band, 1)
    out = []
    for run, channel in enumerate(tried):
        predicted = in_band(bench, records.motion[run, channel].astype(float), bench.band, 1)
        if np.isfinite(predicted).all() and np.any(predicted):
            own = measured[channel] / chain.gain[channel]
            out += _terms(names[channel], predicted, own, bench.schedule.sampling_frequency)
    return out


def _terms(name: str, predicted: np.ndarray, measured: np.ndarray, rate: float) -> list[Term]:
    """Return the terms of a channel from velocities (sample,) at a rate in Hz."""
    size = float(np.linalg.norm(predicted) * np.linalg.norm(measured))
    fine = signal.resample(signal.correlate(measured, predicted), FINER * (2 * len(measured) - 1))
    lag = (np.arange(len(fine)) / FINER - (len(measured) - 1)) / rate
    near = np.abs(lag) <= LONGEST_S
    best = int(np.argmax(np.where(near, fine, -np.inf)))
    if fine[best] < TOLD * size:
        return []
    gain = float(np.clip(np.linalg.norm(measured) / np.linalg.norm(predicted), *GAINS))
    return [
        Term("sensor_delay", name, (float(lag[best]),)),
        Term("sensor_gain", name, (gain,)),
    ]
