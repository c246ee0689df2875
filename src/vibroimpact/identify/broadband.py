"""Broadband identification: the (k, c) whose linear PSD correlates best with the measured one at
one response point over a band.

The correlation coefficient |a.b| / (|a| |b|) of two spectra does not see their level, so the load
need not be known (Thénint et al. 2012, §4.3). Departure from the paper: the vectors hold the
amplitude spectral density, PSD**EXPONENT, not the PSD. With the PSD itself the few highest bins
decide alone and the scatter of c from record to record is twice as large (40 against 20 % on the
linear tube).
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.spectra.window_leakage import correlated_sum

from .segments import widened

EXPONENT = 0.5
STEPS = 40


@dataclass(frozen=True)
class FamilyMap:
    """Spectra of the family on a coarse grid, for the global search: k (k,) N/m; c (k, damping) N
    s/m; vectors (k, damping, bin) of unit length.
    """

    k: np.ndarray
    c: np.ndarray
    vectors: np.ndarray


@dataclass(frozen=True)
class BroadbandFit:
    """k (N/m), c (N s/m) of the best correlation, its value, covariance (2, 2) of (k, c), the
    fitted PSD curve (bin,) in the units of the measured one, and the correlations (k, damping) on
    the FamilyMap.
    """

    k: float
    c: float
    correlation: float
    covariance: np.ndarray
    curve: np.ndarray
    correlation_map: np.ndarray


def family_map(response, kernel, k, c):
    """Return the FamilyMap of k (k,) and c (k, damping) for the one output of a FamilyResponse on
    the kernel's fine grid of the band.
    """
    vectors = np.array(
        [
            [kernel.smooth(response.psd(stiffness, damping)[0]) ** EXPONENT for damping in row]
            for stiffness, row in zip(k, c, strict=True)
        ]
    )
    return FamilyMap(k, c, vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


def identify_broadband(
    psd, response, kernel, family, least_damping, averages=np.inf, segments=None
):
    """Return the BroadbandFit of a PSD (bin,), or None when the search ends nowhere.

    response: FamilyResponse of the point on the kernel's fine grid of the band's bins; family: its
    FamilyMap; least_damping(k) -> c (N s/m) below which a member is unstable (its spectrum would
    look damped); averages: effective degrees of freedom of a bin; segments (segment, bin): PSDs of
    the single segments, from which the standard error may be widened. Maximal correlation is the
    least-squares fit of the vector with a free amplitude: damped Gauss-Newton steps in (ln k, c)
    from the best member of the map.
    """
    target = psd**EXPONENT
    target = target / np.linalg.norm(target)
    correlations = family.vectors @ target
    row, column = np.unravel_index(np.argmax(correlations), correlations.shape)
    found = _climb(target, response, kernel, family.k[row], family.c[row, column], least_damping)
    if found is None:
        return None
    k, c, (residual, jacobian, member, amplitude) = found
    curve = (amplitude * np.linalg.norm(psd**EXPONENT)) ** (1.0 / EXPONENT) * member
    inverse = np.linalg.inv(jacobian @ jacobian.T)
    weighted = jacobian * (EXPONENT * amplitude * member**EXPONENT)
    covariance = inverse @ correlated_sum(weighted, kernel) @ inverse * (2.0 / averages)
    if segments is not None:
        covariance = widened(
            covariance, ((segments - psd) / curve) @ weighted.T @ inverse, averages
        )
    scale = np.array([k, 1.0])
    correlation = float(np.sqrt(max(0.0, 1.0 - residual @ residual)))
    return BroadbandFit(
        float(k), float(c), correlation, covariance * np.outer(scale, scale), curve, correlations
    )


def _climb(target, response, kernel, k, c, least_damping):
    """Return (k, c, linearisation there) of the largest correlation near a start, or None when k
    leaves any sensible range.
    """
    state, damping = _linearise(target, response, kernel, k, c), 1.0e-3
    for _ in range(STEPS):
        residual, jacobian = state[:2]
        normal = jacobian @ jacobian.T
        change = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), jacobian @ residual)
        change *= min(1.0, 0.7 / max(abs(change[0]), 1.0e-12))
        next_k = k * np.exp(change[0])
        next_c = max(c + change[1], least_damping(next_k))
        if not 1.0e-3 < next_k < 1.0e12:
            return None
        ahead = _linearise(target, response, kernel, next_k, next_c)
        if ahead[0] @ ahead[0] <= residual @ residual:
            settled = abs(change[0]) < 1.0e-6 and abs(next_c - c) < 1.0e-5 * (abs(c) + 1.0)
            k, c, state, damping = next_k, next_c, ahead, 0.2 * damping
            if settled:
                break
        else:
            damping *= 10.0
            if damping > 1.0e8:
                break
    return k, c, state


def _linearise(target, response, kernel, k, c):
    """Return (residual (bin,), jacobian (2, bin) to (ln k, c) with the amplitude projected out,
    member's PSD (bin,), amplitude).

    residual @ residual is one minus the squared correlation.
    """
    value, slope = (part[0] for part in response.frf_slope(k, c))
    product = 2.0 * value.conj() * slope
    curves = np.array(
        [
            value.real**2 + value.imag**2,
            product.real,
            -product.imag * (2.0 * np.pi * response.frequency),
        ]
    )
    psd, by_k, by_c = kernel.smooth(curves)
    vector = psd**EXPONENT
    amplitude = vector @ target / (vector @ vector)
    jacobian = amplitude * EXPONENT * vector / psd * np.array([k * by_k, by_c])
    jacobian -= np.outer(jacobian @ vector, vector) / (vector @ vector)
    return target - amplitude * vector, jacobian, psd, amplitude
