"""OpenSees in Python: zeroLength elements to fixed nodes, elastic and viscous, or with gaps.

The file defines `add_supports(ops, nodes, first_tag)`, or `add_contacts`, for a model of three
dimensions and six degrees of freedom a node. A flat land is a zeroLength element along its normal
with the material ElasticPPGap, a round hole a CoupledZeroLength, whose force follows the distance
from its centre. It acts along two degrees of freedom, so that a round hole must lie across a global
axis. Source: OpenSees documentation, commands element zeroLength, uniaxialMaterial Elastic (force
E u + eta du/dt), and CoupledZeroLength.cpp.
"""

from collections.abc import Iterable

import numpy as np

from ..answer import EquivalentError
from ..contact_points import ContactPoint, ContactSet
from ..springs import SpringSet
from .frames import UnitSystem, global_axes, head, numbers, plain_name

SPRINGS_USE = (
    "Call add_supports(ops, nodes) after your nodes: nodes = {point: tag of your node at its"
    " place}."
)
SPRINGS_PROGRAM = '''


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
DIGITS = ".9e"
CONTACTS_USE = (
    "Call add_contacts(ops, nodes) after your nodes: nodes = {point: tag of your node at its"
    " place}. In a transient analysis, iterate (algorithm Newton)."
)
CONTACTS_PROGRAM = '''
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


def springs_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the program. Tags count from first_number."""
    lines = head(springs, unit, "#", SPRINGS_USE)
    lines += ["# point: (position, axes of the two directions, k and c along them)", "POINTS = {"]
    for spring in springs.springs:
        position = _tuple(value + 0.0 for value in spring.position)
        axes = ", ".join(_tuple(value + 0.0 for value in axis) for axis in spring.axes)
        values = f"{_tuple(spring.k)}, {_tuple(spring.c)}"
        lines.append(f'    "{plain_name(spring.name)}": ({position}, ({axes}), {values}),')
    return "\n".join([*lines, "}"]) + SPRINGS_PROGRAM.format(first=first_number)


def _tuple(values: Iterable[float | None]) -> str:
    """Return a tuple of Python: every number with ten digits and as a float."""
    return f"({', '.join('None' if value is None else f'{value:.9e}' for value in values)})"


def contacts_text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the program. Tags count from first_number.

    Raises EquivalentError for a hole with lobes, off centre, or askew to the global axes.
    """
    lines = head(contacts, unit, "#", CONTACTS_USE)
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
    return "\n".join([*lines, "}"]) + CONTACTS_PROGRAM.format(first=first_number)


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
