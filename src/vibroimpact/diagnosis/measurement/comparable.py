"""Which channels of a campaign are compared with a model, and why a comparison is not possible.

The model simulates motions under forces in N or on a moving base, strains of the outer fibre of a
tube, and the forces of supports. Other channels are left out. A campaign with too little
left is refused. Each comes with a sentence that says why.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, force_units, support_ratios
from vibroimpact.campaign.force_kinds import BASE, FORCE, base_channels
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.geometry.sections import outer_width
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.point_structure import build_point_structure
from vibroimpact.structure.tube import build_structure
from vibroimpact.units import UnitError, si_factor

from .named_places import LEAST_COSINE, no_motion, point_at
from .sensed_motion import CONTACT_FORCE, SENSED, STRAIN, across, support_at
from .sensor_chain import NO_CHANNELS

READ = ", ".join(SENSED).replace("_", " ")
LEFT_OUT = "channels"  # name of the check
# Largest |cosine| between the outward normal at a gauge and the tangent of the tube. The chord of a
# bend deviates from its tangent by less.
LEANS = 0.2
ON_AXIS = 0.99  # least |cosine| of that normal with an axis of a section that is not round
NO_DIRECTION = 1.0e-6  # a shorter vector has no direction
IDENTIFIED = "model=identified compares without a model"


def _channel_faults(campaign: xr.Dataset) -> dict[int, str]:
    """Return {channel index: sentence} of the channels that can not be compared with any model."""
    faults = {}
    for channel in range(campaign.sizes["channel"]):
        name, kind = (str(campaign[f"channel_{key}"].values[channel]) for key in ("name", "kind"))
        if kind not in SENSED:
            faults[channel] = (
                f"{name} is of kind {kind.replace('_', ' ')}; a comparison with a model reads"
                f" {READ}: it is left out"
            )
        elif _nowhere(campaign, "channel", channel):
            faults[channel] = (
                f"{name} has no known place and direction: it is left out of a comparison with a"
                " model"
            )
    return faults


def compared_channels(campaign: xr.Dataset) -> np.ndarray:
    """Return (channel,) bool, whether a channel is compared with a model."""
    faults = _channel_faults(campaign)
    return np.array([channel not in faults for channel in range(campaign.sizes["channel"])])


def channel_rows(campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each channel that is left out of the comparison."""
    names = campaign["channel_name"].values
    return [
        _left_out(str(names[channel]), sentence)
        for channel, sentence in _channel_faults(campaign).items()
    ]


