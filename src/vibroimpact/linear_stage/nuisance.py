"""Likelihood of the linear stage: modal parameters and gains of the lowest record (a Reading),
compared with those of a model with or without an effect.

Frequencies, damping and gains scatter in any test; their priors are in priors.py. The most probable
nuisance is corrected in the model, never beyond its limit, and an effect has to explain the rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from vibroimpact.observation.sensor_chain import Measuring
from vibroimpact.observation.strain import by_family, gauges_of
from vibroimpact.reduction.modal_model import NEAR, ModalModel

from . import priors
from .linearised import same_modes
from .modal_fit import ModalFit

# of a mode's largest participation among the channels: below it a channel does not see the mode
SEEN = 0.05
TURNS = 4  # of expectation and maximisation


@dataclass(frozen=True)
class Reading:
    """Modal parameters of the lowest record, identified or predicted, with their scatter.

    modes (mode,): indices of the model's modes.
    log_frequency (mode,): ln rad/s. log_damping (mode,): ln of the damping ratio.
    participation (channel, mode). residual (channel,): over noise.
    gauges (channel,) bool: strain gauges, None for none.
    error: covariance of [log_frequency, log_damping, participation], channel by channel of the
    last, None where they are exact.
    """

    modes: np.ndarray
    log_frequency: np.ndarray
    log_damping: np.ndarray
    participation: np.ndarray
    residual: np.ndarray
    gauges: np.ndarray | None = None
    error: np.ndarray | None = None

    @property
    def scale(self) -> np.ndarray:
        """Return (channel, mode): a mode's largest participation among the channels that measure
        the same, a motion or a strain.
        """
        return by_family(np.abs(self.participation), self.gauges)


@dataclass(frozen=True)
class Nuisance:
    """Corrections of a model.

    modes (mode,): indices of the corrected modes. frequency, damping (mode,): their factors.
    gain (channel,): of each channel.
    """

    modes: np.ndarray
    frequency: np.ndarray
    damping: np.ndarray
    gain: np.ndarray


def reading_of_fit(fit: ModalFit, model: ModalModel) -> Reading:
    """Return the Reading of a ModalFit relative to `model`."""
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


def reading_of_model(model: ModalModel, modes: np.ndarray) -> Reading:
    """Return the Reading that a linear model predicts of its modes (mode,), without noise."""
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


def driven(drive_shapes: np.ndarray) -> np.ndarray:
    """Return (mode,): how much the forces drive each mode, from drive_shapes (mode, force_channel).

    One force: its shape. Several: their root sum of squares, with the sign of the first force that
    drives the mode at least half as much as any, so that the sign of a mode shape does not matter.
    """
    if drive_shapes.shape[1] == 1:
        return drive_shapes[:, 0]
    size = np.abs(drive_shapes)
    leading = np.argmax(size >= 0.5 * size.max(axis=1, keepdims=True), axis=1)
    sense = np.take_along_axis(np.sign(drive_shapes), leading[:, None], axis=1)[:, 0]
    return sense * np.linalg.norm(drive_shapes, axis=1)


def gained(reading: Reading, measuring: Measuring | None) -> Reading:
    """Return a Reading with the gains of a measuring chain, None for a perfect one."""
    return (
        reading
        if measuring is None
        else replace(
            reading,
            participation=reading.participation * (measuring.gain / measuring.force_gain)[:, None],
        )
    )


def seen_by(measured: Reading, simulated: Reading) -> np.ndarray:
    """Return (channel, mode) bool: whether a channel sees a mode, in one of two Readings at
    least.
    """
    size = np.maximum(np.abs(simulated.participation), np.abs(measured.participation))
    return size > SEEN * by_family(size, measured.gauges)


def difference(
    measured: Reading,
    simulated: Reading,
    seen: np.ndarray | None = None,
    bare: Reading | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (values (n,), covariance (n, n), sensitivity (n, nuisance)) of measured minus
    simulated Reading.

    Nuisances: mode frequencies, mode dampings, channel gains, each in units of its prior's sigma;
    the covariance does not include them. seen (channel, mode) bool: the participations that are
    compared, see seen_by; bare: Reading without the effect, whose change of the shapes is uncertain
    by a share (priors.SHAPE_LAW_SD).
    """
    count, channels = len(measured.log_frequency), len(measured.participation)
    # of the measured alone: a gain that enlarges the simulated shapes must not reduce differences
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


