"""Half ("positive") spectra: the part of the cross-spectra that holds each mode once, as an
output-only pole estimator needs it.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.spectra.window_leakage import window_autocorrelation


@dataclass(frozen=True)
class LagWindow:
    """How correlations are weighted before they go back to spectra.

    weights: (lag,); decay (1/s): what the exponential window adds to the decay of every mode, to be
    taken off again.
    """

    weights: np.ndarray
    decay: float


def lag_window(window, samples, segment_s, longest_lag_s, last_weight=0.01):
    """Return the LagWindow up to longest_lag_s: exponential, falling to last_weight, over the
    autocorrelation of the analysis window.

    samples: lags in one segment of segment_s seconds. Dividing by the autocorrelation takes the
    analysis window's widening of the peaks out exactly; the exponential keeps the noise of the late
    lags out and its decay is known.
    """
    lags = max(2, min(int(longest_lag_s / segment_s * samples), samples // 2))
    decay = -np.log(last_weight) / longest_lag_s
    weights = np.exp(-decay * np.arange(lags) * (segment_s / samples)) / window_autocorrelation(
        window, samples, lags
    )
    weights[0] *= 0.5  # lag 0 belongs half to each side
    return LagWindow(weights, float(decay))


def half_spectra(cross_spectra, lags, band):
    """Return the half spectra (..., bin) of averaged one-sided cross-spectra (..., frequency) in
    unit²/Hz, frequency contiguous from 0.

    lags: LagWindow made for 2 (frequency - 1) samples; band: slice of the bins wanted. A mode with
    pole p appears as A / (i omega + decay - p): once, with a positive decay. Source: Verboven, PhD
    thesis, Vrije Universiteit Brussel 2002 (output-only estimators work on positive power spectra).
    """
    samples = 2 * (cross_spectra.shape[-1] - 1)
    correlation = np.fft.irfft(cross_spectra, samples, axis=-1)[..., : lags.weights.size]
    return np.fft.rfft(correlation * lags.weights, samples, axis=-1)[..., band]
