"""The effect of the analysis window on a PSD.

The expected averaged spectrum is the true one convolved with the window's |W|². A 10 s Hann window
widens the half-power width of the first peak by about 8 %. Every model spectrum therefore passes
through the same kernel before it is compared with an estimate, and noisy data are not deconvolved.
"""

from dataclasses import dataclass

import numpy as np

from .welch import window_values

SIDE_LOBES = 1.0e-5  # fraction of the kernel's area that may be cut off
MAX_HALF_WIDTH = 40  # bins
WINDOW_SAMPLES = 1024  # the kernel near zero frequency does not depend on them


@dataclass(frozen=True)
class SpectralKernel:
    """Weights of the window's power kernel on a grid finer than the bins.

    spacing_Hz: distance of two bins.
    oversampling: fine points per bin.
    weights: (tap,) centred, of odd length, summing to 1.
    bin_correlation: (distance,) squared correlation of segment spectra 0, 1, ... bins apart, for a
        flat PSD.
    """

    spacing_Hz: float
    oversampling: int
    weights: np.ndarray
    bin_correlation: np.ndarray

    @property
    def half_width(self) -> int:
        """Return the number of fine points on each side of the kernel's centre."""
        return self.weights.size // 2

    @property
    def bins(self) -> slice:
        """Return the slice of fine_index that holds the bins themselves."""
        return slice(self.half_width, -self.half_width or None, self.oversampling)

    def fine_index(self, frequency: np.ndarray) -> np.ndarray:
        """Return (fine,) indices into a grid from 0 Hz in steps of spacing_Hz / oversampling.

        A model PSD must be given at these points to be smoothed. Below 0 Hz a PSD is its own mirror
        image.

        frequency: (frequency,) Hz, contiguous bins.
        """
        first = int(round(frequency[0] / self.spacing_Hz)) * self.oversampling
        last = first + (frequency.size - 1) * self.oversampling
        return np.abs(np.arange(first - self.half_width, last + self.half_width + 1))

    def smooth(self, fine_psd: np.ndarray) -> np.ndarray:
        """Return the expected averaged PSD (..., frequency).

        fine_psd: (..., fine), the true PSD on `fine_index`.
        """
        if self.weights.size == 1:
            return fine_psd[..., :: self.oversampling]
        windows = np.lib.stride_tricks.sliding_window_view(fine_psd, self.weights.size, axis=-1)
        return windows[..., :: self.oversampling, :] @ self.weights


def spectral_kernel(window: str, segment_s: float, oversampling: int = 4) -> SpectralKernel:
    """Return the SpectralKernel of a window over segments of segment_s seconds.

    With 4 points per bin the discrete convolution is exact up to the correlation of the response at
    lags beyond 3 segments: the kernel's Fourier transform is the window's autocorrelation, which
    ends at one segment, and its images start at 4.

    window: hann, boxcar, or "none" for the identity (spectra known without a window).
    """
    if window == "none":
        return SpectralKernel(1.0 / segment_s, 1, np.ones(1), np.ones(1))
    values = window_values(window, WINDOW_SAMPLES)
    transform = np.abs(np.fft.fft(values, WINDOW_SAMPLES * oversampling)) ** 2
    both_sides = np.concatenate([transform[:1], 2.0 * transform[1 : transform.size // 2]])
    area = np.cumsum(both_sides) / transform.sum()
    needed = int(np.searchsorted(area, 1.0 - SIDE_LOBES))
    half_width = min(oversampling * MAX_HALF_WIDTH, needed)
    weights = np.concatenate([transform[-half_width:], transform[: half_width + 1]])
    spread = np.abs(np.fft.fft(values**2)[:8]) ** 2
    spread = spread[: 1 + int(np.flatnonzero(spread > 1.0e-6 * spread[0])[-1])]
    return SpectralKernel(
        1.0 / segment_s, oversampling, weights / weights.sum(), spread / spread[0]
    )


def correlated_sum(weighted: np.ndarray, kernel: SpectralKernel) -> np.ndarray:
    """Return (parameter, parameter): sum over bins f, f' of w_f rho(f - f') w_f'^T.

    Times 2/averages it is the covariance of sum_f w_f (estimate/expectation - 1), in which
    neighbouring bins share the window.

    weighted: w, (parameter, bin).
    """
    total = np.zeros((len(weighted), len(weighted)))
    for distance, share in enumerate(kernel.bin_correlation[: weighted.shape[1]]):
        product = weighted[:, distance:] @ weighted[:, : weighted.shape[1] - distance].T
        total += share * (product if distance == 0 else product + product.T)
    return total


def window_autocorrelation(window: str, length: int, lags: int) -> np.ndarray:
    """Return (lags,) the autocorrelation of a window at lags 0 .. lags-1, relative to lag 0.

    The inverse transform of an averaged PSD is the true correlation times this, so that division by
    it removes the window exactly.

    length: samples of the window.
    """
    if window == "none":
        return np.ones(lags)
    transform = np.fft.rfft(window_values(window, length), 2 * length)
    correlation = np.fft.irfft(transform.real**2 + transform.imag**2)[:lags]
    return correlation / correlation[0]
