"""Contact forces that were measured, beside those of a held model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.reduction.modal_model import ModalModel

from .measurement.comparable import compared_channels, contact_force_fault
from .measurement.sensed_motion import CONTACT_FORCE, across, support_at
from .whole_records import Held, Holder


@dataclass(frozen=True, eq=False)
class ForceChannel:
    """A channel that measures the force of a support on the structure.

    support: its index. weights (2,): of its two resultants in what is measured.
    records: of each record (sample,) N.
    """

    name: str
    support: int
    weights: np.ndarray
    records: tuple[np.ndarray, ...]


def force_channels(campaign: xr.Dataset, model: ModalModel) -> tuple[list[ForceChannel], list[str]]:
    """Return (the ForceChannels of a campaign, sentences on those at no support of the model)."""
    found, notes = [], []
    signals = campaign_signals(campaign)
    pressed = campaign["channel_kind"].values == CONTACT_FORCE
    for channel in np.flatnonzero(pressed & compared_channels(campaign)):
        name = str(campaign["channel_name"].values[channel])
        place, direction = (
            campaign[f"channel_{key}"].values[channel].astype(float)
            for key in ("point", "direction")
        )
        support = support_at(model, place)
        why = contact_force_fault(model, place, direction)
        if support is None or why:
            notes.append(f"{name} {why}.")
        elif int(channel) in signals.unit_faults:
            notes.append(f"{signals.unit_faults[int(channel)]}: {name} is left out.")
        else:
            weights = across(model, support) @ unit_vector(direction)
            records = tuple(response[channel] for response in signals.response)
            found.append(ForceChannel(name, support, weights, records))
    return found, notes


def side_by_side(holder: Holder, held: Held, channel: ForceChannel) -> np.ndarray:
    """Return (2, stretch, sample) N: the virtual and the measured force along a channel, in the
    band of the motion that is held.
    """
    runs, _, samples = held.runs.support_force.shape
    own = held.support_force[2 * channel.support : 2 * channel.support + 2]
    every = holder.rates.decimation
    first = round(held.first_s * holder.signals.rate)
    measured = channel.records[held.record][first : first + runs * samples * every]
    top = holder.band[1]
    both = (
        _low_pass(np.nan_to_num(channel.weights @ own), top / held.sampling),
        _low_pass(measured, top / holder.signals.rate)[::every],
    )
    return np.stack([series.reshape(runs, samples) for series in both])


def _low_pass(series, highest):
    """Return a series without the lines above a frequency, a share of its sampling frequency."""
    lines = np.fft.rfft(series)
    lines[np.fft.rfftfreq(len(series)) > highest] = 0.0
    return np.fft.irfft(lines, len(series))
