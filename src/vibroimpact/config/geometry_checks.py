"""The checks of the geometry: the tube, the points and supports on it, and the gaps."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from vibroimpact.geometry.centreline import (
    LOCATION_TOLERANCE_M,
    SAME_PLACE_M,
    Centreline,
    build_centreline,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.geometry.support_spans import contact_places, support_middles, support_spans

from .key_problem import Problem, Problems
from .stage_settings import ConfigPart

TOLERANCE = 1e-9
APART_M = 4.0 * LOCATION_TOLERANCE_M  # along the tube: two places, not one seen from a bend
RADIAL = "give the radial clearance in metres"
MOST_SLENDER = 1e4
MOST_OFFSET = 10.0  # gaps that a centre may be off: the structure then presses at rest


def path_directions(tube: ConfigPart) -> Problems:
    """Yield a problem unless the bends of a path have directions."""
    if tube.kind != "path":
        return
    tangent = np.array(tube.start_direction) / np.linalg.norm(tube.start_direction)
    for index, segment in enumerate(tube.segments):
        if segment.kind != "bend":
            continue
        toward = np.array(segment.toward) - (np.array(segment.toward) @ tangent) * tangent
        if np.linalg.norm(toward) < 1e-6 * (1 + np.linalg.norm(segment.toward)):
            yield Problem(
                f"structure.segments[{index}].toward",
                "is parallel to the tube there: give a direction across the tangent"
                f" {np.round(tangent, 4).tolist()}",
            )
            return
        angle = math.radians(segment.angle_deg)
        tangent = math.cos(angle) * tangent + math.sin(angle) * toward / np.linalg.norm(toward)


def slender(tube: ConfigPart, line: Centreline) -> Problems:
    """Yield a problem unless a tube is shorter than MOST_SLENDER of its widths."""
    width = outer_width(tube.section)
    if line.length > MOST_SLENDER * width:
        yield Problem(
            f"structure.{'leg_length_m' if tube.kind == 'u_tube' else 'segments'}",
            f"makes the tube {line.length / width:.3g} times as long as it is wide, {width:g} m"
            f" (at most {MOST_SLENDER:g}): lengths and section both in metres?",
            f"{line.length:g} m",
        )


def centreline_of(tube: ConfigPart) -> Centreline | None:
    """Return the centreline, or None if its directions are a problem already reported."""
    return None if any(path_directions(tube)) else build_centreline(tube)


def off_the_tube(line: Centreline, place: str, position: Sequence[float]) -> Problems:
    """Yield a problem when `position` (3,) m is farther from the centreline than the tolerance."""
    places = line.nearest(position)
    arc_length, distance = min(places, key=lambda each: each[1])
    if distance > LOCATION_TOLERANCE_M:
        nearest = line.position(arc_length)
        yield Problem(
            place,
            f"is {distance:.4f} m off the tube (at most {LOCATION_TOLERANCE_M} m): "
            f"the nearest point of the centreline is {np.round(nearest, 4).tolist()} m",
        )
        return
    ends = {place for segment in line.segments for place in (segment.begin, segment.end)}
    for other in ends | {place for place, _ in places}:
        near = np.linalg.norm(line.position(other) - position) <= LOCATION_TOLERANCE_M
        if near and abs(other - arc_length) > APART_M:
            yield Problem(
                place,
                f"is on the tube twice, at arc lengths {min(other, arc_length):.4g} and"
                f" {max(other, arc_length):.4g} m: move it, or let the tube pass itself at more"
                f" than {2 * LOCATION_TOLERANCE_M} m",
            )
            return


def ends_off_the_tube(line: Centreline, place: str, stretch: ConfigPart) -> Problems:
    """Yield a problem for each of from_m and to_m that is given and off the tube."""
    for key in ("from_m", "to_m"):
        if (end := getattr(stretch, key)) is not None:
            yield from off_the_tube(line, f"{place}.{key}", end)


def points_on_the_tube(line: Centreline, points: Mapping[str, Sequence[float]]) -> Problems:
    """Yield a problem unless named points are on the tube."""
    for name, position in points.items():
        yield from off_the_tube(line, f"points.{name}", position)


def supports_on_the_tube(tube: ConfigPart, line: Centreline, supports: ConfigPart) -> Problems:
    """Yield a problem unless supports are on one movable segment of the tube each, and
    do not overlap.
    """
    taken: list[tuple[str, float, float]] = []
    for index, support in enumerate(supports):
        if support.at_m is None or support.height_m is None or support.point is not None:
            yield Problem(
                f"supports[{index}]",
                "is on a tube: give at_m and height_m, and no point",
                support.name,
            )
            continue
        place = f"supports[{index}]"
        off = list(off_the_tube(line, f"{place}.at_m", support.at_m))
        off = off or list(_lattice_bars(line, place, support))
        yield from off
        if off:
            continue
        yield from _across_a_joint(line, place, support)
        yield from _at_a_held_end(tube, line, place, support)
        for low, high in support_spans(line, support):
            for other, other_low, other_high in taken:
                if low < other_high - TOLERANCE and other_low < high - TOLERANCE:
                    yield Problem(
                        f"{place}.at_m",
                        f"'{support.name}' overlaps '{other}': move one or lower its height_m",
                    )
            taken.append((support.name, low, high))


def _lattice_bars(line: Centreline, place: str, support: ConfigPart) -> Problems:
    """Yield a problem unless the pairs of bars of a lattice are apart, and on the tube."""
    spacing = getattr(support.profile, "spacing_m", 0.0)
    if spacing == 0.0:
        return
    if spacing < support.height_m:
        yield Problem(
            f"{place}.profile.spacing_m",
            f"is less than the height of the bars, height_m = {support.height_m:g}: give 0 for"
            " bars that cross at the same height, or more",
        )
    middle = line.locate(support.at_m, support.name)
    room = 2 * min(middle, line.length - middle)
    if spacing > room:
        yield Problem(
            f"{place}.profile.spacing_m",
            f"puts a pair of bars beyond an end of the tube: at most {room:.4g} m there",
        )


def _across_a_joint(line: Centreline, place: str, support: ConfigPart) -> Problems:
    """Yield a problem if a support reaches across a joint of two segments."""
    joints = [segment.end for segment in line.segments[:-1]]
    spans = zip(support_middles(line, support), support_spans(line, support), strict=True)
    for middle, (low, high) in spans:
        for joint in joints:
            if low < joint - TOLERANCE and joint < high - TOLERANCE:
                room = 2 * abs(joint - middle)
                position = np.round(line.position(joint), 4).tolist()
                yield Problem(
                    f"{place}.height_m",
                    f"reaches beyond the segment of the tube that '{support.name}' is on, from"
                    f" arc length {low:.4g} to {high:.4g} m across the joint at {joint:.4g} m,"
                    f" {position}: at most {room:.4g} m there (in metres?), or move it off the"
                    " joint, or make it two supports that meet there",
                )


def _at_a_held_end(tube: ConfigPart, line: Centreline, place: str, support: ConfigPart) -> Problems:
    """Yield a problem if a support has a contact point at an end that does not move."""
    ends = (tube.root, tube.root) if tube.kind == "u_tube" else (tube.start, tube.end)
    places = contact_places(line, support)
    for kind, end in zip((each.kind for each in ends), (0.0, line.length), strict=True):
        if kind in ("clamped", "pinned") and np.any(np.abs(places - end) < SAME_PLACE_M):
            yield Problem(
                f"{place}.at_m",
                f"'{support.name}' reaches to the {kind} end of the tube, which does not move:"
                " lower its height_m or move it away from the end",
            )


def support_lists(supports: ConfigPart) -> Problems:
    """Yield a problem unless lists of a support have one entry per contact point."""
    for index, support in enumerate(supports):
        offset = support.centre_offset_m
        lists = {
            "stiffness_N_per_m": support.stiffness_N_per_m,
            "gap_factor": support.gap_factor,
            "centre_offset_m": offset if isinstance(offset[0], tuple) else None,
        }
        for key, value in lists.items():
            if isinstance(value, tuple) and len(value) != support.points:
                yield Problem(
                    f"supports[{index}].{key}",
                    f"has {len(value)} values for {support.points} contact points: give one"
                    " value, or one per point",
                )


def gaps(tube: ConfigPart, grid: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless gaps are clearances, with their factors and the depth of lobes."""
    radius = outer_width(tube.section) / 2
    told = f"half the diameter, {radius:g} m"
    for index, gap in enumerate(grid.gap_m):
        if abs(gap) > radius:
            yield Problem(f"grid.gap_m[{index}]", f"is larger than {told}: {RADIAL}")
    for index, support in enumerate(supports):
        place = f"supports[{index}]"
        if support.gap_m is not None and abs(support.gap_m) > radius:
            yield Problem(f"{place}.gap_m", f"is larger than {told}: {RADIAL}")
            continue
        gap, factor, depth = effective_gap(support, grid)
        beyond = "extra_gap_m" if support.profile.kind == "planes" else "depth_m"
        if gap * factor > radius >= gap:
            yield Problem(
                f"{place}.gap_factor",
                f"makes the gap of {gap:g} m {gap * factor:.4g} m, larger than {told}: give gap_m",
                factor,
            )
        elif gap * factor + depth > radius >= gap:
            yield Problem(
                f"{place}.profile.{beyond}",
                f"makes the clearance {gap * factor + depth:.4g} m, larger than {told}: {RADIAL}",
                depth,
            )


