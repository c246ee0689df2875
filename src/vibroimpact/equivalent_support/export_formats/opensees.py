"""OpenSees in Python: zeroLength elements to fixed nodes, with elastic and viscous materials.

The file defines `add_supports(ops, nodes, first_tag)` for a model of three dimensions and six
degrees of freedom a node. Source: OpenSees documentation, commands element zeroLength, and
uniaxialMaterial Elastic (force E u + eta du/dt).
"""

from __future__ import annotations

from collections.abc import Iterable

from ..springs import SpringSet
from .frames import UnitSystem, head, plain_name

USE = (
    "Call add_supports(ops, nodes) after your nodes: nodes = {point: tag of your node at its"
    " place}."
)
PROGRAM = '''


def add_supports(ops, nodes, first_tag={first}):
    """Tie your nodes to ground. Tags of nodes, materials and elements count from first_tag.

    ops: the module openseespy.opensees. nodes: {{name of a point: tag of your node}}.
    """
    tag = first_tag
    for name, (position, axes, stiffness, damping) in POINTS.items():
        ops.node(tag, *position)
        ops.fix(tag, 1, 1, 1, 1, 1, 1)
        materials, directions = [], []
        for direction, (k, c) in enumerate(zip(stiffness, damping), 1):
            if k is None:
                continue
            material = 2 * tag + direction
            ops.uniaxialMaterial("Elastic", material, k, c or 0.0)
            materials.append(material)
            directions.append(direction)
        ops.element(
            "zeroLength", tag, tag, nodes[name],
            "-mat", *materials, "-dir", *directions, "-orient", *axes[0], *axes[1],
            "-doRayleigh", 0,
        )
        tag += 1
'''


def text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the program. Tags count from first_number."""
    lines = head(springs, unit, "#", USE)
    lines += [
        "# point: (position, axes of the two directions, k and c along them)",
        "POINTS = {",
    ]
    for spring in springs.springs:
        position = _tuple(value + 0.0 for value in spring.position)
        axes = ", ".join(_tuple(value + 0.0 for value in axis) for axis in spring.axes)
        values = f"{_tuple(spring.k)}, {_tuple(spring.c)}"
        lines.append(f'    "{plain_name(spring.name)}": ({position}, ({axes}), {values}),')
    return "\n".join([*lines, "}"]) + PROGRAM.format(first=first_number)


def _tuple(values: Iterable[float | None]) -> str:
    """Return a tuple of Python: every number with ten digits and as a float."""
    return f"({', '.join('None' if value is None else f'{value:.9e}' for value in values)})"
