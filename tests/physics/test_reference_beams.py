"""Beams, U-bend and ring with published or closed-form frequencies, and the rate at which the error falls with the element size.

Euler-Bernoulli: fourth power. Timoshenko: second power, because a shear angle constant along an element follows the varying one of a
vibration to first order only; the constant is small for a slender tube (below 1e-5 of the first frequency at 20 elements per metre).
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

from vibroimpact.beam import element_matrices, tube_beam
from vibroimpact.ritz import eigenmodes, uncoupled_groups
from vibroimpact.structure import build_structure, element_geometry

TUBE = SimpleNamespace(outer_diameter_m=0.02222, wall_thickness_m=0.00127, shear_coefficient=0.53)
INCONEL = SimpleNamespace(young_modulus_Pa=2.02e11, poisson_ratio=0.3, density_kg_per_m3=8330.0)
ROOTS = {("clamped", "pinned"): (3.926602312, 7.068582746, 10.210176123), ("clamped", "clamped"): (4.730040745, 7.853204624, 10.995607838),
         ("clamped", "free"): (1.875104069, 4.694091133, 7.854757438), ("pinned", "pinned"): (np.pi, 2.0 * np.pi, 3.0 * np.pi)}


def path(segments, theory, ends, elements):
    """Return the Structure of a tube without supports; elements = (per straight segment, per bend)."""
    start, end = (SimpleNamespace(kind=kind) for kind in ends)
    structure = SimpleNamespace(kind="path", theory=theory, section=TUBE, material=INCONEL, start_m=[0.0, 0.0, 0.0],
                                start_direction=[0.0, 0.0, 1.0], segments=segments, start=start, end=end,
                                mesh=SimpleNamespace(elements_per_span=elements[0], elements_per_bend=elements[1]))
    return build_structure(SimpleNamespace(structure=structure, supports=[]))


def frequencies_by_plane(structure, to_Hz):
    """Return [(frequency,) Hz] of each uncoupled group, the group that moves along x first, then along y."""
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    return [eigenmodes(group.stiffness, group.mass, to_Hz)[0] / (2.0 * np.pi) for group in groups]


def straight_beam(ends, theory, elements, length=1.0):
    """Return (mode,) Hz of bending in one plane of a straight tube of `length` m."""
    structure = path([SimpleNamespace(kind="straight", length_m=length)], theory, ends, (elements, 1))
    one, other = frequencies_by_plane(structure, 5000.0 / length**2)[:2]
    assert one == pytest.approx(other, rel=1e-6)  # a circular tube bends alike in both planes
    return one


def pinned_timoshenko(order, length):
    """Return Hz of mode `order` of a simply supported Timoshenko beam with rotary inertia, the lower root of the exact quadratic."""
    beam = tube_beam(TUBE, INCONEL, "timoshenko")
    wave = (order * np.pi / length) ** 2
    coupling = beam.mass_per_length + wave * (beam.rotary_inertia + beam.mass_per_length * beam.bending_stiffness / beam.shear_stiffness)
    squares = np.roots([beam.mass_per_length * beam.rotary_inertia / beam.shear_stiffness, -coupling, beam.bending_stiffness * wave**2])
    return np.sqrt(squares.min()) / (2.0 * np.pi)


def measured_rates(error_at, sizes):
    """Return the exponents of the error's fall between successive numbers of elements."""
    errors = np.array([error_at(size) for size in sizes])
    return np.log(errors[:-1] / errors[1:]) / np.log(np.array(sizes[1:]) / np.array(sizes[:-1]))[:, None]


@pytest.mark.parametrize("ends", ROOTS, ids="-".join)
def test_euler_bernoulli_beam_converges_with_order_four(ends):
    beam = tube_beam(TUBE, INCONEL, "euler_bernoulli")
    exact = np.array(ROOTS[ends]) ** 2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length) / (2.0 * np.pi)
    rates = measured_rates(lambda size: straight_beam(ends, "euler_bernoulli", size)[:3] / exact - 1.0, (10, 14, 20))
    assert rates == pytest.approx(np.full((2, 3), 4.0), abs=0.15)
    assert straight_beam(ends, "euler_bernoulli", 40)[:3] == pytest.approx(exact, rel=1e-5)


