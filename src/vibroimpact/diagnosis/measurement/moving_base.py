"""A model on a moving base: the excitation base_motion along the directions of a campaign.

Motions are relative to the base, supports and obstacles move with it, and the drive shapes are
those of excitation.force_vectors.
"""

import numpy as np
import xarray as xr

from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.config.excitation import BandSignal, BaseMotion, highest_frequency
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.reduction.reduced_model import build_model

LOWEST_HZ = 1.0  # of a signal where the model states no band; a comparison does not depend on it
DEFAULT_HIGHEST_HZ = 200.0


def driven_by_base(config: ConfigPart, campaign: xr.Dataset) -> ConfigPart:
    """Return the configuration excited by the motion of the base along the campaign's first base
    acceleration; unchanged where the campaign measured forces.

    config: a checked Config. A base_motion keeps its signal, a band-limited force its band.
    """
    bases = base_channels(campaign)
    if not bases.any():
        return config
    direction = campaign["force_channel_direction"].values[bases][0]
    # identification works from the force of a study, not from a motion of the base
    return config.model_copy(
        update={"excitation": _along(config.excitation, direction), "identification": None}
    )


def further_drive_shapes(config: ConfigPart, directions: np.ndarray) -> list[np.ndarray]:
    """Return [(mode, 1)] drive shapes per m/s² of the base along directions (base channel, 3).

    config: of the model.
    """
    return [
        build_model(
            config.model_copy(update={"excitation": _along(config.excitation, direction)}),
            motion_only=True,
        ).drive_shapes
        for direction in directions
    ]


def _along(excitation, direction):
    """Return the section BaseMotion along a direction (3,), in place of an excitation."""
    direction = tuple(map(float, np.asarray(direction, float)))
    if excitation.kind == "base_motion":
        return excitation.model_copy(update={"direction": direction, "obstacles": "moving"})
    band_Hz = getattr(
        excitation, "band_Hz", (LOWEST_HZ, highest_frequency(excitation) or DEFAULT_HIGHEST_HZ)
    )
    return BaseMotion(
        kind="base_motion",
        direction=direction,
        obstacles="moving",
        signal=BandSignal(kind="band_limited", band_Hz=band_Hz),
        constant=getattr(excitation, "constant", ()),
    )
