"""The channels and records of a campaign that are compared with a model, and reasons against a
comparison.

The model simulates motions under forces in N or on a moving base, strains of the outer fibre of a
tube, and the forces of supports. Other channels are left out, with a sentence that says why.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.campaign.file import CampaignError, force_units, support_ratios, valid_count
from vibroimpact.campaign.force_kinds import BASE, FORCE, force_kinds
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.geometry.sections import outer_width
from vibroimpact.integration.output_filter import PASS_FRACTION
from vibroimpact.io.units import UnitError, si_factor
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.point_structure import build_point_structure
from vibroimpact.structure.tube import build_structure

from .named_places import LEAST_COSINE, no_motion, point_at
from .sensed_motion import CONTACT_FORCE, SENSED, STRAIN, across, support_at
from .sensor_chain import NO_CHANNELS

READ = ", ".join(SENSED).replace("_", " ")
LEFT_OUT = "channels"  # name of the check
# Largest |cosine| between the outward normal at a gauge and the tangent of the tube. The chord of a
# bend deviates from its tangent by less.
LEANS = 0.2
ON_AXIS = 0.99  # least |cosine| of that normal with an axis of a section that is not round
SHORTEST_RECORD_S = 2.5  # spectra are averages of segments of 2 s; motion is known between fades
SHORT = "short records"  # name of the check
SHOWN = 5.0  # of the first mode of a model: motion that records show at least
NO_DIRECTION = 1.0e-6  # a shorter vector has no direction
LIKELY_MM = 10.0  # m: a coordinate larger than those of most structures may be in millimetres
IDENTIFIED = "model=identified compares without a model"


class Place(NamedTuple):
    """A channel or a force of a campaign. point (3,): m. direction (3,). directed, known: whether
    its direction, and its point too, is known.
    """

    number: int
    name: str
    kind: str
    point: np.ndarray
    direction: np.ndarray
    directed: bool
    known: bool

    def fault(self) -> str:
        """Return why no model can be compared with a channel, "" if one can."""
        if self.kind not in SENSED:
            return (
                f"is of kind {self.kind.replace('_', ' ')}; a comparison with a model reads {READ}:"
                " it is left out"
            )
        lost = "has no known place and direction: it is left out of a comparison with a model"
        return "" if self.known else lost


def _places(campaign: xr.Dataset, what: str) -> list[Place]:
    """Return the Places of "channel", or of "force_channel": forces and accelerations of a base."""
    kinds = campaign["channel_kind"].values if what == "channel" else force_kinds(campaign)
    names = map(str, campaign[f"{what}_name"].values)
    points, directions = (
        campaign[f"{what}_{key}"].values.astype(float) for key in ("point", "direction")
    )
    directed = np.linalg.norm(directions, axis=1) > NO_DIRECTION
    known = directed & np.isfinite(points).all(axis=1)
    rows = zip(names, map(str, kinds), points, directions, directed, known, strict=True)
    return [Place(number, *row) for number, row in enumerate(rows)]


def compared_channels(campaign: xr.Dataset) -> list[Place]:
    """Return the channels that are compared with a model."""
    return [channel for channel in _places(campaign, "channel") if not channel.fault()]


def _forces(campaign: xr.Dataset) -> list[Place]:
    """Return the forces that act at a place."""
    return [force for force in _places(campaign, "force_channel") if force.kind != BASE]


def channel_rows(campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each channel that is left out of the comparison."""
    return _left_out((channel, channel.fault()) for channel in _places(campaign, "channel"))


