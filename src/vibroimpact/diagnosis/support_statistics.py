"""The statistics of supports from a held record: estimates, their intervals, and their trust."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import stats

from vibroimpact.identify.secant import MOMENTS, secant_support
from vibroimpact.integration.run_statistics import pooled, statistics
from vibroimpact.linear.support_groups import SupportDirection

from .measured_forces import ForceChannel
from .whole_records import Held, Holder

LEVEL = 0.999  # share of the time for which a force is below its level
CONFIDENCE = 0.90  # of the intervals
SEEN = 0.5  # least share of the motion at a support that is of modes which move a sensor
STILL = 1e-3  # of the mean of a sensor's squared shape: it does not move in that mode

FROM_TALLY = ("rms_force", "peak_force", "contact_fraction", "impact_rate", "wear_work_rate")
Key = tuple[int, str, str]  # support, force channel ("": the resultant), quantity


@dataclass(frozen=True, eq=False)
class HeldTwice:
    """A record held at the full strength and at half of it."""

    holder: Holder
    run: Held
    weaker: Held
    directions: list[SupportDirection]
    channels: list[ForceChannel]

    @property
    def supports(self) -> tuple[str, ...]:
        """Return the names of the supports."""
        return tuple(self.holder.model.support_names)


def estimates(
    record: HeldTwice, both: Mapping[str, np.ndarray], chosen: np.ndarray
) -> dict[Key, float]:
    """Return {Key: value} from the stretches with the indices `chosen`.

    both: {force channel: (2, stretch, sample)}, see measured_forces.side_by_side.
    """
    run, model = record.run, record.holder.model
    found = statistics(pooled(run.runs, chosen), 0, run.steps_per_second)
    force = run.runs.support_force[chosen].astype(float)
    size = np.hypot(force[:, 0::2], force[:, 1::2])
    gap = float(record.holder.signals.gap[run.record])
    moments = xr.Dataset(
        {
            name: (("contact_point", "direction")[: found[name].ndim], found[name])
            for name in MOMENTS
        },
        attrs={"gap_m": gap},
    )
    out: dict[Key, float] = {}
    for support, name in enumerate(record.supports):
        out[support, "", "force_level"] = float(np.quantile(size[:, support], LEVEL))
        out |= {(support, "", key): float(found[key][support]) for key in FROM_TALLY}
        for direction in record.directions:
            if name in direction.supports:
                secant = secant_support(moments, model, direction)
                out[support, "", f"secant_stiffness_{direction.direction}"] = secant.k
                out[support, "", f"secant_damping_{direction.direction}"] = secant.c
    for channel in record.channels:
        virtual, measured = both[channel.name][:, chosen]
        out |= _of_channel(channel, virtual)
        together = np.sqrt(np.mean(virtual**2) * np.mean(measured**2))
        out[channel.support, channel.name, "correlation"] = (
            float(np.mean(virtual * measured) / together) if together > 0.0 else np.nan
        )
    return out


def _of_channel(channel, force) -> dict[Key, float]:
    """Return {Key: value} of the force (stretch, sample) N along a channel."""
    size = np.abs(force)
    found = {
        "rms_force": np.sqrt(np.mean(size**2)),
        "force_level": np.quantile(size, LEVEL),
        "peak_force": size.max(),
    }
    return {(channel.support, channel.name, name): float(value) for name, value in found.items()}


def measured_of(
    record: HeldTwice, both: Mapping[str, np.ndarray], chosen: np.ndarray
) -> dict[Key, float]:
    """Return {Key: value} of the measured contact forces."""
    found = [_of_channel(each, both[each.name][1, chosen]) for each in record.channels]
    return {key: value for own in found for key, value in own.items()}


def with_interval(
    estimate: Callable[[np.ndarray], dict[Key, float]], stretches: np.ndarray
) -> tuple[dict[Key, float], dict[Key, float], dict[Key, float]]:
    """Return ({key: value}, {key: low}, {key: high}) of an estimate from stretches.

    Source: the block jackknife, H. Kuensch, Ann. Statist. 17 (1989) 1217, blocks side by side, with
    Student's t. It does not hold for a largest value, which has no interval.
    """
    found = estimate(stretches)
    count = len(stretches)
    parts = [estimate(np.delete(stretches, k)) for k in range(count)] if count > 1 else []
    low, high = {}, {}
    for key, value in found.items():
        left = np.array([part[key] for part in parts])
        known = bool(parts) and key[2] != "peak_force"
        spread = np.sqrt((count - 1) * np.var(left)) if known else np.nan
        reach = stats.t.ppf(0.5 + 0.5 * CONFIDENCE, max(count - 1, 1)) * spread
        low[key], high[key] = float(value - reach), float(value + reach)
    return found, low, high


def agreement_of(run: Held, weaker: Held, chosen: np.ndarray) -> np.ndarray:
    """Return (support,) the correlation of the contact forces under two strengths of the dampers,
    1 where neither touches.

    Measured: where it is below 0.95, the correlation with the true force is about as low; above, it
    does not see what is wrong in the model. See docs/virtual_supports.md.
    """
    one, other = (
        held.runs.support_force[chosen].astype(float).transpose(1, 0, 2) for held in (run, weaker)
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
    out: list[list[str]] = [[] for _ in record.supports]
    for direction in record.directions:
        there = np.sum(direction.contact[inside] ** 2, axis=1)
        if np.sum(there * seen) < SEEN * np.sum(there):
            for name in direction.supports:
                out[record.supports.index(name)].append(direction.direction)
    return out
