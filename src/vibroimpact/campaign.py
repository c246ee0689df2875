"""The campaign file: measured forces and responses at several levels and gaps, one netCDF-4 file, read and written here.

Contract. Dimensions record, channel, force_channel, time. force (record, force_channel, time) in N; response (record, channel, time) in
channel_units (channel); channel_kind (channel): acceleration, velocity, displacement, contact_force or generic; channel_name (channel);
channel_point (channel, xyz) in m and channel_direction (channel, xyz), a unit vector, the positive sense; the same for forces. Per record:
record_name, load_rms (N, of force channel 0 over the valid samples), gap (m, NaN where there is none), repeat, split (fit or holdout),
optional valid_samples (the rest NaN). Attributes: sampling_frequency (Hz), antialias, start_up, period_samples, transient_periods, source.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from vibroimpact.records import read_dataset, write_record

KINDS = ("acceleration", "velocity", "displacement", "contact_force", "generic")
TO_SI = {"m s-2": 1.0, "m/s2": 1.0, "m/s^2": 1.0, "m/s²": 1.0, "m.s-2": 1.0, "m s^-2": 1.0, "mm s-2": 1e-3, "mm/s2": 1e-3, "g": 9.80665,
         "m s-1": 1.0, "m/s": 1.0, "mm/s": 1e-3, "mm s-1": 1e-3, "m": 1.0, "mm": 1e-3, "um": 1e-6, "N": 1.0, "kN": 1e3}
NEEDED = {"force": ("record", "force_channel", "time"), "response": ("record", "channel", "time"), "channel_units": ("channel",),
          "channel_kind": ("channel",), "channel_name": ("channel",), "channel_point": ("channel", "xyz"),
          "channel_direction": ("channel", "xyz"), "load_rms": ("record",), "gap": ("record",)}
NEAR_M = 5.0e-3  # a channel farther from a point than this is not at the point
ALONG = 0.99  # least |cosine| between a channel's direction and the wanted one


class CampaignError(Exception):
    """A campaign file that can not be used; the message holds every problem, with the file's name."""


@dataclass(frozen=True)
class Channel:
    """A measured channel: name, point (3,) m, direction (3,), units as UDUNITS text, kind."""

    name: str
    point: tuple
    direction: tuple
    units: str
    kind: str


@dataclass(frozen=True)
class Level:
    """A record of a campaign: name, gap in m, repeat from 0, split "fit" or "holdout"."""

    name: str
    gap_m: float
    repeat: int = 0
    split: str = "fit"


def campaign_dataset(force, response, channels, drives, levels, sampling_frequency, **attributes):
    """Return the Dataset of a campaign by the contract.

    force (record, force_channel, time) N; response (record, channel, time) in the channels' units; channels, drives: lists of Channel
    (drives' units are N); levels: list of Level; sampling_frequency Hz; attributes: source, antialias, start_up.
    """
    dims = {"units": "channel", "kind": "channel", "name": "channel"}
    data = {
        "force": (("record", "force_channel", "time"), np.asarray(force, np.float32), {"units": "N"}),
        "response": (("record", "channel", "time"), np.asarray(response, np.float32)),
        **{f"channel_{key}": (dim, np.array([getattr(channel, key) for channel in channels], dtype=object)) for key, dim in dims.items()},
        "force_channel_name": ("force_channel", np.array([drive.name for drive in drives], dtype=object)),
        "record_name": ("record", np.array([level.name for level in levels], dtype=object)),
        "load_rms": ("record", np.sqrt(np.mean(np.square(np.asarray(force, float)[:, 0]), axis=-1)), {"units": "N"}),
        "gap": ("record", np.array([level.gap_m for level in levels], float), {"units": "m"}),
        "repeat": ("record", np.array([level.repeat for level in levels], np.int64)),
        "split": ("record", np.array([level.split for level in levels], dtype=object)),
        "time": ("time", np.arange(np.shape(force)[-1]) / sampling_frequency, {"units": "s"}),
    }
    for prefix, group, dim in (("channel", channels, "channel"), ("force_channel", drives, "force_channel")):
        data[f"{prefix}_point"] = ((dim, "xyz"), np.array([item.point for item in group], float), {"units": "m"})
        data[f"{prefix}_direction"] = ((dim, "xyz"), np.array([item.direction for item in group], float))
    known = {"antialias": "fir80", "start_up": "stationary", "period_samples": 0, "transient_periods": 0, "source": ""}
    return xr.Dataset(data, attrs={"sampling_frequency": float(sampling_frequency), **known, **attributes})


