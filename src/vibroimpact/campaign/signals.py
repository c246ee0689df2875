"""A campaign's signals in SI as its checks read them, and the spectra of one record: force to
response, coherence, excited band.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vibroimpact.spectra.periodic_lines import PeriodError, find_period
from vibroimpact.spectra.welch import segment_spectra

from .file import CampaignError, channel_factor, force_factor, valid_count

SEGMENT_S = 8.0
FEWEST_SEGMENTS = 12
EXCITED_SHARE = 0.01  # of the typical PSD of the force: what lies below is not excited


@dataclass(frozen=True)
class Averaging:
    """How spectra of one record are averaged, as spectra.segment_spectra takes it."""

    segment_s: float
    overlap: float = 0.5
    window: str = "hann"


@dataclass(frozen=True)
class Measured:
    """A campaign in SI. rate Hz; force, response: per record (force_channel, time) and (channel,
    time), valid samples alone; unit_faults, force_unit_faults {channel: sentence}: these signals
    stay in their stored unit; period_samples: stated, or found, 0 for none.
    """

    rate: float
    records: list
    channels: list
    forces: list
    kinds: list
    load_rms: np.ndarray
    splits: list
    points: np.ndarray
    directions: np.ndarray
    force_directions: np.ndarray
    period_samples: int
    transient_periods: int
    starts_at_rest: bool
    force: list
    response: list
    unit_faults: dict
    force_unit_faults: dict

    def lowest(self):
        """Return the record of the lowest load whose force and at least one response are finite
        throughout, or None.
        """
        order = np.argsort(self.load_rms, kind="stable")
        return next(
            (
                int(record)
                for record in order
                if np.isfinite(self.force[record][0]).all()
                and self.force[record][0].any()
                and self.finite(record).any()
            ),
            None,
        )

    def finite(self, record):
        """Return (channel,) whether a channel of a record holds numbers alone."""
        return np.isfinite(self.response[record]).all(axis=-1)


def measured_signals(campaign):
    """Return the Measured signals of a campaign Dataset that keeps the contract."""
    factors, faults = _factors(campaign, campaign.sizes["channel"], channel_factor)
    force_factors, force_faults = _factors(campaign, campaign.sizes["force_channel"], force_factor)
    counts = [valid_count(campaign, record) for record in range(campaign.sizes["record"])]
    force = [
        campaign["force"].values[record, :, :count].astype(float) * force_factors[:, None]
        for record, count in enumerate(counts)
    ]
    response = [
        campaign["response"].values[record, :, :count].astype(float) * factors[:, None]
        for record, count in enumerate(counts)
    ]
    texts = {
        name: [str(value) for value in campaign[name].values]
        for name in ("record_name", "channel_name", "force_channel_name", "channel_kind", "split")
    }
    return Measured(
        rate=float(campaign.attrs["sampling_frequency"]),
        records=texts["record_name"],
        channels=texts["channel_name"],
        forces=texts["force_channel_name"],
        kinds=texts["channel_kind"],
        load_rms=campaign["load_rms"].values.astype(float),
        splits=texts["split"],
        points=campaign["channel_point"].values.astype(float),
        directions=campaign["channel_direction"].values.astype(float),
        force_directions=campaign["force_channel_direction"].values.astype(float),
        period_samples=int(campaign.attrs.get("period_samples", 0))
        or common_period([signals[0] for signals in force]),
        transient_periods=int(campaign.attrs.get("transient_periods", 0)),
        starts_at_rest=campaign.attrs.get("start_up") == "rest",
        force=force,
        response=response,
        unit_faults=faults,
        force_unit_faults=force_faults,
    )


def common_period(forces):
    """Return the samples of the period that all forces (time,) have, at least twice each; 0 where
    they have none in common.

    Also of a file that does not say so: the peaks of a periodic record come back in every period,
    and would be taken for flat tops.
    """
    periods = set()
    for force in forces:
        try:
            period = find_period(force) if np.isfinite(force).all() else 0
        except PeriodError:
            period = 0
        periods.add(period if 2 * period <= force.size else 0)
    return periods.pop() if len(periods) == 1 else 0


def _factors(campaign, count, factor_of):
    """Return (factors (count,), {index: sentence}); a factor of 1 where the unit can not be
    used.
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
    """Spectra of one record in the excited band: frequency (line,) Hz; h1 (channel, line) response
    per force; coherence (channel, line) 0 to 1; power (channel,) mean square of the responses in
    the band; averages: number of segments.
    """

    frequency: np.ndarray
    h1: np.ndarray
    coherence: np.ndarray
    power: np.ndarray
    averages: int


def transfer(measured, record):
    """Return the Transfer from force channel 0 of a record, at lines that the force excites; None
    for a record too short to average.
    """
    force, response = measured.force[record][:1], measured.response[record]
    averaging = Averaging(
        min(SEGMENT_S, force.shape[-1] / measured.rate / (0.5 * FEWEST_SEGMENTS + 0.5))
    )
    if measured.period_samples:
        start = measured.period_samples * measured.transient_periods
        whole = (force.shape[-1] - start) // measured.period_samples * measured.period_samples
        if whole < 2 * measured.period_samples:
            return None
        force, response = force[:, start : start + whole], response[:, start : start + whole]
        averaging = Averaging(measured.period_samples / measured.rate, 0.0, "boxcar")
    if averaging.segment_s * measured.rate < 64:
        return None
    spectra = segment_spectra(
        np.concatenate([force, np.nan_to_num(response)]), measured.rate, averaging
    )
    force_psd = np.mean(np.abs(spectra.values[0]) ** 2, axis=0)
    kept = _excited(force_psd)
    if kept.sum() < 8:
        return None
    values = spectra.values[:, :, kept]
    cross = np.mean(values[1:] * values[0].conj(), axis=1)
    psd = np.mean(np.abs(values[1:]) ** 2, axis=1)
    coherence = np.abs(cross) ** 2 / np.maximum(psd * force_psd[kept], np.finfo(float).tiny)
    step = spectra.frequency[1]
    return Transfer(
        spectra.frequency[kept],
        cross / force_psd[kept],
        coherence,
        psd.sum(axis=-1) * step,
        values.shape[1],
    )


def _excited(psd):
    """Return (line,) whether the force has power there: above a share of the PSD at which half of
    its power lies.
    """
    order = np.sort(psd[1:])[::-1]
    typical = (
        order[np.searchsorted(np.cumsum(order), 0.5 * order.sum())] if order.sum() > 0.0 else np.inf
    )
    kept = psd > EXCITED_SHARE * typical
    kept[0] = False
    return kept


def excited_band(measured):
    """Return (low, high) in Hz of what the force of the lowest usable record excites, or None where
    nothing can be told.
    """
    record = measured.lowest()
    spectra = transfer(measured, record) if record is not None else None
    return None if spectra is None else (float(spectra.frequency[0]), float(spectra.frequency[-1]))
