"""Spectra of free runs against the measured ones, before and after a completion.

The log-spectral distance is the RMS over bands, channels and records of the difference in dB. Its
floor is the distance of two runs of the completed model from other starts: free impacting motion is
chaotic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, pairwise

import numpy as np

from vibroimpact.diagnosis.verdict.misfit import closed_fraction
from vibroimpact.integration.contact_convergence import IntegrationError

from .constants import FREE_EXCESS_DB, LEFT_SHARE
from .explanations import Point, Structure
from .measurement.sensed_motion import moving, orders
from .measurement.signals import Signals
from .measurement.simulated_records import simulate_records
from .measurement.stretches import MOVING, rates_of, valid_samples

SEEDS = 4  # whirling may begin in one run and not in another
CHANCE_RUNS = 20  # of a record that seems off: a measurement is the farthest of all once in 21
SETTLE_S = 1.0  # at the start of a record
ABOVE_NOISE_DB = 6.0
SEGMENT_S = 2.0
LEAST_SCATTER_DB = 0.5  # between runs of a model, in a band


@dataclass(frozen=True, eq=False)
class FreeRuns:
    """Spectra of whole records of a campaign, and of a model as given and after completion.

    frequency (line,): Hz. measured (record, channel, line); before, after (record, seed, channel,
    line): one-sided PSD in the unit of the channel squared per Hz; NaN of a run that failed.
    noise (record, channel): PSD. structure, point: of the runs after completion; None without a
    model.
    """

    signals: Signals
    frequency: np.ndarray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    noise: np.ndarray
    structure: Structure | None = None
    point: Point = Point()

    @property
    def as_given(self) -> FreeRuns:
        """Return the FreeRuns without a completion."""
        return replace(self, after=self.before, point=Point())

    def completed(self, point: Point, records: Sequence[int] | None = None) -> FreeRuns:
        """Return the FreeRuns with another Point after completion; on some records only if
        given.
        """
        values = _simulated(self.structure, self.signals, point, records)
        return replace(self, after=_psd(values, self.signals)[1], point=point)

    def surely_off(self) -> list[int]:
        """Return the records that are farther from the model after completion than its own runs are
        from one another. It may leave FREE_EXCESS_DB, and LEFT_SHARE of what the model as given
        leaves: laws of two codes differ.

        Whether a tube whirls may be chance. A record that is off some runs is compared with
        CHANCE_RUNS of them: if the model whirls with any probability, and the measurement does not
        (or the reverse), all of them differ from it in 2 % of the records at most.
        """
        most = FREE_EXCESS_DB + LEFT_SHARE * np.maximum(self.as_given._beyond_chance(), 0.0)
        off = np.flatnonzero(self._beyond_chance() > most).tolist()
        if not off:
            return []
        many = replace(self, after=self._with_more(self.after, self.point, off))
        beyond = many._beyond_chance() - most
        return [record for record in off if beyond[record] > 0.0]

    def repeated(self) -> FreeRuns:
        """Return the FreeRuns with CHANCE_RUNS of each record before and after completion: of a few
        runs, chance can make either look nearer.
        """
        before = self._with_more(self.before, Point())
        return replace(self, before=before, after=self._with_more(self.after, self.point))

    def _with_more(self, spectra, point, records=None):
        """Return spectra (record, seed, channel, line) of a Point with those of further seeds, up
        to CHANCE_RUNS; NaN for other records than those given.
        """
        for first in range(SEEDS, CHANCE_RUNS, SEEDS):
            seeds = range(first, first + SEEDS)
            more = _simulated(self.structure, self.signals, point, records, seeds)
            spectra = np.concatenate([spectra, _psd(more, self.signals)[1]], axis=1)
        return spectra

    def farther(self, records: Sequence[int] | np.ndarray) -> bool:
        """Return whether the spectra of one of records are farther off after completion than
        before, and than the runs of the completed model are from one another, by more than a right
        explanation may be.
        """
        least = FREE_EXCESS_DB + np.maximum(self.as_given._beyond_chance(), 0.0)
        return bool(np.any((self._beyond_chance() > least)[records]))

    def _beyond_chance(self):
        """Return (record,) dB: distance of the measured spectra of a record from the mean of the
        runs after completion, less the largest distance of one of these runs from the mean of the
        others.
        """
        out = np.full(len(self.measured), -np.inf)
        for record, known in enumerate(self._cells["known"]):
            if known.any():
                power = self._cells["after"][record]
                others = [_mean(np.delete(power, seed, axis=0)) for seed in range(len(power))]
                own = [_rms(one - rest, known) for one, rest in zip(power, others, strict=True)]
                away = _rms(self._cells["measured"][record] - _mean(power), known)
                out[record] = away - max(own)
        return out

    @cached_property
    def _cells(self):
        """Return {measured (record, channel, band), before, after (record, seed, channel, band):
        dB; known (record, channel, band) bool: above the noise, and simulated}.
        """
        edges = np.searchsorted(self.frequency, self.signals.edges)
        bands = [(low, max(high, low + 1)) for low, high in pairwise(edges)]
        sensed = self.noise[:, None, :, None]  # sensors would add it to the simulated response
        psd = {"measured": self.measured, "before": self.before + sensed}
        out = {
            name: _dB(np.stack([each[..., low:high].mean(axis=-1) for low, high in bands], axis=-1))
            for name, each in (psd | {"after": self.after + sensed}).items()
        }
        known = out["measured"] > _dB(self.noise)[..., None] + ABOVE_NOISE_DB
        for name in ("before", "after"):
            known &= np.isfinite(out[name]).all(axis=1)
        return out | {"known": known & ~self._at_rest[..., None]}

    @cached_property
    def _at_rest(self):
        """Return (record, channel) bool: slower than MOVING, as measured and as simulated. What a
        sensor picks up across its axis is as large, and so is the error of the force's direction.
        """
        own = moving(self.signals.kinds)
        low, high = self.signals.band_Hz
        inside = (self.frequency >= low) & (self.frequency <= high)
        omega = 2.0 * np.pi * self.frequency[inside]
        to_speed = omega ** (2.0 - 2.0 * orders(self.signals.kinds)[:, None])
        out = np.broadcast_to(own, self.measured.shape[:2])
        for psd in (self.measured, self.before.mean(axis=1), self.after.mean(axis=1)):
            square = np.sum(psd[..., inside] * to_speed, axis=-1) * own
            out = out & (square <= MOVING**2 * square.max(axis=-1, initial=0.0, keepdims=True))
        return out

    @property
    def compared(self) -> np.ndarray:
        """Return (record, channel) bool: whether a channel is compared in some band."""
        return self._cells["known"].any(axis=-1)

    @property
    def resting(self) -> list[str]:
        """Return the names of the channels that rest in every record, and measure more than their
        noise in one.
        """
        heard = (_dB(self.measured) > _dB(self.noise)[..., None] + ABOVE_NOISE_DB).any(axis=(0, 2))
        rest = self._at_rest.all(axis=0) & heard
        return [self.signals.names[channel] for channel in np.flatnonzero(rest)]

    def distance(
        self, records: Sequence[int] | np.ndarray, channel: int | None = None
    ) -> dict[str, float | None]:
        """Return {before_dB, after_dB, floor_dB, closed_fraction} over records, of all channels
        unless one is given.
        """
        channels = slice(None) if channel is None else [channel]
        chosen = self._cells["known"][records][:, channels]
        if not chosen.any():
            return dict.fromkeys(("before_dB", "after_dB", "floor_dB", "closed_fraction"))
        measured = self._cells["measured"][records][:, channels]
        away, floors = [], []
        for name in ("before", "after"):
            power = self._cells[name][records][:, :, channels]
            floors.append(_floor(power, chosen))
            own = floors[-1] * np.sqrt((1.0 - 1.0 / power.shape[1]) / 2.0)
            away.append(float(np.hypot(_rms(measured - _mean(power, axis=1), chosen), own)))
        return {
            "before_dB": away[0],
            "after_dB": away[1],
            "floor_dB": floors[1],
            "closed_fraction": closed_fraction(away[0], away[1], floors[1], floors[0]),
        }

    def regions(self, shown: int) -> list[dict]:
        """Return the rows of verdict.json's regions: bands in which the model as given is farthest
        off, in units of the scatter between its runs.
        """
        signals, known, before = self.signals, self._cells["known"], self._cells["before"]
        scatter = np.maximum(np.where(known, np.std(before, axis=1, ddof=1), 0.0), LEAST_SCATTER_DB)
        off = np.where(known, self._cells["measured"] - _mean(before, axis=1), 0.0)
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


def free_runs(structure: Structure, signals: Signals) -> FreeRuns:
    """Return the FreeRuns of the model as given."""
    frequency, measured = _psd(signals.response[:, None], signals)
    _, before = _psd(_simulated(structure, signals, Point()), signals)
    noise = signals.record_noise**2 / (0.5 * signals.rate)
    return FreeRuns(signals, frequency, measured[:, 0], before, before, noise, structure)


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


def _dB(power):
    """Return a power in dB."""
    return 10.0 * np.log10(np.maximum(power, np.finfo(float).tiny))


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