def effective_gap(support: ConfigPart, grid: ConfigPart) -> tuple[float, float, float]:
    """Return (largest gap in m, largest factor of it, depth of lobes or extra gap in m) of a
    support.
    """
    depth = getattr(support.profile, "depth_m", None) or 0.0
    depth = max([depth, *getattr(support.profile, "extra_gap_m", ())])
    if support.gap_m is not None:
        return support.gap_m, 1.0, depth
    if support.preload_N is not None:
        return 0.0, 1.0, depth
    return max(grid.gap_m), float(np.max(support.gap_factor)), depth


def _largest_offset(support: ConfigPart) -> float:
    """Return the largest distance in m of a contact point's obstacle from the structure at rest."""
    return float(np.max(np.linalg.norm(np.atleast_2d(support.centre_offset_m), axis=1)))


def offsets(grid: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless offsets are some gaps."""
    for index, support in enumerate(supports):
        largest = _largest_offset(support)
        gap, factor, depth = effective_gap(support, grid)
        clearance = gap * factor + depth
        if clearance > 0.0 and largest > MOST_OFFSET * clearance:
            yield Problem(
                f"supports[{index}].centre_offset_m",
                f"is {largest / clearance:.3g} times the clearance, {clearance:.3g} m (at most"
                f" {MOST_OFFSET:g}): in metres?",
                largest,
            )


def offsets_on_a_tube(tube: ConfigPart, supports: ConfigPart) -> Problems:
    """Yield a problem unless offsets are smaller than the tube."""
    radius = outer_width(tube.section) / 2
    for index, support in enumerate(supports):
        largest = _largest_offset(support)
        if largest > radius:
            yield Problem(
                f"supports[{index}].centre_offset_m",
                f"is larger than half the diameter, {radius:g} m: in metres?",
                largest,
            )
