"""Still fluids inside and outside a tube, from the configuration to frequencies and damping."""

import copy

import numpy as np
import pytest
from scipy import special
from scipy.sparse.linalg import spsolve

from evidence.validation.reference.frequencies import ROOTS
from tests.support.straight_path import straight_path
from vibroimpact.config.materials.fluids import fluid_properties
from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.effects.fluid_added_mass_damping import EFFECT
from vibroimpact.excitation.force_vectors import force_vector
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.fluid import (
    added_mass_coefficients,
    equivalent_diameter_ratio,
    viscous_damping_ratio,
)
from vibroimpact.structure.tube import build_structure

DIAMETER, WALL, LENGTH = 0.02222, 0.00127, 1.2
INNER = DIAMETER - 2.0 * WALL
METAL = 8330.0 * np.pi * (DIAMETER - WALL) * WALL  # kg/m
WATER = 998.158052  # kg/m³ at 20 °C
VISCOSITY = 1.001629e-3  # Pa s
TUBE = {"outer_diameter_m": DIAMETER, "wall_thickness_m": WALL}
IN_WATER = {"kind": "outside", "name": "water"}
STUDY = {
    "study": "tube_in_water",
    "structure": straight_path(
        LENGTH,
        [0.0, 0.0, 1.0],
        TUBE,
        (2.02e11, 0.3, 8330.0),
        ends=("pinned", "pinned"),
        theory="euler_bernoulli",
        mesh={"elements_per_span": 40, "elements_per_bend": 1},
    ),
    "damping": {"kind": "modal", "other_ratio": 0.003},
    "points": {"middle": [0.0, 0.0, 0.6]},
    "excitation": {
        "kind": "band_limited",
        "point": "middle",
        "direction": [1.0, 0.0, 0.0],
        "band_Hz": [5.0, 200.0],
    },
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3]},
    "record": {"sensors": {"points": ["middle"], "directions": ["x", "y"]}},
}


def study(*fluids, **changes):
    """Return the Config of the tube with fluids and changed keys of its structure."""
    data = copy.deepcopy(STUDY)
    data["structure"] |= {"fluid": list(fluids), **changes}
    return check_config(data, "tube.yaml")


def pinned_frequency(mass_per_length, order=1):
    """Return Hz of mode `order` of the pinned tube with a mass per length in kg/m."""
    second_moment = np.pi / 64.0 * (DIAMETER**4 - INNER**4)
    wave = ROOTS["pinned-pinned"][order - 1] / LENGTH
    return wave**2 * np.sqrt(2.02e11 * second_moment / mass_per_length) / (2.0 * np.pi)


def confined(**keys):
    """Return (added mass coefficient, De/D) of the tube with a confinement."""
    confinement, section = StageSettings(keys), StageSettings({"kind": "tube", **TUBE})
    first, second = added_mass_coefficients(confinement, section)
    assert first == second
    return first, equivalent_diameter_ratio(confinement, section)


def test_a_tube_full_of_water_has_the_frequency_of_its_mass():
    inside = WATER * np.pi * INNER**2 / 4.0
    model = build_model(study({"kind": "inside", "name": "water", "temperature_C": 20.0}))
    for order in (1, 2, 3):
        exact = pinned_frequency(METAL + inside, order)
        assert model.frequencies[2 * order - 2 : 2 * order] == pytest.approx([exact] * 2, rel=2e-5)
    assert model.damping == pytest.approx(2.0 * 0.003 * model.omega, rel=1e-12)


def test_a_tube_in_much_water_carries_what_it_displaces():
    outside = WATER * np.pi * DIAMETER**2 / 4.0
    model = build_model(study(IN_WATER))
    assert model.frequencies[:2] == pytest.approx([pinned_frequency(METAL + outside)] * 2, rel=2e-5)


def test_a_tube_in_a_bundle_carries_more_and_is_damped():
    pitch = 1.44 * DIAMETER
    model = build_model(
        study(
            {"kind": "inside", "density_kg_per_m3": 700.0},
            IN_WATER | {"confinement": {"kind": "bundle", "pitch_m": pitch}},
        )
    )
    ratio = (0.96 + 0.5 * 1.44) * 1.44  # 2.4192
    outside = WATER * np.pi * DIAMETER**2 / 4.0 * (ratio**2 + 1.0) / (ratio**2 - 1.0)
    total = METAL + 700.0 * np.pi * INNER**2 / 4.0 + outside
    frequency = pinned_frequency(total)
    assert model.frequencies[:2] == pytest.approx([frequency] * 2, rel=2e-5)
    factor = (1.0 + ratio**-3) / (1.0 - ratio**-2) ** 2
    damping = (
        np.pi
        / np.sqrt(8.0)
        * (WATER * DIAMETER**2 / total)
        * np.sqrt(2.0 * VISCOSITY / WATER / (np.pi * frequency * DIAMETER**2))
        * factor
    )
    found = model.damping[:2] / (2.0 * model.omega[:2])
    assert found == pytest.approx([0.003 + damping] * 2, rel=1e-5)
    # Each mode at its own frequency: a quarter of the time, half the ratio.
    second = model.damping[2] / (2.0 * model.omega[2]) - 0.003
    assert second == pytest.approx(0.5 * damping, rel=1e-4)


