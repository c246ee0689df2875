"""Systems of units that finite-element models are written in."""

from __future__ import annotations

from dataclasses import dataclass

from ..answer import EquivalentError


@dataclass(frozen=True)
class UnitSystem:
    """A consistent system of units.

    name: in a comment. length: of 1 m. stiffness, damping: of 1 N/m and 1 N s/m.
    """

    name: str
    length: float
    stiffness: float
    damping: float


UNIT_SYSTEMS = {
    "m": UnitSystem("m, N, kg, s", 1.0, 1.0, 1.0),
    "mm": UnitSystem("mm, N, t, s", 1.0e3, 1.0e-3, 1.0e-3),
}


def unit_system(name: str) -> UnitSystem:
    """Return a system by the name of its length. Raises EquivalentError for another name."""
    if name not in UNIT_SYSTEMS:
        raise EquivalentError(f"unit '{name}' is none of {', '.join(UNIT_SYSTEMS)}")
    return UNIT_SYSTEMS[name]
