"""Broadband identification of several supports: the (k, c) of each whose PSDs fit best.

As in `broadband`, amplitude spectral densities are compared and their common level is free. With
several unknowns one response point is not enough: all sensors along the driven directions take
part, each scaled to unit length, so that a quiet sensor near a support counts like a loud one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.identify.linear.supported_structure import Observed, SupportedStructure
from vibroimpact.identify.spectra.window_leakage import SpectralKernel, correlated_sum

from .broadband import EXPONENT
from .segment_scatter import widened
from .support_fit import (
    FoundSupports,
    LowestDamping,
    Start,
    SupportSearch,
    SupportValues,
    inverse_information,
)


@dataclass(frozen=True)
class SpectraFit:
    """The supports whose spectra fit best.

    values: SupportValues.
    found: FoundSupports.
    correlation: smallest correlation coefficient over sensors.
    curve: (sensor, bin) fitted PSDs in the unit of the measured ones.
    """

    values: SupportValues
    found: FoundSupports
    correlation: float
    curve: np.ndarray


class SpectraComparison:
    """Compares measured PSDs with those of the structure on any supports."""

    def __init__(
        self,
        structure: SupportedStructure,
        observed: Observed,
        kernel: SpectralKernel,
        segments: np.ndarray,
    ) -> None:
        """Take the segments' PSDs (segment, sensor, bin) in m²/Hz.

        observed: of the sensors, on the kernel's fine grid of the band's bins.
        """
        self.structure, self.observed, self.kernel = structure, observed, kernel
        self.segments, self.psd = segments, segments.mean(axis=0)
        amplitude = self.psd**EXPONENT
        self.length = np.linalg.norm(amplitude, axis=1, keepdims=True)
        self.target = amplitude / self.length
        self.frequency = structure.frequency[observed.part]

    def spectra(self, k: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (PSDs (sensor, bin), derivatives (2 direction, sensor, bin) by ln k and c)."""
        response, slope = self.structure.frf_slope(self.observed, k, c)
        product = 2.0 * np.sum(response.conj() * slope, axis=-1)  # over channels
        omega = 2.0 * np.pi * self.frequency[:, None]
        by_k = product.real * k[:, None, None]
        by_c = -product.imag * omega
        power = np.sum(response.real**2 + response.imag**2, axis=-1)
        fine = np.concatenate([power[None], by_k, by_c]).swapaxes(1, 2)
        smooth = self.kernel.smooth(fine)
        return smooth[0], smooth[1:]

    def residual(self, k: np.ndarray, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (residual (sensor bin,), its jacobian (sensor bin, 2 direction))."""
        psd, slope = self.spectra(k, c)
        vector, by = self._vectors(psd, slope)
        amplitude = np.sum(vector * self.target) / np.sum(vector**2)
        inner = np.tensordot(by, vector, axes=2)[:, None, None] * vector / np.sum(vector**2)
        jacobian = -amplitude * (by - inner)
        residual = self.target - amplitude * vector
        return residual.ravel(), jacobian.reshape(len(by), -1).T

    def _vectors(self, psd: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the scaled amplitude spectra (sensor, bin) and their derivatives."""
        vector = psd**EXPONENT
        return vector / self.length, EXPONENT * vector / psd * slope / self.length

    def coarse_cost(self, observed: Observed, k: np.ndarray, c: np.ndarray) -> float:
        """Return the squared residual of k (direction,) in N/m and c (direction,) in N s/m.

        observed: of the sensors on the bins of the spectra themselves.
        """
        response = self.structure.frf(observed, k, c)
        psd = np.sum(response.real**2 + response.imag**2, axis=-1).T
        vector = psd**EXPONENT / self.length
        amplitude = np.sum(vector * self.target) / np.sum(vector**2)
        return float(np.sum((self.target - amplitude * vector) ** 2))

    def fit(
        self,
        search: SupportSearch,
        starts: Sequence[Start],
        lowest_c: LowestDamping,
        averages: float,
    ) -> SpectraFit:
        """Return the SpectraFit from some starts; arguments as in SupportSearch.minimise.

        averages: effective degrees of freedom of a bin.
        """
        values = search.best_of(self.residual, starts, lowest_c)
        psd, slope = self.spectra(values.k, values.c)
        vector, _ = self._vectors(psd, slope)
        amplitude = np.sum(vector * self.target) / np.sum(vector**2)
        curve = amplitude ** (1.0 / EXPONENT) * psd
        inverse = inverse_information(values.jacobian)
        # One force moves all sensors: their spectra are high and low together.
        weighted = -values.jacobian.T * (EXPONENT * amplitude * vector).ravel()
        by_bin = weighted.reshape(len(weighted), *psd.shape).sum(axis=1)
        covariance = inverse @ correlated_sum(by_bin, self.kernel) @ inverse * (2.0 / averages)
        relative = (self.segments - self.psd) / curve
        changes = relative.reshape(len(relative), -1) @ weighted.T @ inverse
        covariance = _widened(covariance, changes, averages)
        bins = self.frequency[self.kernel.half_width :: self.kernel.oversampling][: psd.shape[1]]
        stretch = np.gradient(np.log(psd), np.log(bins), axis=1)
        model_change = inverse @ weighted @ stretch.ravel()
        lengths = np.linalg.norm(vector, axis=1)
        correlation = float(np.min(np.sum(vector * self.target, axis=1) / lengths))
        found = FoundSupports(values.k, values.c, covariance, model_change)
        return SpectraFit(values, found, correlation, curve)


def _widened(covariance: np.ndarray, changes: np.ndarray, averages: float) -> np.ndarray:
    """Return the covariance, widened per value if the segments scatter more than it says."""
    result = covariance.copy()
    for index in range(len(covariance)):
        own = covariance[index : index + 1, index : index + 1]
        if own[0, 0] > 0.0:
            factor = np.sqrt(
                widened(own, changes[:, index : index + 1], averages)[0, 0] / own[0, 0]
            )
            result[index] *= factor
            result[:, index] *= factor
    return result