def test_added_mass_of_much_fluid_is_the_displaced_one():
    assert confined(kind="unconfined") == (1.0, np.inf)
    assert confined(kind="annulus", equivalent_diameter_m=1.0e3)[0] == pytest.approx(1.0, abs=1e-8)
    assert confined(kind="annulus", equivalent_diameter_m=1.01 * DIAMETER)[0] > 99.0
    # P/D 1.5: De/D 2.565 and 2.865
    for pattern, ratio in (("triangular", 2.565), ("square", 2.865)):
        mass, diameter = confined(kind="bundle", pitch_m=1.5 * DIAMETER, pattern=pattern)
        assert diameter == pytest.approx(ratio, rel=1e-12)
        assert mass == pytest.approx((ratio**2 + 1.0) / (ratio**2 - 1.0), rel=1e-12)


def oscillating_force(ratio, stokes):
    """Return H: the force of a viscous fluid on an oscillating circle in a channel at rest, over
    that of the displaced fluid; its real part is the added mass, minus its imaginary part the
    damping. Unsteady Stokes flow, solved for its four constants (Chen and others 1976).

    ratio: outer over inner diameter. stokes: f D² / nu.
    """
    wave = np.sqrt(0.5j * np.pi * stokes)  # of radius 1: sqrt(i omega R²/nu)
    # Stream function (a r + b / r + c I1(wave r) + d K1(wave r)) sin(angle), scaled Bessel
    # functions; both velocities at r = 1 (unit velocity) and at the channel (at rest).
    rows = []
    for radius in (1.0, ratio):
        grow, decay = np.exp(wave.real * (radius - ratio)), np.exp(-wave.real * (radius - 1.0))
        i1, i0 = (special.ive(order, wave * radius) * grow for order in (1, 0))
        turn = np.exp(-1j * wave.imag * radius)  # kve is scaled by exp(z), ive by exp(-|Re z|)
        k1, k0 = (special.kve(order, wave * radius) * decay * turn for order in (1, 0))
        rows.append([1.0, radius**-2, i1 / radius, k1 / radius])
        rows.append([1.0, -(radius**-2), wave * i0 - i1 / radius, -wave * k0 - k1 / radius])
    _, b, _, _ = np.linalg.solve(np.array(rows), np.array([1.0, 1.0, 0.0, 0.0]))
    # The pressure of the part without vorticity, -i omega rho (a r - b / r), and the shear stress
    # at the wall add up to the force of the displaced fluid times 1 - 2 b, along the velocity.
    return 2.0 * b - 1.0


@pytest.mark.parametrize("ratio", [1.3, 1.5, 2.4, 4.0, 30.0])
def test_damping_approaches_the_exact_viscous_flow(ratio):
    inviscid, damping = [], []
    for stokes in (2.0e3, 2.0e5):
        force = oscillating_force(ratio, stokes)
        exact = -force.imag * np.pi / 8.0  # zeta of rho = m = D = 1: displaced fluid pi / 4
        found = viscous_damping_ratio(stokes, 1.0, 1.0, (1.0, 1.0), ratio)
        damping.append(found / exact - 1.0)
        inviscid.append((ratio**2 + 1.0) / (ratio**2 - 1.0) / force.real - 1.0)
    # What is left out is of the order of the boundary layer: a tenth at a hundred times f.
    assert damping[1] / damping[0] == pytest.approx(0.1, abs=0.012)
    assert inviscid[1] / inviscid[0] == pytest.approx(0.1, abs=0.015)
    assert abs(damping[1]) < 0.02


def test_damping_in_much_fluid_is_stokes_law():
    # Stokes (1851), first order: -Im(H) = 4 / sqrt(pi beta), beta = f D² / nu
    frequency, kinematic = 40.0, 1.0e-6
    beta = frequency * DIAMETER**2 / kinematic
    exact = 4.0 / np.sqrt(np.pi * beta) * (1000.0 * np.pi * DIAMETER**2 / 4.0) / (2.0 * 0.9)
    found = viscous_damping_ratio(frequency, DIAMETER, 0.9, (1000.0, kinematic))
    assert found == pytest.approx(exact, rel=1e-12)


def test_fluid_over_half_the_tube_is_half_of_it():
    lower, upper = {"to_m": [0.0, 0.0, 0.6]}, {"from_m": [0.0, 0.0, 1.2], "to_m": [0.0, 0.0, 0.6]}
    half, other = (build_model(study(IN_WATER | stretch)) for stretch in (lower, upper))
    assert half.frequencies[:6] == pytest.approx(other.frequencies[:6], rel=1e-7)
    # To first order in the added mass, a mode of the pinned tube feels half of it.
    thin = {"kind": "outside", "density_kg_per_m3": 1.0, "viscosity_Pa_s": 1.0e-6}
    model = build_model(study(thin | lower))
    total = METAL + 0.5 * np.pi * DIAMETER**2 / 4.0
    assert model.frequencies[0] == pytest.approx(pinned_frequency(total), rel=2e-5)
    ratio = 0.5 * viscous_damping_ratio(model.frequencies[0], DIAMETER, total, (1.0, 1.0e-6))
    found = model.damping[0] / (2.0 * model.omega[0]) - 0.003
    assert found == pytest.approx(ratio, rel=1e-4)


