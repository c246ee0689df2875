"""Abaqus keywords: SPRING1 and DASHPOT1 elements to ground.

Source: Abaqus Keywords Guide, *SPRING and *DASHPOT: the degree of freedom, then the constant. If
the directions are not global axes, ORIENTATION gives the local ones. CalculiX reads the springs;
it has no DASHPOT1.
"""

from __future__ import annotations

from ..springs import PointSpring, SpringSet
from .frames import UnitSystem, head, local_axes, numbers, plain_name

USE = (
    "Each node is a point of the tube: tie it to your model, or replace its number in the elements"
    " by that of your node."
)


def text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the keywords. Nodes and elements count from first_number."""
    lines = [*head(springs, unit, "**", USE), "*NODE, NSET=SUPPORT_POINTS"]
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
