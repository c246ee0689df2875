"""The checks of the profiles of supports: allowed contact and preload, places of their lands."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from vibroimpact.geometry.centreline import Centreline
from vibroimpact.geometry.directions import unit_vector

from .geometry_checks import off_the_tube
from .key_problem import Problem, Problems
from .profiles import has_flat_lands
from .stage_settings import ConfigPart

SAME_DEG = 1e-6
ACROSS_DEG = 2.0  # a normal given with a few digits may be this far off the plane across the tube


def gaps_of_supports(structure: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless only flat stops touch at rest."""
    for index, support in enumerate(supports):
        flat = has_flat_lands(support.profile)
        if support.gap_m is not None and support.gap_m <= 0.0 and not flat:
            yield Problem(
                f"supports[{index}].gap_m",
                "must be > 0 round a centre: only flat stops (profile planes, bars, lattice or flat"
                " lands) may touch or press",
            )


def preloads(supports: ConfigPart) -> Problems:
    """Yield a problem unless only flat lands press, and their interference is not given twice."""
    for index, support in enumerate(supports):
        if support.preload_N is None:
            continue
        place = f"supports[{index}].preload_N"
        if not has_flat_lands(support.profile):
            yield Problem(
                place,
                f"needs flat lands to press with, the profile is {support.profile.kind}: use bars",
            )
        if support.gap_m is not None:
            yield Problem(
                place,
                f"is given together with gap_m = {support.gap_m:g}, both set the preload:"
                " give one of them",
            )


def normals(supports: ConfigPart, given: Mapping[str, Any]) -> Problems:
    """Yield a problem unless a profile has one direction, across tube or axis of contact."""
    line = given.get("line")
    known = line is not None or "other" in given  # else the bends of the tube have no directions
    for index, support in enumerate(supports if known else ()):
        profile = support.profile
        place = f"supports[{index}].profile"
        if profile.kind == "planes":
            yield from _stops_twice(f"{place}.normals_deg", profile.normals_deg)
            yield from _extra_gaps(f"{place}.extra_gap_m", profile, support)
        if profile.kind not in ("broached", "bars", "lattice"):
            continue
        if profile.kind == "lattice" and profile.spacing_m > 0.0 and line is None:
            yield Problem(f"{place}.spacing_m", "is for tubes: leave it out")
        if (profile.normal is None) == (profile.angle_deg is None):
            stated = "neither" if profile.normal is None else "both"
            yield Problem(
                place,
                f"has {stated} of normal and angle_deg: give one, the direction of its first land",
                profile.kind,
            )
        elif profile.normal is not None:
            yield from _across(line, f"{place}.normal", profile.normal, support.at_m)


def _extra_gaps(place: str, profile: ConfigPart, support: ConfigPart) -> Problems:
    """Yield a problem unless there is an extra gap for each stop, and no preload."""
    given, stops = len(profile.extra_gap_m), len(profile.normals_deg)
    if given not in (0, stops):
        yield Problem(place, f"has {given} values for {stops} stops: give one each")
    if given and support.preload_N is not None:
        yield Problem(
            place,
            f"is given together with preload_N = {support.preload_N:g}, which presses every stop:"
            " give gap_m, which may be negative, in place of preload_N",
        )


def _stops_twice(place: str, normals_deg: Sequence[float]) -> Problems:
    """Yield a problem if two stops of a profile are one."""
    for index, angle in enumerate(normals_deg):
        if any(
            abs((angle - other + 180.0) % 360.0 - 180.0) < SAME_DEG for other in normals_deg[:index]
        ):
            yield Problem(
                f"{place}[{index}]",
                "is a stop that is there already: leave it out, or raise stiffness_N_per_m",
            )


def _across(
    line: Centreline | None, place: str, normal: Sequence[float], at_m: Sequence[float] | None
) -> Problems:
    """Yield a problem unless the normal of a profile is across the structure at its support.

    at_m: position of the support on the centreline.
    """
    tangent = np.array([0.0, 0.0, 1.0])  # a structure other than a tube has contact along x and y
    if line is not None:
        if at_m is None or any(off_the_tube(line, place, at_m)):
            return
        tangent = line.direction(line.locate(at_m, place))
    along = float(unit_vector(normal) @ tangent)
    if abs(along) <= math.sin(math.radians(ACROSS_DEG)):
        return
    where = "the tube, which runs along" if line is not None else "the axis of contact,"
    across = unit_vector(normal) - along * tangent
    remedy = (
        f"give the part across, {np.round(unit_vector(across), 4).tolist()}"
        if np.linalg.norm(across) > 1.0e-6
        else "give a direction across it"
    )
    yield Problem(
        place,
        f"is {math.degrees(math.asin(min(1.0, abs(along)))):.1f} degrees off the plane across"
        f" {where} {np.round(tangent, 4).tolist()} there: {remedy}",
    )
