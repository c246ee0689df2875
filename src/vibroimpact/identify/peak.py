"""Main peak of a PSD: frequency and damping ratio from its width at 1/2, 1/4 and 1/25 of its
height.

A width read off a spectrum of 18 effective degrees of freedom is badly biased (the highest bin is
high by chance, a smoothed one is widened), so the width is read off a resonance curve A
N(f)/|D(f)|² fitted to the bins. The fit weighs the bins above peak/n by 1 and those below by how
far they are below: weight min(1, n S/S_peak). So each level looks at its own part of the peak (a
peak that is not a resonance gives three different widths), without paying for the few bins above
half power with a threefold scatter.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.spectra.window_leakage import correlated_sum

from .segments import widened

LEVELS = {"peak_half": 2.0, "peak_quarter": 4.0, "peak_25th": 25.0}
SMALLEST_RATIO, LARGEST_RATIO = 1.0e-4, 0.5  # damping ratios beyond which a peak is no resonance
# the weight falls to nothing at S_peak / FARTHEST: other modes and sensors' floors live there
FARTHEST = 50.0
FEWEST_BINS = 7
LEAST_WEIGHT = 0.01
SCORING_STEPS, FULL_STEPS = 60, 15
SETTLED, ROUGHLY = 1.0e-7, 1.0e-3  # of ln damping ratio; a 20th of that in ln frequency
OTHER_MODES_PASSES = 4


@dataclass(frozen=True)
class PeakFit:
    """Resonance curve fitted around the main peak.

    frequency (Hz, undamped), damping_ratio; covariance (2, 2) of (frequency, damping_ratio);
    edges_Hz: where 1/|D|² crosses peak/n; bins: the part of the spectrum used, curve (bin,) the
    fitted expected PSD there.
    """

    frequency: float
    damping_ratio: float
    covariance: np.ndarray
    edges_Hz: tuple
    bins: slice
    curve: np.ndarray


def level_edges(frequency, damping_ratio, level):
    """Return the two frequencies (Hz) where 1/|D|² is `level` times below its maximum; exact for
    any damping ratio below 0.7.

    The lower edge is 0 where a wide curve never falls that low.
    """
    centre = 1.0 - 2.0 * damping_ratio**2
    half = 2.0 * damping_ratio * np.sqrt((1.0 - damping_ratio**2) * (level - 1.0))
    return float(frequency * np.sqrt(max(centre - half, 0.0))), float(
        frequency * np.sqrt(centre + half)
    )


def damping_from_width(edges_Hz, level):
    """Return (undamped frequency in Hz, damping ratio) of the resonance whose 1/|D|² crosses
    peak/level at edges_Hz.

    To first order zeta = width / (2 f sqrt(level - 1)); the paper prints 2 width/f; that is not
    copied. Here without approximation: (f2² - f1²) / (f2² + f1²) = 2 zeta sqrt(1 - zeta²)
    sqrt(level - 1) / (1 - 2 zeta²), that is tan(2 arcsin zeta) sqrt(level - 1).
    """
    low, high = np.square(edges_Hz)
    damping_ratio = np.sin(0.5 * np.arctan((high - low) / (high + low) / np.sqrt(level - 1.0)))
    return float(np.sqrt(0.5 * (high + low) / (1.0 - 2.0 * damping_ratio**2))), float(damping_ratio)


def find_peak(frequency, psd, search_Hz, smoothing_bins=5):
    """Return (frequency of the main peak in Hz, its width at half height in Hz) on a PSD smoothed
    over a few bins: a start for fits.

    Raises ValueError when search_Hz holds fewer than smoothing_bins bins.
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
    frequency, psd, kernel, level, start, other_modes=None, averages=np.inf, segments=None
):
    """Return the PeakFit at one level of a PSD (frequency,), or None where the iteration leaves the
    plausible range.

    kernel: SpectralKernel of the analysis window, through which the curve passes before it meets
    the PSD; start: (Hz, width in Hz) as find_peak gives; other_modes(frequency, damping_ratio) ->
    function of the fine index that gives N (fine,): what the other modes of a linear model with
    that first pole make of the curve (None: N = 1, a structure without a model); averages:
    effective degrees of freedom of a bin; segments (segment, frequency): PSDs of the single
    segments, from which the standard error may be widened.
    """
    theta = np.array([np.nan, np.log(start[0]), np.log(min(0.5 * start[1] / start[0], 0.2))])
    passes = 1 if other_modes is None else OTHER_MODES_PASSES
    for number in range(passes):
        factor = None if other_modes is None else other_modes(*np.exp(theta[1:]))
        fit = _score(
            frequency,
            psd,
            kernel,
            level,
            theta,
            factor,
            SETTLED if number == passes - 1 else ROUGHLY,
        )
        if fit is None:
            return None
        theta = fit.theta
    weighted = fit.slopes * fit.weights
    inverse = np.linalg.inv(weighted @ fit.slopes.T)
    covariance = (inverse @ correlated_sum(weighted, kernel) @ inverse * (2.0 / averages))[1:, 1:]
    if segments is not None:
        pulls = (segments[:, fit.bins] - psd[fit.bins]) / fit.curve @ weighted.T @ inverse
        covariance = widened(covariance, pulls[:, 1:], averages)
    frequency_Hz, damping_ratio = np.exp(theta[1:])
    edges = level_edges(frequency_Hz, damping_ratio, level)
    if edges[0] > 0.0:
        frequency_Hz, damping_ratio = damping_from_width(edges, level)
    scale = np.array([frequency_Hz, damping_ratio])
    return PeakFit(
        float(frequency_Hz),
        float(damping_ratio),
        covariance * np.outer(scale, scale),
        edges,
        fit.bins,
        fit.curve,
    )


