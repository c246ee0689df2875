"""The formats that contact can be written in, by the name that the command line takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ..answer import EquivalentError
from ..export_formats.frames import FIRST_NUMBER, UnitSystem, unit_system
from . import abaqus, code_aster, opensees
from .points import ContactSet

# format -> (its text, laws that it lacks)
FORMATS: dict[str, tuple[Callable[[ContactSet, UnitSystem, int], str], tuple[str, ...]]] = {
    "abaqus": (abaqus.text, ("damping", "friction")),
    "opensees": (opensees.text, ("damping", "friction")),
    "code_aster": (code_aster.text, ()),
}


def contacts_text(
    contacts: ContactSet, form: str, unit: str = "m", first_number: int = FIRST_NUMBER
) -> tuple[str, tuple[str, ...]]:
    """Return (text of a file with the contacts, sentences on its omissions).

    form: one of FORMATS. unit: "m" for m, N, kg, s or "mm" for mm, N, t, s.
    first_number: first number or tag of nodes and elements, if the format has them.

    Raises EquivalentError for another format or unit, and for holes that the format lacks.
    """
    if form not in FORMATS:
        raise EquivalentError(f"format '{form}' is none of {', '.join(FORMATS)}")
    write, lacking = FORMATS[form]
    left_out = tuple(
        f"{law} of the contact, which the export for {form} does not have"
        for law in lacking
        if any(getattr(point, law) > 0.0 for point in contacts.points)
    )
    own = replace(contacts, left_out=left_out)
    return write(own, unit_system(unit), first_number), left_out
