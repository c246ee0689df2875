"""By how much channels lag, from the phases of the modes that they show."""

import numpy as np

from vibroimpact.observation.sensed_motion import orders

LONGEST_LAG_S = 0.02
HEARD, FEWEST = 3.0, 50  # times the noise of a line, and so many lines
EXCITED = 1.0e-3  # of the strongest line of the force
REAL_ENOUGH = 0.6  # least agreement of twice the phase once the delay is taken out
SEEN_S = 3.0e-4  # less is told by the phases of modes
SIGNED = 3  # modes that move a channel
DEAF = 0.3  # share of a channel that no mode explains: above it the channel has nothing to tell


def lags(found, model, signs_told=True):
    """Return (channel,) s: by how much each channel lags, from the phases of its participations in
    a fit that leaves them free.

    Modes damped in proportion move in phase or against it, as the model says; what turns with the
    frequency is a delay, the same for all modes. signs_told: whether the model tells the sense of
    each mode there. Where it does not, two modes, one with the other sense, look like a delay of
    half a period: from fewer than SIGNED modes no more than a quarter of one is believed.
    """
    frequency = model.frequencies[found.modes] * np.exp(found.log_frequency)
    tried = np.arange(-LONGEST_LAG_S, LONGEST_LAG_S, 0.02 / frequency.max())
    driven = driven_modes(model, found.modes)
    out = np.zeros(len(found.participation))
    for channel, (shape, own) in enumerate(
        zip(found.participation, model.sensor_shapes[found.modes].T, strict=True)
    ):
        weight = np.where(driven & (np.abs(own) > 0.05 * np.abs(own).max()), 1.0, 0.0)
        if found.share[channel] > DEAF or not weight.any():
            continue  # a channel of noise, or of motion of which the model does not tell the sense
        there = frequency[weight > 0.0]
        reach = np.inf if signs_told or len(there) >= SIGNED else 0.25 / there.max()
        unit = weight * shape * np.sign(own) / np.maximum(np.abs(shape), 1.0e-300)
        match = np.real(np.exp(2j * np.pi * np.outer(tried, frequency)) @ unit)
        best = tried[np.argmax(match - 1.0e-3 * np.abs(tried) / LONGEST_LAG_S)]
        for _ in range(5):
            turned = unit * np.exp(2j * np.pi * frequency * best)
            best -= np.sum(frequency * turned.imag) / max(
                2.0 * np.pi * np.sum(frequency**2 * np.abs(turned)), 1.0e-300
            )
        out[channel] = best if np.abs(best) <= reach else 0.0
    return out


def from_phases(lines, noise):
    """Return (channel,) s: by how much each channel lags, 0 where that can not be told, from the
    lines of a record (ModalLines) alone; noise (channel,) RMS in the band.

    Modes damped in proportion answer in phase or against it away from their resonances, so that
    twice the phase per force is zero on most lines; half a turn for velocities.
    """
    record = lines.record
    force = record.short_spectra(record.spectrum[:1])[0]
    driven = (
        np.abs(force) > EXCITED * np.abs(force).max()
    )  # of periodic forces most lines are empty
    tried = np.arange(-LONGEST_LAG_S, LONGEST_LAG_S, 0.02 / record.frequency[-1])
    out = np.zeros(len(lines.measured))
    sense = 1.0 - 2.0 * (orders(lines.kinds) % 2)
    for channel, own in enumerate(lines.measured):
        heard = (np.abs(own) > HEARD * noise[channel] / np.sqrt(own.size)) & driven
        if heard.sum() < FEWEST:
            continue
        squared = sense[channel] * (own[heard] / force[heard]) ** 2
        score = (
            np.real(
                (squared / np.abs(squared))
                @ np.exp(4j * np.pi * np.outer(record.frequency[heard], tried))
            )
            / heard.sum()
        )
        if score.max() > REAL_ENOUGH and abs(tried[np.argmax(score)]) > SEEN_S:
            out[channel] = tried[np.argmax(score)]
    return out


def driven_modes(model, modes):
    """Return (mode,) bool: whether a force drives these modes of a model."""
    return (
        np.abs(model.drive_shapes[modes]).max(axis=1) >= 1.0e-6 * np.abs(model.drive_shapes).max()
    )
