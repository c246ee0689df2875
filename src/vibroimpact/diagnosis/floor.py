"""The holding force of a model that lacks nothing: the model plays the measurement.

The model with drawn nuisances runs free under the measured force. The model without them is held to
that motion and noise, and nuisances are fitted as to the measurement. The holding force that
remains is the floor.
"""

from dataclasses import replace

import numpy as np
from scipy import signal

from vibroimpact.integration.held_run import HeldLane, hold

from .bench import Bench, mean_log_power, undelayed
from .comparison import Comparison
from .constants import DAMPING_SD, FREQUENCY_SD, GAIN_SD, TURN_SD
from .explanations import Point
from .gauss_newton import Fit, fit
from .measurement.sensed_motion import orders
from .measurement.stretches import Stretch

LEAD_S = 2.0  # of a free run before its stretch
WINDOW = ("kaiser", 9.0)  # of the interpolation: images 90 dB down
PASSES = 1  # of the fit of the nuisances: a second one changes the floor by 0.1 at most


def floor_of(comparison: Comparison, best: Fit) -> tuple[float, float]:
    """Return (mean log power of the holding force of a Fit, the same if nothing else is missing),
    on the fitted stretches; the second NaN if records are unfiltered or the free run fails.
    """
    bench = comparison.fitted()
    rng = np.random.default_rng(1)
    modes, channels = comparison.all_modes, len(comparison.structure.names)
    played = Point(
        best.point.terms,
        tuple(FREQUENCY_SD * rng.standard_normal(modes)),
        tuple(DAMPING_SD * rng.standard_normal(modes)),
        tuple(GAIN_SD * rng.standard_normal(channels)),
        tuple(TURN_SD * rng.standard_normal(int(comparison.across))),
    )
    level = mean_log_power(bench, best.lines)
    filtered = comparison.structure.campaign.attrs.get("antialias") != "none"
    stretches = played_stretches(comparison, bench, played, rng) if filtered else None
    if stretches is None:
        return level, np.nan
    own = replace(bench, stretches=stretches)
    found = fit(own, Point(best.point.terms), comparison.nuisances(), PASSES)
    return level, mean_log_power(own, found.lines)


def _noise(
    comparison: Comparison, record: int, samples: int, rng: np.random.Generator
) -> np.ndarray:
    """Return (channel, sample) m: noise of the channels in a record, as a displacement."""
    signals, (low, high) = comparison.signals, comparison.band
    rate = comparison.rates.sampling
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    inside = (frequency >= low) & (frequency <= high)
    omega = 2.0 * np.pi * np.where(inside, frequency, 1.0)
    # white over the range to half the sampling frequency of the campaign
    level = signals.record_noise[record] * np.sqrt(rate / signals.rate) * comparison.structure.scale
    white = level[:, None] * rng.standard_normal((len(level), samples))
    lines = np.fft.rfft(white, axis=-1) * inside / (1j * omega) ** orders(signals.kinds)[:, None]
    return np.fft.irfft(lines, samples, axis=-1)


def played_stretches(
    comparison: Comparison, bench: Bench, point: Point, rng: np.random.Generator
) -> tuple[Stretch, ...] | None:
    """Return the stretches with the motion of a Point that runs free, None if it fails.

    The run begins before the stretch, so that the held run does not know its start, as with a
    measurement.
    """
    model, chain = bench.structure.held_model(point), bench.structure.measuring(point)
    led, lead = comparison.led(bench, LEAD_S)
    schedule = replace(bench.schedule, duration=bench.schedule.duration + lead)
    free = np.zeros(len(chain.gain))
    still, scale = np.zeros_like(led[0].motion), 1.0 / chain.force_gain
    runs = [HeldLane(model, each.gap, each.force, still, free, force_scale=scale) for each in led]
    motion = hold(runs, schedule, bench.threads).motion
    if not np.isfinite(motion).all():
        return None
    up = round(schedule.steps_per_second / schedule.sampling_frequency)
    first = round(lead * schedule.sampling_frequency) * up
    held = bench.measures_motion
    out = []
    for each, own in zip(bench.stretches, motion, strict=True):
        own = own * chain.gain[:, None] + _noise(comparison, each.record, own.shape[1], rng)
        fine = signal.resample_poly(own, up, 1, axis=-1, window=WINDOW, padtype="edge")
        # the motion of a stretch begins one step before its first sample
        count = len(each.motion)
        dense = np.pad(fine, ((0, 0), (1, count)), mode="edge")[:, first : first + count]
        late = undelayed(dense.T, -chain.delay, schedule.steps_per_second)
        out.append(replace(each, motion=late * held))
    return tuple(out)
