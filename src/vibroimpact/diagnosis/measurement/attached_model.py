"""The reduced model with the channels and forces of a campaign as its sensors and drives."""

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import CampaignError, support_ratios
from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.config.excitation import BandSignal, BaseMotion
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.schema import Sensors
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.force_vectors import turn_axis, turned_direction
from vibroimpact.reduction.basis import Basis
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model, reduced_basis

from .named_places import point_at
from .sensed_motion import STRAIN, moving, of_modes

SAME_POINT_M = 1.0e-3
ANY_SIGNAL = BandSignal(kind="band_limited", band_Hz=(1.0, 200.0))  # no model depends on it


def attach(config: ConfigPart, campaign: xr.Dataset, basis: Basis | None = None) -> ModalModel:
    """Return the ModalModel of `config` with the campaign's channels as sensors and its forces as
    drives, without shape line and stresses.

    config: a checked Config or StageSettings. basis: see build_model and attached_basis. The
    sensors are in the order of the channels: displacements, positive along channel_direction; for
    a strain gauge on a tube the strain of the outer fibre; for a contact force zero. With a
    campaign on a moving base, the drives are the accelerations of the base, and motions are
    relative to it. Raises ValueError for a channel or force that is more than 5 mm off the tube, or
    off the named points of another structure, CampaignError for another number of supports; see
    comparable.comparison_problems.
    """
    kinds, bases = campaign["channel_kind"].values, _base_directions(campaign)
    channels = len(kinds)
    places, directions = (_of_sensors_and_forces(campaign, key) for key in ("point", "direction"))
    gauged = np.flatnonzero(kinds == STRAIN)
    config = _on_base(config, bases[0]) if len(bases) else config
    model, displacements = _displacement_shapes(
        config, places, {int(number): directions[number] for number in gauged}, basis
    )
    along = directions / np.linalg.norm(directions, axis=1)[:, None]
    # excitation.turn_deg turns the forces; the sensors keep their directions
    acting = along.copy()
    angle = getattr(config.excitation, "turn_deg", 0.0)
    for number in range(channels, len(places)) if angle else ():
        acting[number] = turned_direction(along[number], angle, turn_axis(config, places[number]))
    shapes = np.einsum("mpa,pa->mp", displacements, acting)
    shapes[:, :channels] *= of_modes(kinds)
    shapes[:, gauged] = model.sensor_shapes[:, 3 * len(places) :]
    drive_shapes = shapes[:, channels:]
    if len(bases):
        more = (build_model(_on_base(config, each), motion_only=True) for each in bases[1:])
        drive_shapes = np.hstack([each.drive_shapes for each in (model, *more)])
    return replace(
        model,
        gap_factor=model.gap_factor * _ratio_of_points(campaign, model),
        sensor_shapes=shapes[:, :channels],
        sensor_names=tuple(map(str, campaign["channel_name"].values)),
        sensor_positions=places[:channels],
        sensor_directions=along[:channels],
        drive_shapes=drive_shapes,
    )


def attached_basis(config: ConfigPart, campaign: xr.Dataset) -> Basis | None:
    """Return the Basis of a tube attached to a campaign, on which its variants are reduced; None
    for another structure, which is small.
    """
    if config.structure.kind not in TUBES:
        return None
    bases, places = _base_directions(campaign), _of_sensors_and_forces(campaign, "point")
    return reduced_basis(_with_places(_on_base(config, bases[0]) if len(bases) else config, places))


def _base_directions(campaign):
    """Return (base acceleration, 3) the directions of the accelerations of the base."""
    return campaign["force_channel_direction"].values[base_channels(campaign)].astype(float)


def _of_sensors_and_forces(campaign, key):
    """Return (channel and force, 3): "point" or "direction" of the channels, then of the forces."""
    forces = campaign[f"force_channel_{key}"].values[~base_channels(campaign)]
    return np.concatenate([campaign[f"channel_{key}"].values, forces]).astype(float)


def _on_base(config, direction):
    """Return the configuration of a structure whose base moves along a direction (3,), with
    supports that ride on it.
    """
    excitation = BaseMotion(
        kind="base_motion",
        direction=tuple(map(float, direction)),
        obstacles="moving",
        signal=ANY_SIGNAL,
        constant=getattr(config.excitation, "constant", ()),
    )
    # identification works from the force of a study, not from a motion of the base
    return config.model_copy(update={"excitation": excitation, "identification": None})


def _displacement_shapes(
    config: ConfigPart,
    places: np.ndarray,
    normals: Mapping[int, np.ndarray],
    basis: Basis | None,
) -> tuple[ModalModel, np.ndarray]:
    """Return (ModalModel, displacement shapes (mode, place, 3)) at places (place, 3) in m; normals:
    {index of a place: outward normal (3,)} of strain gauges there on a tube, whose shapes are the
    last of the model's sensors.
    """
    if config.structure.kind in TUBES:
        gauges = [(f"place_{number}", normal) for number, normal in normals.items()]
        own = _with_places(config, places)
        model = build_model(own, motion_only=True, gauges=gauges, basis=basis)
        moved = model.sensor_shapes[:, : 3 * len(places)]
        return model, moved.reshape(model.modes, len(places), 3)
    names = [
        point_at(config.points, place, f"point place_{number}")
        for number, place in enumerate(places)
    ]
    named = [*dict.fromkeys(names)]
    model = build_model(_sensed_at(config, named), motion_only=True)
    moved = model.sensor_shapes.reshape(model.modes, len(named), 3)
    return model, moved[:, [named.index(name) for name in names]]


def _with_places(config, places):
    """Return the configuration of a tube with named points place_0, ... as its sensors."""
    points = {f"place_{number}": tuple(map(float, place)) for number, place in enumerate(places)}
    return _sensed_at(config.model_copy(update={"points": {**config.points, **points}}), points)


def _sensed_at(config, points):
    """Return the configuration with sensors in all three directions at named points."""
    sensors = Sensors(points=tuple(points), directions=("x", "y", "z"))
    record = config.record.model_copy(update={"sensors": sensors})
    return config.model_copy(update={"record": record})


def with_channel_points(config: ConfigPart, campaign: xr.Dataset) -> ConfigPart:
    """Return the configuration of a tube with a named point at every channel that measures a
    motion; other structures are unchanged: their channels are at their points.

    A part at the sensor, or the sensor itself, may be missing in the model there. No point is added
    within SAME_POINT_M of another, for a strain or for a contact force.
    """
    if config.structure.kind not in TUBES:
        return config
    points, taken = dict(config.points), list(config.points.values())
    names, places = campaign["channel_name"].values, campaign["channel_point"].values
    for channel in np.flatnonzero(moving(campaign["channel_kind"].values)):
        name, place = names[channel], places[channel]
        if all(np.linalg.norm(np.subtract(place, other)) > SAME_POINT_M for other in taken):
            new = re.sub(r"[^A-Za-z0-9_.-]", "_", str(name))
            while new in points:  # a named point elsewhere may have the name of the channel
                new = f"at_{new}"
            points[new] = tuple(map(float, place))
            taken.append(place)
    return config.model_copy(update={"points": points})


def _ratio_of_points(campaign, model):
    """Return (contact_point,) the clearance over the nominal gap of the record."""
    ratios = support_ratios(campaign)
    if ratios is None:
        return np.ones(len(model.support_of_point))
    if len(ratios) != len(model.support_names):
        raise CampaignError(
            f"support_gap has {len(ratios)} supports, the model {len(model.support_names)}"
            f" ({', '.join(model.support_names)}): give one clearance for each, in that order"
        )
    return ratios[model.support_of_point]