def model_rows(config: ConfigPart, campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each channel that a model gives nothing of: strains of a tube that
    are no bending strains; of a structure of named points strains, and motions along which its
    point has no degree of freedom.
    """
    tube = config.structure.kind in TUBES
    structure: Any = build_structure(config) if tube else build_point_structure(config)
    rows = []
    for channel in np.flatnonzero(compared_channels(campaign)):
        name, kind, place, direction = (
            campaign[f"channel_{key}"].values[channel]
            for key in ("name", "kind", "point", "direction")
        )
        why = ""
        if kind == STRAIN and tube:
            why = _no_gauge(structure, place.astype(float), unit_vector(direction.astype(float)))
        elif kind == STRAIN:
            why = "is a strain, which a structure of named points does not tell: it is left out"
        elif kind != CONTACT_FORCE and not tube:
            still = no_motion(structure, config.points, place, direction)
            why = f"measures {still}: it is left out" if still else ""
        if why:
            rows.append(_left_out(str(name), f"{name} {why}"))
    return rows


def contact_force_fault(
    model: ModalModel, position: np.ndarray, direction: np.ndarray
) -> str | None:
    """Return why a contact force is left out of the comparison, None where it is not.

    model: attached to the campaign. position (3,): m. direction (3,): of the channel.
    """
    support = support_at(model, position)
    if support is None:
        return (
            "is a contact force at no support of the model"
            f" ({', '.join(model.support_names) or 'it has none'}): it is left out; give as"
            " channel_point the middle of its support"
        )
    if np.abs(across(model, support) @ unit_vector(direction)).max() < LEAST_COSINE:
        return (
            "is a contact force along the tube, in which direction"
            f" {model.support_names[support]} has none in the model: it is left out"
        )
    return None


def contact_force_rows(model: ModalModel, campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each contact force that is left out; arguments as of
    contact_force_fault.
    """
    rows = []
    for channel in np.flatnonzero(campaign["channel_kind"].values == CONTACT_FORCE):
        name = str(campaign["channel_name"].values[channel])
        why = contact_force_fault(
            model, model.sensor_positions[channel], model.sensor_directions[channel]
        )
        if why:
            rows.append(_left_out(name, f"{name} {why}"))
    return rows


def _no_gauge(structure, point, normal):
    """Return why a gauge does not measure a bending strain of the model, None where it does.

    structure: TubeStructure. point (3,): m. normal (3,): outward unit normal at the gauge.
    """
    place = structure.centreline.locate(point, "the gauge")
    along = abs(structure.centreline.direction(place) @ normal)
    if along > LEANS:
        return (
            f"is a strain whose channel_direction is along the tube (cosine {along:.2f}): it is"
            " left out; give the outward normal of the tube where the gauge is glued"
        )
    if structure.first_axis is None:
        return None
    nearest = np.abs(structure.section_axes(place) @ normal).max()
    if nearest < ON_AXIS:
        return (
            "is a strain between the axes of a section that is not round (cosine"
            f" {nearest:.2f} with the nearest axis), where the model does not say how far off the"
            " centre the surface is: it is left out; glue gauges on an axis of the section"
        )
    return None


def left_out(checks: list[dict]) -> set[str]:
    """Return the names of the channels that rows of checks leave out of the comparison."""
    return {row["channel"] for row in checks if row["check"] == LEFT_OUT and row["channel"]}


def _left_out(name: str, sentence: str) -> dict:
    return check_row(LEFT_OUT, "warn", f"{sentence}.", channel=name)


def _model_problems(config: ConfigPart, on_base: bool) -> list[str]:
    """Return sentences on why a model can not be compared with any campaign.

    on_base: whether the campaign measured the motion of the base instead of a force.
    """
    problems = []
    force = config.excitation
    if on_base:
        if force.kind == "base_motion" and force.obstacles == "fixed":
            problems.append(
                "excitation.obstacles = 'fixed', but a campaign on a moving base is compared with"
                " supports that ride on the base: give obstacles: moving"
            )
    elif not (hasattr(force, "point") and hasattr(force, "direction")):
        problems.append(
            f"excitation.kind = '{force.kind}' has no point at which the measured force acts: give"
            " a model with excitation.kind: band_limited, and its point and direction"
        )
    return problems


def campaign_problems(campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign can not be compared with any model.

    campaign: keeps the contract; its signals are not read.
    """
    problems = []
    faults = _channel_faults(campaign)
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
    bases = base_channels(campaign)
    problems += _mixed_problems(campaign, bases)
    for channel, name in enumerate(campaign["force_channel_name"].values):
        if bases[channel]:
            if not _directed(campaign, "force_channel", channel):
                problems.append(
                    f"base acceleration {name} has no known direction, but drives the model: give"
                    f" force_channel_direction[{channel}]"
                )
            continue
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


def comparison_problems(config: ConfigPart, campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign can not be compared with a model.

    config: a checked Config.
    campaign: as in campaign_problems.
    """
    on_base = bool(base_channels(campaign).any())
    problems = [*_model_problems(config, on_base), *campaign_problems(campaign)]
    if config.structure.kind in TUBES:
        problems += _gap_problems(config, campaign)
    elif not config.points:
        return [
            *problems,
            f"structure.kind = '{config.structure.kind}' does not say where its named points are:"
            f" give `points`, {{name: [x, y, z]}} in m; {IDENTIFIED}",
        ]
    else:
        problems += _push_problems(config, campaign)
    return [*problems, *_place_problems(config, campaign)]


def _mixed_problems(campaign, bases):
    """Yield a sentence where a campaign has both forces and accelerations of the base."""
    if bases.any() and not bases.all():
        force, base = int(np.argmin(bases)), int(np.argmax(bases))
        names = campaign["force_channel_name"].values
        yield (
            f"force_channel_kind[{force}] = '{FORCE}' ({names[force]}) beside"
            f" force_channel_kind[{base}] = '{BASE}' ({names[base]}): a comparison reads forces or"
            " the motion of the base, not both at once; give a campaign for each, with records in"
            " which the other was still"
        )


def _directed(campaign: xr.Dataset, what: str, channel: int) -> bool:
    """Return whether the direction of a channel is known."""
    direction = campaign[f"{what}_direction"].values[channel].astype(float)
    return bool(np.linalg.norm(direction) > NO_DIRECTION)


def _nowhere(campaign: xr.Dataset, what: str, channel: int) -> bool:
    """Return whether the place or the direction of a channel is unknown."""
    point = campaign[f"{what}_point"].values[channel].astype(float)
    return not (np.isfinite(point).all() and _directed(campaign, what, channel))


def _gap_problems(config, campaign):
    """Yield a sentence for gaps that are larger than the width of the tube."""
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
    """Yield a sentence for every channel and force that is not on the structure."""
    if config.structure.kind in TUBES:
        locate, on = build_centreline(config.structure).locate, "on the tube"
    else:
        locate, on = partial(point_at, config.points), "at a named point"
    kept = {
        "channel": compared_channels(campaign),
        "force_channel": ~base_channels(campaign),
    }
    for what, chosen in kept.items():
        for channel in np.flatnonzero(chosen):
            point = campaign[f"{what}_point"].values[channel].astype(float)
            if not np.isfinite(point).all():
                continue
            off = _off(locate, point, f"{what}_point[{channel}]")
            if off and not _off(locate, 1.0e-3 * point, ""):
                off += f"; a thousandth of it is {on}: is it in millimetres? Write metres"
            if off:
                name = campaign[f"{what}_name"].values[channel]
                yield f"{what.replace('_', ' ')} {name}: {off}"


def _push_problems(config, campaign):
    """Yield a sentence for every force that pushes a structure of named points where it does not
    move.
    """
    structure = build_point_structure(config)
    for channel in np.flatnonzero(~base_channels(campaign)):
        if _nowhere(campaign, "force_channel", channel):
            continue
        name, place, direction = (
            campaign[f"force_channel_{key}"].values[channel]
            for key in ("name", "point", "direction")
        )
        still = no_motion(structure, config.points, place, direction)
        if still:
            yield f"force channel {name} acts {still}: give its degree of freedom a name"


def _off(locate: Callable, point: np.ndarray, place: str) -> str | None:
    """Return a sentence where a point (3,) in m is not on the structure, None where it is; locate:
    raises ValueError there, see Centreline.locate and point_at.
    """
    try:
        locate(point, place)
    except ValueError as error:
        return str(error)
    return None
