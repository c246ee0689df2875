"""The part of a campaign that is usable without a model: one force, one gap, channels that are
sound in every record, periods or the last stretch of a long record.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.fft import prev_fast_len

from vibroimpact.campaign.checks.file_checks import refused, usable_signals
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import PARALLEL, SAME_POINT_M, valid_count
from vibroimpact.campaign.force_kinds import BASE, base_channels
from vibroimpact.campaign.signals import (
    CampaignSignals,
    campaign_signals,
    common_period,
    transfer_band,
)
from vibroimpact.identify.spectra.periodic_lines import LevelLines

from ..measurement.usable import Refused, checked_campaign, refuse
from .levels import noise_share

OTHER_FORCE = 0.01  # of the first force: another one above it can not be left out
# Of the end and of the beginning of the excited band: the longer of them is kept of a record
# without period.
CYCLES, LOW_CYCLES = 1000, 60
# A leading period with more than SETTLED times the usual difference to the last one, and more than
# UNSEEN of the response, holds the transient.
SETTLED, UNSEEN = 2.0, 0.005
SCATTERED = 0.2  # of the mean response: scatter between periods above it leaves a record out
# Kinds of channels that are left out, and why.
NO_MOTION = {
    "contact_force": "a contact force is no motion",
    "strain": "measured modes do not tell how a strain follows from motions",
}
Rows = list[dict[str, Any]]


def usable_records(
    campaign: xr.Dataset | str | Path,
) -> tuple[xr.Dataset, Rows, CampaignSignals]:
    """Return (the usable part, rows of checks, its signals) of a campaign Dataset or the path of
    its file.

    Attributes of the Dataset: period_samples (0: each record has a period of its own),
    transient_periods, and whole_records if records have no period and are cut to their last
    stretch. Raises Refused with the reason.
    """
    whole, rows = checked_campaign(campaign)
    if whole is None or refused(rows):
        raise Refused(" ".join(row["message"] for row in rows if row["level"] == "refuse"), rows)
    kept = _sound(whole, rows)
    measured = campaign_signals(kept)
    for signals in measured.force:
        sizes = np.sqrt(np.mean(np.square(np.nan_to_num(signals)), axis=-1))
        if sizes.size > 1 and sizes[1:].max() > OTHER_FORCE * sizes[0]:
            refuse(
                f"Several forces act at once ({', '.join(measured.forces)}): modes are identified"
                " under one; drive at one point.",
                rows,
            )
    periods = [measured.period_samples or common_period([force[0]]) for force in measured.force]
    if all(periods):
        unsettled = map(unsettled_periods, measured.response, periods)
        attributes = {
            "period_samples": measured.period_samples,
            "transient_periods": max(measured.transient_periods, *unsettled),
        }
        return kept.assign_attrs(attributes), rows, measured
    band = transfer_band(measured)
    if band is None:
        refuse("The records are too short to tell which lines the force excites.", rows)
    longest = int(max(CYCLES / band[1], LOW_CYCLES / band[0]) * measured.rate)
    attributes = {"period_samples": 0, "transient_periods": 0, "whole_records": 1}
    return _last_stretch(kept, longest).assign_attrs(attributes), rows, measured


def _sound(campaign: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Return the records of one gap, and the channels that measure a motion in all of them."""
    base = np.flatnonzero(base_channels(campaign))
    if base.size:
        refuse(
            f"force_channel_kind[{base[0]}] = '{BASE}': a structure without a model is scaled by"
            " the response at a measured force, which a moving base has not: give a model of the"
            " structure, or measure a force.",
            rows,
        )
    force, response = usable_signals(campaign, rows)
    kinds = [str(kind) for kind in campaign["channel_kind"].values]
    force &= response.any(axis=1)
    shown = response[force].all(axis=0) & ~np.isin(kinds, list(NO_MOTION))
    for channel in np.flatnonzero(~shown):
        why = NO_MOTION.get(kinds[channel], "it can not be used in every record")
        name = str(campaign["channel_name"].values[channel])
        rows.append(check_row("channels", "warn", f"{name} is left out: {why}.", channel=name))
    if not shown.any():
        refuse(
            "No channel is usable in every record: repair or leave out the records that the checks"
            " name.",
            rows,
        )
    # the gap of most usable records: another gap is another structure
    gap = np.nan_to_num(campaign["gap"].values.astype(float), nan=-1.0)
    values, counts = np.unique(gap[force], return_counts=True)
    chosen = values[int(np.argmax(counts))]
    if values.size > 1:
        told = "without gap" if chosen < 0.0 else f"with the gap {chosen:.4g} m"
        text = (
            f"The records have {values.size} gaps, each another structure: only those {told} are"
            " used."
        )
        rows.append(check_row("gaps", "warn", text))
    force &= gap == chosen
    return campaign.isel(record=np.flatnonzero(force), channel=np.flatnonzero(shown))


