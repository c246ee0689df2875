"""code_aster commands: AFFE_CARA_ELEM of discrete elements K_TR_D_N and A_TR_D_N at nodes.

Source: code_aster documentation U4.42.01 (AFFE_CARA_ELEM, keywords DISCRET and ORIENTATION):
K_TR_D_N takes the six diagonal terms of a stiffness to ground in the axes of REPERE, A_TR_D_N those
of a damping; VECT_X_Y gives the local x and y axes.
"""

from __future__ import annotations

from ..answer import EquivalentError
from ..springs import PointSpring, SpringSet
from .frames import UnitSystem, head, local_axes, numbers, plain_name

LONGEST_NAME = 24
USE = (
    "Each GROUP_MA is one POI1 element on the node of your mesh at the coordinates given"
    " (CREA_MAILLAGE, CREA_POI1), with the model DIS_TR (AFFE_MODELE). Put the terms into the"
    " AFFE_CARA_ELEM of your model, or use this one."
)


def text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
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
    lines = [*head(springs, unit, "#", USE), *places, "SUPPORTS = AFFE_CARA_ELEM("]
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
