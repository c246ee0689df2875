"""The free space of the tube's centre in the hole of a support, the outline of the hole, and its
static force on the tube, as the figures draw them.

The two axes are the support's transverse directions. A profile is circular, planes or lobes; those
with other names are resolved by `profiles.plain_profile`.
"""

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

from .profiles import land_extra_gaps

POINTS = 361  # of a curved outline: one per degree, ends included
OPEN = 3.0  # reach if stops leave a side open, as a multiple of the farthest stop


def radial_gap(profile: ConfigPart, gap_m: float, angle: np.ndarray) -> np.ndarray:
    """Return (angle,) m: the travel of the tube from the obstacle's centre until it touches.

    profile: of a support.
    gap_m: its gap, m; between flat stops it may be 0 or negative.
    angle (angle,): direction of motion in rad from the first transverse direction to the second.

    It is inf if no stop lies ahead. Source: the laws of config.supports, Circular, Planes and
    Lobes.
    """
    turn = np.asarray(angle, dtype=float)
    if profile.kind == "planes":
        normals = np.deg2rad(np.asarray(profile.normals_deg, dtype=float))
        ahead = np.cos(turn[..., None] - normals)
        facing = ahead > 1e-12
        distance = gap_m + land_extra_gaps(profile, len(normals))
        reach = np.divide(distance, ahead, out=np.full(ahead.shape, np.inf), where=facing)
        return reach.min(axis=-1)
    if profile.kind == "lobes":
        wave = 1.0 - np.cos(profile.count * (turn - np.deg2rad(profile.angle_deg)))
        return gap_m + 0.5 * profile.depth_m * wave
    return np.full(turn.shape, float(gap_m))


def hole_outline(
    profile: ConfigPart,
    gap_m: float,
    radius_m: float,
    scale: float = 1.0,
    reach_m: float | None = None,
) -> np.ndarray:
    """Return (point, 2) m: the closed outline of the hole that a tube of a radius passes through.

    profile, gap_m: as in radial_gap.
    scale: factor of gap and lobes, to make them visible next to the tube.
    reach_m: if stops leave a side open, the outline ends on a square of this half side; 3 times
        the farthest stop by default.

    It is the free space of the tube's centre, scaled, moved outward by the radius: a flat stop by
    its normal, a curved hole along the direction from its centre. It runs counter-clockwise and
    ends at its start; it has no points if stops leave no space.
    """
    wall = radius_m + scale * gap_m
    if profile.kind == "planes":
        walls = wall + scale * land_extra_gaps(profile, len(profile.normals_deg))
        return _between_stops(profile.normals_deg, walls, reach_m or OPEN * walls.max())
    angle = np.linspace(0.0, 2.0 * np.pi, POINTS)
    radius = radius_m + scale * radial_gap(profile, gap_m, angle)
    outline = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    outline[-1] = outline[0]  # closed to the last bit
    return outline


def facing_angle(profile: ConfigPart) -> float:
    """Return the direction in rad of the first stop or land; 0 for a circular hole."""
    if profile.kind == "planes":
        return float(np.deg2rad(profile.normals_deg[0]))
    return float(np.deg2rad(profile.angle_deg)) if profile.kind == "lobes" else 0.0


def _between_stops(normals_deg: ConfigPart, distances: np.ndarray, reach: float) -> np.ndarray:
    """Return (point, 2): the part of a square of half side `reach` behind every stop.

    A square clipped by one half plane after the other (Sutherland and Hodgman, 1974).
    """
    outline = reach * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for normal, distance in zip(np.deg2rad(normals_deg), distances, strict=True):
        beyond = outline @ [np.cos(normal), np.sin(normal)] - distance
        kept = []
        for here, there, depth, next_depth in zip(
            outline, np.roll(outline, -1, axis=0), beyond, np.roll(beyond, -1), strict=True
        ):
            if depth <= 0.0:
                kept.append(here)
            if (depth <= 0.0) != (next_depth <= 0.0):
                kept.append(here + (there - here) * depth / (depth - next_depth))
        outline = np.array(kept).reshape(-1, 2)
    return np.concatenate([outline, outline[:1]])


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
