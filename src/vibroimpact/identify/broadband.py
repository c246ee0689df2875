"""Broadband identification: the (k, c) whose linear PSD correlates best with the measured one.

The PSDs are those of one response point over a band. The correlation coefficient
|a.b| / (|a| |b|) of two spectra does not depend on their level, so the load need not be known
(Thénint et al. 2012, section 4.3). Departure from the paper: a and b are amplitude spectral
densities, PSD**EXPONENT, not PSDs. With PSDs the few highest bins decide alone, and the scatter of
c from record to record is twice as large (40 against 20 % on the linear tube).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from vibroimpact.identify.linear.family import FamilyResponse
from vibroimpact.identify.spectra.window_leakage import SpectralKernel, correlated_sum

from .segment_scatter import widened

EXPONENT = 0.5
UNKNOWN = "unknown"  # the attribute `force` of spectra whose force is not known
NEEDS_FORCE = "the force is not known, and spectra over a band depend on it"
STEPS = 40  # at most, of the search


# Spectra of the family on a coarse grid, for the global search: k (k,) in N/m, c (k, damping) in
# N s/m, and amplitude spectral densities (k, damping, bin) of unit length.
FamilyMap = tuple[np.ndarray, np.ndarray, np.ndarray]


@dataclass(frozen=True)
class BroadbandFit:
    """The member of the family with the largest correlation.

    k, c: N/m and N s/m.
    correlation: its correlation coefficient.
    covariance: (2, 2) of (k, c).
    curve: (bin,) fitted PSD in the unit of the measured one.
    correlation_map: (k, damping), correlations on the FamilyMap.
    c_at_edge: whether the search ended at the least c that leaves every member stable.
    """

    k: float
    c: float
    correlation: float
    covariance: np.ndarray
    curve: np.ndarray
    correlation_map: np.ndarray
    c_at_edge: bool = False


def family_map(
    response: FamilyResponse, kernel: SpectralKernel, k: np.ndarray, c: np.ndarray
) -> FamilyMap:
    """Return the FamilyMap of k (k,) in N/m and c (k, damping) in N s/m.

    response: FamilyResponse of one output, on the kernel's fine grid of the band.
    """
    vectors = np.array(
        [
            [kernel.smooth(response.psd(stiffness, damping)[0]) ** EXPONENT for damping in row]
            for stiffness, row in zip(k, c, strict=True)
        ]
    )
    return k, c, vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def identify_broadband(
    psd: np.ndarray,
    response: FamilyResponse,
    kernel: SpectralKernel,
    family: FamilyMap,
    lowest_stable_damping: Callable[[float], float],
    averages: float = np.inf,
    segments: np.ndarray | None = None,
) -> BroadbandFit | None:
    """Return the BroadbandFit of a PSD (bin,), or None when the search leaves any sensible range.

    The largest correlation is the least-squares fit of the vector with a free amplitude. It is
    found by damped Gauss-Newton steps in (ln k, c) from the best member of the map.

    response: FamilyResponse of the point, on the kernel's fine grid of the band's bins.
    family: its FamilyMap.
    lowest_stable_damping: function of k that gives the c (N s/m) below which a member is unstable;
        the spectrum of an unstable member would look damped.
    averages: effective degrees of freedom of a bin.
    segments: (segment, bin) PSDs of the segments, which may widen the standard error.
    """
    target = psd**EXPONENT
    target = target / np.linalg.norm(target)
    all_k, all_c, vectors = family
    correlations = vectors @ target
    row, column = np.unravel_index(np.argmax(correlations), correlations.shape)
    linearise = partial(_linearise, target, response, kernel)
    found = _maximise_correlation(linearise, all_k[row], all_c[row, column], lowest_stable_damping)
    if found is None:
        return None
    k, c, (residual, jacobian, member, amplitude) = found
    curve = (amplitude * np.linalg.norm(psd**EXPONENT)) ** (1.0 / EXPONENT) * member
    inverse = np.linalg.inv(jacobian @ jacobian.T)
    weighted = jacobian * (EXPONENT * amplitude * member**EXPONENT)
    covariance = inverse @ correlated_sum(weighted, kernel) @ inverse * (2.0 / averages)
    if segments is not None:
        changes = ((segments - psd) / curve) @ weighted.T @ inverse
        covariance = widened(covariance, changes, averages)
    scale = np.array([k, 1.0])
    correlation = float(np.sqrt(max(0.0, 1.0 - residual @ residual)))
    return BroadbandFit(
        k=float(k),
        c=float(c),
        correlation=correlation,
        covariance=covariance * np.outer(scale, scale),
        curve=curve,
        correlation_map=correlations,
        c_at_edge=bool(c <= lowest_stable_damping(k)),
    )


def _maximise_correlation(
    linearise: Callable, k: float, c: float, lowest_stable_damping: Callable[[float], float]
) -> tuple | None:
    """Return (k, c, linearisation) of the largest correlation near a start, or None.

    None means that k leaves any sensible range.
    """
    state, damping = linearise(k, c), 1.0e-3
    for _ in range(STEPS):
        residual, jacobian = state[:2]
        normal = jacobian @ jacobian.T
        change = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), jacobian @ residual)
        change *= min(1.0, 0.7 / max(abs(change[0]), 1.0e-12))
        next_k = k * np.exp(change[0])
        next_c = max(c + change[1], lowest_stable_damping(next_k))
        if not 1.0e-3 < next_k < 1.0e12:
            return None
        trial = linearise(next_k, next_c)
        if trial[0] @ trial[0] <= residual @ residual:
            settled = abs(change[0]) < 1.0e-6 and abs(next_c - c) < 1.0e-5 * (abs(c) + 1.0)
            k, c, state, damping = next_k, next_c, trial, 0.2 * damping
            if settled:
                break
        else:
            damping *= 10.0
            if damping > 1.0e8:
                break
    return k, c, state


def _linearise(
    target: np.ndarray, response: FamilyResponse, kernel: SpectralKernel, k: float, c: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return (residual (bin,), jacobian (2, bin), PSD of the member (bin,), amplitude).

    The jacobian is by (ln k, c), with the amplitude projected out. residual @ residual is one minus
    the squared correlation.
    """
    value, slope = (part[:, 0] for part in response.frf_slope(k, c))
    product = (2.0 * value.conj() * slope).sum(axis=0)
    omega = 2.0 * np.pi * response.frequency
    power = (value.real**2 + value.imag**2).sum(axis=0)
    curves = np.array([power, product.real, -product.imag * omega])
    psd, by_k, by_c = kernel.smooth(curves)
    vector = psd**EXPONENT
    amplitude = vector @ target / (vector @ vector)
    jacobian = amplitude * EXPONENT * vector / psd * np.array([k * by_k, by_c])
    jacobian -= np.outer(jacobian @ vector, vector) / (vector @ vector)
    return target - amplitude * vector, jacobian, psd, amplitude
