"""The signals of a campaign in SI units, and the spectra of one record.

Spectra: response per force, coherence, and the band of both.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from vibroimpact.identify.spectra.periodic_lines import PeriodError, find_period
from vibroimpact.identify.spectra.welch import SegmentSpectra, segment_spectra

from .file import CampaignError, band_of, channel_factor, force_factor, load_of, measured_values
from .force_kinds import force_kinds

SEGMENT_S = 8.0
FEWEST_SEGMENTS = 12
SHORTEST_SEGMENT = 64  # samples
AT_REST, IN_BLOWS = 0.1, 0.05  # of the largest blow; of the samples of a force
FEWEST_BLOWS = 3  # that an average takes
FEWEST_LINES = 8  # that a force excites
RESPONDING = 0.01  # of the power of a response
# Of a record whose spectra can be averaged: FEWEST_SEGMENTS that overlap by half.
FEWEST_SAMPLES = SHORTEST_SEGMENT * (FEWEST_SEGMENTS + 1) // 2
EXCITED_SHARE = 0.01  # of the typical PSD of the force: lines below it are not excited

LOAD_TOLERANCE = 0.01
DEFAULT_BAND_HZ = (5.0, 200.0)
EXCITED_PSD = 1.0e-3  # of the largest lines of the smoothed PSD of all forces


@dataclass(frozen=True)
class Averaging:
    """Parameters of averaged spectra, as welch.segment_spectra reads them."""

    segment_s: float
    overlap: float = 0.5
    window: str = "hann"


@dataclass(frozen=True)
class CampaignSignals:
    """A campaign in SI units.

    rate: sampling frequency, Hz.
    records, channels, forces: names. kinds (channel,). force_kinds (force_channel,), see
    campaign.force_kinds. splits (record,): "fit" or "holdout".
    load_rms (record,): N, or m/s² of a base, as stated, or that of the force if it differs, see
    file.load_of.
    gap (record,): m, NaN if there is none.
    points (channel, xyz): m.
    directions (channel, xyz), force_directions (force_channel, xyz): unit vectors.
    stated_period: samples of a period as the file states it, 0 for none.
    transient_periods: periods at the start of a record before the steady state.
    starts_at_rest: whether records begin at rest.
    force, response: an array per record, (force_channel, sample) and (channel, sample), cut to its
    valid samples.
    factors (channel,): SI units per stored unit.
    unit_faults, force_unit_faults: {channel index: sentence} of signals whose unit can not be used;
    they stay in their stored unit, with a factor of 1.
    stated_band: Hz, the band that the file states, or None.
    """

    rate: float
    records: list[str]
    channels: list[str]
    forces: list[str]
    kinds: list[str]
    force_kinds: list[str]
    load_rms: np.ndarray
    gap: np.ndarray
    splits: list[str]
    points: np.ndarray
    directions: np.ndarray
    force_directions: np.ndarray
    stated_period: int
    transient_periods: int
    starts_at_rest: bool
    force: list[np.ndarray]
    response: list[np.ndarray]
    factors: np.ndarray
    unit_faults: dict[int, str]
    force_unit_faults: dict[int, str]
    stated_band: tuple[float, float] | None = None

    @property
    def valid_samples(self) -> np.ndarray:
        """Return (record,) the number of valid samples."""
        return np.array([force.shape[-1] for force in self.force])

    @cached_property
    def period_samples(self) -> int:
        """Return the samples of a period: as stated, or found in the forces; 0 for none."""
        driven = [force[0] for force in self.force if len(force)]
        return self.stated_period or common_period(driven)

    def require_units(self) -> "CampaignSignals":
        """Return the signals themselves. Raises CampaignError if a unit can not be used."""
        for fault in (*self.unit_faults.values(), *self.force_unit_faults.values()):
            raise CampaignError(fault)
        return self

    def padded(self, samples: int) -> tuple[np.ndarray, np.ndarray]:
        """Return force (record, force_channel, sample) and response (record, channel, sample).

        samples: length of the last axis, at least the longest record; NaN beyond valid samples.
        """
        force = np.full((len(self.records), len(self.forces), samples), np.nan)
        response = np.full((len(self.records), len(self.channels), samples), np.nan)
        for record, count in enumerate(self.valid_samples):
            force[record, :, :count] = self.force[record]
            response[record, :, :count] = self.response[record]
        return force, response

    def lowest(self) -> int | None:
        """Return the record of the lowest load with a finite force and response, or None."""
        for record in np.argsort(self.load_rms, kind="stable").tolist() if self.forces else ():
            force = self.force[record][0]
            if np.isfinite(force).all() and force.any() and self.finite(record).any():
                return record
        return None

    def finite(self, record: int) -> np.ndarray:
        """Return (channel,) whether all samples of a channel of a record are finite."""
        return np.isfinite(self.response[record]).all(axis=-1)


def campaign_signals(campaign: xr.Dataset) -> CampaignSignals:
    """Return the CampaignSignals of a campaign Dataset that keeps the contract, filled in."""
    factors, faults = _factors(campaign, campaign.sizes["channel"], channel_factor)
    force_factors, force_faults = _factors(campaign, campaign.sizes["force_channel"], force_factor)
    records, rate = range(campaign.sizes["record"]), float(campaign.attrs["sampling_frequency"])
    force, response = (
        [measured_values(campaign, name, record) * own[:, None] for record in records]
        for name, own in (("force", force_factors), ("response", factors))
    )
    band = band_of(campaign.attrs)
    found = [load_of(each[0], rate, band) if each.size else np.nan for each in force]
    loads = zip(campaign["load_rms"].values.astype(float).tolist(), found, strict=True)
    texts = {
        name: [str(value) for value in campaign[name].values]
        for name in ("record_name", "channel_name", "force_channel_name", "channel_kind", "split")
    }
    return CampaignSignals(
        rate=rate,
        records=texts["record_name"],
        channels=texts["channel_name"],
        forces=texts["force_channel_name"],
        kinds=texts["channel_kind"],
        force_kinds=force_kinds(campaign),
        load_rms=np.array([load if is_load(load, own) else own for load, own in loads]),
        gap=campaign["gap"].values.astype(float),
        splits=texts["split"],
        points=campaign["channel_point"].values.astype(float),
        directions=campaign["channel_direction"].values.astype(float),
        force_directions=campaign["force_channel_direction"].values.astype(float),
        stated_period=int(campaign.attrs.get("period_samples", 0)),
        transient_periods=int(campaign.attrs.get("transient_periods", 0)),
        starts_at_rest=campaign.attrs.get("start_up") == "rest",
        force=force,
        response=response,
        factors=factors,
        unit_faults=faults,
        force_unit_faults=force_faults,
        stated_band=band,
    )


def blows(force: np.ndarray) -> int:
    """Return how many blows of a hammer a force (time,) consists of, 0 if it does not: it is at
    rest except for a few samples. Between blows a window may have set it to exact zeros.
    """
    if not np.isfinite(force).any():
        return 0
    size = np.abs(force - np.nanmedian(force))
    hit = size > AT_REST * np.nanmax(size)
    number = int(hit[0]) + int(np.count_nonzero(hit[1:] & ~hit[:-1]))
    return number if 0.0 < hit.mean() < IN_BLOWS else 0


def is_load(stated: float, found: float) -> bool:
    """Return whether a stated load is that of the force, if that is known."""
    return not np.isfinite(found) or abs(found - stated) <= LOAD_TOLERANCE * max(found, 1e-300)


def common_period(forces: list[np.ndarray]) -> int:
    """Return the samples of the period that all forces (time,) have in common, 0 for none.

    Each force holds it at least twice. It is searched if the file does not state one: the peaks
    of a periodic record recur in every period, and a check would take them for clipping.
    """
    periods = set()
    for force in forces:
        try:
            period = find_period(force) if np.isfinite(force).all() else 0
        except PeriodError:
            period = 0
        periods.add(period if 2 * period <= force.size else 0)
    return periods.pop() if len(periods) == 1 else 0


def _factors(
    campaign: xr.Dataset, count: int, factor_of: Callable[[xr.Dataset, int], float]
) -> tuple[np.ndarray, dict[int, str]]:
    """Return (factors (count,), {index: sentence}).

    The factor is 1 if the unit can not be used; the sentence says why.
    """
    factors, faults = np.ones(count), {}
    for index in range(count):
        try:
            factors[index] = factor_of(campaign, index)
        except CampaignError as error:
            faults[index] = str(error)
    return factors, faults


@dataclass(frozen=True)
class Transfer:
    """Spectra of one record in the excited band.

    frequency (line,): Hz.
    h1 (channel, line): response per force.
    coherence (channel, line): 0 to 1.
    power (channel,): mean square of the responses in the band.
    following (channel,): share of that power which follows the force, 0 to 1.
    averages: number of segments.
    responding: Hz, the lowest frequency of the response, over the channels: below it lies
    RESPONDING of the power that follows the force.
    """

    frequency: np.ndarray
    h1: np.ndarray
    coherence: np.ndarray
    power: np.ndarray
    following: np.ndarray
    averages: int
    responding: float


def transfer(signals: CampaignSignals, record: int) -> Transfer | None:
    """Return the Transfer of a record; None if transfer_or_reason returns a reason."""
    found = transfer_or_reason(signals, record)
    return found if isinstance(found, Transfer) else None


def transfer_or_reason(signals: CampaignSignals, record: int) -> Transfer | str:
    """Return the Transfer from force channel 0 of a record, at lines that the force excites within
    the stated band; a sentence without a full stop if no average of that kind is possible.
    """
    name, force = signals.records[record], signals.force[record][:1]
    number = blows(force[0])
    if 0 < number < FEWEST_BLOWS:
        return (
            f"record {name} holds {number} of the {FEWEST_BLOWS} blows of a hammer that an average"
            " takes: record several in one file"
        )
    force, response = (
        values - values.mean(axis=-1, keepdims=True)
        for values in (force, np.nan_to_num(signals.response[record]))
    )
    averaging = Averaging(
        min(SEGMENT_S, force.shape[-1] / signals.rate / (0.5 * FEWEST_SEGMENTS + 0.5))
    )
    if signals.period_samples:
        start = signals.period_samples * signals.transient_periods
        whole = (force.shape[-1] - start) // signals.period_samples * signals.period_samples
        if whole < 2 * signals.period_samples:
            return f"record {name} holds no two periods after the transient"
        force, response = force[:, start : start + whole], response[:, start : start + whole]
        averaging = Averaging(signals.period_samples / signals.rate, 0.0, "boxcar")
    if averaging.segment_s * signals.rate < SHORTEST_SEGMENT:
        return f"record {name} has {force.shape[-1]} samples, averages take {FEWEST_SAMPLES}"
    spectra = segment_spectra(np.concatenate([force, response]), signals.rate, averaging)
    force_psd = np.mean(np.abs(spectra.values[0]) ** 2, axis=0)
    kept = _excited(force_psd)
    low, high = signals.stated_band or (0.0, np.inf)
    kept &= (spectra.frequency >= low) & (spectra.frequency <= high)
    if kept.sum() < FEWEST_LINES:
        where = np.average(spectra.frequency, weights=force_psd * kept + np.finfo(float).tiny)
        return (
            f"{signals.forces[0]} excites {kept.sum()} lines of the spectrum of record {name},"
            f" about {where:.3g} Hz, as a sine does, and {FEWEST_LINES} are needed: take a force"
            " of many frequencies"
        )
    return _at_lines(spectra, force_psd, kept)


def _at_lines(spectra: SegmentSpectra, force_psd: np.ndarray, kept: np.ndarray) -> Transfer:
    """Return the Transfer from the first row of segment spectra to the others, at the kept lines.

    force_psd, kept (line,): PSD of the force, and which lines are kept.
    """
    values, tiny = spectra.values[:, :, kept], np.finfo(float).tiny
    cross = np.mean(values[1:] * values[0].conj(), axis=1)
    psd = np.mean(np.abs(values[1:]) ** 2, axis=1)
    coherence = np.abs(cross) ** 2 / np.maximum(psd * force_psd[kept], tiny)
    explained = np.cumsum(coherence * psd, axis=-1)
    reached = explained >= RESPONDING * np.maximum(explained[:, -1:], tiny)
    lowest = [np.argmax(line) for line in reached if line.any()]
    return Transfer(
        spectra.frequency[kept],
        cross / force_psd[kept],
        coherence,
        psd.sum(axis=-1) * spectra.frequency[1],
        explained[:, -1] / np.maximum(psd.sum(axis=-1), tiny),
        values.shape[1],
        float(spectra.frequency[kept][min(lowest, default=0)]),
    )


def _excited(psd: np.ndarray) -> np.ndarray:
    """Return (line,) whether the force excites a line.

    It does if its PSD is above EXCITED_SHARE of the PSD above which half of its power lies.
    """
    order = np.sort(psd[1:])[::-1]
    middle = np.searchsorted(np.cumsum(order), 0.5 * order.sum())
    kept = psd > EXCITED_SHARE * (order[middle] if order.sum() > 0.0 else np.inf)
    kept[0] = False
    return kept


def transfer_band(signals: CampaignSignals) -> tuple[float, float] | None:
    """Return (low, high) in Hz: first and last line of the transfer of the lowest usable record.

    None if there is no such record.
    """
    record = signals.lowest()
    spectra = transfer(signals, record) if record is not None else None
    return None if spectra is None else (float(spectra.frequency[0]), float(spectra.frequency[-1]))


def excited_band(force: np.ndarray, rate: float) -> tuple[float, float]:
    """Return (low, high) in Hz of the band that the forces excite.

    force (record, force_channel, sample): N, NaN beyond valid samples.
    rate: Hz.

    In the band the PSD, summed over all records, is above EXCITED_PSD of its largest lines; several
    forces count alike, whatever their sizes. Ends close to DEFAULT_BAND_HZ become those.
    """
    length = int(4.0 * rate)
    window = np.hanning(length)
    power = np.zeros(length // 2 + 1)
    force = np.nan_to_num(force)
    if force.shape[1] > 1:
        rms = np.sqrt(np.mean(force**2, axis=(0, 2), keepdims=True))
        force = force / np.where(rms > 0.0, rms, 1.0)
    for series in force.reshape(-1, force.shape[-1]):
        for first in range(0, max(len(series) - length, 0) + 1, length // 2):
            part = np.resize(series[first : first + length], length)
            power += np.abs(np.fft.rfft(window * part)) ** 2
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    smooth = np.convolve(power, np.ones(5) / 5.0, mode="same")
    largest = np.median(np.sort(smooth[1:])[-len(smooth) // 50 :])
    inside = np.flatnonzero(smooth[1:] > EXCITED_PSD * largest) + 1
    low, high = frequency[inside[0]] + 0.5, frequency[inside[-1]] - 0.5
    if abs(low - DEFAULT_BAND_HZ[0]) < 1.5 and abs(high - DEFAULT_BAND_HZ[1]) < 3.0:
        return DEFAULT_BAND_HZ
    return float(max(low, 2.0 / (force.shape[-1] / rate))), float(high)