def write_campaign(campaign, path):
    """Write a campaign Dataset. Raises CampaignError when it breaks the contract."""
    _require(campaign, path)
    write_record(campaign.assign_attrs(title="vibroimpact campaign"), path)


def read_campaign(path):
    """Return the campaign Dataset of a file.

    Raises RecordError when there is no such file or it is not netCDF, CampaignError with every breach of the contract.
    """
    campaign = read_dataset(path)
    _require(campaign, path)
    return campaign


def _require(campaign, path):
    """Raise CampaignError unless the Dataset keeps the contract."""
    problems = [*_problems(campaign)]
    if problems:
        raise CampaignError("\n".join(f"{path}: {problem}" for problem in problems))


def _problems(campaign):
    """Yield a sentence for every breach of the contract."""
    for name, dims in NEEDED.items():
        if name not in campaign:
            yield f"has no variable '{name}' {dims}: see the contract in campaign.py"
        elif campaign[name].dims != dims:
            yield f"'{name}' has dimensions {campaign[name].dims}, expected {dims}"
    if not campaign.attrs.get("sampling_frequency", 0.0) > 0.0:
        yield "has no attribute sampling_frequency in Hz"
    if "force" in campaign and campaign["force"].attrs.get("units", "N") != "N":
        yield f"the unit of 'force' is {campaign['force'].attrs['units']}, expected N"
    if "channel_kind" in campaign:
        for kind in sorted({str(kind) for kind in campaign["channel_kind"].values} - set(KINDS)):
            yield f"channel_kind '{kind}' is unknown: use one of {', '.join(KINDS)}"


def channel_at(campaign, position, direction, kind):
    """Return the index of the channel of a kind at position (3,) m along direction (3,), of either sense; the nearest one.

    Raises CampaignError when there is none within 5 mm; the message lists the channels there are.
    """
    direction = np.asarray(direction, float) / np.linalg.norm(direction)
    distance = np.linalg.norm(campaign["channel_point"].values - np.asarray(position, float), axis=1)
    along = np.abs(campaign["channel_direction"].values @ direction) > ALONG
    usable = along & (campaign["channel_kind"].values == kind) & (distance < NEAR_M)
    if not usable.any():
        known = ", ".join(f"{name} ({kind})" for name, kind in zip(campaign["channel_name"].values, campaign["channel_kind"].values,
                                                                   strict=True))
        raise CampaignError(f"the campaign has no channel of kind {kind} within {NEAR_M * 1e3:g} mm of {np.round(position, 4).tolist()} m along "
                            f"{np.round(direction, 3).tolist()}: it has {known}")
    return int(np.argmin(np.where(usable, distance, np.inf)))


def channel_signal(campaign, record, channel):
    """Return (time,) the valid samples of a channel of a record, in SI. Raises CampaignError for a unit that is not known."""
    units = str(campaign["channel_units"].values[channel]).strip()
    if units not in TO_SI:
        raise CampaignError(f"channel {campaign['channel_name'].values[channel]} has the unit '{units}': known are {', '.join(TO_SI)}")
    samples = int(campaign["valid_samples"].values[record]) if "valid_samples" in campaign else campaign.sizes["time"]
    return campaign["response"].values[record, channel, :samples].astype(float) * TO_SI[units]
