"""The quality of the stiffnesses and dampings that a method gives for several supports.

A stiffness must differ from zero by the model's and chance's errors, as that of one support must:
see estimate. The response depends on k through k/(1 + k G), with G the compliance of the structure
at the support. So its sensitivity to k is (1 + k G)² times smaller than at k = 0, and the error of
k as much larger.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vibroimpact.identify.linear.supported_structure import SupportedStructure

from .estimate import (
    BOUND_SIGMAS,
    CHANCE_SIGMAS,
    FREQUENCY_ERROR,
    MODEL_SIGMAS,
    UNRESOLVED_ABOVE,
    WEAK_ABOVE,
    Estimate,
    edge_of_range,
    joined,
    mark_weak,
    unresolved,
)
from .support_fit import FoundSupports, SupportSearch

# c is resolved when its standard error is below one of these: of its own size, and as a loss factor
# omega c / k at the main peak.
C_ERROR, LOSS_ERROR = 0.5, 0.15

KNOWN = 0.25  # largest standard deviation of ln of a combination that counts as known
LEAST_POWER = 0.3  # smallest power that a stiffness must have to be part of a combination
SHOWN_POWER = 0.15


def graded_supports(
    method: str,
    found: FoundSupports,
    structure: SupportedStructure,
    search: SupportSearch,
    frequency: float = np.nan,
    damping_ratio: float = np.nan,
) -> list[Estimate]:
    """Return the Estimate of each direction; k and c are NaN if they are not resolved.

    frequency, damping_ratio: of the pole behind them, Hz and fraction; NaN for none.
    """
    directions = structure.directions
    count = len(directions)
    total = found.covariance
    if found.by_frequency is not None:
        shift = FREQUENCY_ERROR * found.by_frequency
        total = total + np.outer(shift, shift)
    saturation = (1.0 + found.k * structure.own_compliance(found.k)) ** 2
    names = [direction.name for direction in directions]
    estimates = []
    for index, direction in enumerate(directions):
        k, error = float(found.k[index]), float(np.sqrt(total[index, index]))
        chance = float(np.sqrt(found.covariance[index, index]))
        floor = MODEL_SIGMAS * np.sqrt(max(error**2 - chance**2, 0.0)) + CHANCE_SIGMAS * chance
        reason = "no finite support has this response"
        if np.isfinite(k) and np.isfinite(error):
            reason = edge_of_range(k, search.stiffness_range)
        bound = np.nan
        if not reason and floor > saturation[index]:
            margin = floor - (CHANCE_SIGMAS - BOUND_SIGMAS) * chance
            bound = float(k * (1.0 + margin / saturation[index]))
            least = k * floor / saturation[index]
            reason = f"k = {k:.3g} N/m does not differ from 0 (least {least:.3g})"
        if not reason and error > UNRESOLVED_ABOVE:
            reason = f"standard error {min(error, 99.0):.0%} of k: " + what_is_known(
                names, total[:count, :count], index
            )
        if reason:
            estimate = unresolved(method, reason, frequency, damping_ratio)
            estimates.append(replace(estimate, k_bound=bound).at(direction))
            continue
        pole = frequency, damping_ratio
        estimate = Estimate(method, k, k * chance, np.nan, np.nan, *pole).at(direction)
        if error > WEAK_ABOVE:
            estimate = mark_weak(estimate, f"standard error {error:.0%} of k")
        c_error = float(np.sqrt(total[count + index, count + index]))
        estimates.append(_with_damping(estimate, float(found.c[index]), c_error, search))
    return estimates


def _with_damping(estimate: Estimate, c: float, error: float, search: SupportSearch) -> Estimate:
    """Return the estimate with c if it is resolved, or with the reason."""
    if not np.isfinite(c):
        return estimate
    if error > C_ERROR * abs(c) and error * search.omega > LOSS_ERROR * estimate.k:
        note = f"c = {c:.3g} +- {error:.2g} N s/m not resolved"
        return replace(estimate, note=joined(estimate.note, note))
    return replace(estimate, c=c, c_standard_error=error)


def what_is_known(names: Sequence[str], covariance: np.ndarray, index: int) -> str:
    """Return a sentence on a stiffness that is not known alone, but perhaps in combination.

    A combination of stiffnesses, a product of powers, is an eigenvector of the covariance of ln k.
    Its variance is the eigenvalue.

    names: (direction,) of the stiffnesses.
    covariance: (direction, direction) of ln k.
    index: of the stiffness.
    """
    variances, vectors = np.linalg.eigh(covariance)
    variances = np.maximum(variances, 0.0)  # a round-off below 0
    for variance, vector in zip(variances, vectors.T, strict=True):
        partners = np.flatnonzero(np.abs(vector) > SHOWN_POWER).tolist()
        if np.sqrt(variance) < KNOWN and abs(vector[index]) > LEAST_POWER and len(partners) > 1:
            vector = vector * np.sign(vector[index])
            product = " ".join(f"k({names[i]})^{vector[i]:.2f}" for i in partners)
            return f"only the product {product} is known, within {np.sqrt(variance):.0%}"
    scatter = np.sqrt(covariance[index, index])
    size = f"a factor of {np.exp(scatter):.3g}" if scatter < 5.0 else "more than a factor of 100"
    return f"a change of k by {size} is within the scatter of the data"
