"""Nastran bulk data: CGAP and PGAP, one for each flat land.

The gap element acts along the first axis of its coordinate system and closes when the tube's grid
moves along it by U0. It has no round form. Source: MSC Nastran Quick Reference Guide, entries CGAP,
PGAP, CORD2R, GRID, SPC1.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.equivalent_support.answer import EquivalentError
from vibroimpact.equivalent_support.export_formats.frames import head
from vibroimpact.equivalent_support.export_formats.nastran import card
from vibroimpact.equivalent_support.export_formats.unit_system import UnitSystem

from .points import ContactPoint, ContactSet

USE = (
    "The first GRID of each point is on the tube: equivalence it with a node of your model, or"
    " replace its number in CGAP. Add SPC1 set 1 to your constraints; the solution must be a"
    " nonlinear one."
)


def text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the bulk data. Grids, elements, properties and systems count from first_number.

    Raises EquivalentError for a round hole.
    """
    lines = head(contacts, unit, "$", USE, title="Contact of supports")
    number, element = first_number, first_number
    for point in contacts.points:
        if not len(point.lands):
            raise EquivalentError(
                f"{point.name}: CGAP of Nastran acts along one direction, and this hole is round:"
                " export another format"
            )
        lines.append(f"$ {point.name}")
        place = unit.length * point.position
        lines += card("GRID", [number, 0, *place, 0]) + card("GRID", [number + 1, 0, *place, 0])
        lines += card("SPC1", [1, 123456, number + 1])
        for normal in point.lands:
            lines += _land(point, unit, normal, (element, number))
            element += 1
        number += 2
    return "\n".join(lines) + "\n"


def _land(
    point: ContactPoint, unit: UnitSystem, normal: np.ndarray, numbers: tuple[int, int]
) -> list[str]:
    """Return the cards of a land. numbers: of its element and of the tube's grid."""
    element, grid = numbers
    place = unit.length * point.position
    corners = [place, place + unit.length * point.axis, place + unit.length * normal]
    stiffness = unit.stiffness * point.stiffness
    sticking = [unit.stiffness * point.stick_stiffness, point.friction] if point.friction else []
    gap = [unit.length * point.land_gap(normal), 0.0, stiffness, None, *sticking]
    return [
        *card("CORD2R", [element, 0, *np.concatenate(corners)]),
        *card("CGAP", [element, element, grid, grid + 1, None, None, None, element]),
        *card("PGAP", [element, *gap]),
    ]
