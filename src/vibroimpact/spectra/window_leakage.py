"""What the analysis window does to a PSD: the expected averaged spectrum is the true one convolved
with the window's |W|².

A 10 s Hann window widens the half-power width of the first peak by about 8 %. The cure here is to
pass every MODEL spectrum through the same kernel before it is compared with an estimate, so that
nothing is divided out of noisy data.
"""

from dataclasses import dataclass

import numpy as np

from .welch import window_values

SIDE_LOBES = 1.0e-5  # part of the kernel's area that may be cut off
LONGEST_REACH = 40  # bins
WINDOW_SAMPLES = 1024  # the kernel near zero frequency does not depend on them


@dataclass(frozen=True)
class SpectralKernel:
    """Weights of the window's power kernel on a grid finer than the bins.

    spacing_Hz: distance of two bins; oversampling: fine points per bin; weights: (tap,) summing to
    1, odd length, centred; bin_correlation: (distance,) squared correlation of the segment spectra
    0, 1, ... bins apart for a flat PSD.
    """

    spacing_Hz: float
    oversampling: int
    weights: np.ndarray
    bin_correlation: np.ndarray

    @property
    def reach(self):
        """Return the number of fine points on each side of the kernel's centre."""
        return self.weights.size // 2

    def fine_index(self, frequency):
        """Return (fine,) indices into a grid from 0 Hz in steps of spacing/oversampling, on which a
        model PSD must be given.

        frequency: (frequency,) Hz, contiguous bins. Below 0 Hz a PSD is its own mirror image.
        """
        first = int(round(frequency[0] / self.spacing_Hz)) * self.oversampling
        return np.abs(
            np.arange(
                first - self.reach,
                first + (frequency.size - 1) * self.oversampling + self.reach + 1,
            )
        )

    def smooth(self, fine_psd):
        """Return the expected averaged PSD (..., frequency) from the true PSD (..., fine) on
        `fine_index`.
        """
        if self.weights.size == 1:
            return fine_psd[..., :: self.oversampling]
        windows = np.lib.stride_tricks.sliding_window_view(fine_psd, self.weights.size, axis=-1)
        return windows[..., :: self.oversampling, :] @ self.weights


def spectral_kernel(window, segment_s, oversampling=4):
    """Return the SpectralKernel of a named window over segment_s seconds; window "none" gives the
    identity (spectra known without one).

    With 4 points per bin the discrete convolution is exact up to the correlation of the response at
    lags beyond 3 segments: the kernel's Fourier transform is the window's autocorrelation, which
    ends at one segment, and its images start at 4.
    """
    if window == "none":
        return SpectralKernel(1.0 / segment_s, 1, np.ones(1), np.ones(1))
    values = window_values(window, WINDOW_SAMPLES)
    transform = np.abs(np.fft.fft(values, WINDOW_SAMPLES * oversampling)) ** 2
    inside = (
        np.cumsum(np.concatenate([transform[:1], 2.0 * transform[1 : transform.size // 2]]))
        / transform.sum()
    )
    reach = min(oversampling * LONGEST_REACH, int(np.searchsorted(inside, 1.0 - SIDE_LOBES)))
    weights = np.concatenate([transform[-reach:], transform[: reach + 1]])
    spread = np.abs(np.fft.fft(values**2)[:8]) ** 2
    spread = spread[: 1 + int(np.flatnonzero(spread > 1.0e-6 * spread[0])[-1])]
    return SpectralKernel(
        1.0 / segment_s, oversampling, weights / weights.sum(), spread / spread[0]
    )


def correlated_sum(weighted, kernel):
    """Return sum over bins f, f' of weighted_f rho(f - f') weighted_f'^T (parameter, parameter) for
    weighted (parameter, bin).

    Times 2/averages it is the covariance of sum_f weighted_f (estimate/expectation - 1):
    neighbouring bins share the window.
    """
    total = np.zeros((len(weighted), len(weighted)))
    for distance, share in enumerate(kernel.bin_correlation[: weighted.shape[1]]):
        product = weighted[:, distance:] @ weighted[:, : weighted.shape[1] - distance].T
        total += share * (product if distance == 0 else product + product.T)
    return total


def window_autocorrelation(window, length, lags):
    """Return (lags,) the autocorrelation of the window of `length` samples at lags 0 .. lags-1,
    divided by its value at 0.

    The inverse transform of an averaged PSD is the true correlation times this: dividing by it
    undoes the window exactly.
    """
    if window == "none":
        return np.ones(lags)
    transform = np.fft.rfft(window_values(window, length), 2 * length)
    correlation = np.fft.irfft(transform.real**2 + transform.imag**2)[:lags]
    return correlation / correlation[0]
