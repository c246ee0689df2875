"""The measuring chain: gains and delays of channels, and a gain of the force."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

# Locations of a fault other than single channels: no channel may have such a name.
NO_CHANNELS = ("force", "responses", "force_and_responses")


@dataclass(frozen=True)
class Measuring:
    """Gains and delays of a measuring chain.

    gain (channel,): measured over true. delay (channel,): s. force_gain: measured over true force.
    """

    gain: np.ndarray
    delay: np.ndarray
    force_gain: float = 1.0

    def with_fault(
        self, effect_id: str, parameters: Mapping[str, float], location: str, names: Sequence[str]
    ) -> "Measuring":
        """Return the Measuring with the effect sensor_gain or sensor_delay at a location too.

        parameters: {"factor": ...} or {"delay": s}. location: one of places(names (channel,)).
        """
        chosen = np.array([location in (one, "responses", "force_and_responses") for one in names])
        if effect_id == "sensor_gain":
            gain = self.gain * np.where(chosen, parameters["factor"], 1.0)
            of_force = parameters["factor"] if location in ("force", "force_and_responses") else 1.0
            return replace(self, gain=gain, force_gain=self.force_gain * of_force)
        share = -1.0 if location == "force" else chosen
        return replace(self, delay=self.delay + parameters["delay"] * share)


def places(names: Iterable[str]) -> list[str]:
    """Return the locations of a fault: every channel, the force, all responses, force and responses
    together.
    """
    return [*names, *NO_CHANNELS]
