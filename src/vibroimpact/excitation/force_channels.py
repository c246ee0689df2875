"""The force of a seed in every force channel of a model."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.excitation.random_streams import random_generator
from vibroimpact.geometry.sections import outer_width

from .force_stream import SpectralForce
from .line_force_spectrum import line_force_psd

Made = TypeVar("Made")


def force_channels(
    config: ConfigPart,
    seed: int,
    channels: int,
    made: Callable[[ConfigPart | SpectralForce, np.random.Generator], Made],
) -> list[Made]:
    """Return the force of a seed in each channel, per newton of the load.

    Turbulence has independent forces of one spectrum in all channels; a channel does not depend on
    how many there are. Any other excitation has one channel.

    config: parts seed, excitation and structure.section.
    channels: number of force channels of the model.
    made: function (excitation, random stream) that makes the force of a channel, as a ForceStream
        or an array.
    """
    force = config.excitation
    if force.kind != "turbulence":
        return [made(force, random_generator(config.seed, seed, "force"))]
    diameter = outer_width(config.structure.section)
    spectral = SpectralForce(
        force.band_Hz, lambda frequency: line_force_psd(force, diameter, frequency)
    )
    return [
        made(spectral, random_generator(config.seed, seed, "force", channel))
        for channel in range(channels)
    ]
