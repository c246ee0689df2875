"""A model on a moving base: the study's excitation base_motion, with the directions of a campaign.

Motions are relative to the base, supports and obstacles move with it, and the drive shapes are
those of excitation.force_vectors.
"""

import numpy as np

from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.config.excitation import BandSignal, BaseMotion, highest_frequency

LOWEST_HZ = 1.0  # of a signal where the model states none: it plays no part in a comparison
DEFAULT_HIGHEST_HZ = 200.0


def driven_by_base(config, campaign):
    """Return the configuration whose excitation is the motion of the base along the campaign's
    first base acceleration; itself where the campaign measured forces.

    config: a checked Config. The signal of its base_motion stays, a force in a band gives its band.
    """
    if not base_channels(campaign).any():
        return config
    direction = base_directions(campaign)[0]
    # what a study identifies from its force it does not from a motion of the base
    return config.model_copy(
        update={"excitation": _along(config.excitation, direction), "identification": None}
    )


def base_directions(campaign):
    """Return (base channel, 3): the stated directions of the accelerations of the base."""
    directions = campaign["force_channel_direction"].values.astype(float)
    return directions[base_channels(campaign)]


def further_drive_shapes(config, directions, build):
    """Return [(mode, 1)] drive shapes per m/s² of the base along directions (base channel, 3).

    config: of the model; build(config) gives its ModalModel.
    """
    return [
        build(
            config.model_copy(update={"excitation": _along(config.excitation, direction)})
        ).drive_shapes
        for direction in directions
    ]


def _along(excitation, direction):
    """Return the section BaseMotion along a direction (3,) in place of an excitation."""
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
