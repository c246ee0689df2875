"""What a faulty measuring chain does to simulated records: gains and delays of channels, and a
force that is not the one measured.
"""

from dataclasses import dataclass

import numpy as np
from scipy import fft

# Places of a measuring fault beside the channels: no channel may have such a name.
NO_CHANNELS = ("force", "responses", "force_and_responses")


@dataclass(frozen=True)
class Measuring:
    """gain (channel,); delay (channel,) s; force_gain: measured force over the true one."""

    gain: np.ndarray
    delay: np.ndarray
    force_gain: float = 1.0

    def delayed(self, responses, rate):
        """Return (..., channel, sample) responses as they are read late."""
        if not np.any(self.delay):
            return responses
        length = fft.next_fast_len(responses.shape[-1] + 64, real=True)
        lines = fft.rfft(responses, length, axis=-1)
        turn = np.exp(-2j * np.pi * np.outer(self.delay, fft.rfftfreq(length, 1.0 / rate)))
        return fft.irfft(lines * turn, length, axis=-1)[..., : responses.shape[-1]].astype(
            responses.dtype
        )


def places(names):
    """Return the places of a measuring fault: every channel, the force, all responses together,
    force and responses together.
    """
    return [*names, *NO_CHANNELS]


def measuring_of(effect_id, parameters, location, names):
    """Return the Measuring of sensor_gain or sensor_delay at a location."""
    gain, delay, force = np.ones(len(names)), np.zeros(len(names)), 1.0
    chosen = np.array([location in (name, "responses", "force_and_responses") for name in names])
    if effect_id == "sensor_gain":
        gain[chosen] = parameters["factor"]
        force = parameters["factor"] if location in ("force", "force_and_responses") else 1.0
    else:
        delay[chosen] = parameters["delay"]
        if location == "force":
            delay[:] = -parameters["delay"]
    return Measuring(gain, delay, force)