def structure_mass(*fluids, direction=0):
    """Return the mass per length in kg/m of the free tube along x (0), y (1) or z (2)."""
    free = {"kind": "free"}
    structure = build_structure(study(*fluids, start=free, end=free))
    return structure.inertia[direction].reshape(-1, 6)[:, direction].sum() / LENGTH


def test_a_fluid_outside_does_not_move_along_the_tube():
    assert structure_mass(IN_WATER, direction=2) == pytest.approx(METAL, rel=1e-9)
    full = {"kind": "inside", "name": "water"}
    assert structure_mass(full, direction=2) == pytest.approx(
        METAL + WATER * np.pi * INNER**2 / 4.0, rel=1e-6
    )


def test_a_shaken_vessel_carries_a_tube_as_heavy_as_water():
    # m a = rho V a + Ca rho V (a - x'') for fluid that moves with the base: a solid as heavy as the
    # fluid stays where the fluid is, whatever the added mass.
    neutral = study(
        IN_WATER | {"confinement": {"kind": "bundle", "pitch_m": 0.03}},
        section={"kind": "round", "diameter_m": DIAMETER},
        material={"young_modulus_Pa": 2.0e9, "poisson_ratio": 0.3, "density_kg_per_m3": WATER},
    )
    structure, rows = build_structure(neutral), None
    driven = {
        obstacles: force_vector(
            structure,
            rows,
            StageSettings(
                {"kind": "base_motion", "direction": [1.0, 0.0, 0.0], "obstacles": obstacles}
            ),
        )
        for obstacles in ("moving", "fixed")
    }
    assert driven["fixed"].sum() < 0.0
    assert np.abs(driven["moving"]).max() < 1e-6 * np.abs(driven["fixed"]).max()


def test_a_blade_in_water_takes_two_coefficients():
    blade = {"kind": "rectangle", "sides_m": [0.004, 0.030]}
    confinement = {"kind": "coefficient", "added_mass_coefficient": [5.9, 0.2]}
    free = {"kind": "free"}
    structure = build_structure(
        study(IN_WATER | {"confinement": confinement}, section=blade, start=free, end=free)
    )
    area = 0.004 * 0.030
    for axis, coefficient in enumerate((5.9, 0.2)):
        mass = structure.inertia[axis].reshape(-1, 6)[:, axis].sum() / LENGTH
        assert mass == pytest.approx((8330.0 + coefficient * WATER) * area, rel=1e-8)
    assert abs(structure.viscous).sum() == 0.0


def test_named_water_is_that_of_its_temperature():
    hot = study(IN_WATER | {"temperature_C": 280.0}).structure.fluid[0]
    assert hot.density_kg_per_m3 == fluid_properties("water", 280.0).density_kg_per_m3
    assert hot.viscosity_Pa_s == fluid_properties("water", 280.0).viscosity_Pa_s
    still = study(IN_WATER | {"viscosity_Pa_s": 0.0})
    model = build_model(still)
    assert model.damping == pytest.approx(2.0 * 0.003 * model.omega, rel=1e-12)


@pytest.mark.parametrize("fluids", [(), (IN_WATER | {"viscosity_Pa_s": 0.0},)])
def test_the_effect_of_a_fluid_adds_to_what_is_there(fluids):
    section = {"kind": "round", "diameter_m": DIAMETER}
    values = study(*fluids, section=section).model_dump()
    changed = EFFECT.apply(values, {"mass": 0.2, "damping": 3.0}, "tube")
    model = build_model(check_config(changed, "changed.yaml"))
    displaced = np.pi * DIAMETER**2 / 4.0
    total = (8330.0 + (WATER if fluids else 0.0)) * displaced + 0.2
    second_moment = np.pi / 64.0 * DIAMETER**4
    exact = (np.pi / LENGTH) ** 2 * np.sqrt(2.02e11 * second_moment / total)
    assert model.omega[0] == pytest.approx(exact, rel=2e-5)
    # 2 zeta omega = c / m, beside the modal damping
    assert model.damping[0] - 2.0 * 0.003 * model.omega[0] == pytest.approx(3.0 / total, rel=1e-6)


def test_a_static_load_does_not_feel_the_fluid():
    dry, wet = (build_structure(study(*fluids)) for fluids in ((), (IN_WATER,)))
    for structure in (dry, wet):
        row = structure.displacement_rows(0.6)[0]
        sag = row @ spsolve(structure.stiffness.tocsc(), row)
        second_moment = np.pi / 64.0 * (DIAMETER**4 - INNER**4)
        assert sag == pytest.approx(LENGTH**3 / (48.0 * 2.02e11 * second_moment), rel=1e-6)
