"""code_aster commands: AFFE_CARA_ELEM of discrete elements K_TR_D_N and A_TR_D_N at nodes, and the
relation DIS_CHOC of DYNA_VIBRA on modes, with its obstacles.

K_TR_D_N takes the six diagonal terms of a stiffness to ground in the axes of REPERE, A_TR_D_N those
of a damping; VECT_X_Y gives the local x and y axes. A flat land is one of two parallel planes
PLAN_Z so far apart that the other is never met, a circle is CERCLE, and lobes are an outline
DISCRET of angle in degrees and radius. NORM_OBST is the axis of the tube; ANGL_VRIL turns the other
two axes of the obstacle about it. Source: code_aster U4.42.01 (AFFE_CARA_ELEM, keywords DISCRET and
ORIENTATION), U4.44.21 (DEFI_OBSTACLE), U4.53.21 (DYNA_VIBRA), its routines op0073 and distno, and
its test sdnd100a.
"""

from collections.abc import Iterator

import numpy as np

from vibroimpact.config.profiles import Lobes
from vibroimpact.structure.contact.outline import radial_gap

from ..answer import EquivalentError
from ..contact_points import ContactPoint, ContactSet
from ..springs import PointSpring, SpringSet
from .frames import UnitSystem, head, local_axes, numbers, plain_name

LONGEST_NAME = 24
SPRINGS_USE = (
    "Each GROUP_MA is one POI1 element on the node of your mesh at the coordinates given"
    " (CREA_MAILLAGE, CREA_POI1), with the model DIS_TR (AFFE_MODELE). Put the terms into the"
    " AFFE_CARA_ELEM of your model, or use this one."
)
FAR = 1.0  # m, half the distance of the two planes of a land
OUTLINE_DEG = np.linspace(0.0, 360.0, 361)
DIGITS = ".12g"
CONTACTS_USE = (
    "Each GROUP_NO_1 is the node of your mesh at its contact point. Give CONTACTS to"
    " DYNA_VIBRA(BASE_CALCUL='GENE', TYPE_CALCUL='TRAN', COMPORTEMENT=CONTACTS, ...)."
)


