"""Faults of the measuring chain applied to simulated records: gains and delays of channels, and a
gain of the force.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import fft

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

    def delayed(self, responses: np.ndarray, rate: float) -> np.ndarray:
        """Return responses (..., channel, sample) with the delays applied; rate: Hz."""
        if not np.any(self.delay):
            return responses
        length = fft.next_fast_len(responses.shape[-1] + 64, real=True)
        lines = fft.rfft(responses, length, axis=-1)
        turn = np.exp(-2j * np.pi * np.outer(self.delay, fft.rfftfreq(length, 1.0 / rate)))
        return fft.irfft(lines * turn, length, axis=-1)[..., : responses.shape[-1]].astype(
            responses.dtype
        )


def places(names: Iterable[str]) -> list[str]:
    """Return the locations of a fault: every channel, the force, all responses, force and responses
    together.
    """
    return [*names, *NO_CHANNELS]


def measuring_of(
    effect_id: str, parameters: Mapping[str, float], location: str, names: Sequence[str]
) -> Measuring:
    """Return the Measuring of the effect sensor_gain or sensor_delay at a location.

    parameters: {"factor": ...} or {"delay": s}. location: one of places(names). names (channel,).
    """
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
