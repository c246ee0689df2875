"""Turbulence that follows the velocity of the flow, in runs side by side."""

from typing import Any, cast

from vibroimpact.config.changed_keys import changed_config
from vibroimpact.config.schema import Config
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