def unsettled_periods(response: np.ndarray, period: int) -> int:
    """Return the number of leading periods of a response (channel, time) that differ from the last
    one by more than the rest do; one is always kept.
    """
    count = response.shape[-1] // period
    if count < 3:
        return max(count - 1, 0)
    parts = response[:, response.shape[-1] - count * period :].reshape(len(response), count, period)
    size = np.maximum(parts[:, -1].std(axis=-1), np.finfo(float).tiny)
    apart = (parts[:, :-1] - parts[:, -1:]).std(axis=-1) / size[:, None]
    apart = np.sqrt(np.mean(apart**2, axis=0))
    # drift makes near periods more alike than far ones: not the least
    usual = np.sort(apart)[(apart.size - 1) // 2]
    return int(np.argmax(apart <= max(SETTLED * usual, UNSEEN)))


def _last_stretch(campaign: xr.Dataset, longest: int) -> xr.Dataset:
    """Return the campaign with the last samples of every record, at most `longest` and a fast
    length of an FFT, moved to the front.
    """
    counts = [valid_count(campaign, record) for record in range(campaign.sizes["record"])]
    kept = np.array([prev_fast_len(min(count, longest), real=True) for count in counts])
    out = campaign.isel(time=slice(0, int(kept.max()))).copy(deep=True)
    for record, (count, size) in enumerate(zip(counts, kept, strict=True)):
        for name in ("force", "response"):
            last = campaign[name].values[record, :, count - size : count]
            out[name].values[record] = np.nan
            out[name].values[record, :, :size] = last
    return out.drop_vars("voltage", errors="ignore").assign(valid_samples=("record", kept))


def along_force(
    campaign: xr.Dataset, measured: CampaignSignals, wanted: str | None, rows: Rows
) -> tuple[xr.Dataset, int, bool]:
    """Return (campaign, index of the channel at the force, whether it was turned); that channel is
    made positive along the force, since shapes are scaled by it.

    wanted: its name; else the nearest channel along the force, or the nearest of all. A row is
    added if it is not at the point of the force.
    """
    names = [str(name) for name in campaign["channel_name"].values]
    size = np.linalg.norm(measured.force_directions[0])
    along = measured.directions @ measured.force_directions[0] / max(size, np.finfo(float).tiny)
    point = campaign["force_channel_point"].values[0].astype(float)
    distance = np.linalg.norm(measured.points - point, axis=1)
    distance = np.where(np.isfinite(distance), distance, np.inf)
    parallel = np.abs(along) > PARALLEL
    nearest = int(np.argmin(distance + np.where(parallel, 0.0, 1.0e6)))
    drive = nearest if wanted is None else names.index(wanted)
    if not (parallel[drive] and distance[drive] < SAME_POINT_M):
        text = (
            f"{names[drive]} is taken for the response at the force but lies"
            f" {distance[drive] * 1e3:.3g} mm away or across it: stiffnesses and forces of laws are"
            " then only right up to a factor; measure at the force."
        )
        rows.append(check_row("drive", "warn", text, channel=names[drive]))
    turned = bool(along[drive] < -PARALLEL)
    if turned:
        campaign = campaign.copy(deep=True)
        campaign["response"].values[:, drive] *= -1.0
        campaign["channel_direction"].values[drive] *= -1.0
    return campaign, drive, turned


def repeating(
    campaign: xr.Dataset, levels: Sequence[LevelLines], band_Hz: Sequence[float], rows: Rows
) -> tuple[xr.Dataset, list[LevelLines]]:
    """Return (campaign in the order of its levels, levels) without records whose response does not
    repeat with the force (chaotic, drifting or noisy): no law can be fitted to their waveform.
    """
    kept = []
    for level in levels:
        share = float(np.median(noise_share(level, band_Hz)))
        if level.periods > 1 and share > SCATTERED:
            text = (
                "The response does not repeat with the force: its mean over periods is uncertain by"
                f" {share:.0%}. The record is left out: no waveform can be fitted to it."
            )
            rows.append(check_row("periods", "warn", text, level.name))
        else:
            kept.append(level)
    names = campaign["record_name"].values.astype(str).tolist()
    return campaign.isel(record=[names.index(level.name) for level in kept]), kept
