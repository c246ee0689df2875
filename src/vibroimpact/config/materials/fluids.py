"""Fluids by name: density and viscosity of saturated water and steam against temperature.

Sources:
- densities: IAPWS SR1-86(1992), Revised supplementary release on saturation properties of ordinary
  water substance; W. Wagner and A. Pruss, J. Phys. Chem. Ref. Data 22 (1993) 783-787, eqs. 2, 3.
- viscosity: IAPWS R12-08, Release on the IAPWS formulation 2008 for the viscosity of ordinary water
  substance, eqs. 10 to 12; its enhancement next to the critical point is left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

KELVIN = 273.15  # K at 0 °C
CRITICAL_TEMPERATURE = 647.096  # K
CRITICAL_DENSITY = 322.0  # kg/m³
RANGE_C = (0.01, 350.0)  # from the triple point to where the critical enhancement is below 0.1 %

# SR1-86: {power of 1 - T/Tc: coefficient}.
LIQUID = {
    1.0 / 3.0: 1.99274064,
    2.0 / 3.0: 1.09965342,
    5.0 / 3.0: -0.510839303,
    16.0 / 3.0: -1.75493479,
    43.0 / 3.0: -45.5170352,
    110.0 / 3.0: -6.74694450e5,
}
VAPOUR = {
    2.0 / 6.0: -2.03150240,
    4.0 / 6.0: -2.68302940,
    8.0 / 6.0: -5.38626492,
    18.0 / 6.0: -17.2991605,
    37.0 / 6.0: -44.7586581,
    71.0 / 6.0: -63.9201063,
}
# R12-08: coefficients of 1/T in the dilute gas, and of (1/T - 1)^i (rho - 1)^j, rows i, columns j.
DILUTE_GAS = (1.67752, 2.20462, 0.6366564, -0.241605)
FINITE_DENSITY = np.array(
    [
        [0.520094, 0.222531, -0.281378, 0.161913, -0.0325372, 0.0, 0.0],
        [0.0850895, 0.999115, -0.906851, 0.257399, 0.0, 0.0, 0.0],
        [-1.08374, 1.88797, -0.772479, 0.0, 0.0, 0.0, 0.0],
        [-0.289555, 1.26613, -0.489837, 0.0, 0.0698452, 0.0, -0.00435673],
        [0.0, 0.0, -0.257040, 0.0, 0.0, 0.00872102, 0.0],
        [0.0, 0.120573, 0.0, 0.0, 0.0, 0.0, -0.000593264],
    ]
)


@dataclass(frozen=True)
class FluidProperties:
    """Properties of a fluid at a temperature: kg/m³, Pa s; the names are configuration keys."""

    density_kg_per_m3: float
    viscosity_Pa_s: float


def fluid_properties(name: str, temperature_C: float) -> FluidProperties:
    """Return the FluidProperties of a named fluid, saturated at a temperature in °C.

    Raises ValueError for an unknown name, with the known ones, and outside the range of
    temperature, with the range.
    """
    if name not in DENSITIES:
        raise ValueError(f"fluid '{name}' is unknown: known are {', '.join(DENSITIES)}")
    low, high = RANGE_C
    if not low <= temperature_C <= high:
        raise ValueError(
            f"{name} is known from {low:g} to {high:g} °C: for {temperature_C:g} °C, give the"
            " fluid's density and viscosity instead of its name"
        )
    kelvin = temperature_C + KELVIN
    density = DENSITIES[name](kelvin)
    return FluidProperties(density, water_viscosity(kelvin, density))


def liquid_density(kelvin: float) -> float:
    """Return the density in kg/m³ of saturated liquid water. Source: SR1-86, eq. 2."""
    closeness = 1.0 - kelvin / CRITICAL_TEMPERATURE
    terms = (coefficient * closeness**power for power, coefficient in LIQUID.items())
    return CRITICAL_DENSITY * (1.0 + sum(terms))


def vapour_density(kelvin: float) -> float:
    """Return the density in kg/m³ of saturated steam. Source: SR1-86, eq. 3."""
    closeness = 1.0 - kelvin / CRITICAL_TEMPERATURE
    terms = (coefficient * closeness**power for power, coefficient in VAPOUR.items())
    return CRITICAL_DENSITY * float(np.exp(sum(terms)))


def water_viscosity(kelvin: float, density: float) -> float:
    """Return the dynamic viscosity in Pa s of water or steam at a density in kg/m³.

    Source: R12-08, eqs. 11 and 12.
    """
    reduced, dense = kelvin / CRITICAL_TEMPERATURE, density / CRITICAL_DENSITY
    gas = 100.0 * np.sqrt(reduced) / sum(h / reduced**i for i, h in enumerate(DILUTE_GAS))
    rows, columns = (np.arange(count) for count in FINITE_DENSITY.shape)
    powers = (1.0 / reduced - 1.0) ** rows[:, None] * (dense - 1.0) ** columns
    return float(1.0e-6 * gas * np.exp(dense * np.sum(FINITE_DENSITY * powers)))


DENSITIES: dict[str, Callable[[float], float]] = {"water": liquid_density, "steam": vapour_density}
