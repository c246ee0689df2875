"""The drive of the structure of a campaign: measured forces, or the measured motion of its base.

The variable force_channel_kind (force_channel) says it; without it every force channel is a force.
"""

from typing import Literal, get_args

import numpy as np
import xarray as xr

ForceKind = Literal["force", "base_acceleration"]
FORCE_KINDS = get_args(ForceKind)
FORCE, BASE = FORCE_KINDS


def force_kinds(campaign: xr.Dataset) -> list[str]:
    """Return (force_channel,) the kinds of the force channels, each one of FORCE_KINDS."""
    if "force_channel_kind" not in campaign:
        return [FORCE] * campaign.sizes["force_channel"]
    return [str(kind) for kind in campaign["force_channel_kind"].values]


def base_channels(campaign: xr.Dataset) -> np.ndarray:
    """Return (force_channel,) bool, whether a force channel is an acceleration of the base."""
    return np.array([kind == BASE for kind in force_kinds(campaign)], bool)


def unit_kinds(campaign: xr.Dataset) -> list[str]:
    """Return (force_channel,) the kind as which units.si_factor converts each force channel."""
    return [BASE if kind == BASE else "excitation" for kind in force_kinds(campaign)]


def load_unit(campaign: xr.Dataset) -> str:
    """Return the SI unit of the loads, as UDUNITS text: that of the first force channel."""
    return "m s-2" if base_channels(campaign)[0] else "N"


def shown_load_unit(campaign: xr.Dataset) -> str:
    """Return the unit of the loads in words."""
    return {"m s-2": "m/s²"}.get(load_unit(campaign), "N")
