"""The checks of a tube's cross-section and of the fluids inside and outside it. Each yields
(place, value, text), see checks.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vibroimpact.geometry.centreline import SAME_PLACE_M
from vibroimpact.geometry.sections import ROUND, outer_width, section_properties

from .geometry_checks import centreline_of, off_the_tube
from .schema import RecordKeys
from .structure import Path, Structure, UTube
from .wear import Wear

Problems = Iterator[tuple[str, Any, str]]
Tube = UTube | Path

CROSS = 1e-3  # sine of the least angle between the first axis of a section and the tube


def wall(structure: Tube) -> Problems:
    """Yield a problem unless the wall is thinner than the radius."""
    section = structure.section
    if section.kind == "tube" and section.wall_thickness_m >= section.outer_diameter_m / 2:
        yield (
            "structure.section.wall_thickness_m",
            section.wall_thickness_m,
            f"must be below half the outer diameter {section.outer_diameter_m}: both in metres?",
        )


def wall_that_wears(structure: Structure, wear: Wear) -> Problems:
    """Yield a problem unless the structure has the wall of a tube."""
    if getattr(getattr(structure, "section", None), "kind", "none") != "tube":
        yield "wear", "...", "is of the wall of a tube, this structure has none: leave it out"


def wear_needs_statistics(record: RecordKeys, wear: Wear) -> Problems:
    """Yield a problem if records hold single steps, which have no work rates."""
    if record.every_step:
        yield "record.every_step", True, "gives no wear work rate: leave it out, or wear"


def axes_of_the_section(structure: Tube) -> Problems:
    """Yield a problem unless the first axis of a section is across the tube at its start."""
    axis = getattr(structure.section, "first_axis", None)
    centreline = centreline_of(structure)
    if axis is None or centreline is None:
        return
    tangent = centreline.direction(0.0)
    if np.linalg.norm(np.cross(axis, tangent)) <= CROSS * np.linalg.norm(axis):
        yield (
            "structure.section.first_axis",
            list(axis),
            f"is along the tube at its start, {np.round(tangent, 4).tolist()}: give a direction"
            " across it",
        )


def enclosed_area(structure: Tube) -> Problems:
    """Yield a problem unless a general section encloses its own material."""
    section = structure.section
    if section.kind != "general" or section.enclosed_area_m2 is None:
        return
    if section.enclosed_area_m2 < section.area_m2:
        yield (
            "structure.section.enclosed_area_m2",
            section.enclosed_area_m2,
            f"is below the area of the material, {section.area_m2:g} m2: it includes both material"
            " and hollow",
        )


def fluids(structure: Tube) -> Problems:
    """Yield a problem unless fluids fit the section, and do not overlap on the same side."""
    centreline = centreline_of(structure)
    if centreline is None or any(wall(structure)) or any(enclosed_area(structure)):
        return
    taken: list[tuple[str, float, float]] = []
    for index, fluid in enumerate(structure.fluid):
        place = f"structure.fluid[{index}]"
        yield from _fits(structure, fluid, place)
        off = [
            problem
            for key in ("from_m", "to_m")
            if getattr(fluid, key) is not None
            for problem in off_the_tube(centreline, f"{place}.{key}", getattr(fluid, key))
        ]
        yield from off
        if off:
            continue
        low, high = centreline.stretch(fluid.from_m, fluid.to_m, place)
        if high - low <= SAME_PLACE_M:
            yield f"{place}.to_m", fluid.to_m, "is the start of the fluid: give another position"
        for side, other_low, other_high in taken:
            if side == fluid.kind and low < other_high and other_low < high:
                yield place, fluid.kind, f"overlaps another fluid {side}: give them apart"
        taken.append((fluid.kind, low, high))


def _fits(structure: Tube, fluid: Any, place: str) -> Problems:
    """Yield a problem unless the section has an inside, or its surroundings are those stated."""
    section = structure.section
    if fluid.kind == "inside":
        if section_properties(section, structure.material.poisson_ratio or 0.0).inner_area <= 0.0:
            yield (
                f"{place}.kind",
                "inside",
                f"needs a hollow section, and a section of kind {section.kind} is solid: leave it"
                " out",
            )
        return
    confinement = fluid.confinement
    if confinement.kind == "coefficient":
        return
    if section.kind not in ROUND:
        yield (
            f"{place}.confinement.kind",
            confinement.kind,
            f"is for round sections: give a section of kind {section.kind} kind coefficient with"
            " an added_mass_coefficient",
        )
        return
    key = {"bundle": "pitch_m", "annulus": "equivalent_diameter_m"}.get(confinement.kind)
    if key is not None and getattr(confinement, key) <= outer_width(section):
        yield (
            f"{place}.confinement.{key}",
            getattr(confinement, key),
            f"must be above the diameter of the tube, {outer_width(section):g} m",
        )
