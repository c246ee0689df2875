"""The statistics of supports from a held record: estimates, their intervals, and their trust; the
same of contact forces that were measured.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr
from scipy import stats

from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.identify.secant import MOMENTS, secant_support
from vibroimpact.integration.run_statistics import pooled, statistics
from vibroimpact.reduction.modal_model import ModalModel

from .measurement.comparable import compared_channels, contact_force_fault
from .measurement.sensed_motion import CONTACT_FORCE, across, support_at
from .whole_records import Held, Holder

LEVEL = 0.999  # share of the time for which a force is below its level
CONFIDENCE = 0.90  # of the intervals
SEEN = 0.5  # least share of the motion at a support that is in modes which move a sensor
STILL = 1e-3  # of the mean of a sensor's squared shape: it does not move in that mode

FROM_TALLY = ("rms_force", "peak_force", "contact_fraction", "impact_rate", "wear_work_rate")
Key = tuple[int, str, str]  # support, force channel ("": the resultant), quantity


@dataclass(frozen=True, eq=False)
class ForceChannel:
    """A channel that measures the force of a support on the structure.

    support: its index. weights (2,): of its two resultants in the measured force.
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
    for channel in compared_channels(campaign):
        if channel.kind != CONTACT_FORCE:
            continue
        support, why = support_at(model, channel.point), contact_force_fault(model, channel)
        if support is None or why:
            notes.append(f"{channel.name} {why}.")
        elif channel.number in signals.unit_faults:
            notes.append(f"{signals.unit_faults[channel.number]}: {channel.name} is left out.")
        else:
            weights = across(model, support) @ unit_vector(channel.direction)
            records = tuple(response[channel.number] for response in signals.response)
            found.append(ForceChannel(channel.name, support, weights, records))
    return found, notes


@dataclass(frozen=True, eq=False)
class HeldTwice:
    """A record held at the full strength and at half of it."""

    holder: Holder
    run: Held
    weaker: Held
    directions: list[SupportDirection]
    channels: list[ForceChannel]

    @cached_property
    def side_by_side(self) -> dict[str, np.ndarray]:
        """Return {force channel: (2, stretch, sample) N}: the virtual and the measured force along
        it, in the band of the motion that is held.
        """
        rates, rate, top = self.holder.rates, self.holder.signals.rate, self.holder.band[1]
        runs, _, samples = self.run.runs.support_force.shape
        first, count = round(self.run.first_s * rate), runs * samples * rates.decimation
        out = {}
        for channel in self.channels:
            own = self.run.support_force[2 * channel.support : 2 * channel.support + 2]
            measured = channel.records[self.run.record][first : first + count]
            both = (
                _low_pass(np.nan_to_num(channel.weights @ own), top / rates.sampling),
                _low_pass(measured, top / rate)[:: rates.decimation],
            )
            out[channel.name] = np.stack([series.reshape(runs, samples) for series in both])
        return out


def _low_pass(series, highest):
    """Return a series without the lines above a frequency, a share of its sampling frequency."""
    lines = np.fft.rfft(series)
    lines[np.fft.rfftfreq(len(series)) > highest] = 0.0
    return np.fft.irfft(lines, len(series))


def estimates(record: HeldTwice, chosen: np.ndarray) -> dict[Key, float]:
    """Return {Key: value} from the stretches with the indices `chosen`."""
    runs, holder = record.run.runs, record.holder
    found = statistics(pooled(runs, chosen), 0, holder.rates.steps_per_second)
    force = runs.support_force[chosen].astype(float)
    size = np.hypot(force[:, 0::2], force[:, 1::2])
    dims = ("contact_point", "direction")
    moments = xr.Dataset(
        {name: (dims[: found[name].ndim], found[name]) for name in MOMENTS},
        attrs={"gap_m": float(holder.signals.gap[record.run.record])},
    )
    out: dict[Key, float] = {}
    for support, name in enumerate(holder.model.support_names):
        out[support, "", "force_level"] = float(np.quantile(size[:, support], LEVEL))
        out |= {(support, "", key): float(found[key][support]) for key in FROM_TALLY}
        for direction in record.directions:
            if name in direction.supports:
                secant = secant_support(moments, holder.model, direction)
                out[support, "", f"secant_stiffness_{direction.direction}"] = secant.k
                out[support, "", f"secant_damping_{direction.direction}"] = secant.c
    for channel in record.channels:
        virtual, measured = record.side_by_side[channel.name][:, chosen]
        out |= of_channel(channel, virtual)
        together = np.sqrt(np.mean(virtual**2) * np.mean(measured**2))
        alike = float(np.mean(virtual * measured) / together) if together > 0.0 else np.nan
        out[channel.support, channel.name, "correlation"] = alike
    return out


def of_channel(channel: ForceChannel, force: np.ndarray) -> dict[Key, float]:
    """Return {Key: value} of the force (stretch, sample) N along a channel."""
    size = np.abs(force)
    found = {
        "rms_force": np.sqrt(np.mean(size**2)),
        "force_level": np.quantile(size, LEVEL),
        "peak_force": size.max(),
    }
    return {(channel.support, channel.name, name): float(value) for name, value in found.items()}


def with_interval(
    estimate: Callable[[np.ndarray], dict[Key, float]], stretches: np.ndarray
) -> dict[Key, tuple[float, float, float]]:
    """Return {key: (value, low, high)} of an estimate from stretches.

    Source: the block jackknife, H. Kuensch, Ann. Statist. 17 (1989) 1217, blocks side by side, with
    Student's t. It is not valid for a maximum, which has no interval.
    """
    count = len(stretches)
    parts = [estimate(np.delete(stretches, k)) for k in range(count)] if count > 1 else []
    out = {}
    for key, value in estimate(stretches).items():
        left = np.array([part[key] for part in parts])
        known = bool(parts) and key[2] != "peak_force"
        spread = np.sqrt((count - 1) * np.var(left)) if known else np.nan
        reach = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, max(count - 1, 1)) * spread
        out[key] = value, float(value - reach), float(value + reach)
    return out


def agreement_of(record: HeldTwice, chosen: np.ndarray) -> np.ndarray:
    """Return (support,) the correlation of the contact forces under two strengths of the dampers, 1
    if neither touches.

    Measured: if it is below 0.95, the correlation with the true force is about as low; above, it
    does not show errors of the model. See docs/virtual_supports.md.
    """
    one, other = (
        held.runs.support_force[chosen].astype(float).transpose(1, 0, 2)
        for held in (record.run, record.weaker)
    )
    pairs = (-1, 2 * one.shape[1] * one.shape[2])
    one, other = one.reshape(pairs), other.reshape(pairs)
    together = np.sqrt(np.sum(one**2, axis=1) * np.sum(other**2, axis=1))
    product = np.sum(one * other, axis=1)
    return np.divide(product, together, out=np.ones_like(product), where=together > 0.0)


def unseen_of(record: HeldTwice) -> list[list[str]]:
    """Return, per support, the directions in which most of its motion moves no held sensor."""
    model = record.holder.model
    inside = (model.frequencies > 0.0) & (model.frequencies < record.holder.band[1])
    seen = np.sum(model.sensor_shapes[inside][:, record.run.strength > 0.0] ** 2, axis=1)
    seen = seen > STILL * np.mean(seen)
    names = list(model.support_names)
    out: list[list[str]] = [[] for _ in names]
    for direction in record.directions:
        there = np.sum(direction.contact[inside] ** 2, axis=1)
        if np.sum(there * seen) < SEEN * np.sum(there):
            for name in direction.supports:
                out[names.index(name)].append(direction.direction)
    return out
