"""Turbulence that follows the velocity of the flow, in runs side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, cast

import numpy as np

from vibroimpact.config.changed_keys import changed_config
from vibroimpact.config.schema import Config
from vibroimpact.excitation.force_stream import ForceStream
from vibroimpact.excitation.turbulence import load_of_spectrum


def at_velocity(config: Config, velocity: float) -> tuple[Config, float]:
    """Return (configuration with the spectrum of the force at a velocity in m/s, force RMS there
    over the load of the grid).

    Both are those of the grid if flow.turbulence is null.
    """
    rule, force = cast(Any, config.flow).turbulence, cast(Any, config.excitation)
    if rule is None:
        return config, 1.0
    if rule.kind == "power":
        return config, float((velocity / rule.at_m_per_s) ** rule.exponent)
    moved = changed_config(config, {"excitation.spectrum.velocity_m_per_s": velocity})
    loads = [load_of_spectrum(config.structure, own) for own in (moved.excitation, force)]
    return moved, loads[0] / loads[1]


def drive_of_lanes(lanes: Sequence[tuple[list[ForceStream], float]]) -> Callable:
    """Return the Drive of runs side by side, each with the channels of its force and its load."""

    def drive(first: int, count: int) -> np.ndarray:
        out = np.empty((count, len(lanes[0][0]), len(lanes)))
        made: dict[int, list[np.ndarray]] = {}
        for lane, (streams, load) in enumerate(lanes):
            if id(streams) not in made:
                made[id(streams)] = [stream.values(first, count) for stream in streams]
            for channel, values in enumerate(made[id(streams)]):
                np.multiply(values, load, out=out[:, channel, lane])
        return out

    return drive
