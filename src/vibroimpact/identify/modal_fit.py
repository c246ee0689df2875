"""Real modes, scaled by the drive point, fitted to measured responses at the lines of a spectrum:
start by LSCF, then least squares.

The error that is minimised is that of the response, relative to the RMS of each channel and record
over the band: what a prediction is judged by. Noise is far below the distortion of the structures
at hand, so that a line counts by its size.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.least_squares import minimise
from vibroimpact.reduction.modal_structure import IdentifiedModes

from .stable_modes import stable_poles

BELOW, ABOVE = 0.4, 1.35  # residual modes, times the ends of the band
RESIDUAL_RATIOS = (0.2, 0.01)
NEGLIGIBLE = (
    0.005  # of the response of a channel: a mode with less of it in every channel is left out
)
SMALL_SHAPE = (
    1.0e-3  # of the largest drive shape: a mode that the drive hardly moves still has some
)
# Of the relative error, so that what the record does not show stays near the start: per shape as
# large as all modes together, per relative change of a frequency (a residual mode's counts for a
# tenth), and per change of a damping ratio by a factor of e.
RIDGE, FREQUENCY_RIDGE, RATIO_RIDGE = 3.0e-3, 0.4, 0.01


def identify_modes(level, band_Hz, kinds, names, drive, residuals=(True, True)):
    """Return (IdentifiedModes, chart) of one LevelLines over a band: poles by LSCF, residues by
    least squares, then all refined together.

    residuals: whether modes stand in for what is (below, above) the band. Raises ValueError when no
    pole is stable.
    """
    excited = level.excited(band_Hz)
    frequency = level.frequency[excited]
    response = level.response[:, excited] / level.force[excited]
    weighted = (
        response
        * np.abs(level.force[excited])
        / np.sqrt(np.mean(np.abs(level.force[excited]) ** 2))
    )
    scale = np.sqrt(np.mean(np.abs(weighted) ** 2, axis=1, keepdims=True))
    places, ratios, chart = stable_poles(frequency, response / scale)
    if places.size == 0:
        raise ValueError(
            f"{level.name}: no pole is stable between {band_Hz[0]:g} and {band_Hz[1]:g} Hz: is the"
            " force measured, and the band excited?"
        )
    residual = np.zeros(places.size, bool)
    for wanted, place, ratio in zip(
        residuals,
        (BELOW * max(band_Hz[0], 0.2 * places[0]), ABOVE * band_Hz[1]),
        RESIDUAL_RATIOS,
        strict=True,
    ):
        if wanted:
            places, ratios, residual = (
                np.append(places, place),
                np.append(ratios, ratio),
                np.append(residual, True),
            )
    start = IdentifiedModes(
        places,
        ratios,
        np.ones((places.size, len(response))),
        drive,
        tuple(kinds),
        tuple(names),
        residual,
    )
    weight = np.abs(level.force[excited])
    start = with_residues(start, frequency, response, weight)
    start = with_residues(
        _without_small(start, frequency, response, weight), frequency, response, weight
    )
    return refine_modes(start, [level], band_Hz).sorted(), chart


def _without_small(modes, frequency, response, weight):
    """The modes without those whose part of the response is negligible in every channel: poles that
    the estimator spent on noise.
    """
    parts = (
        modes.observed(frequency)[:, None]
        * (modes.shapes * modes.shapes[:, [modes.drive]]).T[:, :, None]
        * modes.receptance(frequency)
        * weight
    )
    share = np.sqrt(
        np.sum(np.abs(parts) ** 2, axis=2)
        / np.sum(np.abs(response * weight) ** 2, axis=1, keepdims=True)
    ).max(axis=0)
    kept = (share > NEGLIGIBLE) | modes.residual
    return replace(
        modes,
        **{
            name: getattr(modes, name)[kept]
            for name in ("frequency", "damping_ratio", "shapes", "residual")
        },
    )


def with_residues(modes, frequency, response, weight):
    """Return the modes with shapes from a linear least-squares fit of their residues to response
    (channel, line), weighted by line.
    """
    columns, observed = modes.receptance(frequency).T * weight[:, None], modes.observed(frequency)
    products = np.empty((modes.modes, len(response)))
    for channel, values in enumerate(response):
        matrix, wanted = columns * observed[channel][:, None], values * weight
        products[:, channel] = np.linalg.lstsq(
            np.vstack([matrix.real, matrix.imag]),
            np.concatenate([wanted.real, wanted.imag]),
            rcond=None,
        )[0]
    driven = np.sqrt(np.maximum(products[:, modes.drive], 0.0))
    driven = np.maximum(driven, SMALL_SHAPE * max(driven.max(), np.sqrt(np.abs(products).max())))
    shapes = products / driven[:, None]
    shapes[:, modes.drive] = driven
    return replace(modes, shapes=shapes)


def refine_modes(modes, levels, band_Hz, passes=60):
    """Return the modes that make the relative error over all LevelLines least, from a start, by
    Levenberg-Marquardt.
    """
    weights, wanted = zip(*(_weighted(level, band_Hz) for level in levels), strict=True)
    grids = [level.frequency[level.excited(band_Hz)] for level in levels]
    ridge = Ridge(modes)

    def evaluate(values):
        trial = unpack(values, modes)
        error = np.concatenate(
            [
                (trial.frf(grid) * weight - aim).ravel()
                for grid, weight, aim in zip(grids, weights, wanted, strict=True)
            ]
        )
        slope = np.concatenate(
            [_derivatives(trial, grid, weight) for grid, weight in zip(grids, weights, strict=True)]
        )
        return np.concatenate([error.real, error.imag, ridge.error(values)]), np.vstack(
            [slope.real, slope.imag, np.diag(ridge.weight)]
        )

    return unpack(minimise(evaluate, pack(modes), passes).values, modes)


class Ridge:
    """What holds values to their start where the records do not: weight (value,) and error(values)
    (value,), in relative error.

    Shapes are held to nothing instead, so that they do not grow without being seen.
    """

    def __init__(self, modes):
        count, size = modes.modes, np.sqrt(np.sum(modes.shapes[~modes.residual] ** 2))
        frequency = np.where(modes.residual, 0.1, 1.0) * FREQUENCY_RIDGE
        self.weight = np.concatenate(
            [frequency, np.full(count, RATIO_RIDGE), np.full(modes.shapes.size, RIDGE / size)]
        )
        self.start = np.concatenate([pack(modes)[: 2 * count], np.zeros(modes.shapes.size)])

    def error(self, values):
        """Return (value,) of values as `pack` orders them, those behind left out."""
        return self.weight * (values[: self.start.size] - self.start)


def pack(modes):
    """Return (value,): logarithms of frequencies and damping ratios, then the shapes."""
    return np.concatenate(
        [
            np.log(modes.frequency),
            np.log(np.maximum(modes.damping_ratio, 1.0e-6)),
            modes.shapes.ravel(),
        ]
    )


def unpack(values, modes):
    """Return the IdentifiedModes of values as `pack` orders them."""
    count = modes.modes
    shapes = values[2 * count : 2 * count + modes.shapes.size].reshape(modes.shapes.shape)
    return replace(
        modes,
        frequency=np.exp(values[:count]),
        damping_ratio=np.exp(values[count : 2 * count]),
        shapes=shapes,
    )


def relative_errors(predicted, level, band_Hz):
    """Return (channel,) RMS of measured minus predicted response over the RMS measured; predicted
    (channel, excited line).
    """
    inside = level.excited(band_Hz)
    weight = np.where(level.frequency[inside] == 0.0, 1.0, 2.0)
    missed = np.sum(weight * np.abs(predicted - level.response[:, inside]) ** 2, axis=1)
    return np.sqrt(missed / np.sum(weight * np.abs(level.response[:, inside]) ** 2, axis=1))


def channel_scale(level, band_Hz):
    """Return (channel, 1) RMS-like size of the response over the excited lines, in the unit of the
    line amplitudes.
    """
    return np.sqrt(
        np.sum(np.abs(level.response[:, level.excited(band_Hz)]) ** 2, axis=1, keepdims=True)
    )


def _weighted(level, band_Hz):
    """Return (weight (channel, line), wanted (channel, line)): force and response over the
    channel's size.
    """
    inside, scale = level.excited(band_Hz), channel_scale(level, band_Hz)
    return level.force[inside] / scale, level.response[:, inside] / scale


def _derivatives(modes, frequency, weight):
    """Return (channel * line, value) derivatives of the weighted response with respect to
    `pack`.
    """
    laplace = 2j * np.pi * frequency
    receptance = modes.receptance(frequency)
    observed = modes.observed(frequency)
    count, channels = modes.shapes.shape
    drive = modes.shapes[:, modes.drive]
    omega, damping = modes.omega[:, None], modes.damping[:, None]
    by_frequency = -(receptance**2) * (
        laplace * damping + 2.0 * omega**2
    )  # damping = 2 zeta omega rises with omega
    by_damping = -(receptance**2) * laplace * damping
    out = np.zeros((channels, frequency.size, 2 * count + count * channels), complex)
    seen = observed * weight
    for channel in range(channels):
        product = (modes.shapes[:, channel] * drive)[:, None]
        out[channel, :, :count] = (product * by_frequency * seen[channel]).T
        out[channel, :, count : 2 * count] = (product * by_damping * seen[channel]).T
        columns = 2 * count + np.arange(count) * channels
        out[channel][:, columns + channel] += (drive[:, None] * receptance * seen[channel]).T
        out[channel][:, columns + modes.drive] += (
            modes.shapes[:, channel][:, None] * receptance * seen[channel]
        ).T
    return out.reshape(channels * frequency.size, -1)
