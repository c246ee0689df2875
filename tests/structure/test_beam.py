"""The beam element against closed forms: matrices, rigid motions and exact static deflections."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.structure.beam_elements import (
    bending_mass,
    bending_shapes,
    bending_stiffness,
    element_matrices,
    interpolation,
    section_beam,
)

SECTION = SimpleNamespace(
    outer_diameter_m=0.02222, wall_thickness_m=0.00127, shear_coefficient=0.53
)
MATERIAL = SimpleNamespace(young_modulus_Pa=2.02e11, poisson_ratio=0.3, density_kg_per_m3=8330.0)
LENGTH = 0.031  # short: shear parameter of order one


BAR = SimpleNamespace(
    kind="rectangle", sides_m=(0.012, 0.030), first_axis=None, shear_coefficient=None
)
COWPER_BAR = 10.0 * 1.3 / (12.0 + 11.0 * 0.3)


@pytest.fixture(
    params=[
        (section, theory)
        for section in (SECTION, BAR)
        for theory in ("timoshenko", "euler_bernoulli")
    ],
    ids=["tube-timoshenko", "tube-euler", "bar-timoshenko", "bar-euler"],
)
def beam(request):
    """Return the beam of the stand-in tube and of a rectangular bar, by both theories."""
    section, theory = request.param
    return section_beam(section, MATERIAL, theory)


def tilted_axes():
    """Return (3, 3) right-handed axes along no global axis."""
    tangent = np.array([1.0, 2.0, -2.0]) / 3.0
    first = np.array([2.0, 1.0, 2.0]) / 3.0
    return np.array([tangent, first, np.cross(tangent, first)])


def test_tube_constants_are_those_of_the_annulus():
    beam = section_beam(SECTION, MATERIAL, "timoshenko")
    assert beam.planes[0] == beam.planes[1]
    plane = beam.planes[0]
    assert beam.mass_per_length == pytest.approx(
        8330.0 * 8.358682e-5, rel=1e-6
    )  # pi (0.02222 - 0.00127) 0.00127 m²
    assert plane.bending_stiffness == pytest.approx(
        2.02e11 * np.pi / 64.0 * (0.02222**4 - 0.01968**4), rel=1e-12
    )
    assert plane.shear_stiffness == pytest.approx(0.53 * 2.02e11 / 2.6 * 8.358682e-5, rel=1e-6)
    assert plane.fibre_stiffness == pytest.approx(2.02e11 * 0.01111, rel=1e-12)


def test_bar_constants_are_those_of_the_rectangle():
    beam = section_beam(BAR, MATERIAL, "timoshenko")
    area = 0.012 * 0.030
    assert beam.mass_per_length == pytest.approx(8330.0 * area, rel=1e-12)
    # b h³ / 12, with h the side along the deflection
    assert [plane.bending_stiffness for plane in beam.planes] == pytest.approx(
        [2.02e11 * 0.030 * 0.012**3 / 12.0, 2.02e11 * 0.012 * 0.030**3 / 12.0], rel=1e-12
    )
    assert [plane.fibre_stiffness for plane in beam.planes] == pytest.approx(
        [2.02e11 * 0.006, 2.02e11 * 0.015], rel=1e-12
    )
    assert [plane.shear_stiffness for plane in beam.planes] == pytest.approx(
        [COWPER_BAR * 2.02e11 / 2.6 * area] * 2, rel=1e-12
    )
    # Timoshenko and Goodier, art. 109: k1 a b³ with k1 = 0.249 for a = 2.5 b
    assert beam.torsion_stiffness == pytest.approx(
        2.02e11 / 2.6 * 0.249 * 0.030 * 0.012**3, rel=2e-3
    )


@pytest.mark.parametrize("theory", ["timoshenko", "euler_bernoulli"])
def test_bending_mass_is_friedman_and_kosmatka_closed_form(theory):
    """With phi = 0 that of textbooks: m L / 420 (156, 22 L, 54, -13 L, ...)."""
    plane = section_beam(SECTION, MATERIAL, theory).planes[0]
    phi, length = plane.shear_parameter(LENGTH), LENGTH
    a, b = 70 * phi**2 + 147 * phi + 78, (35 * phi**2 + 77 * phi + 44) * length / 4
    c, d = 35 * phi**2 + 63 * phi + 27, -(35 * phi**2 + 63 * phi + 26) * length / 4
    e, f = (7 * phi**2 + 14 * phi + 8) * length**2 / 4, -(7 * phi**2 + 14 * phi + 6) * length**2 / 4
    translation = np.array([[a, b, c, d], [b, e, -d, f], [c, -d, a, -b], [d, f, -b, e]])
    g, h = 36.0, -(15 * phi - 3) * length
    i, j = (10 * phi**2 + 5 * phi + 4) * length**2, (5 * phi**2 - 5 * phi - 1) * length**2
    rotation = np.array([[g, h, -g, h], [h, i, -h, j], [-g, -h, g, -h], [h, j, -h, i]])
    expected = (
        plane.mass_per_length * length / 210.0 * translation
        + plane.rotary_inertia / (30.0 * length) * rotation
    ) / (1 + phi) ** 2
    assert np.allclose(bending_mass(plane, length), expected, rtol=1e-12, atol=1e-18)


def test_stiffness_is_the_energy_of_the_shape_functions(beam):
    plane = beam.planes[1]
    points, weights = np.polynomial.legendre.leggauss(5)
    xi, weights = 0.5 * (points + 1.0), 0.5 * weights * LENGTH
    phi, step = plane.shear_parameter(LENGTH), 1.0e-6
    _, rotation, curvature = bending_shapes(xi, LENGTH, phi)
    slope = (
        bending_shapes(xi + step, LENGTH, phi)[0] - bending_shapes(xi - step, LENGTH, phi)[0]
    ) / (2.0 * step * LENGTH)
    energy = plane.bending_stiffness * (curvature * weights) @ curvature.T
    if np.isfinite(plane.shear_stiffness):
        energy += plane.shear_stiffness * ((slope - rotation) * weights) @ (slope - rotation).T
    else:
        assert np.allclose(slope, rotation, atol=1e-7)
    stiffness = bending_stiffness(plane, LENGTH)
    assert np.allclose(energy, stiffness, rtol=1e-6, atol=1e-6 * np.abs(stiffness).min())


def test_rigid_motion_costs_no_energy_and_has_the_element_mass(beam):
    axes = tilted_axes()
    stiffness, mass = element_matrices(beam, LENGTH, axes)
    end = LENGTH * axes[0]
    motions = np.zeros((12, 6))
    for axis in range(3):
        unit = np.eye(3)[axis]
        motions[:, axis] = np.concatenate([unit, np.zeros(3), unit, np.zeros(3)])
        motions[:, 3 + axis] = np.concatenate([np.zeros(3), unit, np.cross(unit, end), unit])
    assert np.abs(stiffness @ motions).max() < 1e-12 * np.abs(stiffness).max()
    inertia = motions.T @ mass @ motions
    assert np.allclose(
        inertia[:3, :3], beam.mass_per_length * LENGTH * np.eye(3), rtol=0, atol=1e-14
    )
    # about the first node, across the tangent: m L³/3 of the line and rho I L of the section; along
    # it the polar inertia
    about_second, about_first = (
        beam.mass_per_length * LENGTH**3 / 3.0 + plane.rotary_inertia * LENGTH
        for plane in beam.planes
    )
    turning = axes @ inertia[3:, 3:] @ axes.T
    assert np.allclose(
        turning,
        np.diag([beam.torsion_inertia * LENGTH, about_first, about_second]),
        rtol=0,
        atol=1e-12 * about_first,
    )


@pytest.mark.parametrize("across", [1, 2])
def test_one_element_gives_the_exact_cantilever_everywhere(beam, across):
    axes, load, plane = tilted_axes(), 3.0, beam.planes[across - 1]
    stiffness, _ = element_matrices(beam, LENGTH, axes)
    force = np.zeros(12)
    force[6:9] = load * axes[across]
    dofs = np.zeros(12)
    dofs[6:] = np.linalg.solve(stiffness[6:, 6:], force[6:])
    for xi in (0.0, 0.37, 1.0):
        displacement, gradient = (rows @ dofs for rows in interpolation(beam, LENGTH, axes, xi))
        x = xi * LENGTH
        exact = load * (
            x**2 * (3.0 * LENGTH - x) / (6.0 * plane.bending_stiffness) + x / plane.shear_stiffness
        )
        tip = load * LENGTH**3 / plane.bending_stiffness
        assert np.allclose(displacement, exact * axes[across], rtol=0, atol=1e-10 * tip)
        curvature = (
            load * (LENGTH - x) / plane.bending_stiffness
        )  # turns about tangent x transverse
        assert np.allclose(
            gradient,
            curvature * np.cross(axes[0], axes[across]),
            rtol=0,
            atol=1e-10 * tip / LENGTH**2,
        )


def test_axial_force_and_torque_give_bar_and_rod_flexibility(beam):
    stiffness, _ = element_matrices(beam, LENGTH, np.eye(3))
    flexibility = np.linalg.inv(stiffness[6:, 6:])
    assert flexibility[0, 0] == pytest.approx(LENGTH / beam.axial_stiffness, rel=1e-9)
    assert flexibility[3, 3] == pytest.approx(LENGTH / beam.torsion_stiffness, rel=1e-9)


def test_axial_and_torsion_mass_are_consistent():
    beam = section_beam(SECTION, MATERIAL, "timoshenko")
    _, mass = element_matrices(beam, LENGTH, np.eye(3))
    for dof, inertia in ((0, beam.mass_per_length), (3, beam.torsion_inertia)):
        expected = inertia * LENGTH * np.array([[1.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 1.0 / 3.0]])
        assert np.allclose(
            mass[np.ix_([dof, dof + 6], [dof, dof + 6])], expected, rtol=1e-12, atol=0
        )


def test_very_stiff_shear_is_euler_bernoulli():
    thick = section_beam(BAR, MATERIAL, "timoshenko")
    planes = [replace(plane, shear_stiffness=1.0e30, rotary_inertia=0.0) for plane in thick.planes]
    slender = replace(thick, planes=tuple(planes))
    thin = section_beam(BAR, MATERIAL, "euler_bernoulli")
    for one, other in zip(
        element_matrices(slender, LENGTH, tilted_axes()),
        element_matrices(thin, LENGTH, tilted_axes()),
        strict=True,
    ):
        assert np.allclose(one, other, rtol=1e-10, atol=0)


def test_impossible_tubes_are_named():
    with pytest.raises(ValueError, match="0.02 m must lie between 0 and the outer radius"):
        section_beam(
            SimpleNamespace(outer_diameter_m=0.02222, wall_thickness_m=0.02, shear_coefficient=0.5),
            MATERIAL,
            "timoshenko",
        )
    with pytest.raises(ValueError, match="theory 'rayleigh' is unknown"):
        section_beam(SECTION, MATERIAL, "rayleigh")
