"""OpenSees in Python: zeroLength elements with gaps to fixed nodes.

A flat land is a zeroLength element along its normal with the material ElasticPPGap, a round hole a
CoupledZeroLength, whose force follows the distance from its centre. It acts along two degrees of
freedom, so that a round hole must lie across a global axis. The file defines
`add_contacts(ops, nodes, first_tag)` for a model of three dimensions and six degrees of freedom a
node. Source: OpenSees documentation, and CoupledZeroLength.cpp.
"""

from __future__ import annotations

import numpy as np

from ..answer import EquivalentError
from ..export_formats.frames import UnitSystem, global_axes, numbers, plain_name
from .points import ContactPoint, ContactSet

DIGITS = ".9e"
USE = (
    "Call add_contacts(ops, nodes) after your nodes: nodes = {point: tag of your node at its"
    " place}. In a transient analysis, iterate (algorithm Newton)."
)
PROGRAM = '''
YIELD = 1.0e20  # force at which the material of a gap would yield: never


def add_contacts(ops, nodes, first_tag={first}):
    """Put the supports round your nodes. All tags count from first_tag.

    ops: the module openseespy.opensees. nodes: {{name of a point: tag of your node}}.
    """
    tag = first_tag
    for name, (position, stiffness, round_hole, lands) in POINTS.items():
        ground = tag
        ops.node(ground, *position)
        ops.fix(ground, 1, 1, 1, 1, 1, 1)
        if round_hole is not None:
            gap, first, second = round_hole
            ops.uniaxialMaterial("ElasticPPGap", tag, stiffness, YIELD, gap)
            ops.uniaxialMaterial("ElasticPPGap", tag + 1, stiffness, -YIELD, -gap)
            ops.uniaxialMaterial("Parallel", tag + 2, tag, tag + 1)
            ops.element("CoupledZeroLength", tag, ground, nodes[name], first, second, tag + 2)
            tag += 3
        for gap, normal, across in lands:
            ops.uniaxialMaterial("ElasticPPGap", tag, stiffness, YIELD, gap)
            ops.element(
                "zeroLength", tag, ground, nodes[name],
                "-mat", tag, "-dir", 1, "-orient", *normal, *across, "-doRayleigh", 0,
            )
            tag += 1
'''


def text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the program. Tags count from first_number.

    Raises EquivalentError for a hole with lobes, off centre, or askew to the global axes.
    """
    lines = contacts.head(unit, "#", USE)
    lines += [
        "# point: (position, k, (gap, two degrees of freedom) of a round hole,",
        "#         [(gap, normal, direction across it) of each flat land])",
        "POINTS = {",
    ]
    for point in contacts.points:
        place = numbers(unit.length * point.position, DIGITS)
        values = f"({place}), {unit.stiffness * point.stiffness:{DIGITS}}"
        lands = ", ".join(_land(point, number, unit) for number in range(len(point.lands)))
        lines.append(
            f'    "{plain_name(point.name)}": ({values}, {_hole(point, unit)}, [{lands}]),'
        )
    return "\n".join([*lines, "}"]) + PROGRAM.format(first=first_number)


def _hole(point: ContactPoint, unit: UnitSystem) -> str:
    """Return the tuple of a round hole, None for flat lands."""
    if len(point.lands):
        return "None"
    point.require_circle("OpenSees")
    along = global_axes(point.axes)
    if along is None:
        raise EquivalentError(
            f"{point.name}: a round hole of OpenSees lies across a global axis, this one does not:"
            " export another format"
        )
    return f"({unit.length * point.gap:.9e}, {along[0] + 1}, {along[1] + 1})"


def _land(point: ContactPoint, number: int, unit: UnitSystem) -> str:
    """Return the tuple of a flat land."""
    normal = point.lands[number]
    across = np.cross(point.axis, normal)
    gap = unit.length * point.land_gaps[number]
    return f"({gap:.9e}, ({numbers(normal, DIGITS)}), ({numbers(across, DIGITS)}))"
