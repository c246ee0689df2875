"""Secant stiffness and damping of a support, from the contact forces of a simulated record.

With f the restoring force and u the displacement along a direction, k = E[f u] / E[u²] and c = E[f
v] / E[v²], v the velocity: of all linear supports, the one whose force is nearest to f in the mean
square if u and v are uncorrelated. If a support is not symmetric, about its mean: a preload or a
one-sided stop has no part in the stiffness. c counts the power that leaves the direction: the power
that friction and damping dissipate, and that the contact hands to the other direction.
"""

import numpy as np
import xarray as xr

from vibroimpact.identify.linear.support_groups import SupportDirection
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.structure.contact.laws import ContactLaws

from .estimate import Estimate

# Moments of a record that secant_support reads.
MOMENTS = (
    *("force_displacement", "displacement_square", "displacement_product", "velocity_square"),
    *("velocity_product", "displacement_mean", "force_mean", "contact_power"),
)
SMALL_OFFSET = 1.0e-3  # of the gap: an imperfection, not an asymmetry


def secant_support(record: xr.Dataset, model: ModalModel, direction: SupportDirection) -> Estimate:
    """Return the Estimate of a record, summed over the points of the group's supports.

    Its standard errors are the scatter over the supports, NaN for a single one.

    record: with MOMENTS, each over contact points, and directions or not; gap_m as attribute.
    """
    moments = {name: record[name].values[direction.rows] for name in MOMENTS}
    along = direction.along
    work = _projected_force(moments["force_displacement"], along)
    square = _projected_square(
        moments["displacement_square"], moments["displacement_product"], along
    )
    speed = _projected_square(moments["velocity_square"], moments["velocity_product"], along)
    power = _projected_force(moments["contact_power"], along)
    if not symmetric(model, float(record.attrs["gap_m"])):
        mean = np.sum(moments["displacement_mean"] * along, axis=1)
        force = np.sum(moments["force_mean"] * along, axis=1)
        work, square = work - force * mean, square - mean**2
    support = model.support_of_point[direction.rows]
    weight = model.contact_weight[direction.rows]
    return Estimate(
        "secant",
        *_ratio(work, square, weight, support),
        *_ratio(power, speed, weight, support),
        note="standard error from the scatter over supports",
    ).at(direction)


def symmetric(model: ModalModel, gap_m: float) -> bool:
    """Return True when motion and mirrored motion meet the same supports: the mean is 0 then."""
    laws: ContactLaws = model.contact_laws
    offset = np.abs(model.centre_offset).max(initial=0.0) > SMALL_OFFSET * gap_m
    if offset or np.any(model.constant_force) or np.any(laws.lobes % 2 == 1):
        return False
    for point in np.unique(laws.land_point):
        own = laws.land_point == point
        normals, extra = laws.land_normal[own], laws.land_extra_gap[own]
        opposite = np.all(np.isclose(normals[:, None], -normals[None]), axis=-1)
        facing = (opposite & np.isclose(extra[:, None], extra)).any(axis=1)
        if not facing.all():
            return False
    return True


def _projected_force(moment: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return (point,) the moment of the force along a direction with the motion along it.

    The force of an oblique direction is along it alone, so that both parts belong to it.
    """
    oblique = np.all(np.abs(along) > 0.0, axis=1)
    return np.where(oblique, moment.sum(axis=1), np.sum(moment * along**2, axis=1))


def _projected_square(square: np.ndarray, product: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return (point,) the mean square along a direction."""
    return np.sum(square * along**2, axis=1) + 2.0 * product * along[:, 0] * along[:, 1]


def _ratio(
    moment: np.ndarray, square: np.ndarray, weight: np.ndarray, support: np.ndarray
) -> tuple[float, float]:
    """Return (moment per square over all supports, standard error from their scatter)."""
    moments = np.bincount(support, moment)
    squares = np.bincount(support, weight * square)
    there = np.unique(support)
    if not np.all(squares[there] > 0.0):
        return np.nan, np.nan
    each = moments[there] / squares[there]
    error = np.std(each, ddof=1) / np.sqrt(each.size) if each.size > 1 else np.nan
    return float(moments.sum() / squares.sum()), float(error)
