"""Nastran bulk data: GRID, CBUSH and PBUSH, and CORD2R if directions are not global axes.

Every card is in the large field format (16 characters a field), so that a number keeps ten digits.
Source: MSC Nastran Quick Reference Guide, entries CBUSH, PBUSH, CORD2R, GRID. CBUSH with a blank GB
is a spring to ground; its coordinate system CID gives the axes of K1 to K3.
"""

import numpy as np

from ..springs import PointSpring, SpringSet
from .frames import UnitSystem, head, local_axes

FIELDS_PER_LINE = 4
USE = (
    "Each GRID is a point of the tube: equivalence it with a node of your model, or replace its"
    " number in CBUSH by that of your node."
)


def springs_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the bulk data. Grids, elements, properties and systems count from first_number."""
    lines = head(springs, unit, "$", USE)
    for number, spring in enumerate(springs.springs, first_number):
        lines.append(f"$ {spring.name}")
        lines += _cards(spring, unit, number)
    return "\n".join(lines) + "\n"


def _cards(spring: PointSpring, unit: UnitSystem, number: int) -> list[str]:
    """Return the lines of one point."""
    place, system, lines = spring.position, 0, []
    axes, turned = local_axes(spring.axes)
    if turned:
        system = number
        along = np.cross(spring.axes[0], spring.axes[1])
        corners = [place, place + unit.length * along, place + unit.length * spring.axes[0]]
        lines += _card("CORD2R", [number, 0, *np.concatenate(corners)])
    lines += _card("GRID", [number, 0, *place, 0])
    lines += _card("CBUSH", [number, number, number, None, None, None, None, system])
    properties: list = [number]
    for letter, values in (("K", spring.k), ("B", spring.c)):
        row: list = [None] * 6
        for axis, value in zip(axes, values, strict=True):
            row[axis] = value
        if any(value is not None for value in row):
            properties += [letter, *row]
            if letter == "K":
                properties += [None]  # the next letter begins a line of its own
    return lines + _card("PBUSH", properties)


def _card(name: str, fields: list) -> list[str]:
    """Return the lines of a card in large field format."""
    while fields and fields[-1] is None:
        fields = fields[:-1]
    rows = [
        fields[first : first + FIELDS_PER_LINE] for first in range(0, len(fields), FIELDS_PER_LINE)
    ]
    return [
        f"{f'{name}*' if not order else '*':8}" + "".join(map(_field, row)).rstrip()
        for order, row in enumerate(rows)
    ]


def _field(value: float | int | str | None) -> str:
    """Return a field of 16 characters; a real number always has a decimal point."""
    if value is None or isinstance(value, (int, str)):
        return f"{'' if value is None else value:>16}"
    return f"{float(value) + 0.0:16.9E}"
