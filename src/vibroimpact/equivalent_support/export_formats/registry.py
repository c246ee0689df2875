"""The formats that springs can be written in, by the name that the command line takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..answer import EquivalentError
from ..springs import PointSpring, SpringSet, shared
from . import abaqus, code_aster, nastran, opensees, tables
from .frames import FIRST_NUMBER, UnitSystem, plain_name, unit_system

FORMATS: dict[str, Callable[[SpringSet, UnitSystem, int], str]] = {
    "nastran": nastran.text,
    "code_aster": code_aster.text,
    "abaqus": abaqus.text,
    "opensees": opensees.text,
    "csv": tables.csv_text,
    "json": tables.json_text,
}


def springs_text(
    springs: SpringSet, form: str, unit: str = "m", first_number: int = FIRST_NUMBER
) -> str:
    """Return the text of a file with springs and dampers to ground.

    form: one of FORMATS. unit: "m" for m, N, kg, s or "mm" for mm, N, t, s.
    first_number: first number or tag of nodes and elements, if the format has them.

    Raises EquivalentError for another format or unit, and if two supports have the same name in the
    letters of a format.
    """
    if form not in FORMATS:
        raise EquivalentError(f"format '{form}' is none of {', '.join(FORMATS)}")
    names = [plain_name(spring.name).lower() for spring in springs.springs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise EquivalentError(
            f"two points are both called {twice[0]} in letters, digits and underscores: rename a"
            " support"
        )
    system = unit_system(unit)
    own = tuple(_in_unit(spring, system) for spring in springs.springs)
    return FORMATS[form](replace(springs, springs=own), system, first_number)


def _in_unit(spring: PointSpring, unit: UnitSystem) -> PointSpring:
    """Return a spring whose position, k and c are in a system of units."""
    return replace(
        spring,
        position=unit.length * spring.position,
        k=shared(spring.k, unit.stiffness),
        c=shared(spring.c, unit.damping),
    )
