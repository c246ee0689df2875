"""Metals of heat exchangers by name: Young's modulus against temperature, Poisson's ratio, density.

Densities are those at room temperature: a tube's mass per length, by its dimensions at room
temperature, does not change with heat. A Poisson's ratio of 0.3 is taken where the sources give
none; the bending of a slender tube hardly depends on it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

KELVIN = 273.15  # K at 0 °C
GPA = 1.0e9

Law = Callable[[float], float]  # of a temperature in °C


@dataclass(frozen=True)
class Solid:
    """A metal.

    range_C: lowest and highest temperature in °C for which its modulus is known.
    young_modulus: Pa, of a temperature in °C.
    poisson_ratio: of a temperature in °C.
    density: kg/m³.
    source: where modulus, Poisson's ratio and density come from.
    """

    range_C: tuple[float, float]
    young_modulus: Law
    poisson_ratio: Law
    density: float
    source: str


@dataclass(frozen=True)
class SolidProperties:
    """Properties of a metal at a temperature: Pa, 1, kg/m³; the names are configuration keys."""

    young_modulus_Pa: float
    poisson_ratio: float
    density_kg_per_m3: float


def solid_properties(name: str, temperature_C: float) -> SolidProperties:
    """Return the SolidProperties of a named metal at a temperature in °C.

    Raises ValueError for an unknown name, with the known ones, and outside the range of
    temperature, with the range.
    """
    if name not in SOLIDS:
        raise ValueError(f"material '{name}' is unknown: known are {', '.join(SOLIDS)}")
    solid = SOLIDS[name]
    low, high = solid.range_C
    if not low <= temperature_C <= high:
        raise ValueError(
            f"{name} is known from {low:g} to {high:g} °C: for {temperature_C:g} °C, give"
            " young_modulus_Pa, poisson_ratio and density_kg_per_m3 instead of the name"
        )
    return SolidProperties(
        young_modulus_Pa=float(solid.young_modulus(temperature_C)),
        poisson_ratio=float(solid.poisson_ratio(temperature_C)),
        density_kg_per_m3=solid.density,
    )


def _constant(value: float) -> Law:
    """Return a property that does not change with temperature."""
    return lambda temperature_C: value


def _linear_between(*points: tuple[float, float]) -> Law:
    """Return Young's modulus in Pa between tabled (°C, GPa), on straight lines."""
    temperatures, moduli = np.array(points).T
    return lambda temperature_C: GPA * np.interp(temperature_C, temperatures, moduli)


def _inconel_600(temperature_C: float) -> float:
    """Return Young's modulus in Pa of alloy 600: the polynomial of CEA."""
    return 1.0e7 * (2.1421e4 - 3.8654 * temperature_C - 3.1636e-3 * temperature_C**2)


def _zircaloy(temperature_C: float) -> float:
    """Return Young's modulus in Pa of zircaloy in the alpha phase: CELMOD of MATPRO, neither cold
    worked nor oxidised nor irradiated.
    """
    return 1.088e11 - 5.475e7 * (temperature_C + KELVIN)


def _zircaloy_poisson(temperature_C: float) -> float:
    """Return Poisson's ratio of zircaloy: E / (2 G) - 1 with G of CSHEAR of MATPRO."""
    shear_modulus = 4.04e10 - 2.168e7 * (temperature_C + KELVIN)
    return _zircaloy(temperature_C) / (2.0 * shear_modulus) - 1.0


# ASME Boiler and Pressure Vessel Code, section II part D (metric), table TM-1.
CARBON_STEEL = _linear_between(
    *((-75, 209), (25, 202), (100, 198), (150, 195), (200, 192), (250, 189), (300, 185)),
    *((350, 179), (400, 171), (450, 162), (500, 151), (550, 137)),
)
AUSTENITIC_STEEL = _linear_between(
    *((-75, 201), (25, 195), (100, 189), (150, 186), (200, 183), (250, 179), (300, 176)),
    *((350, 172), (400, 169), (450, 165), (500, 160), (550, 156), (600, 151), (650, 146)),
    (700, 140),
)
TM_1 = "E: ASME BPVC II-D (metric), table TM-1"
ROOM = (15.0, 30.0)  # °C; for metals of which the sources give one modulus, at room temperature

SOLIDS: dict[str, Solid] = {
    "inconel_600": Solid(
        (20.0, 500.0),
        _inconel_600,
        _constant(0.3),
        8470.0,
        "E: CEA, DEN/CAD/DEC/SESC/LC2I DO 84 (2004), in MFront's Inconel600_YoungModulus; nu:"
        " code_aster validation manual V5.02.112; density: Special Metals, INCONEL alloy 600",
    ),
    "inconel_690": Solid(
        ROOM,
        _constant(211.0 * GPA),
        _constant(0.3),
        8190.0,
        "E and density: Special Metals, INCONEL alloy 690; nu: taken as that of alloy 600",
    ),
    "incoloy_800": Solid(
        ROOM,
        _constant(196.5 * GPA),
        _constant(0.3),
        7940.0,
        "E and density: Special Metals, INCOLOY alloys 800H and 800HT (28.5e3 ksi, 7.94 g/cm3);"
        " nu: taken as that of alloy 600",
    ),
    "stainless_steel_304": Solid(
        (-75.0, 700.0),
        AUSTENITIC_STEEL,
        _constant(0.3),
        7900.0,
        f"{TM_1}, group G; nu: EN 1993-1-4; density: EN 10088-1, 1.4301",
    ),
    "stainless_steel_316": Solid(
        (-75.0, 700.0),
        AUSTENITIC_STEEL,
        _constant(0.3),
        8000.0,
        f"{TM_1}, group G; nu: EN 1993-1-4; density: EN 10088-1, 1.4401",
    ),
    "carbon_steel": Solid(
        (-75.0, 550.0),
        CARBON_STEEL,
        _constant(0.3),
        7750.0,
        f"{TM_1}, carbon steels with C <= 0.30 %; nu and density: table PRD",
    ),
    "zircaloy_4": Solid(
        (20.0, 800.0),
        _zircaloy,
        _zircaloy_poisson,
        6520.0,
        "E and G: MATPRO, CELMOD and CSHEAR, NUREG/CR-6150 vol. 4; density: FRAPCON (NRC), the"
        " theoretical density of zircaloy",
    ),
}
