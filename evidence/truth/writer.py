"""The campaign file, written with netCDF4 by the campaign contract, without the truth."""

import os
from pathlib import Path

import netCDF4
import numpy as np


def write_campaign(path, force, response, channels, drive, records, stated, noise=None):
    """Write a campaign file, under a temporary name until it is complete.

    force (record, time): N, or the unit of the drive.
    response (record, channel, time): in the units of the channels.
    channels: {name, units, kind, point (3,) m, direction (3,)} each; drive: the same, without
    units and kind where it is a force in N.
    records: {name, gap m, repeat, split} each.
    stated: {sampling_frequency Hz, start_up "rest" or "stationary"}.
    noise: (channel,) RMS, or None.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.part{os.getpid()}")
    with netCDF4.Dataset(part, "w") as file:
        file.setncatts(
            {
                "Conventions": "CF-1.8",
                "sampling_frequency": float(stated["sampling_frequency"]),
                "antialias": "fir80",
                "start_up": stated["start_up"],
                "period_samples": np.int64(0),
                "transient_periods": np.int64(0),
                "source": "sealed campaign",
            }
        )
        for name, size in (
            ("record", len(records)),
            ("force_channel", 1),
            ("channel", len(channels)),
            ("time", force.shape[-1]),
            ("xyz", 3),
        ):
            file.createDimension(name, size)
        _series(
            file,
            "force",
            ("record", "force_channel", "time"),
            force[:, None],
            units=drive.get("units", "N"),
        )
        _series(file, "response", ("record", "channel", "time"), response)
        _described(file, "channel", channels, ("units", "kind"))
        _described(file, "force_channel", [drive], ("units", "kind") if "kind" in drive else ())
        _text(file, "record_name", "record", [record["name"] for record in records])
        _numbers(
            file,
            "load_rms",
            ("record",),
            np.sqrt(np.mean(np.square(force.astype(np.float32), dtype=float), axis=-1)),
            units=drive.get("units", "N"),
        )
        _numbers(file, "gap", ("record",), [record["gap"] for record in records], units="m")
        _numbers(file, "repeat", ("record",), [record["repeat"] for record in records], kind="i8")
        _text(file, "split", "record", [record["split"] for record in records])
        if noise is not None:
            _numbers(file, "noise_floor_rms", ("channel",), noise)
        _numbers(
            file,
            "time",
            ("time",),
            np.arange(force.shape[-1]) / stated["sampling_frequency"],
            units="s",
        )
    os.replace(part, path)


def _series(file, name, dims, values, **attributes):
    """A compressed float32 time series."""
    variable = file.createVariable(
        name, "f4", dims, zlib=True, complevel=1, shuffle=True, fill_value=np.float32(np.nan)
    )
    variable.setncatts(attributes)
    variable[:] = values


def _numbers(file, name, dims, values, kind="f8", **attributes):
    """A variable of numbers."""
    variable = file.createVariable(name, kind, dims)
    variable.setncatts(attributes)
    variable[:] = np.asarray(values)


def _text(file, name, dim, values):
    """A variable of texts."""
    file.createVariable(name, str, (dim,))[:] = np.array(values, dtype=object)


def _described(file, dim, channels, more):
    """Name, point, direction and `more` of the channels of a dimension."""
    for key in ("name", *more):
        _text(file, f"{dim}_{key}", dim, [channel[key] for channel in channels])
    _numbers(
        file, f"{dim}_point", (dim, "xyz"), [channel["point"] for channel in channels], units="m"
    )
    _numbers(file, f"{dim}_direction", (dim, "xyz"), [channel["direction"] for channel in channels])