def spread(
    values: np.ndarray, covariance: np.ndarray, sensitivity: np.ndarray
) -> tuple[np.ndarray, float]:
    """Return (spread (nuisance,) in sigma of its prior, log of its prior density over that of 1) of
    each nuisance, the most probable for values (n,) of the other arguments: see difference.

    A Student law of priors.TAILS degrees of freedom is a normal law whose variance is itself drawn;
    that variance, at most priors.WIDEST squared, is found by expectation and maximisation (Lange,
    Little and Taylor, J. Am. Stat. Assoc. 84 (1989) 881-896).
    """
    variance, tails = np.ones(sensitivity.shape[1]), priors.TAILS
    for _ in range(TURNS):
        wide = sensitivity * variance
        factor = linalg.cho_factor(covariance + wide @ sensitivity.T, lower=True)
        pulls = wide.T @ linalg.cho_solve(factor, values)
        unknown = variance - np.sum(wide * linalg.cho_solve(factor, wide), axis=0)
        variance = np.minimum((tails + pulls**2 + unknown) / (tails + 1.0), priors.WIDEST**2)
    cost = 0.5 * tails * np.sum(np.log(variance) + 1.0 / variance - 1.0)
    return np.sqrt(variance), -float(cost)


def likelihood(
    measured: Reading, simulated: Reading, bare: Reading | None = None
) -> tuple[float, float, np.ndarray]:
    """Return (log likelihood, chi-square, pulls (nuisance,)) of a measured given a simulated
    Reading: nuisances marginalised, their most probable values (pulls) in sigma. bare: see
    difference.
    """
    values, covariance, sensitivity = difference(measured, simulated, bare=bare)
    wide, density = spread(values, covariance, sensitivity)
    sensitivity = sensitivity * wide
    factor = linalg.cho_factor(covariance + sensitivity @ sensitivity.T, lower=True)
    solved = linalg.cho_solve(factor, values)
    chi_square = float(values @ solved)
    return (
        density - 0.5 * chi_square - np.sum(np.log(np.diag(factor[0]))),
        chi_square,
        wide * (sensitivity.T @ solved),
    )


def nuisance_of(pulls: np.ndarray, modes: np.ndarray, channels: int) -> Nuisance:
    """Return the Nuisance of pulls (nuisance,) in sigma, limited to priors.CORRECTION_LIMIT."""
    limited = np.clip(pulls, -priors.CORRECTION_LIMIT, priors.CORRECTION_LIMIT)
    count = len(modes)
    return Nuisance(
        modes,
        np.exp(priors.FREQUENCY_SD * limited[:count]),
        np.exp(priors.DAMPING_SD * limited[count : 2 * count]),
        1.0 + priors.GAIN_SD * limited[2 * count : 2 * count + channels],
    )


def neutral(modes: Sequence[int] | np.ndarray, channels: int) -> Nuisance:
    """Return the Nuisance that corrects nothing."""
    return Nuisance(np.asarray(modes), np.ones(len(modes)), np.ones(len(modes)), np.ones(channels))


def plausible(pulls: np.ndarray) -> bool:
    """Return whether pulls (nuisance,) in sigma are compatible with the priors: few of them are
    large, as that of a faulty channel's gain may be.
    """
    return np.mean(np.abs(pulls) > priors.PULLED) <= priors.FEW_PULLED


def corrected(
    model: ModalModel, nuisance: Nuisance | None, bare: ModalModel | None = None
) -> ModalModel:
    """Return the ModalModel with the frequencies and damping of a Nuisance; bare: the model to
    which its mode indices refer, where that is another.
    """
    if nuisance is None or not len(nuisance.modes):
        return model
    omega, damping = model.omega.copy(), model.damping.copy()
    modes = nuisance.modes if bare is None else same_modes(model, nuisance.modes, bare)
    omega[modes] *= nuisance.frequency
    damping[modes] *= nuisance.damping * nuisance.frequency
    # the corrected modes keep their frequencies, the others are limited to stay in order; of two
    # close modes, as those of a straight tube in two planes, the second may be below the first
    seen = np.isin(np.arange(len(omega)), modes)
    lower = np.maximum.accumulate(np.where(seen, omega, 0.0))
    upper = np.minimum.accumulate(np.where(seen, omega, np.inf)[::-1])[::-1]
    omega = np.where(seen, omega, np.clip(omega, lower, upper))
    return replace(
        model,
        omega=np.maximum(omega, (1.0 - NEAR) * np.maximum.accumulate(omega)),
        damping=damping,
    )
