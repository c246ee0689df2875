"""The motion of the base in the signals of sensors on a shaken structure.

A model describes the motion relative to the base, on which supports and obstacles ride.
Accelerometers and vibrometers measure the absolute motion: the relative one, and that of the base
along their direction. The base's share is taken out here, once, and everything that follows works
on relative motion. A displacement sensor is taken to sit on the base, so that nothing is taken out.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import fft

from .checks.stated import check_row, warning
from .force_kinds import BASE
from .signals import CampaignSignals, transfer_band

# How often the acceleration of the base is integrated to match a kind of sensor.
INTEGRALS = {"acceleration": 0, "velocity": 1}
# Of the lower end of the excited band. Below the first nothing is integrated, above the second
# everything: the offset and the drift of an accelerometer grow without end.
INTEGRATED_FROM = (0.25, 0.5)
NO_BAND_HZ = 1.0


def moves_with_base(signals: CampaignSignals) -> np.ndarray:
    """Return (channel,) bool, whether the base's own motion is part of a channel's signal."""
    if BASE not in signals.force_kinds:
        return np.zeros(len(signals.kinds), bool)
    return np.array([kind in INTEGRALS for kind in signals.kinds], bool)


def base_motion(signals: CampaignSignals) -> list[np.ndarray] | None:
    """Return (channel, sample) in SI for every record: the base's own motion in each channel.

    It is 0 in a channel that measures none of it. None if no force channel is a base
    acceleration.
    """
    if BASE not in signals.force_kinds:
        return None
    moved, bases = moves_with_base(signals), np.array(signals.force_kinds) == BASE
    cosines = _unit(signals.directions) @ _unit(signals.force_directions).T
    cosines = np.nan_to_num(np.where(np.outer(moved, bases), cosines, 0.0))
    velocity = np.array(signals.kinds) == "velocity"
    # the lower end of the band that the base excites, if a record is long enough to show it
    low_Hz = (transfer_band(signals) or (NO_BAND_HZ,))[0] if velocity.any() else 0.0
    motions = []
    for force in signals.force:
        own = cosines @ force
        if velocity.any():
            own[velocity] = cosines[velocity] @ integrated(force, signals.rate, low_Hz)
        own[~moved] = 0.0  # also where a sample of the base is missing
        motions.append(own)
    return motions


def relative_to_base(signals: CampaignSignals) -> CampaignSignals:
    """Return the signals with the responses relative to the base; themselves without base motion.

    signals: as measured, in SI.
    """
    motions = base_motion(signals)
    if motions is None:
        return signals
    response = [own - base for own, base in zip(signals.response, motions, strict=True)]
    return replace(signals, response=response)


def integrated(acceleration: np.ndarray, rate: float, low_Hz: float) -> np.ndarray:
    """Return (..., sample) m/s: the integral over time of accelerations (..., sample) in m/s².

    rate: Hz.
    low_Hz: lower end of the excited band; below it see INTEGRATED_FROM.

    Missing samples count as 0.
    """
    samples = acceleration.shape[-1]
    if not samples:
        return acceleration
    length = fft.next_fast_len(2 * samples, real=True)  # the end must not leak into the start
    frequency = fft.rfftfreq(length, 1.0 / rate)
    begin, end = (share * low_Hz for share in INTEGRATED_FROM)
    passed = 0.5 - 0.5 * np.cos(np.pi * np.clip((frequency - begin) / (end - begin), 0.0, 1.0))
    factor = passed / (2j * np.pi * np.maximum(frequency, frequency[1]))
    lines = fft.rfft(np.nan_to_num(acceleration), length, axis=-1)
    return fft.irfft(lines * factor, length, axis=-1)[..., :samples]


def base_motion_rows(signals: CampaignSignals) -> Iterator[dict]:
    """Yield rows of checks that name the channels from which the base motion was subtracted."""
    if BASE not in signals.force_kinds:
        return
    bases = [
        name for name, kind in zip(signals.forces, signals.force_kinds, strict=True) if kind == BASE
    ]
    names = np.array(signals.channels, dtype=object)
    moved = names[moves_with_base(signals)]
    if moved.size:
        yield check_row(
            "base motion",
            "pass",
            f"The motion of the base by {', '.join(bases)} is taken out of {', '.join(moved)}: what"
            " is compared is the motion relative to the base.",
        )
    fixed = names[np.array(signals.kinds) == "displacement"]
    if fixed.size:
        yield warning(
            "base motion",
            f"The displacements {', '.join(fixed)} are taken as relative to the base: if their"
            " sensors stand on the floor, leave them out.",
        )


def _unit(directions: np.ndarray) -> np.ndarray:
    """Return (vector, 3) with a length of 1, NaN if it is 0."""
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    return directions / np.where(length > 0.0, length, np.nan)
