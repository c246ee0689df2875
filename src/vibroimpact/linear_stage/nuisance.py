"""The linear stage: what the lowest record says of modes and sensors, and how far a model, with or
without an effect, is from it.

Frequencies, damping and gains scatter in any test; their priors are in priors.py. The most probable
nuisance is corrected in the model, never beyond its limit, and the rest is left to be explained.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy import priors
from vibroimpact.observation.strain import by_family, gauges_of
from vibroimpact.reduction.modal_model import NEAR

from .linearised import same_modes

# of a mode's largest participation among the channels: below it a channel says nothing of the mode
SEEN = 0.05


@dataclass(frozen=True)
class Reading:
    """What a fit of the lowest record reads: ln frequency and ln damping (mode,), participation
    (channel, mode), residual over noise (channel,); gauges (channel,) bool: those that read a
    strain, None where none does; error: covariance of the three first, participations channel by
    channel, None where they are known.
    """

    modes: np.ndarray
    log_frequency: np.ndarray
    log_damping: np.ndarray
    participation: np.ndarray
    residual: np.ndarray
    gauges: np.ndarray | None = None
    error: np.ndarray | None = None

    @property
    def scale(self):
        """Return (channel, mode): a mode's largest participation among the channels that read the
        same, a motion or a strain.
        """
        return by_family(np.abs(self.participation), self.gauges)


@dataclass(frozen=True)
class Nuisance:
    """The corrections: factors of frequency and damping of modes (mode,) with indices `modes`, gain
    (channel,) of each channel.
    """

    modes: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    gain: np.ndarray


def reading_of_fit(fit, model):
    """Return the Reading of a ModalFit of responses to the force on `model`."""
    omega, damping = model.omega[fit.modes], model.damping[fit.modes]
    drive = driven(fit.drive)
    unit = np.concatenate([np.ones(2 * len(drive)), np.tile(drive, len(fit.participation))])
    return Reading(
        fit.modes,
        np.log(omega) + fit.log_frequency,
        np.log(damping / (2.0 * omega)) + fit.log_damping,
        fit.participation * drive,
        fit.residual,
        gauges_of(model),
        fit.joint_covariance * unit * unit[:, None],
    )


def reading_of_model(model, modes):
    """Return the Reading that a linear model gives without noise."""
    omega = model.omega[modes]
    participation = model.sensor_shapes[modes].T * driven(model.drive_shapes[modes])
    return Reading(
        modes,
        np.log(omega),
        np.log(model.damping[modes] / (2.0 * omega)),
        participation,
        np.ones(participation.shape[0]),
        gauges_of(model),
    )


def driven(drive_shapes):
    """Return (mode,): how much the forces drive each mode, from drive_shapes (mode, force_channel).

    One force: its shape. Several: their root sum of squares, with the sign of the first force that
    drives the mode at least half as much as any, so that the sense of a mode does not matter.
    """
    if drive_shapes.shape[1] == 1:
        return drive_shapes[:, 0]
    size = np.abs(drive_shapes)
    leading = np.argmax(size >= 0.5 * size.max(axis=1, keepdims=True), axis=1)
    sense = np.take_along_axis(np.sign(drive_shapes), leading[:, None], axis=1)[:, 0]
    return sense * np.linalg.norm(drive_shapes, axis=1)


def gained(reading, measuring):
    """Return a Reading as a measuring chain (Measuring, None for a perfect one) shows it."""
    return (
        reading
        if measuring is None
        else replace(
            reading,
            participation=reading.participation * (measuring.gain / measuring.force_gain)[:, None],
        )
    )


def seen_by(measured, simulated):
    """Return (channel, mode) bool: whether a channel sees a mode, in one of two Readings at
    least.
    """
    size = np.maximum(np.abs(simulated.participation), np.abs(measured.participation))
    return size > SEEN * by_family(size, measured.gauges)


def difference(measured, simulated, seen=None, bare=None):
    """Return (values (n,), covariance (n, n), sensitivity (n, nuisance)) of measured minus
    simulated Reading.

    Nuisances: mode frequencies, mode dampings, channel gains, each in units of its prior's sigma;
    the covariance is of what is not nuisance. seen (channel, mode) bool: the participations that
    are compared, see seen_by; bare: Reading without the effect, of whose change of the shapes two
    codes differ by a share.
    """
    count, channels = len(measured.log_frequency), len(measured.participation)
    # of the measured alone: a gain that inflates what is simulated must not shrink its errors
    scale = measured.scale
    seen = seen_by(measured, simulated) if seen is None else seen
    ratio = (measured.participation - simulated.participation)[seen] / scale[seen]
    level = (simulated.participation / scale)[seen]
    residual = np.log(np.hypot(1.0, measured.residual)) - np.log(np.hypot(1.0, simulated.residual))
    values = np.concatenate(
        [
            measured.log_frequency - simulated.log_frequency,
            measured.log_damping - simulated.log_damping,
            ratio,
            residual,
        ]
    )
    change = 0.0 if bare is None else ((simulated.participation - bare.participation) / scale)[seen]
    covariance = np.diag(
        np.concatenate(
            [
                np.full(count, 1.0e-10),
                np.full(count, 1.0e-4),
                np.full(len(ratio), priors.SHAPE_SD**2) + (priors.SHAPE_LAW_SD * change) ** 2,
                np.full(channels, priors.RESIDUAL_SD**2),
            ]
        )
    )
    if measured.error is not None:
        kept = np.concatenate([np.arange(2 * count), 2 * count + np.flatnonzero(seen)])
        unit = np.concatenate([np.ones(2 * count), 1.0 / scale[seen]])
        own = slice(len(kept))
        covariance[own, own] += measured.error[np.ix_(kept, kept)] * unit * unit[:, None]
    sensitivity = np.zeros((len(values), 2 * count + channels))
    sensitivity[:count, :count] = np.eye(count) * priors.FREQUENCY_SD
    sensitivity[count : 2 * count, count : 2 * count] = np.eye(count) * priors.DAMPING_SD
    rows = np.flatnonzero(seen.ravel()) // seen.shape[1]
    for number, (channel, value) in enumerate(zip(rows, level, strict=True)):
        sensitivity[2 * count + number, 2 * count + channel] = value * priors.GAIN_SD
    return values, covariance, sensitivity


def likelihood(measured, simulated, bare=None):
    """Return (log likelihood, chi-square, pulls (nuisance,)) of a Reading under another: nuisances
    marginalised, pulls in sigma. bare: see difference.
    """
    values, covariance, sensitivity = difference(measured, simulated, bare=bare)
    total = covariance + sensitivity @ sensitivity.T
    factor = linalg.cho_factor(total, lower=True)
    solved = linalg.cho_solve(factor, values)
    chi_square = float(values @ solved)
    return (
        -0.5 * chi_square - np.sum(np.log(np.diag(factor[0]))),
        chi_square,
        sensitivity.T @ solved,
    )


def nuisance_of(pulls, modes, channels):
    """Return the Nuisance of pulls in sigma, limited."""
    limited = np.clip(pulls, -priors.CORRECTION_LIMIT, priors.CORRECTION_LIMIT)
    count = len(modes)
    return Nuisance(
        modes,
        np.exp(priors.FREQUENCY_SD * limited[:count]),
        np.exp(priors.DAMPING_SD * limited[count : 2 * count]),
        1.0 + priors.GAIN_SD * limited[2 * count : 2 * count + channels],
    )


def neutral(modes, channels):
    """Return the Nuisance that corrects nothing."""
    return Nuisance(np.asarray(modes), np.ones(len(modes)), np.ones(len(modes)), np.ones(channels))


def plausible(pulls):
    """Return whether pulls in sigma (nuisance,) are those of nuisances: few of them far off, as a
    faulty channel's gain may be.
    """
    return np.mean(np.abs(pulls) > priors.PULLED) <= priors.FEW_PULLED


def corrected(model, nuisance, bare=None):
    """Return the ModalModel with the frequencies and damping of a Nuisance; bare: the model whose
    modes that numbers, where it is another.
    """
    if nuisance is None or not len(nuisance.modes):
        return model
    omega, damping = model.omega.copy(), model.damping.copy()
    modes = nuisance.modes if bare is None else same_modes(model, nuisance.modes, bare)
    omega[modes] *= nuisance.frequency
    damping[modes] *= nuisance.damping * nuisance.frequency
    # a mode that was seen is where it was seen, its neighbours make room; of two that are close, as
    # those of a straight tube in two planes, the second may be below the first
    seen = np.isin(np.arange(len(omega)), modes)
    lower = np.maximum.accumulate(np.where(seen, omega, 0.0))
    upper = np.minimum.accumulate(np.where(seen, omega, np.inf)[::-1])[::-1]
    omega = np.where(seen, omega, np.clip(omega, lower, upper))
    return replace(
        model,
        omega=np.maximum(omega, (1.0 - NEAR) * np.maximum.accumulate(omega)),
        damping=damping,
    )
