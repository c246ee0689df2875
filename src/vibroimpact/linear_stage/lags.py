"""Delays of channels, from the phases of their modal participations: part of the identification of
modes.
"""

import numpy as np
from scipy.signal import CZT

from vibroimpact.observation.sensed_motion import orders
from vibroimpact.reduction.modal_model import ModalModel

from .modal_fit import ModalFit
from .modal_lines import ModalLines

LONGEST_LAG_S = 0.02
HEARD, FEWEST = 3.0, 50  # times the noise of a line, for so many lines at least
EXCITED = 1.0e-3  # of the strongest line of the force
REAL_ENOUGH = 0.6  # least agreement of twice the phase once the delay is compensated
SEEN_S = 3.0e-4  # a smaller delay is found from the phases of modes
SIGNED = 3  # modes that move a channel
PHASE_SD = 0.02  # rad, of a participation: modes of a structure are not quite in phase
DEAF = 0.3  # share of a channel that no mode explains: above it the delay can not be found


def lags(
    found: ModalFit, model: ModalModel, signs_told: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Return ((channel,) s the delay of each channel, (channel,) its standard deviation, 0 where it
    can not be found), from the phases of its participations in a ModalFit with complex
    participations.

    Proportionally damped modes move in phase or in antiphase, with the signs of the model. A phase
    proportional to frequency is a delay, the same for all modes.

    Modes count by the errors of their phases, those of the fit and PHASE_SD.

    signs_told: whether the model gives the sign of each mode in a channel. Where it does not, two
    modes, one of them with the wrong sign, look like a delay of half a period: with fewer than
    SIGNED modes, a delay of more than a quarter period is rejected.
    """
    frequency = model.frequencies[found.modes] * np.exp(found.log_frequency)
    tried = np.arange(-LONGEST_LAG_S, LONGEST_LAG_S, 0.02 / frequency.max())
    driven = driven_modes(model, found.modes)
    out, errors = np.zeros((2, len(found.participation)))
    for channel, (shape, own) in enumerate(
        zip(found.participation, model.sensor_shapes[found.modes].T, strict=True)
    ):
        weight = np.where(driven & (np.abs(own) > 0.05 * np.abs(own).max()), 1.0, 0.0)
        if found.share[channel] > DEAF or not weight.any():
            continue  # a channel of noise, or without a mode whose sign the model gives
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
        best, error = _weighted(best, unit, frequency, _phase_errors(found, channel))
        if np.abs(best) <= reach:
            out[channel], errors[channel] = best, error
    return out, errors


def _phase_errors(found, channel):
    """Return (fitted,) rad: the standard deviations of the phases of a channel's participations."""
    size = np.maximum(np.abs(found.participation[channel]), 1.0e-300)
    variance = np.diag(found.shape_covariance[channel])
    return np.hypot(PHASE_SD, np.sqrt(np.maximum(variance, 0.0)) / size)


def _weighted(lag, unit, frequency, errors):
    """Return (s, its standard deviation): a delay near `lag` by the phases of unit (fitted,), each
    known to errors (fitted,) in rad.
    """
    phase = np.angle(unit * np.exp(2j * np.pi * frequency * lag))
    weight = np.where(unit != 0.0, 1.0 / errors**2, 0.0)
    curvature = 2.0 * np.pi * np.sum(weight * frequency**2)
    more = np.sum(weight * frequency * phase) / curvature
    return lag - more, np.sqrt(1.0 / (2.0 * np.pi * curvature))


def from_phases(lines: ModalLines, noise: np.ndarray) -> np.ndarray:
    """Return (channel,) s: the delay of each channel, 0 where it can not be found, from the lines
    of a record alone; noise (channel,) RMS in the band.

    Away from their resonances, proportionally damped modes respond in phase or in antiphase, so
    that twice the phase per force is 0 on most lines, 180 degrees for velocities.
    """
    record = lines.record
    force = record.short_spectra(record.spectrum[:1])[0]
    # most lines of a periodic force are empty
    driven = np.abs(force) > EXCITED * np.abs(force).max()
    if len(record.frequency) < FEWEST:
        return np.zeros(len(lines.measured))
    step = 0.02 / record.frequency[-1]
    tried = np.arange(-LONGEST_LAG_S, LONGEST_LAG_S, step)
    apart = 4j * np.pi * (record.frequency[1] - record.frequency[0])
    transform = CZT(  # the lines are evenly spaced
        len(record.frequency), len(tried), np.exp(apart * step), np.exp(-apart * tried[0])
    )
    first = np.exp(4j * np.pi * record.frequency[0] * tried)
    out = np.zeros(len(lines.measured))
    sense = 1.0 - 2.0 * (orders(lines.kinds) % 2)
    for channel, own in enumerate(lines.measured):
        heard = (np.abs(own) > HEARD * noise[channel] / np.sqrt(own.size)) & driven
        if heard.sum() < FEWEST:
            continue
        squared = np.zeros(own.size, complex)
        squared[heard] = sense[channel] * (own[heard] / force[heard]) ** 2
        squared[heard] /= np.abs(squared[heard])
        score = np.real(first * transform(squared)) / heard.sum()
        if score.max() > REAL_ENOUGH and abs(tried[np.argmax(score)]) > SEEN_S:
            out[channel] = tried[np.argmax(score)]
    return out


def driven_modes(model: ModalModel, modes: np.ndarray) -> np.ndarray:
    """Return (mode,) bool: whether a force drives these modes of a model."""
    return (
        np.abs(model.drive_shapes[modes]).max(axis=1) >= 1.0e-6 * np.abs(model.drive_shapes).max()
    )