@dataclass(frozen=True)
class _Score:
    """State of the fit: theta = (ln A, ln frequency in Hz, ln damping ratio), bins, curve (bin,),
    slopes (3, bin), weights (bin,).
    """

    theta: np.ndarray
    bins: slice
    curve: np.ndarray
    slopes: np.ndarray
    weights: np.ndarray


def _score(frequency, psd, kernel, level, theta, factor, tolerance):
    """Return the _Score where the quasi-likelihood of the bins is stationary, or None.

    The bins are gamma distributed about the curve: Fisher scoring on sum of weight (estimate/curve
    - 1) slope = 0. Bins and weights follow the curve, not the noise. An amplitude that is NaN is
    set from the first curve.
    """
    for step in range(SCORING_STEPS):
        bins = _bins(frequency, theta)
        shape, slopes, weights = _curve(frequency[bins], theta, kernel, level, factor)
        if np.count_nonzero(weights > LEAST_WEIGHT) < len(theta) + 1:
            return None  # a peak narrower than the bins has no width to be read
        if np.isnan(theta[0]):
            theta = np.array(
                [np.log(np.sum(weights * psd[bins] / shape) / np.sum(weights)), *theta[1:]]
            )
        curve = np.exp(theta[0]) * shape
        weighted = slopes * weights
        information = weighted @ slopes.T
        information[np.diag_indices(3)] *= 1.0 + 1.0e-10
        change = np.linalg.solve(information, weighted @ (psd[bins] / curve - 1.0))
        largest = max(abs(change[1]) * 20.0, abs(change[2]))
        if largest < tolerance:
            return _Score(theta, bins, curve, slopes, weights)
        # The weights follow the curve: where they make the steps go to and fro, half steps settle.
        theta = theta + change * min(1.0 if step < FULL_STEPS else 0.5, 0.5 / largest)
        if not _plausible(theta, frequency):
            return None
    return _Score(theta, bins, curve, slopes, weights) if largest < ROUGHLY else None


def _plausible(theta, frequency):
    """Return whether the pole of theta lies inside the spectrum and is a damped resonance."""
    ratios = np.log((SMALLEST_RATIO, LARGEST_RATIO))
    return bool(
        np.all(np.isfinite(theta))
        and frequency[0] < np.exp(theta[1]) < frequency[-1]
        and ratios[0] < theta[2] < ratios[1]
    )


def _bins(frequency, theta):
    """Return the slice of bins where the resonance is above its peak/FARTHEST (they alone weigh),
    at least FEWEST_BINS of them.
    """
    low, high = level_edges(np.exp(theta[1]), np.exp(theta[2]), FARTHEST)
    first, last = np.searchsorted(frequency, (low, high))
    middle, half = int(np.searchsorted(frequency, np.exp(theta[1]))), FEWEST_BINS // 2
    return slice(
        max(0, min(first, middle - half)), min(frequency.size, max(last, middle + half + 1))
    )


def _weights(relative, level):
    """Return the weights (bin,) of bins at a height relative to the peak: 1 above 1/level, falling
    smoothly to 0 at 1/FARTHEST.

    Smoothly, because the fit's own curve sets them: a bin that enters with a jump can keep the
    iteration from settling.
    """
    return np.minimum(1.0, level * relative) * np.clip(1.5 - 1.5 / (FARTHEST * relative), 0.0, 1.0)


def _curve(frequency, theta, kernel, level, factor):
    """Return (expected PSD for A = 1, logarithmic slopes (3, bin), weights (bin,)) of contiguous
    bins frequency (bin,) Hz.
    """
    index = kernel.fine_index(frequency)
    curves = resonance(index * (kernel.spacing_Hz / kernel.oversampling), theta[1], theta[2])
    if factor is not None:
        curves = curves * factor(index)
    model, by_frequency, by_ratio = kernel.smooth(curves)
    slopes = np.array([np.ones(model.size), by_frequency / model, by_ratio / model])
    return model, slopes, _weights(model / model.max(), level)


def resonance(frequency, ln_frequency, ln_ratio):
    """Return (3, frequency): 1/|D|² of D = 1 - y + 2 i zeta sqrt(y), y = (f/f0)², and its
    derivatives to ln f0 and ln zeta.
    """
    square = (frequency / np.exp(ln_frequency)) ** 2
    damping = 4.0 * np.exp(2.0 * ln_ratio) * square
    curve = 1.0 / ((1.0 - square) ** 2 + damping)
    by_frequency = curve**2 * (2.0 * damping - 4.0 * square * (1.0 - square))
    return np.array([curve, by_frequency, -2.0 * damping * curve**2])
