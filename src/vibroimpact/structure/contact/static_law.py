"""The static force of a support's hole on the tube, as the figures draw it."""

from __future__ import annotations

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

from .outline import radial_gap
from .profiles import land_extra_gaps


def support_gap(support: ConfigPart, gap_m: float) -> float:
    """Return the gap in m of a support: its own, or that of the case times its factor.

    Contact points with factors of their own count with their mean.
    """
    if support.gap_m is not None:
        return float(support.gap_m)
    return float(gap_m * np.mean(support.gap_factor))


def static_force(
    support: ConfigPart, gap_m: float, angle: float, displacement: np.ndarray
) -> np.ndarray:
    """Return (displacement,) N: the component along a direction of the force on the support.

    support: of the configuration; its stiffness, or Hertz law, in all.
    gap_m: of the support, m.
    angle: of the direction in rad, a stop's normal or a land's direction, so that the force of a
        curved hole is along it.
    displacement (displacement,): of the tube along the direction, m; negative on the other side.

    Source: the laws of config.supports: k p or H p^1.5, with p the penetration; the forces of flat
    stops add up.
    """
    moved = np.asarray(displacement, dtype=float)
    if support.profile.kind == "planes":
        along = np.cos(np.deg2rad(np.asarray(support.profile.normals_deg, dtype=float)) - angle)
        gaps = gap_m + land_extra_gaps(support.profile, len(along))
        penetration = np.maximum(moved[:, None] * along - gaps, 0.0)
        return (_elastic(support, penetration) * along).sum(axis=1)
    ahead, behind = radial_gap(support.profile, gap_m, np.array([angle, angle + np.pi]))
    depth = np.abs(moved) - np.where(moved >= 0.0, ahead, behind)
    return np.sign(moved) * _elastic(support, np.maximum(depth, 0.0))


def _elastic(support: ConfigPart, penetration: np.ndarray) -> np.ndarray:
    """Return the elastic force in N of a penetration in m."""
    if support.hertz_N_per_m15 != 0.0:
        return support.hertz_N_per_m15 * penetration**1.5
    return float(np.sum(support.stiffness_N_per_m)) * penetration
