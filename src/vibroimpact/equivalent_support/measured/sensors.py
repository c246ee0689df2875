"""The linear model as the sensors of a campaign see it: they are its sensors and its shape line."""

from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import CampaignError
from vibroimpact.campaign.signals import CampaignSignals
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.sensed_motion import moving
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.identify.linear.support_groups import reached_supports
from vibroimpact.identify.spectra.welch import driven_axis
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.reduced_model import build_model

from .forces import KnownForce, groups_of, known_force

LEAST_MOTION = 0.02  # of the sensor that the force moves most


@dataclass(frozen=True, eq=False)
class MeasuredTube:
    """A linear tube as the sensors of a campaign see it.

    signals: of the campaign.
    model: its sensors are those of the campaign, from one end of the tube to the other. They are
        also the points of the shape line.
    force: KnownForce.
    channels: (sensor,) indices of their channels.
    points: (sensor,) names of their points, those of the channels without the axis at the end.
    direction: (3,) of the first force, or of the model's excitation.
    """

    signals: CampaignSignals
    model: ModalModel
    force: KnownForce
    channels: np.ndarray
    points: tuple[str, ...]
    direction: tuple[float, ...]


def measured_tube(
    config: ConfigPart, campaign: xr.Dataset, signals: CampaignSignals
) -> MeasuredTube:
    """Return the MeasuredTube of a campaign.

    Its sensors are those channels that measure a motion which the force causes.

    Raises CampaignError if there is none.
    """
    model = attach(config, campaign)
    own_drive = model.drive_shapes
    if not signals.forces:
        # The same places give the same mesh, and with it the same modes.
        places = {f"place_{number}": tuple(place) for number, place in enumerate(signals.points)}
        own = config.model_copy(update={"points": {**config.points, **places}})
        own_drive = build_model(own, motion_only=True).drive_shapes  # by its own excitation
    force = known_force(config, signals, model, own_drive)
    model = replace(model, drive_shapes=force.drive_shapes)
    _, modes = reached_supports(model, groups_of(config))
    size = np.abs(model.sensor_shapes[modes]).max(axis=0) * moving(signals.kinds)
    used = np.flatnonzero(size > LEAST_MOTION * size.max(initial=0.0))
    if not used.size:
        raise CampaignError("no channel measures a motion of the tube that the force causes")
    centreline = build_centreline(config.structure)
    arc_lengths = np.array([centreline.locate(signals.points[each], "a channel") for each in used])
    order = np.argsort(arc_lengths, kind="stable")
    used, arc_lengths = used[order], arc_lengths[order]
    direction = tuple(getattr(config.excitation, "direction", (0.0, 1.0, 0.0)))
    if signals.forces:
        direction = tuple(map(float, signals.force_directions[0]))
    axis = driven_axis(direction)
    points = tuple(signals.channels[each].removesuffix(f".{axis}") for each in used)
    sensed = replace(
        model,
        sensor_names=tuple(f"{point}.{axis}" for point in points),
        sensor_shapes=model.sensor_shapes[:, used],
        sensor_positions=model.sensor_positions[used],
        sensor_directions=model.sensor_directions[used],
        line_shapes=model.sensor_shapes[:, used],
        line_positions=model.sensor_positions[used],
        line_arc_length=arc_lengths,
    )
    return MeasuredTube(signals, sensed, force, used, points, direction)
