"""Named metals and fluids: printed values of their sources, and refusals with the known range."""

import numpy as np
import pytest

from vibroimpact.config.fluid import Fluid_name
from vibroimpact.config.material import Metal
from vibroimpact.config.materials.fluids import (
    DENSITIES,
    fluid_properties,
    liquid_density,
    vapour_density,
    water_viscosity,
)
from vibroimpact.config.materials.solids import SOLIDS, solid_properties


def test_names_of_the_configuration_are_those_of_the_tables():
    assert set(Metal.__args__) == set(SOLIDS)
    assert set(Fluid_name.__args__) == set(DENSITIES)


@pytest.mark.parametrize(
    ("name", "temperature", "modulus", "tolerance"),
    [
        ("carbon_steel", 25.0, 202.0, 1e-12),  # ASME II-D, TM-1
        ("carbon_steel", 275.0, 187.0, 1e-12),  # between 189 and 185
        ("stainless_steel_316", 300.0, 176.0, 1e-12),
        ("stainless_steel_304", 20.0, 195.3, 1e-12),  # between 201 at -75 and 195 at 25
        ("zircaloy_4", 26.85, 92.375, 1e-9),  # MATPRO at 300 K: 1.088e11 - 5.475e7 x 300
        ("inconel_600", 20.0, 214.0, 5e-3),  # ASME II-D gives 214 at room temperature
        ("inconel_600", 300.0, 199.77, 1e-4),  # 214.21 - 0.038654 T - 3.1636e-5 T²
        ("inconel_600", 350.0, 195.0, 0.01),  # ASME II-D, TM-4, N06600
        ("inconel_690", 25.0, 208.0, 1e-12),  # ASME II-D, TM-4, N06690
        ("inconel_690", 350.0, 191.0, 1e-12),
        ("inconel_690", 24.0, 211.0, 0.015),  # Special Metals, at room temperature
        ("incoloy_800", 25.0, 196.0, 1e-12),  # ASME II-D, TM-4, N08800
        ("incoloy_800", 350.0, 179.0, 1e-12),
        ("incoloy_800", 24.0, 28.5 * 6.894757, 3e-3),  # Special Metals, 28.5e3 ksi at 75 °F
        ("stainless_steel_304L", 350.0, 172.0, 1e-12),  # ASME II-D, TM-1, group G
        ("stainless_steel_316L", 275.0, 177.5, 1e-12),  # between 179 and 176
        ("stainless_steel_405", 350.0, 178.0, 1e-12),  # ASME II-D, TM-1, group F
        ("stainless_steel_410", 25.0, 201.0, 1e-12),
        ("stainless_steel_410", 20.0, 215.0, 0.07),  # EN 10088-1, 1.4006
        ("titanium_grade_2", 20.0, 107.0, 1e-12),  # ASME II-D, TM-5, R50400
        ("titanium_grade_2", 350.0, 84.0, 1e-12),
    ],
)
def test_moduli_are_the_printed_ones(name, temperature, modulus, tolerance):
    found = solid_properties(name, temperature).young_modulus_Pa
    assert found == pytest.approx(modulus * 1.0e9, rel=tolerance)


@pytest.mark.parametrize("name", SOLIDS)
def test_metals_are_known_from_room_to_operating_temperature(name):
    cold, hot = (solid_properties(name, temperature) for temperature in (20.0, 350.0))
    assert hot.young_modulus_Pa < cold.young_modulus_Pa


def test_poissons_ratio_of_zircaloy_follows_both_moduli():
    # MATPRO at 300 K: G = 3.3896e10 Pa, nu = 9.2375e10 / (2 G) - 1
    assert solid_properties("zircaloy_4", 26.85).poisson_ratio == pytest.approx(0.3626239, rel=1e-6)


@pytest.mark.parametrize("name", SOLIDS)
def test_metals_are_plausible_over_their_range(name):
    low, high = SOLIDS[name].range_C
    table = [solid_properties(name, temperature) for temperature in np.linspace(low, high, 9)]
    moduli = [each.young_modulus_Pa for each in table]
    assert all(one >= other for one, other in zip(moduli[:-1], moduli[1:], strict=True))
    assert all(0.25 < each.poisson_ratio < 0.5 for each in table)
    assert 5e10 < moduli[-1] <= moduli[0] < 2.2e11
    assert SOLIDS[name].source.startswith("E") and "density" in SOLIDS[name].source
    with pytest.raises(ValueError, match=f"{name} is known from {low:g} to {high:g} °C"):
        solid_properties(name, high + 1.0)


def test_unknown_names_are_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="'unobtainium' is unknown: known are inconel_600"):
        solid_properties("unobtainium", 20.0)
    with pytest.raises(ValueError, match="'oil' is unknown: known are water, steam"):
        fluid_properties("oil", 20.0)
    with pytest.raises(ValueError, match="water is known from 0.01 to 350 °C: for 360 °C"):
        fluid_properties("water", 360.0)


@pytest.mark.parametrize(
    ("kelvin", "density", "microPa_s"),
    [  # IAPWS R12-08, table 4
        (298.15, 998.0, 889.735100),
        (298.15, 1200.0, 1437.649467),
        (373.15, 1000.0, 307.883622),
        (433.15, 1.0, 14.538324),
        (433.15, 1000.0, 217.685358),
        (873.15, 1.0, 32.619287),
        (873.15, 600.0, 77.430195),
    ],
)
def test_viscosity_is_that_of_the_release(kelvin, density, microPa_s):
    assert water_viscosity(kelvin, density) == pytest.approx(microPa_s * 1e-6, rel=1e-8)


def test_saturation_densities_are_those_of_the_release():
    # IAPWS SR1-86, table 1
    for kelvin, liquid, vapour in (
        (273.16, 999.789, 0.00485426),
        (373.1243, 958.365, 0.597586),
        (647.096, 322.0, 322.0),
    ):
        assert liquid_density(kelvin) == pytest.approx(liquid, rel=1e-6)
        assert vapour_density(kelvin) == pytest.approx(vapour, rel=2e-6)


@pytest.mark.parametrize(
    ("temperature", "density", "viscosity"),
    # Another formulation: IAPWS-IF97 with R12-08, saturated liquid
    [(20.0, 998.161, 1.00163e-3), (150.0, 917.007, 1.82610e-4), (300.0, 712.138, 8.5856e-5)],
)
def test_saturated_water_agrees_with_the_industrial_formulation(temperature, density, viscosity):
    water = fluid_properties("water", temperature)
    assert water.density_kg_per_m3 == pytest.approx(density, rel=5e-4)
    assert water.viscosity_Pa_s == pytest.approx(viscosity, rel=1e-3)
