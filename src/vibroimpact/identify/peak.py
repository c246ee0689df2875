"""Main peak of a PSD: frequency and damping ratio from its width at 1/2, 1/4 and 1/25 height.

A width read directly off a spectrum of 18 effective degrees of freedom is badly biased: the highest
bin is high by chance, and a smoothed peak is wider. So a resonance curve A N(f)/|D(f)|² is
fitted to the bins and the width is read off the curve. The fit weighs bins above peak/n by 1 and
those below by n S/S_peak. So each level n looks at its own part of the peak, and a peak that is not
a resonance gives three different widths. A fit to the few bins above half power alone would scatter
three times as much.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.spectra.window_leakage import SpectralKernel, correlated_sum

from .segment_scatter import widened

LEVELS = {"peak_half": 2.0, "peak_quarter": 4.0, "peak_25th": 25.0}
SMALLEST_RATIO, LARGEST_RATIO = 1.0e-4, 0.5  # damping ratios beyond which a peak is not a resonance
# The weight is zero below S_peak / FARTHEST, where other modes and the sensors' noise dominate.
FARTHEST = 50.0
FEWEST_BINS = 7
LEAST_WEIGHT = 0.01
SCORING_STEPS, FULL_STEPS = 60, 15
SETTLED, ROUGHLY = 1.0e-7, 1.0e-3  # of ln damping ratio; a 20th of that in ln frequency
OTHER_MODES_PASSES = 4


@dataclass(frozen=True)
class PeakFit:
    """Resonance curve fitted around the main peak.

    frequency, damping_ratio: Hz (undamped) and fraction.
    covariance: (2, 2) of the two.
    edges_Hz: frequencies at which 1/|D|² crosses peak/level.
    bins: slice of the spectrum used.
    curve: (bin,) the fitted expected PSD there.
    """

    frequency: float
    damping_ratio: float
    covariance: np.ndarray
    edges_Hz: tuple
    bins: slice
    curve: np.ndarray


def level_edges(frequency: float, damping_ratio: float, level: float) -> tuple[float, float]:
    """Return the two frequencies in Hz at which 1/|D|² is `level` times below its maximum.

    Exact for any damping ratio below 0.7. The lower edge is 0 if a wide curve never falls that
    low.
    """
    centre = 1.0 - 2.0 * damping_ratio**2
    half = 2.0 * damping_ratio * np.sqrt((1.0 - damping_ratio**2) * (level - 1.0))
    low = float(frequency * np.sqrt(max(centre - half, 0.0)))
    return low, float(frequency * np.sqrt(centre + half))


def damping_from_width(edges_Hz: Sequence[float], level: float) -> tuple[float, float]:
    """Return (undamped frequency in Hz, damping ratio) of the resonance with these edges.

    1/|D|² crosses peak/level at edges_Hz. To first order zeta = width / (2 f sqrt(level - 1)); the
    paper prints 2 width/f, which is not copied. Here without approximation:
    (f2² - f1²) / (f2² + f1²) = tan(2 arcsin zeta) sqrt(level - 1).
    """
    low, high = np.square(edges_Hz)
    damping_ratio = np.sin(0.5 * np.arctan((high - low) / (high + low) / np.sqrt(level - 1.0)))
    return float(np.sqrt(0.5 * (high + low) / (1.0 - 2.0 * damping_ratio**2))), float(damping_ratio)


def find_peak(
    frequency: np.ndarray, psd: np.ndarray, search_Hz: Sequence[float], smoothing_bins: int = 5
) -> tuple[float, float]:
    """Return (frequency, width at half height) of the main peak in Hz, a start for fits.

    The PSD (frequency,) is smoothed over a few bins. Raises ValueError when the search band holds
    fewer than smoothing_bins bins.
    """
    inside = np.flatnonzero((frequency >= search_Hz[0]) & (frequency <= search_Hz[1]))
    if inside.size < smoothing_bins:
        raise ValueError(
            f"only {inside.size} bins between {search_Hz[0]:g} and {search_Hz[1]:g} Hz: longer"
            " segments or a wider search"
        )
    weights = np.hanning(smoothing_bins + 2)[1:-1]
    smooth = np.convolve(psd, weights / weights.sum(), mode="same")
    top = int(inside[np.argmax(smooth[inside])])
    below = smooth < 0.5 * smooth[top]
    left, right = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    low = left[-1] + 1 if left.size else 0
    high = top + right[0] - 1 if right.size else frequency.size - 1
    return float(frequency[top]), float(max(high - low, 2) * (frequency[1] - frequency[0]))


def fit_peak(
    frequency: np.ndarray,
    psd: np.ndarray,
    kernel: SpectralKernel,
    level: float,
    start: tuple[float, float],
    other_modes: Callable | None = None,
    averages: float = np.inf,
    segments: np.ndarray | None = None,
) -> PeakFit | None:
    """Return the PeakFit at one level of a PSD, or None if the iteration diverges.

    frequency, psd: (frequency,) Hz and unit²/Hz.
    kernel: of the analysis window; the curve passes through it before it is compared.
    start: (frequency, width) in Hz from find_peak.
    other_modes: function of (frequency, damping ratio) that returns a function of the fine index
        for N (fine,): the effect of the other modes of a linear model with that first pole. None
        for N = 1, a structure without a model.
    averages: effective degrees of freedom of a bin.
    segments: (segment, frequency) PSDs of the segments, which may widen the standard error.
    """
    theta = np.array([np.nan, np.log(start[0]), np.log(min(0.5 * start[1] / start[0], 0.2))])
    passes = 1 if other_modes is None else OTHER_MODES_PASSES
    for number in range(passes):
        factor = None if other_modes is None else other_modes(*np.exp(theta[1:]))
        tolerance = SETTLED if number == passes - 1 else ROUGHLY
        fit = _score(frequency, psd, kernel, level, theta, factor, tolerance)
        if fit is None:
            return None
        theta, bins, curve, slopes, weighted = fit
    inverse = np.linalg.inv(weighted @ slopes.T)
    covariance = (inverse @ correlated_sum(weighted, kernel) @ inverse * (2.0 / averages))[1:, 1:]
    if segments is not None:
        pulls = (segments[:, bins] - psd[bins]) / curve @ weighted.T @ inverse
        covariance = widened(covariance, pulls[:, 1:], averages)
    frequency_Hz, damping_ratio = np.exp(theta[1:])
    edges = level_edges(frequency_Hz, damping_ratio, level)
    if edges[0] > 0.0:
        frequency_Hz, damping_ratio = damping_from_width(edges, level)
    scale = np.array([frequency_Hz, damping_ratio])
    return PeakFit(
        frequency=float(frequency_Hz),
        damping_ratio=float(damping_ratio),
        covariance=covariance * np.outer(scale, scale),
        edges_Hz=edges,
        bins=bins,
        curve=curve,
    )


def _score(
    frequency: np.ndarray,
    psd: np.ndarray,
    kernel: SpectralKernel,
    level: float,
    theta: np.ndarray,
    factor: Callable | None,
    tolerance: float,
) -> tuple[np.ndarray, slice, np.ndarray, np.ndarray, np.ndarray] | None:
    """Return where the quasi-likelihood of the bins is stationary, or None.

    It is (theta: ln A, ln frequency in Hz, ln damping ratio; slice of the bins used; curve (bin,);
    slopes (3, bin); slopes times weights).

    The bins are gamma distributed about the curve. Fisher scoring solves
    sum of weight (estimate/curve - 1) slope = 0. Bins and weights follow the curve, not the noise.
    An amplitude of NaN is set from the first curve.
    """
    low, high = np.log((SMALLEST_RATIO, LARGEST_RATIO))
    for step in range(SCORING_STEPS):
        bins = _bins(frequency, theta)
        shape, slopes, weights = _curve(frequency[bins], theta, kernel, level, factor)
        if np.count_nonzero(weights > LEAST_WEIGHT) < len(theta) + 1:
            return None  # a peak narrower than the bins has no measurable width
        if np.isnan(theta[0]):
            amplitude = np.sum(weights * psd[bins] / shape) / np.sum(weights)
            theta = np.array([np.log(amplitude), *theta[1:]])
        curve = np.exp(theta[0]) * shape
        weighted = slopes * weights
        information = weighted @ slopes.T
        information[np.diag_indices(3)] *= 1.0 + 1.0e-10
        change = np.linalg.solve(information, weighted @ (psd[bins] / curve - 1.0))
        largest = max(abs(change[1]) * 20.0, abs(change[2]))
        if largest < tolerance:
            return theta, bins, curve, slopes, weighted
        # The weights follow the curve. If this makes the steps oscillate, half steps converge.
        theta = theta + change * min(1.0 if step < FULL_STEPS else 0.5, 0.5 / largest)
        if not np.all(np.isfinite(theta)):
            return None
        if not frequency[0] < np.exp(theta[1]) < frequency[-1] or not low < theta[2] < high:
            return None  # the pole lies outside the spectrum, or is no damped resonance
    return (theta, bins, curve, slopes, weighted) if largest < ROUGHLY else None


def _bins(frequency: np.ndarray, theta: np.ndarray) -> slice:
    """Return the bins in which the resonance is above its peak/FARTHEST, at least FEWEST_BINS.

    Only these have a weight.
    """
    low, high = level_edges(np.exp(theta[1]), np.exp(theta[2]), FARTHEST)
    first, last = np.searchsorted(frequency, (low, high))
    middle, half = int(np.searchsorted(frequency, np.exp(theta[1]))), FEWEST_BINS // 2
    return slice(
        max(0, min(first, middle - half)), min(frequency.size, max(last, middle + half + 1))
    )


def _curve(
    frequency: np.ndarray,
    theta: np.ndarray,
    kernel: SpectralKernel,
    level: float,
    factor: Callable | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (expected PSD for A = 1, logarithmic slopes (3, bin), weights (bin,)).

    The weights are 1 above 1/level of the peak and fall smoothly to 0 at 1/FARTHEST. Smoothly,
    because the fit's own curve sets them: a bin that enters with a jump can keep the iteration from
    converging.

    frequency: (bin,) Hz, contiguous bins.
    """
    index = kernel.fine_index(frequency)
    curves = resonance(index * (kernel.spacing_Hz / kernel.oversampling), theta[1], theta[2])
    if factor is not None:
        curves = curves * factor(index)
    model, by_frequency, by_ratio = kernel.smooth(curves)
    slopes = np.array([np.ones(model.size), by_frequency / model, by_ratio / model])
    relative = model / model.max()
    fall = np.clip(1.5 - 1.5 / (FARTHEST * relative), 0.0, 1.0)
    return model, slopes, np.minimum(1.0, level * relative) * fall


def resonance(frequency: np.ndarray, ln_frequency: float, ln_ratio: float) -> np.ndarray:
    """Return (3, frequency): 1/|D|² and its derivatives by ln f0 and ln zeta.

    D = 1 - y + 2 i zeta sqrt(y), y = (f/f0)².
    """
    square = (frequency / np.exp(ln_frequency)) ** 2
    damping = 4.0 * np.exp(2.0 * ln_ratio) * square
    curve = 1.0 / ((1.0 - square) ** 2 + damping)
    by_frequency = curve**2 * (2.0 * damping - 4.0 * square * (1.0 - square))
    return np.array([curve, by_frequency, -2.0 * damping * curve**2])
