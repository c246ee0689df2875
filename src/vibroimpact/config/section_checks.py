"""The checks of a tube's cross-section and of the fluids inside and outside it."""

import numpy as np

from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline
from vibroimpact.geometry.sections import ROUND, outer_width, section_properties

from .geometry_checks import ends_off_the_tube
from .key_problem import Problem, Problems
from .stage_settings import ConfigPart

CROSS = 1e-3  # sine of the least angle between the first axis of a section and the tube


def wall(tube: ConfigPart) -> Problems:
    """Yield a problem unless the wall is thinner than the radius."""
    section = tube.section
    if section.kind == "tube" and section.wall_thickness_m >= section.outer_diameter_m / 2:
        yield Problem(
            "structure.section.wall_thickness_m",
            f"must be below half the outer diameter {section.outer_diameter_m}: both in metres?",
        )


def wall_that_wears(structure: ConfigPart, wear: ConfigPart) -> Problems:
    """Yield a problem unless the structure has the wall of a tube."""
    if getattr(getattr(structure, "section", None), "kind", "none") != "tube":
        yield Problem(
            "wear", "is of the wall of a tube, this structure has none: leave it out", "..."
        )


def wear_needs_statistics(record: ConfigPart, wear: ConfigPart) -> Problems:
    """Yield a problem if records hold single steps, which have no work rates."""
    if record.every_step:
        yield Problem("record.every_step", "gives no wear work rate: leave it out, or wear")


def axes_of_the_section(tube: ConfigPart, line: Centreline) -> Problems:
    """Yield a problem unless the first axis of a section is across the tube at its start."""
    axis, tangent = getattr(tube.section, "first_axis", None), line.direction(0.0)
    if axis is not None and np.linalg.norm(np.cross(axis, tangent)) <= CROSS * np.linalg.norm(axis):
        yield Problem(
            "structure.section.first_axis",
            f"is along the tube at its start, {np.round(tangent, 4).tolist()}: give a direction"
            " across it",
        )


def enclosed_area(tube: ConfigPart) -> Problems:
    """Yield a problem unless a general section encloses its own material."""
    section = tube.section
    given = section.enclosed_area_m2 if section.kind == "general" else None
    if given is not None and given < section.area_m2:
        yield Problem(
            "structure.section.enclosed_area_m2",
            f"is below the area of the material, {section.area_m2:g} m2: it includes both material"
            " and hollow",
        )


def fluids(tube: ConfigPart, line: Centreline) -> Problems:
    """Yield a problem unless fluids fit the section, and do not overlap on the same side."""
    if any(wall(tube)) or any(enclosed_area(tube)):
        return
    taken: list[tuple[str, float, float]] = []
    for index, fluid in enumerate(tube.fluid):
        place = f"structure.fluid[{index}]"
        yield from _fits(tube, fluid, place)
        off = [*ends_off_the_tube(line, place, fluid)]
        yield from off
        if off:
            continue
        low, high = line.stretch(fluid.from_m, fluid.to_m, place)
        if high - low <= SAME_PLACE_M:
            yield Problem(f"{place}.to_m", "is the start of the fluid: give another position")
        for side, other_low, other_high in taken:
            if side == fluid.kind and low < other_high and other_low < high:
                yield Problem(place, f"overlaps another fluid {side}: give them apart", fluid.kind)
        taken.append((fluid.kind, low, high))


def _fits(tube: ConfigPart, fluid: ConfigPart, place: str) -> Problems:
    """Yield a problem unless the section has an inside, or its surroundings are those stated."""
    section = tube.section
    if fluid.kind == "inside":
        if section_properties(section, tube.material.poisson_ratio or 0.0).inner_area <= 0.0:
            yield Problem(
                f"{place}.kind",
                f"needs a hollow section, and a section of kind {section.kind} is solid: leave it"
                " out",
            )
        return
    confinement = fluid.confinement
    if confinement.kind == "coefficient":
        return
    if section.kind not in ROUND:
        yield Problem(
            f"{place}.confinement.kind",
            f"is for round sections: give a section of kind {section.kind} kind coefficient with"
            " an added_mass_coefficient",
        )
        return
    key = {"bundle": "pitch_m", "annulus": "equivalent_diameter_m"}.get(confinement.kind)
    if key is not None and getattr(confinement, key) <= outer_width(section):
        yield Problem(
            f"{place}.confinement.{key}",
            f"must be above the diameter of the tube, {outer_width(section):g} m",
        )
