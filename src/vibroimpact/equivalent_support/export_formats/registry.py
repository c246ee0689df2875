"""The formats that springs and contact can be written in, by the names that commands take."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeVar

from ..answer import EquivalentError
from ..contact_points import ContactSet
from ..springs import SpringSet, shared
from . import abaqus, code_aster, nastran, opensees, tables
from .frames import FIRST_NUMBER, UNIT_SYSTEMS, UnitSystem, plain_name

Named = TypeVar("Named")

SPRINGS: dict[str, Callable[[SpringSet, UnitSystem, int], str]] = {
    "nastran": nastran.springs_text,
    "code_aster": code_aster.springs_text,
    "abaqus": abaqus.springs_text,
    "opensees": opensees.springs_text,
    "csv": tables.csv_text,
    "json": tables.json_text,
}
# format -> (its text, laws that it lacks)
CONTACTS: dict[str, tuple[Callable[[ContactSet, UnitSystem, int], str], tuple[str, ...]]] = {
    "abaqus": (abaqus.contacts_text, ("damping", "friction")),
    "opensees": (opensees.contacts_text, ("damping", "friction")),
    "code_aster": (code_aster.contacts_text, ()),
}


def named(what: str, name: str, known: Mapping[str, Named]) -> Named:
    """Return what has a name among those known. Raises EquivalentError for another name."""
    if name not in known:
        raise EquivalentError(f"{what} '{name}' is none of {', '.join(known)}")
    return known[name]


def springs_text(
    springs: SpringSet, form: str, unit: str = "m", first_number: int = FIRST_NUMBER
) -> str:
    """Return the text of a file with springs and dampers to ground.

    form: one of SPRINGS. unit: "m" for m, N, kg, s or "mm" for mm, N, t, s.
    first_number: first number or tag of nodes and elements, if the format has them.

    Raises EquivalentError for another format or unit, and if two supports have the same name in the
    letters of a format.
    """
    write = named("format", form, SPRINGS)
    names = [plain_name(spring.name).lower() for spring in springs.springs]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise EquivalentError(
            f"two points are both called {twice[0]} in letters, digits and underscores: rename a"
            " support"
        )
    system = named("unit", unit, UNIT_SYSTEMS)
    own = []
    for spring in springs.springs:
        k, c = shared(spring.k, system.stiffness), shared(spring.c, system.damping)
        own.append(replace(spring, position=system.length * spring.position, k=k, c=c))
    return write(replace(springs, springs=tuple(own)), system, first_number)


def contacts_text(
    contacts: ContactSet, form: str, unit: str = "m", first_number: int = FIRST_NUMBER
) -> tuple[str, tuple[str, ...]]:
    """Return (text of a file with the contacts, sentences on its omissions).

    form: one of CONTACTS. unit, first_number: as of springs_text.

    Raises EquivalentError for another format or unit, and for holes that the format lacks.
    """
    write, lacking = named("format", form, CONTACTS)
    left_out = tuple(
        f"{law} of the contact, which the export for {form} does not have"
        for law in lacking
        if any(getattr(point, law) > 0.0 for point in contacts.points)
    )
    own = replace(contacts, left_out=left_out)
    return write(own, named("unit", unit, UNIT_SYSTEMS), first_number), left_out
