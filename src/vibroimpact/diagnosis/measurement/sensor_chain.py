"""The measuring chain: gains and delays of channels, and a gain of the force."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

# Locations of a fault other than single channels: no channel may have such a name.
NO_CHANNELS = ("force", "responses", "force_and_responses")


@dataclass(frozen=True)
class Measuring:
    """Gains (channel,), measured over true, and delays (channel,) in s of a measuring chain; the
    gain of the force.
    """

    gain: np.ndarray
    delay: np.ndarray
    force_gain: float = 1.0

    def with_fault(
        self, effect_id: str, parameters: Mapping[str, float], location: str, names: Sequence[str]
    ) -> "Measuring":
        """Return the Measuring with the effect sensor_gain or sensor_delay at a location too, one
        of names (channel,) or NO_CHANNELS; parameters: {"factor": ...} or {"delay": s}.
        """
        chosen = np.array([location in (one, "responses", "force_and_responses") for one in names])
        if effect_id == "sensor_delay":
            share = -1.0 if location == "force" else chosen
            return replace(self, delay=self.delay + parameters["delay"] * share)
        factor, on_force = parameters["factor"], location in ("force", "force_and_responses")
        gain = self.gain * np.where(chosen, factor, 1.0)
        return replace(self, gain=gain, force_gain=self.force_gain * (factor if on_force else 1.0))