def record_rows(campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each record that is too short for a comparison."""
    names, rate = campaign["record_name"].values, float(campaign.attrs["sampling_frequency"])
    seconds = [valid_count(campaign, record) / rate for record in range(names.size)]
    return [
        check_row(
            SHORT,
            "warn",
            f"Record {name} is {duration:.3g} s long: it is left out of a comparison with a model,"
            f" which takes {SHORTEST_RECORD_S:g} s or more.",
            record=str(name),
        )
        for name, duration in zip(names, seconds, strict=True)
        if duration < SHORTEST_RECORD_S
    ]


def model_rows(config: ConfigPart, campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each channel that a model does not give: on a tube strains other
    than bending strains; on a structure of named points strains, and motions along which its point
    has no degree of freedom.
    """
    tube = config.structure.kind in TUBES
    structure: Any = build_structure(config) if tube else build_point_structure(config)

    def why(channel: Place) -> str:
        if channel.kind == STRAIN and tube:
            return _no_gauge(structure, channel)
        if channel.kind == STRAIN:
            return "is a strain, which a structure of named points does not tell: it is left out"
        if tube or channel.kind == CONTACT_FORCE:
            return ""
        still = no_motion(structure, config.points, channel.point, channel.direction)
        return f"measures {still}: it is left out" if still else ""

    return _left_out((channel, why(channel)) for channel in compared_channels(campaign))


def sampling_rows(model: ModalModel, campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks if the records show the first mode of a model alone, or none, or if
    the model has none.
    """
    elastic = model.frequencies[model.omega > 0.0]
    if not elastic.size:
        sentence = "The model has no mode but rigid-body motion: hold it by a spring or an end."
        return [check_row("model", "refuse", sentence)]
    rate = float(campaign.attrs["sampling_frequency"])
    top, first = 0.5 * PASS_FRACTION * rate, float(elastic.min())
    if top > SHOWN * first:
        return []
    sentence = (
        f"Sampled at {rate:.4g} Hz, records show motion to {top:.3g} Hz, and the first mode of the"
        f" model is at {first:.3g} Hz; contact shows in higher ones. Sample at"
        f" {2.0 * SHOWN * first / PASS_FRACTION:.0f} Hz or more."
    )
    return [check_row("sampling", "refuse" if top < first else "warn", sentence)]


def contact_force_fault(model: ModalModel, channel: Place) -> str:
    """Return why a contact force is left out of the comparison, "" if it is not; model: attached to
    the campaign.
    """
    support = support_at(model, channel.point)
    if support is None:
        return (
            "is a contact force at no support of the model"
            f" ({', '.join(model.support_names) or 'it has none'}): it is left out; give as"
            " channel_point the middle of its support"
        )
    if np.abs(across(model, support) @ unit_vector(channel.direction)).max() < LEAST_COSINE:
        return (
            "is a contact force along the tube, in which direction"
            f" {model.support_names[support]} has none in the model: it is left out"
        )
    return ""


def contact_force_rows(model: ModalModel, campaign: xr.Dataset) -> list[dict]:
    """Return a row of checks for each contact force that is left out of the comparison."""
    return _left_out(
        (channel, contact_force_fault(model, channel))
        for channel in compared_channels(campaign)
        if channel.kind == CONTACT_FORCE
    )


def _no_gauge(structure, gauge: Place) -> str:
    """Return why a gauge does not measure a bending strain of a TubeStructure, "" if it does; its
    direction is the outward normal there.
    """
    normal, place = (
        unit_vector(gauge.direction),
        structure.centreline.locate(gauge.point, "the gauge"),
    )
    along = abs(structure.centreline.direction(place) @ normal)
    if along > LEANS:
        return (
            f"is a strain whose channel_direction is along the tube (cosine {along:.2f}): it is"
            " left out; give the outward normal of the tube where the gauge is glued"
        )
    if structure.first_axis is None:
        return ""
    nearest = np.abs(structure.section_axes(place) @ normal).max()
    if nearest < ON_AXIS:
        return (
            "is a strain between the axes of a section that is not round (cosine"
            f" {nearest:.2f} with the nearest axis), where the model does not say how far off the"
            " centre the surface is: it is left out; glue gauges on an axis of the section"
        )
    return ""


def left_out(checks: list[dict]) -> set[str]:
    """Return the names of the channels that rows of checks leave out of the comparison."""
    return {row["channel"] for row in checks if row["check"] == LEFT_OUT and row["channel"]}


def _left_out(faults) -> list[dict]:
    """Return a row of checks for each fault of (channel, fault or "")."""
    return [
        check_row(LEFT_OUT, "warn", f"{channel.name} {why}.", channel=channel.name)
        for channel, why in faults
        if why
    ]


def campaign_problems(campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign, which keeps the contract, can not be compared with any
    model; its signals are not read.
    """
    problems = []
    compared = compared_channels(campaign)
    if not compared:
        kinds = sorted({channel.kind for channel in _places(campaign, "channel")})
        problems.append(
            f"no channel can be compared with a model, which gives {READ}: channel_kind is"
            f" {', '.join(kinds)}; {IDENTIFIED}"
        )
    problems += [
        f"channel_name[{channel.number}] = '{channel.name}' stands for several channels in a"
        " verdict: give the channel another name"
        for channel in compared
        if channel.name in NO_CHANNELS
    ]
    problems += _drive_problems(campaign)
    try:
        support_ratios(campaign)
    except CampaignError as error:
        problems.append(str(error))
    return problems


def _drive_problems(campaign: xr.Dataset) -> Iterator[str]:
    """Yield sentences on forces and accelerations of the base that can not drive a model."""
    drives = _places(campaign, "force_channel")
    first = {drive.kind: drive for drive in reversed(drives)}
    if len(first) > 1:
        force, base = first[FORCE], first[BASE]
        yield (
            f"force_channel_kind[{force.number}] = '{FORCE}' ({force.name}) beside"
            f" force_channel_kind[{base.number}] = '{BASE}' ({base.name}): a comparison reads"
            " forces or the motion of the base, not both at once; give a campaign for each, with"
            " records in which the other was still"
        )
    for drive in drives:
        if drive.kind == BASE:
            if not drive.directed:
                yield (
                    f"base acceleration {drive.name} has no known direction, but drives the model:"
                    f" give force_channel_direction[{drive.number}]"
                )
            continue
        if not drive.known:
            yield (
                f"force channel {drive.name} has no known place and direction, but drives the"
                f" model: give force_channel_point[{drive.number}] and"
                f" force_channel_direction[{drive.number}]"
            )
        try:
            si_factor(force_units(campaign, drive.number), "force")
        except UnitError as error:
            yield f"force channel {drive.name} {error}; {IDENTIFIED}"


def comparison_problems(config: ConfigPart, campaign: xr.Dataset) -> list[str]:
    """Return sentences on why a campaign can not be compared with the model of a checked Config;
    see campaign_problems.
    """
    problems, force = [], config.excitation
    if BASE in force_kinds(campaign):
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
    problems += campaign_problems(campaign)
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


def _push_problems(config, campaign):
    """Yield a sentence for every force along which a structure of named points does not move."""
    structure = build_point_structure(config)
    for force in filter(lambda force: force.known, _forces(campaign)):
        still = no_motion(structure, config.points, force.point, force.direction)
        if still:
            yield f"force channel {force.name} acts {still}: give its degree of freedom a name"


def _place_problems(config, campaign):
    """Yield a sentence for every channel and force that is not on the structure."""
    if config.structure.kind in TUBES:
        locate, on = build_centreline(config.structure).locate, "on the tube"
    else:
        locate, on = partial(point_at, config.points), "at a named point"
    kept = {"channel": compared_channels(campaign), "force_channel": _forces(campaign)}
    for what, places in kept.items():
        for at in places:
            off = _off(locate, at.point, f"{what}_point[{at.number}]")
            far = np.abs(at.point).max() > LIKELY_MM
            if off and far and not _off(locate, 1.0e-3 * at.point, ""):
                off += f"; a thousandth of it is {on}: is it in millimetres? Write metres"
            if off:
                yield f"{what.replace('_', ' ')} {at.name}: {off}"


def _off(locate, point, place):
    """Return a sentence if a known point (3,) in m is not on the structure, else None; locate:
    raises ValueError there, see Centreline.locate and point_at.
    """
    try:
        if np.isfinite(point).all():
            locate(point, place)
    except ValueError as error:
        return str(error)
    return None
