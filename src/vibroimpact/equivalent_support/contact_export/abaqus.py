"""Abaqus keywords: connectors CONN3D2 with a gap in their elasticity.

A flat land is a CARTESIAN connector whose first axis is the normal, a round hole a RADIAL-THRUST
connector round the tube's axis: force over displacement is 0 up to the gap, then rises with the
contact stiffness. Source: Abaqus, connection types CARTESIAN and RADIAL-THRUST, *CONNECTOR SECTION
and *CONNECTOR ELASTICITY.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..export_formats.frames import UnitSystem, numbers, plain_name
from .points import ContactPoint, ContactSet

DIGITS = ".9E"
REACH = 1.0  # m of penetration, up to which the force is given; Abaqus holds it beyond
USE = (
    "Each node of SUPPORT_POINTS is a point of the tube: tie it to your model, or replace its"
    " number in the elements by that of your node."
)


def text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the keywords. Nodes and elements count from first_number.

    Raises EquivalentError for a hole with lobes or off centre.
    """
    count = len(contacts.points)
    lines = contacts.head(unit, "**", USE)
    for name, start in (("POINTS", first_number), ("GROUND", first_number + count)):
        lines.append(f"*NODE, NSET=SUPPORT_{name}")
        for number, point in enumerate(contacts.points, start):
            lines.append(f"{number}, {numbers(unit.length * point.position, DIGITS)}")
    lines += ["*BOUNDARY", "SUPPORT_GROUND, 1, 6"]
    element = first_number
    for number, point in enumerate(contacts.points, first_number):
        lines.append(f"** {point.name}")
        for connector in _connectors(point, unit):
            lines += _lines(connector, (element, number + count, number))
            element += 1
    return "\n".join(lines) + "\n"


Connector = tuple[str, str, np.ndarray, list[tuple[float, float]]]


def _connectors(point: ContactPoint, unit: UnitSystem) -> Iterator[Connector]:
    """Yield (name, type, axes (2, 3), [(force, displacement)]) of the connectors of a point."""
    name = plain_name(point.name).upper()
    if not len(point.lands):
        point.require_circle("Abaqus")
        yield name, "RADIAL-THRUST", point.axes, _elasticity(point, unit, point.gap)
    for number, (normal, gap) in enumerate(zip(point.lands, point.land_gaps, strict=True), 1):
        axes = np.array([normal, np.cross(point.axis, normal)])
        table = [(0.0, -REACH * unit.length), *_elasticity(point, unit, gap)]
        yield f"{name}_{number}", "CARTESIAN", axes, table


def _elasticity(point: ContactPoint, unit: UnitSystem, gap: float) -> list[tuple[float, float]]:
    """Return [(force, displacement)] from rest on."""
    start = [(0.0, 0.0)] if gap > 0.0 else []
    reach = (point.stiffness * REACH * unit.stiffness * unit.length, unit.length * (gap + REACH))
    return [*start, (0.0, unit.length * gap), reach]


def _lines(connector: Connector, tags: tuple[int, int, int]) -> list[str]:
    """Return the lines of a connector. tags: of the element, its ground node and the tube's."""
    name, kind, axes, table = connector
    return [
        f"*ORIENTATION, NAME=AXES_{name}",
        numbers(axes.ravel(), DIGITS),
        f"*ELEMENT, TYPE=CONN3D2, ELSET=CONTACT_{name}",
        ", ".join(map(str, tags)),
        f"*CONNECTOR SECTION, ELSET=CONTACT_{name}, BEHAVIOR=LAW_{name}",
        f"{kind},",
        f"AXES_{name},",
        f"*CONNECTOR BEHAVIOR, NAME=LAW_{name}",
        "*CONNECTOR ELASTICITY, COMPONENT=1, NONLINEAR",
        *(numbers(row, DIGITS) for row in table),
    ]
