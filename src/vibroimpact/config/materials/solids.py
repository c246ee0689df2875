"""Metals of heat exchangers by name: Young's modulus against temperature, Poisson's ratio, density.

Densities are those at room temperature: a tube's mass per length, by its dimensions at room
temperature, does not change with heat. A Poisson's ratio of 0.3 is taken if the sources give
none; the bending of a slender tube hardly depends on it.
"""

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
    source: of modulus, Poisson's ratio and density.
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


# ASME Boiler and Pressure Vessel Code, section II part D (metric), 2025: tables TM-1, TM-4, TM-5.
CARBON_STEEL = _linear_between(
    *((-75, 209), (25, 202), (100, 198), (150, 195), (200, 192), (250, 189), (300, 185)),
    *((350, 179), (400, 171), (450, 162), (500, 151), (550, 137)),
)
CHROMIUM_STEEL = _linear_between(
    *((-75, 208), (25, 201), (100, 195), (150, 192), (200, 189), (250, 186), (300, 182)),
    *((350, 178), (400, 173), (450, 166), (500, 157), (550, 145), (600, 131)),
)
AUSTENITIC_STEEL = _linear_between(
    *((-75, 201), (25, 195), (100, 189), (150, 186), (200, 183), (250, 179), (300, 176)),
    *((350, 172), (400, 169), (450, 165), (500, 160), (550, 156), (600, 151), (650, 146)),
    (700, 140),
)
ALLOY_690 = _linear_between(
    *((-75, 215), (25, 208), (100, 204), (150, 201), (200, 199), (250, 196), (300, 193)),
    *((350, 191), (400, 188), (450, 185), (500, 181), (550, 178), (600, 174)),
)
ALLOY_800 = _linear_between(
    *((-75, 202), (25, 196), (100, 192), (150, 189), (200, 187), (250, 184), (300, 182)),
    *((350, 179), (400, 176), (450, 173), (500, 170), (550, 167), (600, 164)),
)
TITANIUM = _linear_between(  # below 25 °C, as at 25 °C
    *((25, 107), (100, 103), (150, 101), (200, 97), (250, 93), (300, 88), (350, 84), (400, 80)),
)
TABLE = "E: ASME BPVC II-D (metric), table"
PRD = "table PRD"


def _austenitic(density: float, number: str) -> Solid:
    """Return an austenitic steel of the 18-8 or 16-12-2 kind, with or without low carbon."""
    source = f"{TABLE} TM-1, group G; nu: EN 1993-1-4; density: EN 10088-1, {number}"
    return Solid((-75.0, 700.0), AUSTENITIC_STEEL, _constant(0.3), density, source)


def _chromium_steel(group: str) -> Solid:
    """Return a ferritic or martensitic steel with 12 to 13 % chromium."""
    source = f"{TABLE} TM-1, group F ({group}); nu and density: {PRD}, 400 series"
    return Solid((-75.0, 600.0), CHROMIUM_STEEL, _constant(0.31), 7750.0, source)


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
        (-75.0, 600.0),
        ALLOY_690,
        _constant(0.31),
        8190.0,
        f"{TABLE} TM-4, N06690; nu: {PRD}; density: Special Metals, INCONEL alloy 690",
    ),
    "incoloy_800": Solid(
        (-75.0, 600.0),
        ALLOY_800,
        _constant(0.31),
        7940.0,
        f"{TABLE} TM-4, N08800; nu: {PRD}; density: Special Metals, INCOLOY alloys 800H and 800HT"
        " (7.94 g/cm3)",
    ),
    "stainless_steel_304": _austenitic(7900.0, "1.4301"),
    "stainless_steel_304L": _austenitic(7900.0, "1.4307"),
    "stainless_steel_316": _austenitic(8000.0, "1.4401"),
    "stainless_steel_316L": _austenitic(8000.0, "1.4404"),
    "stainless_steel_405": _chromium_steel("12Cr-Al"),
    "stainless_steel_410": _chromium_steel("13Cr"),
    "carbon_steel": Solid(
        (-75.0, 550.0),
        CARBON_STEEL,
        _constant(0.3),
        7750.0,
        f"{TABLE} TM-1, carbon steels with C <= 0.30 %; nu and density: {PRD}",
    ),
    "zircaloy_4": Solid(
        (20.0, 800.0),
        _zircaloy,
        _zircaloy_poisson,
        6520.0,
        "E and G: MATPRO, CELMOD and CSHEAR, NUREG/CR-6150 vol. 4; density: FRAPCON (NRC), the"
        " theoretical density of zircaloy",
    ),
    "titanium_grade_2": Solid(
        (15.0, 400.0),
        TITANIUM,
        _constant(0.32),
        4510.0,
        f"{TABLE} TM-5, R50400; nu and density: {PRD}",
    ),
}