def test_timoshenko_beam_converges_with_order_two():
    length = 0.1  # 4.5 diameters: shear matters
    exact = np.array([pinned_timoshenko(order, length) for order in (1, 2, 3)])
    assert exact[0] < 0.9 * straight_beam(("pinned", "pinned"), "euler_bernoulli", 20, length)[0]
    rates = measured_rates(lambda size: straight_beam(("pinned", "pinned"), "timoshenko", size, length)[:3] / exact - 1.0, (16, 24, 32))
    assert rates == pytest.approx(np.full((2, 3), 2.0), abs=0.05)


def test_slender_timoshenko_beam_is_accurate_at_the_study_mesh():
    exact = np.array([pinned_timoshenko(order, 1.0) for order in (1, 2, 3)])
    assert straight_beam(("pinned", "pinned"), "timoshenko", 20)[:3] == pytest.approx(exact, rel=3e-4)
    assert straight_beam(("pinned", "pinned"), "timoshenko", 20)[0] == pytest.approx(exact[0], rel=5e-6)


@pytest.mark.parametrize("theory, out_of_plane, in_plane", [
    ("euler_bernoulli", [31.89, 87.48, 193.73], [66.32, 174.43]),
    ("timoshenko", [31.85, 87.22, 192.52], [66.00, 173.06]),
])
def test_published_u_bend(theory, out_of_plane, in_plane):
    leg = SimpleNamespace(kind="straight", length_m=0.25043)
    bend = SimpleNamespace(kind="bend", radius_m=0.3955, angle_deg=180.0, toward=[1.0, 0.0, 0.0])
    x_plane, y_plane = frequencies_by_plane(path([leg, bend, leg], theory, ("clamped", "clamped"), (20, 80)), 250.0)
    assert x_plane[:2] == pytest.approx(in_plane, rel=1e-3)
    assert y_plane[:3] == pytest.approx(out_of_plane, rel=1e-3)


def test_free_ring():
    """Free ring (NAFEMS): radius 1 m, solid section of radius 0.05 m; out of plane 51.85 148.8 287.0, in plane 53.38 151.0 289.5 Hz."""
    bar = SimpleNamespace(outer_diameter_m=0.1, wall_thickness_m=0.05, shear_coefficient=0.9)
    steel = SimpleNamespace(young_modulus_Pa=2.0e11, poisson_ratio=0.3, density_kg_per_m3=8000.0)
    beam, count = tube_beam(bar, steel, "euler_bernoulli"), 60
    angle = 2.0 * np.pi * np.arange(count) / count
    nodes = np.stack([np.cos(angle), np.zeros(count), np.sin(angle)], axis=1)
    stiffness, mass = np.zeros((6 * count, 6 * count)), np.zeros((6 * count, 6 * count))
    for element in range(count):
        following = (element + 1) % count
        dofs = np.concatenate([6 * element + np.arange(6), 6 * following + np.arange(6)])
        one, other = element_matrices(beam, *element_geometry(nodes[element], nodes[following]))
        stiffness[np.ix_(dofs, dofs)] += one
        mass[np.ix_(dofs, dofs)] += other
    squares, shapes = linalg.eigh(stiffness, mass, subset_by_index=[0, 17])
    assert np.abs(squares[:6]).max() < 1e-5 * squares[6]  # six rigid motions
    across = (shapes[1::6] ** 2).sum(axis=0) > (shapes[0::6] ** 2 + shapes[2::6] ** 2).sum(axis=0)
    frequency = np.sqrt(squares[6:]) / (2.0 * np.pi)
    assert frequency[across[6:]] == pytest.approx(np.repeat([51.85, 148.8, 287.0], 2), rel=5e-3)
    assert frequency[~across[6:]] == pytest.approx(np.repeat([53.38, 151.0, 289.5], 2), rel=5e-3)
