"""The pole of the main peak from the outputs alone: LSCF on half ("positive") spectra, which hold
each mode once.

The pole of the first stable order is taken. At low orders the estimator is biased by the modes
outside the band; at high orders it follows the noise. So a low order is taken and its bias is
subtracted: the exact spectra of the linear tube with the pole just found pass through the same
estimator, and its error on them is the bias. Without a model no bias is subtracted.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.poles import frequency_of
from vibroimpact.identify.spectra.window_leakage import window_autocorrelation

from .lscf import NormalEquations
from .segment_scatter import jackknife_influences, widened
from .stabilisation import StabilisationChart, first_stable_order, nearest_pole, stabilisation_chart

LAG_TIMES_WIDTH = 0.6  # longest lag used, times the peak's half-power width
SHORTEST_LAG_S = 0.5
LAST_WEIGHT = 0.01
BIAS_PASSES = 2
# How far from the peak its pole is searched: in half-power widths, and at least as a fraction of
# the peak's frequency.
SEARCH_WIDTHS = 2.0
LEAST_SEARCH_RADIUS = 0.06


def lag_window(
    window: str, samples: int, segment_s: float, longest_lag_s: float
) -> tuple[np.ndarray, float]:
    """Return (weights (lag,) of correlations before they are transformed back to spectra, decay in
    1/s that they add to every mode): an exponential over the autocorrelation of the window.

    Division by the autocorrelation removes the window's widening of the peaks exactly. The
    exponential suppresses the noise of late lags, and its decay is known.

    window: name of the analysis window.
    samples: lags in one segment of segment_s seconds.
    longest_lag_s: s, at which the exponential has fallen to LAST_WEIGHT.
    """
    lags = max(2, min(int(longest_lag_s / segment_s * samples), samples // 2))
    decay = -np.log(LAST_WEIGHT) / longest_lag_s
    exponential = np.exp(-decay * np.arange(lags) * (segment_s / samples))
    weights = exponential / window_autocorrelation(window, samples, lags)
    weights[0] *= 0.5  # lag 0 belongs half to each side
    return weights, float(decay)


def half_spectra(cross_spectra: np.ndarray, weights: np.ndarray, band: slice) -> np.ndarray:
    """Return the half spectra (..., bin) of averaged one-sided cross-spectra (..., frequency).

    A mode with pole p appears once, as A / (i omega + decay - p), with a positive decay. Source:
    Verboven, PhD thesis, Vrije Universiteit Brussel 2002 (output-only estimators use positive power
    spectra).

    cross_spectra: unit²/Hz, frequencies contiguous from 0.
    weights: of lag_window for 2 (frequency - 1) samples.
    band: slice of the bins wanted.
    """
    samples = 2 * (cross_spectra.shape[-1] - 1)
    correlation = np.fft.irfft(cross_spectra, samples, axis=-1)[..., : weights.size]
    return np.fft.rfft(correlation * weights, samples, axis=-1)[..., band]


@dataclass(frozen=True)
class OperationalPole:
    """The pole of the main peak.

    frequency, damping_ratio: Hz (undamped) and fraction.
    covariance: (2, 2) of the two.
    order: order of the estimator.
    stable: whether the pole was stable against the order before.
    chart: StabilisationChart.
    """

    frequency: float
    damping_ratio: float
    covariance: np.ndarray
    order: int
    stable: bool
    chart: StabilisationChart


@dataclass(frozen=True)
class PoleSearch:
    """The settings of the estimator.

    frequency: (frequency,) Hz of the spectra, contiguous from 0.
    band_Hz: band of the fit.
    window: name of the analysis window.
    max_order: highest order.
    """

    frequency: np.ndarray
    band_Hz: tuple
    window: str
    max_order: int

    @property
    def band(self) -> slice:
        """Return the slice of the bins in the band."""
        first = np.searchsorted(self.frequency, self.band_Hz[0], side="left")
        return slice(
            int(first), int(np.searchsorted(self.frequency, self.band_Hz[1], side="right"))
        )


def operational_pole(
    outputs: np.ndarray,
    references: Sequence[int],
    search: PoleSearch,
    peak: tuple[float, float],
    averages: float = np.inf,
    duration_s: float = np.inf,
    tube_spectra: Callable | None = None,
) -> OperationalPole | None:
    """Return the OperationalPole of segment spectra, or None if no pole is near the peak.

    outputs: (output, segment, frequency).
    references: indices of the outputs that serve as references.
    peak: (frequency in Hz, half-power width in Hz) from find_peak.
    averages: effective degrees of freedom of a bin.
    duration_s: length of the record.
    tube_spectra: function of (frequency, damping ratio) that returns (cross-spectra (output,
        reference, frequency) of the linear tube with about that first pole, its exact pole in
        rad/s), or None if there is none; no model by default.
    """
    segments = outputs.shape[1]
    longest_lag_s = max(LAG_TIMES_WIDTH / peak[1], SHORTEST_LAG_S)
    samples, segment_s = 2 * (search.frequency.size - 1), 1.0 / search.frequency[1]
    weights, decay = lag_window(search.window, samples, segment_s, longest_lag_s)
    pairs = np.einsum("osf,rsf->sorf", outputs, outputs[list(references)].conj())
    halves = half_spectra(pairs, weights, search.band)
    band_frequency = search.frequency[search.band]
    mean = halves.mean(axis=0)
    equations = NormalEquations(band_frequency, mean, search.max_order)
    orders = [order for order in range(2, search.max_order + 1) if order <= 8 or order % 2 == 0]
    chart = stabilisation_chart(equations, decay, orders)
    start = 2.0 * np.pi * complex(-0.5 * peak[1], peak[0])
    radius_Hz = max(SEARCH_WIDTHS * peak[1], LEAST_SEARCH_RADIUS * peak[0])
    order, stable = first_stable_order(chart, start, radius_Hz)

    def pole_in(values):
        poles = NormalEquations(band_frequency, values, order).poles(order)[0] + decay
        chosen = nearest_pole(poles, start, radius_Hz)
        return None if chosen is None else poles[chosen]

    found = pole_in(mean)
    if found is None:
        return None
    bias: complex = 0.0
    if tube_spectra is not None:
        bias = _estimator_bias(
            found, tube_spectra, lambda cross: pole_in(half_spectra(cross, weights, search.band))
        )
    frequency, ratio = frequency_of(found - bias)
    covariance = cramer_rao_covariance(frequency, ratio, duration_s)
    if segments > 2:
        without = [pole_in((segments * mean - half) / (segments - 1)) for half in halves]
        poles = [found if pole is None else pole for pole in without]
        moved = np.array([frequency_of(pole - bias) for pole in poles])
        covariance = widened(covariance, jackknife_influences(moved), averages)
    return OperationalPole(float(frequency), float(ratio), covariance, order, stable, chart)


def cramer_rao_covariance(frequency: float, damping_ratio: float, duration_s: float) -> np.ndarray:
    """Return the least covariance (2, 2) of (frequency in Hz, damping ratio) of any estimate.

    It is the Cramér-Rao bound of a lightly damped mode under white noise of duration T: the
    variances of omega and of zeta omega are both zeta omega / T.
    """
    omega = 2.0 * np.pi * frequency
    variance = damping_ratio * omega / duration_s
    return np.diag([variance / (2.0 * np.pi) ** 2, variance / omega**2])


def _estimator_bias(
    found: complex, tube_spectra: Callable, estimate: Callable[[np.ndarray], complex | None]
) -> complex:
    """Return the bias of the estimator of a pole in rad/s, on exact spectra of the linear tube."""
    bias: complex = 0.0
    for _ in range(BIAS_PASSES):
        tube = tube_spectra(*frequency_of(found - bias))
        out = None if tube is None else estimate(tube[0])
        if out is None:
            return 0.0
        bias = out - tube[1]
    return bias
