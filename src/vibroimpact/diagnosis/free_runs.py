"""Spectra of free runs against the measured ones, before and after a completion.

The log-spectral distance is the RMS over bands, channels and records of the difference in dB. Its
floor is the distance of two runs of the completed model from other starts: free impacting motion is
chaotic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from vibroimpact.diagnosis.verdict.misfit import closed_fraction
from vibroimpact.integration.contact_convergence import IntegrationError

from .constants import FREE_EXCESS_DB, LEFT_SHARE
from .explanations import Point, Structure
from .measurement.signals import Signals
from .measurement.simulated_records import simulate_records
from .measurement.stretches import rates_of, valid_samples

SEEDS = 4  # whirling may begin in one run and not in another
CHANCE_RUNS = 20  # of a record that seems off: a measurement is the farthest of all once in 21
SETTLE_S = 1.0  # at the start of a record
ABOVE_NOISE_DB = 6.0
SEGMENT_S = 2.0
LEAST_SCATTER_DB = 0.5  # between runs of a model, in a band


@dataclass(frozen=True, eq=False)
class FreeRuns:
    """Spectra of whole records.

    frequency (line,): Hz. measured (record, channel, line); before, after (record, seed, channel,
    line): one-sided PSD in the unit of the channel squared per Hz; NaN of a run that failed.
    noise (record, channel): PSD.
    """

    frequency: np.ndarray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    noise: np.ndarray


def free_runs(structure: Structure, signals: Signals, after: Point | None) -> FreeRuns:
    """Return the FreeRuns of the model as given and of a Point, None if nothing is completed."""
    frequency, measured = _psd(signals.response[:, None], signals)
    _, before = _psd(_simulated(structure, signals, Point()), signals)
    noise = signals.record_noise**2 / (0.5 * signals.rate)
    runs = FreeRuns(frequency, measured[:, 0], before, before, noise)
    return runs if after is None else with_after(runs, structure, signals, after)


def with_after(
    runs: FreeRuns,
    structure: Structure,
    signals: Signals,
    after: Point,
    records: Sequence[int] | None = None,
) -> FreeRuns:
    """Return FreeRuns with another Point after completion; on some records only if given."""
    values = _simulated(structure, signals, after, records)
    return replace(runs, after=_psd(values, signals)[1])


def surely_off(
    runs: FreeRuns,
    structure: Structure,
    signals: Signals,
    after: Point,
    records: Sequence[int] | np.ndarray,
) -> list[int]:
    """Return which of some records are farther from the model after completion than its own runs
    are from one another, the farthest first; after: its Point. It may leave FREE_EXCESS_DB, and
    LEFT_SHARE of what the model as given leaves: laws of two codes differ.

    Whether a tube whirls may be chance. A record that is off some runs is compared with
    CHANCE_RUNS of them: if the model whirls with any probability, and the measurement does not (or
    the reverse), all of them differ from it in 2 % of the records at most.
    """
    given = _beyond_chance(replace(runs, after=runs.before), signals)
    most = FREE_EXCESS_DB + LEFT_SHARE * np.maximum(given, 0.0)
    beyond = _beyond_chance(runs, signals) - most
    off = [int(record) for record in records if beyond[record] > 0.0]
    if off:
        more = _simulated(structure, signals, after, off, range(SEEDS, CHANCE_RUNS))
        many = np.concatenate([runs.after, _psd(more, signals)[1]], axis=1)
        beyond = _beyond_chance(replace(runs, after=many), signals) - most
    off = [record for record in off if beyond[record] > 0.0]
    return sorted(off, key=lambda record: -beyond[record])


def _beyond_chance(runs, signals):
    """Return (record,) dB: distance of the measured spectra of a record from the mean of the runs
    after completion, less the largest distance of one of these runs from the mean of the others.
    """
    cells = _in_bands(runs, signals)
    out = np.full(len(runs.measured), -np.inf)
    for record, known in enumerate(cells["known"]):
        if known.any():
            power = cells["after"][record]
            others = [np.delete(power, seed, axis=0) for seed in range(len(power))]
            own = [_rms(one - _mean(rest), known) for one, rest in zip(power, others, strict=True)]
            out[record] = _rms(cells["measured"][record] - _mean(power), known) - max(own)
    return out


def _simulated(structure, signals, point, records=None, seeds=range(SEEDS)):
    """Return (record, seed, channel, sample): free runs of a Point, as the sensors record them, NaN
    for other records than those given.

    If the exact step makes a damped contact grow by itself, Newmark's is taken.
    """
    samples = max(valid_samples(signals, record) for record in range(len(signals.load)))
    integration = structure.config.integration
    rates = rates_of(signals.rate, integration.steps_per_second)
    model, chain = structure.model(point), structure.measuring(point)
    force = signals.force / chain.force_gain
    raw = replace(model, sensor_shapes=model.sensor_shapes / structure.scale)
    runs = [
        (record, float(signals.gap[record]), seed)
        for record in (range(len(signals.load)) if records is None else records)
        for seed in seeds
    ]
    out = np.full((len(signals.load), len(seeds), len(signals.names), samples), np.nan, np.float32)
    for scheme in dict.fromkeys((integration.scheme, "newmark")):
        schedule = rates.schedule(samples / signals.rate, scheme)
        try:
            found = simulate_records(raw, schedule, force, runs, signals.kinds)
        except IntegrationError:
            continue
        own = found.reshape(-1, *out.shape[1:]) * chain.gain[:, None].astype(np.float32)
        out[list(dict.fromkeys(record for record, _, _ in runs))] = own
        break
    return out


def _psd(values, signals):
    """Return (frequency, PSD (record, run, channel, line)) of values (record, run, channel,
    sample), averaged over segments that overlap by half.
    """
    length = int(SEGMENT_S * signals.rate)
    window = np.hanning(length)
    frequency = np.fft.rfftfreq(length, 1.0 / signals.rate)
    out = np.full((*values.shape[:3], len(frequency)), np.nan)
    for record in range(len(values)):
        last = min(valid_samples(signals, record), values.shape[-1]) - length
        starts = range(min(int(SETTLE_S * signals.rate), max(last, 0)), last + 1, length // 2)
        if not len(starts):
            continue
        power = sum(
            np.abs(np.fft.rfft(values[record, ..., at : at + length] * window, axis=-1)) ** 2
            for at in starts
        )
        out[record] = power * 2.0 / (len(starts) * signals.rate * np.sum(window**2))
    return frequency, out


def distance(
    runs: FreeRuns, signals: Signals, records: Sequence[int] | np.ndarray
) -> dict[str, float | None]:
    """Return {before_dB, after_dB, floor_dB, closed_fraction} over records."""
    return _distance(_in_bands(runs, signals), records, range(len(signals.names)))


def distances(runs: FreeRuns, signals: Signals) -> list[dict[str, float | None]]:
    """Return the rows of `distance` of each record and channel."""
    cells = _in_bands(runs, signals)
    records, channels = range(len(signals.load)), range(len(signals.names))
    return [_distance(cells, [each], [channel]) for each in records for channel in channels]


def _distance(cells, records, channels):
    """Return `distance` over records and channels of the cells of _in_bands."""
    chosen = cells["known"][records][:, channels]
    if not chosen.any():
        return dict.fromkeys(("before_dB", "after_dB", "floor_dB", "closed_fraction"))
    measured = cells["measured"][records][:, channels]
    away, floors = [], []
    for name in ("before", "after"):
        power = cells[name][records][:, :, channels]
        floors.append(_floor(power, chosen))
        mean = _mean(power, axis=1)
        own = floors[-1] * np.sqrt((1.0 - 1.0 / SEEDS) / 2.0)
        away.append(float(np.hypot(_rms(measured - mean, chosen), own)))
    return {
        "before_dB": away[0],
        "after_dB": away[1],
        "floor_dB": floors[1],
        "closed_fraction": closed_fraction(away[0], away[1], floors[1], floors[0]),
    }


def _in_bands(runs, signals):
    """Return {measured (record, channel, band), before, after (record, seed, channel, band): dB;
    known (record, channel, band) bool: above the noise, and simulated}.
    """
    edges = np.searchsorted(runs.frequency, signals.edges)
    bands = [(low, max(high, low + 1)) for low, high in zip(edges[:-1], edges[1:], strict=True)]

    def power(psd):
        mean = np.stack([psd[..., low:high].mean(axis=-1) for low, high in bands], axis=-1)
        return 10.0 * np.log10(np.maximum(mean, np.finfo(float).tiny))

    sensed = runs.noise[:, None, :, None]  # the sensors would add it to the simulated response
    out = {
        "measured": power(runs.measured),
        "before": power(runs.before + sensed),
        "after": power(runs.after + sensed),
    }
    noise = 10.0 * np.log10(np.maximum(runs.noise, np.finfo(float).tiny))[..., None]
    known = out["measured"] > noise + ABOVE_NOISE_DB
    for name in ("before", "after"):
        known &= np.isfinite(out[name]).all(axis=1)
    return out | {"known": known}


def _mean(power, axis=0):
    """Return the mean over runs of power in dB."""
    return 10.0 * np.log10(np.mean(10.0 ** (power / 10.0), axis=axis))


def _rms(difference, chosen):
    """Return the RMS of chosen cells."""
    return float(np.sqrt(np.mean(difference[chosen] ** 2)))


def _floor(power, chosen):
    """Return the distance in dB between two seeds, RMS over pairs; power (record, seed, ...)."""
    pairs = combinations(range(power.shape[1]), 2)
    squares = [_rms(power[:, one] - power[:, other], chosen) ** 2 for one, other in pairs]
    return float(np.sqrt(np.mean(squares))) if squares else 0.0


def regions(runs: FreeRuns, signals: Signals, shown: int) -> list[dict]:
    """Return the rows of verdict.json's regions: bands in which the model as given is farthest off,
    in units of the scatter between its runs.
    """
    cells = _in_bands(runs, signals)
    known, before = cells["known"], cells["before"]
    scatter = np.maximum(np.where(known, np.std(before, axis=1, ddof=1), 0.0), LEAST_SCATTER_DB)
    off = np.where(known, cells["measured"] - _mean(before, axis=1), 0.0)
    z = off / np.hypot(scatter, np.sqrt(np.mean(scatter**2)))
    rows = []
    for flat in np.argsort(-np.abs(z), axis=None)[:shown]:
        record, channel, band = np.unravel_index(flat, z.shape)
        gap = float(signals.gap[record])
        rows.append(
            {
                "band_Hz": [float(signals.edges[band]), float(signals.edges[band + 1])],
                "load_rms_N": float(signals.load[record]),
                "gap_m": gap if np.isfinite(gap) else None,
                "channel": signals.names[channel],
                "discrepancy_dB": float(off[record, channel, band]),
                "z": float(z[record, channel, band]),
                "record": signals.record_names[record],
            }
        )
    return rows
