"""Abaqus keywords: SPRING1 and DASHPOT1 elements to ground, and connectors CONN3D2 with a gap in
their elasticity.

If the directions of a spring are not global axes, ORIENTATION gives the local ones. CalculiX reads
the springs; it has no DASHPOT1. A flat land is a CARTESIAN connector whose first axis is the
normal, a round hole a RADIAL-THRUST connector round the tube's axis: force over displacement is 0
up to the gap, then rises with the contact stiffness. Source: Abaqus Keywords Guide, *SPRING and
*DASHPOT (the degree of freedom, then the constant), *CONNECTOR SECTION and *CONNECTOR ELASTICITY;
its connection types CARTESIAN and RADIAL-THRUST.
"""

from collections.abc import Iterator

import numpy as np

from ..contact_points import ContactPoint, ContactSet
from ..springs import PointSpring, SpringSet
from .frames import UnitSystem, head, local_axes, numbers, plain_name

SPRINGS_USE = (
    "Each node is a point of the tube: tie it to your model, or replace its number in the elements"
    " by that of your node."
)
DIGITS = ".9E"
REACH = 1.0  # m of penetration, up to which the force is given; Abaqus holds it beyond
CONTACTS_USE = (
    "Each node of SUPPORT_POINTS is a point of the tube: tie it to your model, or replace its"
    " number in the elements by that of your node."
)


def springs_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the keywords. Nodes and elements count from first_number."""
    lines = [*head(springs, unit, "**", SPRINGS_USE), "*NODE, NSET=SUPPORT_POINTS"]
    for number, spring in enumerate(springs.springs, first_number):
        lines.append(f"{number}, {numbers(spring.position, '.9E')}")
    element = first_number
    for number, spring in enumerate(springs.springs, first_number):
        lines.append(f"** {spring.name}")
        added = _elements(spring, number, element)
        element += sum(line.startswith("*ELEMENT") for line in added)
        lines += added
    return "\n".join(lines) + "\n"


def _elements(spring: PointSpring, node: int, element: int) -> list[str]:
    """Return the lines of one point, whose elements count from `element`."""
    name, oriented, lines = plain_name(spring.name).upper(), "", []
    axes, turned = local_axes(spring.axes)
    if turned:
        oriented = f", ORIENTATION=AXES_{name}"
        lines += [f"*ORIENTATION, NAME=AXES_{name}", numbers(spring.axes.ravel(), ".9E")]
    for kind, letter, values in (("SPRING", "K", spring.k), ("DASHPOT", "C", spring.c)):
        for axis, value in zip(axes, values, strict=True):
            if value is None:
                continue
            group = f"{letter}{axis + 1}_{name}"
            lines += [
                f"*ELEMENT, TYPE={kind}1, ELSET={group}",
                f"{element}, {node}",
                f"*{kind}, ELSET={group}{oriented}",
                f"{axis + 1}",
                f"{value:.9E}",
            ]
            element += 1
    return lines


def contacts_text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the keywords. Nodes and elements count from first_number.

    Raises EquivalentError for a hole with lobes or off centre.
    """
    count = len(contacts.points)
    lines = head(contacts, unit, "**", CONTACTS_USE)
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
