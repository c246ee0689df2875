"""Half ("positive") spectra: cross-spectra that hold each mode once.

An output-only pole estimator needs them.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.spectra.window_leakage import window_autocorrelation

LAST_WEIGHT = 0.01


@dataclass(frozen=True)
class LagWindow:
    """The weights of correlations before they are transformed back to spectra.

    weights: (lag,).
    decay: 1/s, that the exponential window adds to the decay of every mode; to be subtracted.
    """

    weights: np.ndarray
    decay: float


def lag_window(window: str, samples: int, segment_s: float, longest_lag_s: float) -> LagWindow:
    """Return the LagWindow: an exponential over the autocorrelation of the analysis window.

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
    return LagWindow(weights, float(decay))


def half_spectra(cross_spectra: np.ndarray, lags: LagWindow, band: slice) -> np.ndarray:
    """Return the half spectra (..., bin) of averaged one-sided cross-spectra (..., frequency).

    A mode with pole p appears once, as A / (i omega + decay - p), with a positive decay. Source:
    Verboven, PhD thesis, Vrije Universiteit Brussel 2002 (output-only estimators use positive power
    spectra).

    cross_spectra: unit²/Hz, frequencies contiguous from 0.
    lags: LagWindow made for 2 (frequency - 1) samples.
    band: slice of the bins wanted.
    """
    samples = 2 * (cross_spectra.shape[-1] - 1)
    correlation = np.fft.irfft(cross_spectra, samples, axis=-1)[..., : lags.weights.size]
    return np.fft.rfft(correlation * lags.weights, samples, axis=-1)[..., band]
