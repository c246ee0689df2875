"""A campaign's channels and forces on the model: the reduced model with the campaign's sensors and
drives in place of the study's.
"""

import re
from dataclasses import replace

import numpy as np

from vibroimpact.campaign.file import CampaignError, support_ratios
from vibroimpact.config.schema import Sensors
from vibroimpact.excitation.force_vectors import turn_axis, turned_direction
from vibroimpact.reduction.reduced_model import build_model

from .sensed import moving

SAME_POINT_M = 1.0e-3


def attach(config, campaign):
    """Return the ModalModel of `config` that has the campaign's channels as sensors and its forces
    as drives, and nothing else to keep.

    config: a checked Config or StageSettings of a tube. Sensors are the displacements along
    channel_direction, positive in its sense, in the order of the channels; none of it, zero, for a
    channel that measures no motion. Raises CampaignError
    when a channel or force is farther than 5 mm from the structure; the message lists all of them.
    """
    places = np.vstack([campaign["channel_point"].values, campaign["force_channel_point"].values])
    directions = np.vstack(
        [campaign["channel_direction"].values, campaign["force_channel_direction"].values]
    ).astype(float)
    names = [
        *map(str, campaign["channel_name"].values),
        *map(str, campaign["force_channel_name"].values),
    ]
    _require_directions(directions, names)
    try:
        model, displacements = displacement_shapes(config, places)
    except ValueError as error:
        raise CampaignError(_sentence(str(error), names)) from None
    along = directions / np.linalg.norm(directions, axis=1)[:, None]
    acting = (
        along.copy()
    )  # a force may act beside its stated direction, a sensor's direction is what it is
    angle = getattr(config.excitation, "turn_deg", 0.0)
    for number in range(campaign.sizes["channel"], len(places)) if angle else ():
        acting[number] = turned_direction(along[number], angle, turn_axis(config, places[number]))
    shapes = np.einsum("mpa,pa->mp", displacements, acting)
    channels = campaign.sizes["channel"]
    shapes[:, :channels] *= moving(campaign["channel_kind"].values)
    return replace(
        model,
        gap_factor=model.gap_factor * _ratio_of_points(campaign, model),
        sensor_shapes=shapes[:, :channels],
        sensor_names=tuple(names[:channels]),
        sensor_positions=places[:channels],
        sensor_directions=along[:channels],
        drive_shapes=shapes[:, channels:],
    )


def displacement_shapes(config, places):
    """Return (ModalModel, (mode, place, 3)): the displacements of a configuration's structure at
    places (place, 3) m. Raises ValueError for one that is farther than 5 mm from it.
    """
    points = {f"place_{number}": tuple(map(float, place)) for number, place in enumerate(places)}
    sensors = config.record.model_copy(update={"sensors": config_sensors(tuple(points))})
    model = build_model(
        config.model_copy(update={"points": {**config.points, **points}, "record": sensors}),
        motion_only=True,
    )
    return model, model.sensor_shapes.reshape(model.modes, len(places), 3)


def with_channel_points(config, campaign):
    """Return the configuration with a named point at every channel where it has none: what sits
    there, or was put there with it, may be missing in it. A support's load cell is no such thing.
    """
    points, taken = dict(config.points), list(config.points.values())
    names, places = campaign["channel_name"].values, campaign["channel_point"].values
    for channel in np.flatnonzero(moving(campaign["channel_kind"].values)):
        name, place = names[channel], places[channel]
        if all(np.linalg.norm(np.subtract(place, other)) > SAME_POINT_M for other in taken):
            new = re.sub(r"[^A-Za-z0-9_.-]", "_", str(name))
            while (
                new in points
            ):  # a channel may bear the name of a point elsewhere, which the model means
                new = f"at_{new}"
            points[new] = tuple(map(float, place))
            taken.append(place)
    return config.model_copy(update={"points": points})


def _ratio_of_points(campaign, model):
    """Return (contact point,) the clearance there over the record's nominal one. Raises
    CampaignError when the campaign counts other supports.
    """
    ratios = support_ratios(campaign)
    if ratios is None:
        return np.ones(len(model.support_of_point))
    if len(ratios) != len(model.support_names):
        raise CampaignError(
            f"support_gap has {len(ratios)} supports, the model {len(model.support_names)}"
            f" ({', '.join(model.support_names)}): give one clearance for each, in that order"
        )
    return ratios[model.support_of_point]


def config_sensors(points):
    """Return the section record.sensors with all three directions of some points."""
    return Sensors(points=points, directions=("x", "y", "z"))


def _require_directions(directions, names):
    """Raise CampaignError for a direction that is no direction."""
    for direction, name in zip(directions, names, strict=True):
        if not np.isfinite(direction).all() or np.linalg.norm(direction) < 1.0e-6:
            raise CampaignError(
                f"channel {name} has the direction {direction.tolist()}: give a unit vector"
            )


def _sentence(message, names):
    """A message about place_<number> as one about the channel of that number."""
    for number in reversed(range(len(names))):
        message = message.replace(f"point place_{number}", f"channel {names[number]}")
    return message