def springs_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the commands. first_number is not used: groups have names.

    Raises EquivalentError for a name that code_aster can not take.
    """
    discrete, orientation, places = [], [], []
    for spring in springs.springs:
        name = plain_name(spring.name).upper()
        if len(name) > LONGEST_NAME:
            raise EquivalentError(
                f"'{name}' has more than the {LONGEST_NAME} characters of a group of code_aster:"
                " shorten the support's name"
            )
        places.append(f"#   {name}: ({numbers(spring.position, '.9g')})")
        discrete += _terms(spring, name)
        if local_axes(spring.axes)[1]:
            values = numbers(spring.axes.ravel(), ".12g")
            orientation.append(f"        _F(GROUP_MA='{name}', CARA='VECT_X_Y', VALE=({values})),")
    lines = [*head(springs, unit, "#", SPRINGS_USE), *places, "SUPPORTS = AFFE_CARA_ELEM("]
    lines += ["    MODELE=MODELE,", "    DISCRET=(", *discrete, "    ),"]
    if orientation:
        lines += ["    ORIENTATION=(", *orientation, "    ),"]
    return "\n".join([*lines, ")"]) + "\n"


def _terms(spring: PointSpring, name: str) -> list[str]:
    """Return the _F terms of one point: the stiffness, and the damping if there is one."""
    axes, turned = local_axes(spring.axes)
    frame, lines = "LOCAL" if turned else "GLOBAL", []
    for kind, values in (("K_TR_D_N", spring.k), ("A_TR_D_N", spring.c)):
        if all(value is None for value in values):
            continue
        terms = [0.0] * 6
        for axis, value in zip(axes, values, strict=True):
            terms[axis] = value or 0.0
        diagonal = ", ".join(f"{term:.9g}" for term in terms)
        lines += [
            f"        _F(GROUP_MA='{name}', REPERE='{frame}', CARA='{kind}',",
            f"           VALE=({diagonal})),",
        ]
    return lines


def contacts_text(contacts: ContactSet, unit: UnitSystem, first_number: int) -> str:
    """Return the commands. first_number is not used: groups have names."""
    outlines = {point.name: point for point in contacts.points if point.lobes[0]}
    lines = [
        *head(contacts, unit, "#", CONTACTS_USE),
        "CIRCLE = DEFI_OBSTACLE(TYPE='CERCLE')",
        "PLANES = DEFI_OBSTACLE(TYPE='PLAN_Z')",
    ]
    for point in outlines.values():
        lines += [
            f"{_outline_name(point)} = DEFI_OBSTACLE(TYPE='DISCRET', VALE=(",
            *_outline(point, unit),
            "))",
        ]
    lines.append("CONTACTS = (")
    for point in contacts.points:
        for obstacle, origin, gap, third in _obstacles(point):
            lines += _term(point, unit, (obstacle, origin, gap, third))
    return "\n".join([*lines, ")"]) + "\n"


Obstacle = tuple[str, np.ndarray, float, np.ndarray]


def _obstacles(point: ContactPoint) -> Iterator[Obstacle]:
    """Yield (name, origin (3,) in m, gap in m, direction of the obstacle's third axis)."""
    if not len(point.lands):
        name = _outline_name(point) if point.lobes[0] else "CIRCLE"
        yield name, point.position + point.offset, point.gap, point.axes[1]
    for normal, gap in zip(point.lands, point.land_gaps, strict=True):
        origin = point.position + (gap - FAR) * normal
        yield "PLANES", origin, FAR, normal


def _term(point: ContactPoint, unit: UnitSystem, obstacle: Obstacle) -> list[str]:
    """Return the lines of one obstacle in COMPORTEMENT."""
    name, origin, gap, third = obstacle
    roll = f"{roll_deg(point.axis, third):.9g}"
    lines = [
        f"    _F(RELATION='DIS_CHOC', GROUP_NO_1='{plain_name(point.name).upper()}',",
        f"       OBSTACLE={name}, ORIG_OBST=({numbers(unit.length * origin, DIGITS)}),",
        f"       NORM_OBST=({numbers(point.axis, DIGITS)}), ANGL_VRIL={roll},",
        f"       JEU={unit.length * gap:.12g}, RIGI_NOR={unit.stiffness * point.stiffness:.9g},",
    ]
    if point.damping:
        lines.append(f"       AMOR_NOR={unit.damping * point.damping:.9g},")
    if point.friction:
        lines.append(
            f"       FROTTEMENT='COULOMB', COULOMB={point.friction:.9g},"
            f" RIGI_TAN={unit.stiffness * point.stick_stiffness:.9g},"
        )
    return [*lines, "    ),"]


def roll_deg(axis: np.ndarray, third: np.ndarray) -> float:
    """Return ANGL_VRIL in degrees, by which the third axis of an obstacle is `third`.

    axis: (3,) the first axis, of the nautical angles alpha and beta. Without roll the second axis
    is horizontal.
    """
    alpha, beta = np.arctan2(axis[1], axis[0]), -np.arctan2(axis[2], np.hypot(axis[0], axis[1]))
    second = np.array([-np.sin(alpha), np.cos(alpha), 0.0])
    upwards = np.array([np.cos(alpha) * np.sin(beta), np.sin(alpha) * np.sin(beta), np.cos(beta)])
    return float(np.degrees(np.arctan2(-third @ second, third @ upwards)))


def _outline_name(point: ContactPoint) -> str:
    """Return the name of the obstacle of a point with lobes."""
    return f"HOLE_{plain_name(point.name).upper()}"


def _outline(point: ContactPoint, unit: UnitSystem) -> Iterator[str]:
    """Yield the lines of the outline of a point with lobes: angle in degrees, radius."""
    count, depth, angle = point.lobes
    profile = Lobes(kind="lobes", count=count, depth_m=depth, angle_deg=float(np.degrees(angle)))
    radii = unit.length * radial_gap(profile, point.gap, np.radians(OUTLINE_DEG))
    for degrees, radius in zip(OUTLINE_DEG, radii, strict=True):
        yield f"    {degrees:.9g}, {radius:.9g},"
