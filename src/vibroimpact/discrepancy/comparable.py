"""What of a campaign is compared with a model, and why a campaign and a model can not be compared.

Simulated are accelerations and displacements of a tube under forces in N. Nothing else is simulated
in their place: other channels are left out, and what leaves too little is refused, both with a
sentence.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, force_units, support_ratios
from vibroimpact.config.name_checks import TUBES
from vibroimpact.geometry.centreline import Centreline, build_centreline
from vibroimpact.geometry.sections import outer_width
from vibroimpact.units import UnitError, si_factor

from .measuring import NO_CHANNELS

SIMULATED = ("acceleration", "displacement")
READ = " and ".join(SIMULATED)
NO_DIRECTION = 1.0e-6  # length below which a vector has no direction
IDENTIFIED = "model=identified compares without a model"


def channel_faults(campaign: xr.Dataset) -> dict[int, str]:
    """Return {channel: sentence} of the channels that no model is compared with."""
    faults = {}
    for channel in range(campaign.sizes["channel"]):
        name, kind = (str(campaign[f"channel_{key}"].values[channel]) for key in ("name", "kind"))
        if kind not in SIMULATED:
            faults[channel] = (
                f"{name} measures {kind.replace('_', ' ')}; a comparison with a model reads {READ}:"
                " it is left out"
            )
        elif _nowhere(campaign, "channel", channel):
            faults[channel] = (
                f"{name} has no known place and direction: it is left out of a comparison with a"
                " model"
            )
    return faults


def compared_channels(campaign: xr.Dataset) -> np.ndarray:
    """Return (channel,) bool, whether a model is compared with a channel."""
    faults = channel_faults(campaign)
    return np.array([channel not in faults for channel in range(campaign.sizes["channel"])])


def channel_rows(campaign: xr.Dataset) -> list[dict]:
    """Return the rows of checks that tell which channels are left out."""
    names = campaign["channel_name"].values
    return [
        check_row("channels", "warn", f"{sentence}.", channel=str(names[channel]))
        for channel, sentence in channel_faults(campaign).items()
    ]


def model_problems(config: Any) -> list[str]:
    """Return sentences on why no campaign can be compared with a model."""
    problems = []
    if config.structure.kind not in TUBES:
        problems.append(
            f"structure.kind = '{config.structure.kind}' can not be compared with a campaign: give"
            f" a model of kind {' or '.join(TUBES)}; {IDENTIFIED}"
        )
    force = config.excitation
    if not (hasattr(force, "point") and hasattr(force, "direction")):
        problems.append(
            f"excitation.kind = '{force.kind}' has no point at which the measured force acts: give"
            " a model with excitation.kind: band_limited, and its point and direction"
        )
    return problems


def campaign_problems(campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign can be compared with no model.

    campaign: keeps the contract; its signals are not looked at.
    """
    problems = []
    faults = channel_faults(campaign)
    if len(faults) == campaign.sizes["channel"]:
        kinds = sorted({str(kind) for kind in campaign["channel_kind"].values})
        problems.append(
            f"no channel can be compared with a model, which gives {READ}: channel_kind is"
            f" {', '.join(kinds)}; {IDENTIFIED}"
        )
    for channel, name in enumerate(campaign["channel_name"].values):
        if channel not in faults and name in NO_CHANNELS:
            problems.append(
                f"channel_name[{channel}] = '{name}' stands for several channels in a verdict: give"
                " the channel another name"
            )
    for channel, name in enumerate(campaign["force_channel_name"].values):
        if _nowhere(campaign, "force_channel", channel):
            problems.append(
                f"force channel {name} has no known place and direction, but drives the model: give"
                f" force_channel_point[{channel}] and force_channel_direction[{channel}]"
            )
        try:
            si_factor(force_units(campaign, channel), "force")
        except UnitError as error:
            problems.append(f"force channel {name} {error}; {IDENTIFIED}")
    try:
        support_ratios(campaign)
    except CampaignError as error:
        problems.append(str(error))
    return problems


def comparison_problems(config: Any, campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign can not be compared with a model.

    config: a checked Config.
    campaign: as in campaign_problems.
    """
    problems = [*model_problems(config), *campaign_problems(campaign)]
    if config.structure.kind in TUBES:
        problems += [*_gap_problems(config, campaign), *_place_problems(config, campaign)]
    return problems


def _nowhere(campaign: xr.Dataset, what: str, channel: int) -> bool:
    """Whether the place or the direction of a channel is not known."""
    point, direction = (
        campaign[f"{what}_{key}"].values[channel].astype(float) for key in ("point", "direction")
    )
    return not (np.isfinite(point).all() and np.linalg.norm(direction) > NO_DIRECTION)


def _gap_problems(config, campaign):
    """Yield a sentence about a gap that the tube can not have."""
    width = outer_width(config.structure.section)
    for name in ("gap", "support_gap"):
        values = campaign[name].values.astype(float) if name in campaign else np.zeros(0)
        wide = np.argwhere(values > width)
        if wide.size:
            place = tuple(wide[0])
            index = "".join(f"[{number}]" for number in place)
            more = f" (and {len(wide) - 1} more)" if len(wide) > 1 else ""
            yield (
                f"{name}{index} = {values[place]:g} m{more} is larger than the tube's width of"
                f" {width:g} m: is it in millimetres? Write metres"
            )


def _place_problems(config, campaign):
    """Yield a sentence for every channel and force that is not on the tube."""
    line = build_centreline(config.structure)
    kept = {
        "channel": compared_channels(campaign),
        "force_channel": np.ones(campaign.sizes["force_channel"], bool),
    }
    for what, chosen in kept.items():
        for channel in np.flatnonzero(chosen):
            point = campaign[f"{what}_point"].values[channel].astype(float)
            if not np.isfinite(point).all():
                continue
            off = _off(line, point, f"{what}_point[{channel}]")
            if off and not _off(line, 1.0e-3 * point, ""):
                off += "; a thousandth of it is on the tube: is it in millimetres? Write metres"
            if off:
                name = campaign[f"{what}_name"].values[channel]
                yield f"{what.replace('_', ' ')} {name}: {off}"


def _off(line: Centreline, point: np.ndarray, place: str) -> str | None:
    """Return a sentence where a point (3,) in m is not on the tube, else None."""
    try:
        line.locate(point, place)
    except ValueError as error:
        return str(error)
    return None
