"""The places of the lands of a support's profile, across the tube at a contact point.

A profile of any kind resolves to flat lands, each with its normal, or to a circle with lobes.

Angles count from the first transverse direction towards the second. With base the angle that
angle_deg or normal gives, the normals of the flat lands are at

    planes    the angles given
    broached  base + 360 k / lands
    bars      base, and base + 180 for both sides
    lattice   base, base + 90, base + 180, base + 270; with spacing_m the first pair of bars has
              base and base + 180, the second the other two
"""

from types import SimpleNamespace
from typing import Any

import numpy as np

from vibroimpact.config.profiles import Circular, Lobes, Planes, has_flat_lands
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.directions import unit_vector

ROUNDED = 15  # decimals of a normal: exact zeros across a plane keep the planes of motion uncoupled


def land_normals(profile: ConfigPart, directions: np.ndarray, pair: int = 0) -> np.ndarray:
    """Return (land, 2) unit vectors: normals of the flat lands along the transverse directions.

    They point away from the obstacle's centre. Empty for a round profile.

    profile: section of the configuration.
    directions: (2, 3) the transverse directions at the contact point.
    pair: 1 at the second pair of bars of a lattice with spacing_m, else 0.
    """
    if not has_flat_lands(profile):
        return np.zeros((0, 2))
    angles = np.deg2rad(_land_angles(profile, pair))
    if profile.kind != "planes":
        angles += _base_angle(profile, directions)
    return np.round(np.column_stack([np.cos(angles), np.sin(angles)]), ROUNDED)


def land_extra_gaps(profile: ConfigPart, lands: int) -> np.ndarray:
    """Return (land,) m: distances of the flat lands of a profile beyond the gap."""
    return np.array(getattr(profile, "extra_gap_m", ()) or np.zeros(lands), float)


def lobes(profile: ConfigPart, directions: np.ndarray) -> tuple[int, float, float]:
    """Return (number, depth in m, angle of the first land in rad) of lobes; zeros without.

    profile, directions: as in land_normals.
    """
    if profile.kind == "lobes":
        return profile.count, profile.depth_m, profile.angle_deg * (np.pi / 180.0)
    if profile.kind == "broached" and profile.depth_m is not None:
        return profile.lands, profile.depth_m, _base_angle(profile, directions)
    return 0, 0.0, 0.0


def plain_profile(profile: ConfigPart, directions: np.ndarray, pair: int = 0) -> ConfigPart:
    """Return the planes, lobes or circle that a profile of any name stands for.

    profile, directions, pair: as in land_normals.
    """
    normals = land_normals(profile, directions, pair)
    if len(normals):
        angles = np.degrees(np.arctan2(normals[:, 1], normals[:, 0]))
        extra = getattr(profile, "extra_gap_m", ())
        return Planes(kind="planes", normals_deg=tuple(angles.tolist()), extra_gap_m=extra)
    count, depth, angle = lobes(profile, directions)
    if count:
        return Lobes(kind="lobes", count=count, depth_m=depth, angle_deg=float(np.degrees(angle)))
    return Circular(kind="circular")


def with_plain_profiles(config: ConfigPart, contact: Any) -> ConfigPart:
    """Return a configuration whose supports have their plain profiles, for figures.

    contact: ContactPoints of the tube, which know the transverse directions of each support. Of the
        two pairs of bars of a lattice with spacing_m the first is taken.
    """
    supports = []
    for number, support in enumerate(config.supports):
        first = int(np.flatnonzero(contact.support == number)[0])
        profile = plain_profile(support.profile, contact.directions[first])
        supports.append(SimpleNamespace(**(dict(support) | {"profile": profile})))
    return SimpleNamespace(**(dict(config) | {"supports": tuple(supports)}))


def _land_angles(profile: ConfigPart, pair: int) -> np.ndarray:
    """Return (land,) degrees of the normals, from the first land on (for planes, absolute)."""
    if profile.kind == "planes":
        return np.array(profile.normals_deg, float)
    if profile.kind == "broached":
        return 360.0 / profile.lands * np.arange(profile.lands)
    if profile.kind == "bars":
        return np.array([0.0, 180.0] if profile.sides == "both" else [0.0])
    if profile.spacing_m == 0.0:
        return np.array([0.0, 90.0, 180.0, 270.0])
    return np.array([0.0, 180.0]) + 90.0 * pair


def _base_angle(profile: ConfigPart, directions: np.ndarray) -> float:
    """Return the angle in rad that a profile's angle_deg or normal gives."""
    if profile.normal is None:
        return float(np.deg2rad(profile.angle_deg))
    first, second = directions @ unit_vector(profile.normal)
    return float(np.arctan2(second, first))
