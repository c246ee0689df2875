"""The campaign file: measured forces and responses at several levels and gaps, in netCDF-4.

contract.DECLARED lists the variables: dimensions, units, whether they are needed. In addition:

- force is in force_channel_units, else in its own attribute units or in N; an acceleration if
  force_channel_kind says base_acceleration: of all that holds the structure, positive along
  force_channel_direction; force_channel_point is of no account then
- response is in channel_units, any UDUNITS text
- channel_kind: acceleration, velocity, displacement, contact_force (of the support at
  channel_point on the structure, the sum over its contact points), strain (along a tube, by its
  bending, of the outer fibre at channel_point; channel_direction is the outward normal there) or
  generic
- channel_direction: unit vector of the positive sense
- gap: NaN if there is none
- split: fit or holdout
- load_rms: N, or m s-2 if that is a base acceleration: RMS of force channel 0 about its mean over
  the valid samples, see load_of
- noise_floor_rms: in the unit of the channel
- valid_samples: number of samples that count; the rest is NaN

Attributes: sampling_frequency (Hz), antialias, start_up, period_samples (0 if not periodic),
transient_periods, source, band_Hz (low, high: the band of the analysis; by default the band that
the force excites). Between samples the force is band-limited, not constant.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from vibroimpact.io.records import read_given_dataset, write_record
from vibroimpact.io.units import UnitError, si_factor

from .contract import ABOUT, DIMENSIONS, REQUIRED, SERIES, contract_problems
from .force_kinds import BASE, FORCE, load_unit, unit_kinds
from .stated_values import KINDS as KINDS
from .stated_values import Kind as Kind

# Of the attributes that a file need not state.
DEFAULTS = {
    "antialias": "",
    "start_up": "stationary",
    "period_samples": 0,
    "transient_periods": 0,
    "source": "",
}
LARGEST = 1.0e15  # of any unit; larger samples, such as the fill values of netCDF, are none
SYNTHETIC = "simulated"  # how the source of a campaign without measurements begins
SAME_POINT_M = 5.0e-3  # largest distance of a channel from its nominal point
PARALLEL = 0.99  # least |cosine| between the direction of a channel and the one asked for


class CampaignError(Exception):
    """A campaign file that can not be used; the message lists every problem."""


@dataclass(frozen=True)
class Channel:
    """A measured channel.

    name: text.
    point (3,): m.
    direction (3,): unit vector of the positive sense.
    units: UDUNITS text.
    kind: one of KINDS.
    """

    name: str
    point: tuple
    direction: tuple
    units: str
    kind: str


@dataclass(frozen=True)
class Level:
    """A record of a campaign.

    name: text.
    gap_m: radial clearance, m.
    repeat: index from 0 among records of the same load and gap.
    split: "fit" or "holdout".
    """

    name: str
    gap_m: float
    repeat: int = 0
    split: str = "fit"


def campaign_dataset(
    force: ArrayLike,
    response: ArrayLike,
    channels: Sequence[Channel],
    drives: Sequence[Channel],
    levels: Sequence[Level],
    sampling_frequency: float,
    optional: dict | None = None,
    **attributes: str | int | tuple[float, float],
) -> xr.Dataset:
    """Return the Dataset of a campaign.

    force (record, force_channel, time): in the units of the drives.
    response (record, channel, time): in the units of the channels.
    channels, drives: lists of Channel; a drive is a force if its kind is not base_acceleration.
        Without a drive no force was measured, and `force` is not read.
    levels: list of Level, one per record.
    sampling_frequency: Hz.
    optional: {name: values} of optional variables.
    attributes: source, antialias, start_up, period_samples, transient_periods, band_Hz.
    """
    data: dict[str, tuple] = {}
    if drives:
        first, band = drives[0], band_of(attributes)
        kind = BASE if first.kind == BASE else "excitation"
        factor = _factor(f"force channel {first.name}", first.units, kind)
        load = [factor * load_of(each[0], sampling_frequency, band) for each in np.asarray(force)]
        units = {"units": first.units} if len(drives) == 1 else {}
        data = {
            "force": (DIMENSIONS["force"], np.asarray(force, np.float32), units),
            "load_rms": ("record", load, {"units": "m s-2" if first.kind == BASE else "N"}),
            **_channel_variables("force_channel", drives),
        }
    times = np.arange(np.shape(response)[-1]) / sampling_frequency
    data |= {
        "response": (DIMENSIONS["response"], np.asarray(response, np.float32)),
        "time": ("time", times, {"units": "s"}),
        **_channel_variables("channel", channels),
        "record_name": ("record", np.array([level.name for level in levels], dtype=object)),
        "gap": ("record", np.array([level.gap_m for level in levels], float), {"units": "m"}),
        "repeat": ("record", np.array([level.repeat for level in levels], np.int64)),
        "split": ("record", np.array([level.split for level in levels], dtype=object)),
        **{name: (DIMENSIONS[name], np.asarray(own)) for name, own in (optional or {}).items()},
    }
    stated = {**DEFAULTS, "antialias": "fir80", **attributes}
    return xr.Dataset(data, attrs={"sampling_frequency": float(sampling_frequency), **stated})


def _channel_variables(prefix, channels):
    """Return {name: variable} of the names, units, kinds and places of Channels: those of forces
    have a kind if one is an acceleration of the base.
    """
    if prefix == "channel":
        kinds = [channel.kind for channel in channels]
    else:
        kinds = [BASE if channel.kind == BASE else FORCE for channel in channels]
    columns: dict[str, list] = {
        "name": [channel.name for channel in channels],
        "units": [channel.units for channel in channels],
        **({"kind": kinds} if prefix == "channel" or BASE in kinds else {}),
    }
    points = np.array([channel.point for channel in channels], float)
    directions = np.array([channel.direction for channel in channels], float)
    return {
        **{
            f"{prefix}_{key}": (prefix, np.array(values, dtype=object))
            for key, values in columns.items()
        },
        f"{prefix}_point": ((prefix, "xyz"), points, {"units": "m"}),
        f"{prefix}_direction": ((prefix, "xyz"), directions),
    }


def write_campaign(campaign: xr.Dataset, path: str | Path) -> None:
    """Write a campaign Dataset. Raises CampaignError when it breaks the contract."""
    _sound(campaign, path, force_needed="force" in campaign)
    campaign = campaign.copy()
    for name in set(ABOUT) & {str(name) for name in campaign.variables}:
        units, long_name = ABOUT[name]
        campaign[name].attrs = {
            **({"units": units} if units else {}),
            "long_name": long_name,
            **campaign[name].attrs,
        }
    # The names of dimensions and variables are the contract: nothing is renamed.
    write_record(campaign.assign_attrs(title="vibroimpact campaign"), path, names_kept=True)


def read_campaign(path: str | Path, force_needed: bool = True) -> xr.Dataset:
    """Return the campaign Dataset of a file, texts decoded and missing variables filled in.

    force_needed: whether a file without the variables of the force is refused. It is else a
        campaign without force channels, whose loads are NaN unless stated.

    The attribute `assumed` has a line for each variable that was filled in; see fill_missing.
    Raises RecordError when there is no such file or it is not netCDF, CampaignError with every
    breach of the contract.
    """
    return fill_missing(_sound(opened_campaign(path), path, force_needed))


def opened_campaign(path: str | Path, described: Sequence[str] = ()) -> xr.Dataset:
    """Return the Dataset of a campaign file of any state, texts decoded, nothing filled in.

    described: variables that zeros stand for.
    Raises RecordError when it can not be read as netCDF.
    """
    return decode_texts(read_given_dataset(path, described))


def checked_description(path: str | Path, force_needed: bool = True) -> xr.Dataset:
    """Return the Dataset of a campaign file that keeps the contract, with zeros for all signals.

    It takes no longer for long records. Raises as read_campaign does, whose arguments it has.
    """
    return _sound(opened_campaign(path, SERIES), path, force_needed)


def with_no_force(campaign: xr.Dataset) -> xr.Dataset:
    """Return a campaign without variables of a force as one with no force channels.

    Its loads are NaN if they are not stated. Any other campaign is returned as it is.
    """
    if any(str(name).startswith("force") for name in campaign.variables):
        return campaign
    empty = {
        name: (dims, np.zeros([campaign.sizes.get(dim, 0) for dim in dims]))
        for name, dims in DIMENSIONS.items()
        if name in REQUIRED and name.startswith("force")
    }
    if "load_rms" not in campaign:
        empty["load_rms"] = (("record",), np.full(campaign.sizes.get("record", 0), np.nan))
    empty["force_channel_name"] = (("force_channel",), np.array([], dtype=object))
    return campaign.assign(empty)


def decode_texts(campaign: xr.Dataset) -> xr.Dataset:
    """Return the Dataset with its texts as str, however netCDF stored them (bytes, padded, ...)."""
    as_text = np.vectorize(_text, otypes=[object])
    texts = {
        name: (variable.dims, as_text(variable.values), variable.attrs)
        for name, variable in campaign.variables.items()
        if variable.dtype.kind in "SUO"
    }
    attributes = {
        name: _text(value) if isinstance(value, bytes) else value
        for name, value in campaign.attrs.items()
    }
    return campaign.assign(texts).assign_attrs(attributes)


def _text(value: object) -> str:
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
    return text.strip("\0 ")


def fill_missing(campaign: xr.Dataset) -> xr.Dataset:
    """Return the Dataset with valid_samples, record_name, load_rms, repeat and split.

    Those that are missing are derived from the rest. The attribute `assumed` has a sentence per
    line for each, or is empty.
    """
    assumed: list[str] = []
    # The counts of a converter as real numbers, which know NaN.
    counts = [name for name in ("force", "response") if campaign[name].dtype.kind in "iu"]
    campaign = campaign.assign({name: campaign[name].astype(float) for name in counts})
    count = campaign.sizes["record"]

    def fill(name: str, told: str, values: Any, **attributes: str) -> None:
        nonlocal campaign
        campaign = campaign.assign({name: ("record", values, attributes)})
        assumed.append(f"{name} is missing: {told}")

    if "valid_samples" not in campaign:
        valid = _last_finite(campaign)
        if np.any(valid < campaign.sizes["time"]):
            told = "the records end with NaN, their last finite samples were taken as the ends"
            fill("valid_samples", f"{told} {valid.tolist()}", valid)
    if "load_rms" not in campaign:
        rate, band = float(campaign.attrs["sampling_frequency"]), band_of(campaign.attrs)
        found = [load_of(force_signal(campaign, record), rate, band) for record in range(count)]
        told = "it was computed from force channel 0"
        fill("load_rms", told, np.array(found), units=load_unit(campaign))
    if "repeat" not in campaign:
        rows = zip(campaign["load_rms"].values, campaign["gap"].values, strict=True)
        keys = [(f"{load:.2g}", f"{gap:.3g}") for load, gap in rows]
        repeats = [keys[:index].count(key) for index, key in enumerate(keys)]
        told = "records of the same load and gap were counted"
        fill("repeat", told, np.array(repeats, np.int64))
    if "split" not in campaign:
        fill(
            "split",
            "all records are fitted, so that nothing is left to verify on: mark one as holdout",
            np.array(["fit"] * count, dtype=object),
        )
    if "record_name" not in campaign:
        numbered = [f"record {index}" for index in range(count)]
        fill("record_name", "records were numbered", np.array(numbered, dtype=object))
    return campaign.assign_attrs({**DEFAULTS, **campaign.attrs, "assumed": "\n".join(assumed)})


def load_of(force: np.ndarray, rate: float, band_Hz: tuple[float, float] | None = None) -> float:
    """Return the load of a record: the RMS of its force (time,) about the mean, in its unit.

    A constant reading, such as the offset of an amplifier, is not a load. NaN if all samples are
    missing; others that are missing are left out.

    rate: Hz.
    band_Hz: only lines within it count; None for all.
    """
    kept = force[np.isfinite(force)].astype(float)
    if not kept.size:
        return float("nan")
    if band_Hz is None:
        return float(kept.std())
    frequency = np.fft.rfftfreq(kept.size, 1.0 / rate)
    inside = (frequency >= band_Hz[0]) & (frequency <= band_Hz[1]) & (frequency > 0.0)
    lines = np.where(inside, np.fft.rfft(kept), 0.0)
    return float(np.fft.irfft(lines, kept.size).std())


def band_of(attributes: Mapping[str, Any]) -> tuple[float, float] | None:
    """Return the band (low, high) in Hz that the attributes of a campaign state, or None."""
    band = attributes.get("band_Hz")
    return None if band is None else (float(band[0]), float(band[1]))


def _last_finite(campaign: xr.Dataset) -> np.ndarray:
    """Return (record,) the number of samples up to the last one that is finite in any channel."""
    samples = campaign.sizes["time"]
    some = np.any(
        [(np.abs(campaign[name].values) <= LARGEST).any(axis=1) for name in ("force", "response")],
        axis=0,
    )
    return np.where(some.any(axis=1), samples - np.argmax(some[:, ::-1], axis=1), 0)


def _sound(campaign: xr.Dataset, path: str | Path, force_needed: bool) -> xr.Dataset:
    """Return the Dataset, one without a force as with_no_force does unless it is needed. Raises
    CampaignError unless it keeps the contract.
    """
    campaign = campaign if force_needed else with_no_force(campaign)
    problems = [*contract_problems(campaign, force_needed)]
    if problems:
        raise CampaignError("\n".join(f"{path}: {problem}" for problem in problems))
    return campaign


def channel_at(campaign: xr.Dataset, position: ArrayLike, direction: ArrayLike, kind: str) -> int:
    """Return the index of the nearest channel of a kind at a point along a direction.

    position (3,): m.
    direction (3,): of either sense; its length does not matter.
    kind: one of KINDS.

    Raises CampaignError when there is none within 5 mm; the message lists the channels.
    """
    axis = np.asarray(direction, float) / np.linalg.norm(direction)
    place = np.asarray(position, float)
    distance = np.linalg.norm(campaign["channel_point"].values - place, axis=1)
    along = np.abs(campaign["channel_direction"].values @ axis) > PARALLEL
    kinds = campaign["channel_kind"].values
    usable = along & (kinds == kind) & (distance < SAME_POINT_M)
    if not usable.any():
        channels = zip(campaign["channel_name"].values, kinds, strict=True)
        raise CampaignError(
            f"the campaign has no channel of kind {kind} within {SAME_POINT_M * 1e3:g} mm of"
            f" {np.round(place, 4).tolist()} m along {np.round(axis, 3).tolist()}: it has "
            + ", ".join(f"{name} ({own})" for name, own in channels)
        )
    return int(np.argmin(np.where(usable, distance, np.inf)))


def valid_count(campaign: xr.Dataset, record: int) -> int:
    """Return the number of valid samples of a record, counted from its start."""
    samples = campaign.sizes["time"]
    stated = (
        float(campaign["valid_samples"].values[record]) if "valid_samples" in campaign else np.nan
    )
    return int(min(max(stated, 0), samples)) if np.isfinite(stated) else samples


def channel_signal(campaign: xr.Dataset, record: int, channel: int) -> np.ndarray:
    """Return (time,) the valid samples of a channel of a record, in SI.

    Raises CampaignError for an unknown unit.
    """
    return measured_values(campaign, "response", record)[channel] * channel_factor(
        campaign, channel
    )


def channel_factor(campaign: xr.Dataset, channel: int) -> float:
    """Return SI units per stored unit of a channel.

    Raises CampaignError for a unit that is unknown or not of the channel's kind.
    """
    name, units, kind = (
        str(campaign[f"channel_{key}"].values[channel]) for key in ("name", "units", "kind")
    )
    return _factor(f"channel {name}", units, kind)


def force_signal(campaign: xr.Dataset, record: int) -> np.ndarray:
    """Return (time,) the valid samples of force channel 0 of a record, in N (V if volts were
    recorded, m/s² for an acceleration of the base).

    Raises CampaignError for an unknown unit.
    """
    return measured_values(campaign, "force", record)[0] * force_factor(campaign, 0)


def measured_values(campaign: xr.Dataset, name: str, record: int) -> np.ndarray:
    """Return (channel, time) the valid samples of the force or response of a record, as stored.

    NaN for a missing sample: one that is not finite, or beyond LARGEST.
    """
    values = campaign[name].values[record, :, : valid_count(campaign, record)]
    with np.errstate(invalid="ignore"):  # a signalling NaN of a damaged file
        values = values.astype(float)
    return np.where(np.abs(values) <= LARGEST, values, np.nan)


def force_factor(campaign: xr.Dataset, force_channel: int) -> float:
    """Return N per stored unit of a force channel (V per unit if volts were recorded, m/s² for
    an acceleration of the base).

    Raises CampaignError for an unknown unit.
    """
    return _factor(
        f"force channel {campaign['force_channel_name'].values[force_channel]}",
        force_units(campaign, force_channel),
        unit_kinds(campaign)[force_channel],
    )


def force_units(campaign: xr.Dataset, force_channel: int) -> str:
    """Return the unit of a force channel as it is stored; N if the file does not say."""
    if "force_channel_units" in campaign:
        return str(campaign["force_channel_units"].values[force_channel])
    return str(campaign["force"].attrs.get("units", "N"))


def _factor(place: str, units: str, kind: str) -> float:
    try:
        return si_factor(units, kind)
    except UnitError as error:
        raise CampaignError(f"{place} {error}") from error


def support_ratios(campaign: xr.Dataset) -> np.ndarray | None:
    """Return (support,) the clearance of each support over the gap of the record.

    None if support_gap is not given. Raises CampaignError when the ratio differs between
    records.
    """
    if "support_gap" not in campaign:
        return None
    gap = campaign["gap"].values.astype(float)[:, None]
    ratio = campaign["support_gap"].values.astype(float) / np.where(gap > 0.0, gap, np.nan)
    if not np.isfinite(ratio).all() or np.ptp(ratio, axis=0).max(initial=0.0) > 0.01 * ratio.mean():
        raise CampaignError(
            "support_gap: its ratio to gap differs from record to record, or has no value in some:"
            " give one campaign for each setting of the plates"
        )
    return ratio.mean(axis=0)
