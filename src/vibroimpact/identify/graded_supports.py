"""The quality of the stiffnesses and dampings that a method gives for several supports.

A stiffness must differ from zero by the model's and chance's errors, as that of one support must:
see estimate. The response depends on k through k/(1 + k G), with G the compliance of the structure
at the support. So its sensitivity to k is (1 + k G)² times smaller than at k = 0, and the error of
k as much larger.
"""

from dataclasses import dataclass, replace

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
    mark_weak,
)
from .information import what_is_known
from .support_fit import SupportSearch

# c is resolved when its standard error is below one of these: of its own size, and as a loss factor
# omega c / k at the main peak.
C_ERROR, LOSS_ERROR = 0.5, 0.15


@dataclass(frozen=True)
class MethodResult:
    """The supports that a method found.

    k, c: (direction,) N/m and N s/m; c is NaN if the method does not give it.
    covariance: (2 direction, 2 direction) of (ln k, c).
    by_frequency: (2 direction,) change of (ln k, c) per relative error of the model's frequencies;
        None if the covariance holds the model's error.
    frequency, damping_ratio: of the pole, Hz and fraction; NaN for none.
    """

    method: str
    k: np.ndarray
    c: np.ndarray
    covariance: np.ndarray
    by_frequency: np.ndarray | None
    frequency: float = np.nan
    damping_ratio: float = np.nan


def graded_supports(
    found: MethodResult, structure: SupportedStructure, search: SupportSearch
) -> list[Estimate]:
    """Return the Estimate of each direction; k and c are NaN if they are not resolved."""
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
        k, error = found.k[index], float(np.sqrt(total[index, index]))
        estimate = Estimate(
            method=found.method,
            k=float(k),
            k_standard_error=float(k * np.sqrt(found.covariance[index, index])),
            frequency=found.frequency,
            damping_ratio=found.damping_ratio,
        ).at(direction)
        chance = float(np.sqrt(found.covariance[index, index]))
        floor = MODEL_SIGMAS * np.sqrt(max(error**2 - chance**2, 0.0)) + CHANCE_SIGMAS * chance
        reason = _why_unresolved(k, error, search)
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
            estimate = replace(
                estimate,
                k=np.nan,
                k_standard_error=np.nan,
                quality="unresolved",
                note=reason,
                k_bound=bound,
            )
            estimates.append(estimate)
            continue
        if error > WEAK_ABOVE:
            estimate = mark_weak(estimate, f"standard error {error:.0%} of k")
        c_error = float(np.sqrt(total[count + index, count + index]))
        estimates.append(_with_damping(estimate, found.c[index], c_error, search))
    return estimates


def _why_unresolved(k: float, error: float, search: SupportSearch) -> str:
    """Return why no method could find this k, or an empty text."""
    if not np.isfinite(k) or not np.isfinite(error):
        return "no finite support has this response"
    return edge_of_range(k, search.stiffness_range)


def _with_damping(estimate: Estimate, c: float, error: float, search: SupportSearch) -> Estimate:
    """Return the estimate with c if it is resolved, or with the reason."""
    if not np.isfinite(c):
        return estimate
    if error > C_ERROR * abs(c) and error * search.omega > LOSS_ERROR * estimate.k:
        note = f"c = {c:.3g} +- {error:.2g} N s/m not resolved"
        return replace(estimate, note="; ".join(part for part in (estimate.note, note) if part))
    return replace(estimate, c=float(c), c_standard_error=error)
