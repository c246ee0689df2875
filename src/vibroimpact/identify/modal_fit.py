"""Real modes, scaled by the drive point, fitted to frequency responses at spectral lines.

The start comes from LSCF, the result from least squares. The residual is the error of the response
relative to its RMS over the band, per channel and record, because a prediction is judged by it.
Noise is far below the distortion of the structures at hand, so a line counts by its size.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.identify.least_squares import minimise
from vibroimpact.identify.spectra.periodic_lines import LevelLines
from vibroimpact.reduction.modal_structure import IdentifiedModes

from .stabilisation import StabilisationChart, stable_poles

BELOW, ABOVE = 0.4, 1.35  # residual modes, times the ends of the band
RESIDUAL_RATIOS = (0.2, 0.01)
# A mode with less than this fraction of the response in every channel is left out.
NEGLIGIBLE = 0.005
# Least drive shape of a mode that the drive hardly moves, as a fraction of the largest.
SMALL_SHAPE = 1.0e-3
# Penalties in units of the relative error: per shape as large as all modes together, per relative
# change of a frequency (a tenth of it for residual modes), and per change of a damping ratio by a
# factor of e. They keep values that the record does not determine near the start.
PASSES = 60  # of the refinement, at most
RIDGE, FREQUENCY_RIDGE, RATIO_RIDGE = 3.0e-3, 0.4, 0.01


def identify_modes(
    level: LevelLines,
    band_Hz: Sequence[float],
    kinds: Sequence[str],
    names: Sequence[str],
    drive: int,
    residuals: tuple[bool, bool] = (True, True),
) -> tuple[IdentifiedModes, StabilisationChart]:
    """Return (IdentifiedModes, chart) of one record over a band.

    Poles come from LSCF, residues from linear least squares; then all are refined together.

    kinds, names, drive: of the channels, see IdentifiedModes.
    residuals: whether residual modes stand for modes (below, above) the band.

    Raises ValueError when no pole is stable.
    """
    excited = level.excited(band_Hz)
    frequency = level.frequency[excited]
    response = level.response[:, excited] / level.force[excited]
    size = np.abs(level.force[excited])
    weighted = response * size / np.sqrt(np.mean(size**2))
    scale = np.sqrt(np.mean(np.abs(weighted) ** 2, axis=1, keepdims=True))
    places, ratios, chart = stable_poles(frequency, response / scale)
    if places.size == 0:
        raise ValueError(
            f"{level.name}: no pole is stable between {band_Hz[0]:g} and {band_Hz[1]:g} Hz: is the"
            " force measured, and the band excited?"
        )
    residual = np.zeros(places.size, bool)
    outside = (BELOW * max(band_Hz[0], 0.2 * places[0]), ABOVE * band_Hz[1])
    for wanted, place, ratio in zip(residuals, outside, RESIDUAL_RATIOS, strict=True):
        if wanted:
            places = np.append(places, place)
            ratios = np.append(ratios, ratio)
            residual = np.append(residual, True)
    start = IdentifiedModes(
        frequency=places,
        damping_ratio=ratios,
        shapes=np.ones((places.size, len(response))),
        drive=drive,
        kinds=tuple(kinds),
        names=tuple(names),
        residual=residual,
    )
    weight = np.abs(level.force[excited])
    start = with_residues(start, frequency, response, weight)
    start = _without_small(start, frequency, response, weight)
    start = with_residues(start, frequency, response, weight)
    modes = refine_modes(start, [level], band_Hz)
    return modes.of(np.argsort(modes.frequency)), chart


def _without_small(
    modes: IdentifiedModes, frequency: np.ndarray, response: np.ndarray, weight: np.ndarray
) -> IdentifiedModes:
    """Return the modes whose part of the response is not negligible in every channel.

    The others are poles that the estimator fitted to noise.
    """
    residues = (modes.shapes * modes.shapes[:, [modes.drive]]).T[:, :, None]
    factors = modes.sensor_factors(frequency)[:, None]
    parts = factors * residues * modes.receptance(frequency) * weight
    power = np.sum(np.abs(parts) ** 2, axis=2)
    total = np.sum(np.abs(response * weight) ** 2, axis=1, keepdims=True)
    large = (np.sqrt(power / total).max(axis=0) > NEGLIGIBLE) | modes.residual
    return modes.of(large)


def with_residues(
    modes: IdentifiedModes, frequency: np.ndarray, response: np.ndarray, weight: np.ndarray
) -> IdentifiedModes:
    """Return the modes with shapes from a linear least-squares fit of their residues.

    frequency: (line,) Hz.
    response: (channel, line) per unit force.
    weight: (line,).
    """
    columns = modes.receptance(frequency).T * weight[:, None]
    factors = modes.sensor_factors(frequency)
    products = np.empty((modes.modes, len(response)))
    for channel, values in enumerate(response):
        matrix, wanted = columns * factors[channel][:, None], values * weight
        parts = np.vstack([matrix.real, matrix.imag]), np.concatenate([wanted.real, wanted.imag])
        products[:, channel] = np.linalg.lstsq(*parts, rcond=None)[0]
    driven = np.sqrt(np.maximum(products[:, modes.drive], 0.0))
    driven = np.maximum(driven, SMALL_SHAPE * max(driven.max(), np.sqrt(np.abs(products).max())))
    shapes = products / driven[:, None]
    shapes[:, modes.drive] = driven
    return replace(modes, shapes=shapes)


def refine_modes(
    modes: IdentifiedModes, levels: Sequence[LevelLines], band_Hz: Sequence[float]
) -> IdentifiedModes:
    """Return the modes of least relative error over all records, by Levenberg-Marquardt."""
    records = []
    for level in levels:  # force and response, each (channel, line), over the size of the channel
        inside, scale = level.excited(band_Hz), channel_scale(level, band_Hz)
        sizes = level.force[inside] / scale, level.response[:, inside] / scale
        records.append((level.frequency[inside], *sizes))
    ridge = Ridge(modes)

    def evaluate(values):
        trial = unpack(values, modes)
        error = np.concatenate(
            [(trial.frf(grid) * weight - wanted).ravel() for grid, weight, wanted in records]
        )
        slope = np.concatenate([_derivatives(trial, grid, weight) for grid, weight, _ in records])
        return np.concatenate([error.real, error.imag, ridge.error(values)]), np.vstack(
            [slope.real, slope.imag, np.diag(ridge.weight)]
        )

    return unpack(minimise(evaluate, pack(modes), PASSES).values, modes)


class Ridge:
    """A penalty that holds values near their start if the records do not determine them.

    Shapes are held near zero instead, so that they do not grow unobserved.

    weight: (value,).
    start: (value,).
    """

    def __init__(self, modes: IdentifiedModes) -> None:
        count, size = modes.modes, np.sqrt(np.sum(modes.shapes[~modes.residual] ** 2))
        frequency = np.where(modes.residual, 0.1, 1.0) * FREQUENCY_RIDGE
        self.weight = np.concatenate(
            [frequency, np.full(count, RATIO_RIDGE), np.full(modes.shapes.size, RIDGE / size)]
        )
        self.start = np.concatenate([pack(modes)[: 2 * count], np.zeros(modes.shapes.size)])

    def error(self, values: np.ndarray) -> np.ndarray:
        """Return the residuals (value,) of values in the order of `pack`; ignore further ones."""
        return self.weight * (values[: self.start.size] - self.start)


def pack(modes: IdentifiedModes) -> np.ndarray:
    """Return (value,): logarithms of frequencies and damping ratios, then the shapes."""
    ratios = np.maximum(modes.damping_ratio, 1.0e-6)
    return np.concatenate([np.log(modes.frequency), np.log(ratios), modes.shapes.ravel()])


def unpack(values: np.ndarray, modes: IdentifiedModes) -> IdentifiedModes:
    """Return the IdentifiedModes of values in the order of `pack`."""
    count = modes.modes
    shapes = values[2 * count : 2 * count + modes.shapes.size].reshape(modes.shapes.shape)
    return replace(
        modes,
        frequency=np.exp(values[:count]),
        damping_ratio=np.exp(values[count : 2 * count]),
        shapes=shapes,
    )


def channel_scale(level: LevelLines, band_Hz: Sequence[float]) -> np.ndarray:
    """Return (channel, 1) root of the summed squares of the response over the excited lines."""
    response = level.response[:, level.excited(band_Hz)]
    return np.sqrt(np.sum(np.abs(response) ** 2, axis=1, keepdims=True))


def _derivatives(modes: IdentifiedModes, frequency: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return (channel * line, value) derivatives of the weighted response by `pack`."""
    laplace = 2j * np.pi * frequency
    receptance = modes.receptance(frequency)
    factors = modes.sensor_factors(frequency)
    count, channels = modes.shapes.shape
    drive = modes.shapes[:, modes.drive]
    omega, damping = modes.omega[:, None], modes.damping[:, None]
    # damping = 2 zeta omega rises with omega
    by_frequency = -(receptance**2) * (laplace * damping + 2.0 * omega**2)
    by_damping = -(receptance**2) * laplace * damping
    out = np.zeros((channels, frequency.size, 2 * count + count * channels), complex)
    seen = factors * weight
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
