"""Bars and rods of other sections than a tube, from the configuration: frequencies, deflections and
stresses in both planes against closed forms.
"""

import copy

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from evidence.validation.reference.frequencies import ROOTS, plane_frequencies
from vibroimpact.config.reading import check_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.tube import build_structure

STEEL = {"young_modulus_Pa": 2.0e11, "poisson_ratio": 0.3, "density_kg_per_m3": 8000.0}
WIDE = {"kind": "rectangle", "sides_m": [0.010, 0.040]}  # thin along the first axis
BAR = {
    "study": "bar",
    "structure": {
        "kind": "path",
        "theory": "euler_bernoulli",
        "section": WIDE,
        "material": STEEL,
        "start_m": [0.0, 0.0, 0.0],
        "start_direction": [1.0, 0.0, 0.0],
        "segments": [{"kind": "straight", "length_m": 0.8}],
        "mesh": {"elements_per_span": 40, "elements_per_bend": 60},
        "start": {"kind": "clamped"},
        "end": {"kind": "free"},
    },
    "points": {"tip": [0.8, 0.0, 0.0], "root": [0.0, 0.0, 0.0]},
    "excitation": {
        "kind": "band_limited",
        "point": "tip",
        "direction": [0.0, 0.0, 1.0],
        "band_Hz": [5.0, 200.0],
    },
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3]},
    "record": {"sensors": {"points": ["tip"], "directions": ["y", "z"]}},
}


def bar(**changes):
    """Return the Config of the bar with changed keys of its structure, and of points."""
    data = copy.deepcopy(BAR)
    data["points"] = changes.pop("points", data["points"])
    data["structure"] |= changes
    return check_config(data, "bar.yaml")


def deflection(structure, place, force):
    """Return ((3,) displacement in m, dofs) at an arc length in m under a force (3,) in N there."""
    dofs = spsolve(structure.stiffness.tocsc(), structure.displacement_rows(place).T @ force)
    return structure.displacement_rows(place) @ dofs, dofs


def euler(roots, bending_stiffness, mass_per_length, length):
    """Return (mode,) Hz of an Euler-Bernoulli beam with the roots beta L."""
    return (
        (np.array(roots) / length) ** 2
        * np.sqrt(bending_stiffness / mass_per_length)
        / (2.0 * np.pi)
    )


@pytest.mark.parametrize("along_y", [True, False])
def test_a_rectangular_cantilever_has_two_sets_of_frequencies(along_y):
    axis = [0.0, 1.0, 0.0] if along_y else [0.0, 0.0, 1.0]
    structure = build_structure(bar(section=WIDE | {"first_axis": axis}))
    _, along_y_Hz, along_z_Hz, _ = plane_frequencies(
        structure, 1500.0
    )  # first and last: axial, twist
    thin, wide = (along_y_Hz, along_z_Hz) if along_y else (along_z_Hz, along_y_Hz)
    for found, side, other, count in ((thin, 0.010, 0.040, 3), (wide, 0.040, 0.010, 2)):
        stiffness = 2.0e11 * other * side**3 / 12.0
        exact = euler(ROOTS["clamped-free"][:count], stiffness, 8000.0 * 0.010 * 0.040, 0.8)
        assert found[:count] == pytest.approx(exact, rel=1e-5)


def test_the_default_first_axis_is_a_transverse_direction():
    # Along x the transverse directions are y and z: thin along y.
    free, _ = deflection(build_structure(bar()), 0.8, np.array([0.0, 1.0, 0.0]))
    assert free[1] == pytest.approx(0.8**3 / (3.0 * 2.0e11 * 0.040 * 0.010**3 / 12.0), rel=1e-8)
    stiff, _ = deflection(build_structure(bar()), 0.8, np.array([0.0, 0.0, 1.0]))
    assert free[1] / stiff[2] == pytest.approx(16.0, rel=1e-9)


def test_a_bar_on_a_slant_deflects_across_the_force():
    # First axis at 30° to y: the deflection along y of a force along y, and along z, by the two
    # principal flexibilities.
    turn = np.deg2rad(30.0)
    first = np.array([0.0, np.cos(turn), np.sin(turn)])
    structure = build_structure(bar(section=WIDE | {"first_axis": first.tolist()}))
    found, _ = deflection(structure, 0.8, np.array([0.0, 1.0, 0.0]))
    soft, stiff = (
        0.8**3 / (3.0 * 2.0e11 * inertia / 12.0) for inertia in (0.040 * 0.010**3, 0.010 * 0.040**3)
    )
    assert found[1] == pytest.approx(soft * np.cos(turn) ** 2 + stiff * np.sin(turn) ** 2, rel=1e-8)
    assert found[2] == pytest.approx((soft - stiff) * np.cos(turn) * np.sin(turn), rel=1e-8)


def test_shear_adds_cowpers_flexibility_to_a_rod_and_a_bar():
    rod = {"kind": "round", "diameter_m": 0.02}
    shear_modulus = 2.0e11 / 2.6
    for section, area, inertia, shear in (
        (rod, np.pi * 0.01**2, np.pi * 0.01**4 / 4.0, 6.0 * 1.3 / (7.0 + 1.8)),
        (WIDE, 4.0e-4, 0.010 * 0.040**3 / 12.0, 10.0 * 1.3 / (12.0 + 3.3)),
    ):
        structure = build_structure(bar(section=section, theory="timoshenko"))
        found, _ = deflection(structure, 0.8, np.array([0.0, 0.0, 1.0]))
        exact = 0.8**3 / (3.0 * 2.0e11 * inertia) + 0.8 / (shear * shear_modulus * area)
        assert found[2] == pytest.approx(exact, rel=1e-8)


def test_a_bar_twists_by_its_torsion_constant():
    structure = build_structure(bar(theory="timoshenko"))
    torque = np.zeros(len(structure.nodes) * 6)
    torque[-3] = 1.0  # about x at the free end
    dofs = spsolve(structure.stiffness.tocsc(), structure.transformation.T @ torque)
    twist = (structure.transformation @ dofs)[-3]
    # Timoshenko and Goodier, art. 109, table: 0.281 a b³ for a = 4 b
    assert twist == pytest.approx(0.8 / (2.0e11 / 2.6 * 0.281 * 0.040 * 0.010**3), rel=2e-3)


def test_outer_fibres_of_a_bar_are_its_corners():
    force = np.array([0.0, 3.0, 5.0])
    config = bar(theory="timoshenko")
    structure = build_structure(config)
    _, dofs = deflection(structure, 0.8, force)
    moduli = np.array([0.040 * 0.010**2, 0.010 * 0.040**2]) / 6.0  # b h² / 6
    bending = force[1:] * 0.8 / moduli
    assert structure.stress_rows(0.0) @ dofs == pytest.approx(bending, rel=1e-6)
    excitation = config.excitation.model_copy(update={"direction": tuple(force)})
    model = build_model(config.model_copy(update={"excitation": excitation}))
    assert model.section_names[:2] == ("root_start_corner_1", "root_start_corner_2")
    static = np.linalg.norm(force) * model.drive_shapes[:, 0] / model.omega**2
    corners = np.hypot(*np.einsum("m,msd->ds", static, model.stress_shapes))[:2]
    # On the free modes to 7.5 kHz alone: what lies above is worth 0.3 %.
    assert corners == pytest.approx([bending.sum(), bending[0] - bending[1]], rel=1e-2)


def test_a_general_section_repeats_the_rectangle():
    shear = 10.0 * 1.3 / (12.0 + 3.3)
    general = {
        "kind": "general",
        "area_m2": 4.0e-4,
        "second_moments_m4": [0.040 * 0.010**3 / 12.0, 0.010 * 0.040**3 / 12.0],
        "torsion_constant_m4": 1.1232e-8,
        "shear_coefficients": [shear, shear],
        "outer_fibres_m": [0.005, 0.020],
    }
    one, other = (
        build_structure(bar(section=section, theory="timoshenko")) for section in (WIDE, general)
    )
    assert np.allclose(one.mass.toarray(), other.mass.toarray(), rtol=1e-12, atol=1e-15)
    difference = np.abs(one.stiffness.toarray() - other.stiffness.toarray())
    assert difference.max() < 1e-9 * np.abs(one.stiffness).max()  # torsion to 5 digits
    assert np.allclose(one.stress_rows(0.3), other.stress_rows(0.3), rtol=1e-12)


def test_a_round_rod_is_a_tube_without_hollow():
    rod = {"kind": "round", "diameter_m": 0.02, "shear_coefficient": 0.9}
    tube = {"outer_diameter_m": 0.02, "wall_thickness_m": 0.00999999, "shear_coefficient": 0.9}
    one, other = (
        build_structure(bar(section=section, theory="timoshenko")) for section in (rod, tube)
    )
    for matrix in ("mass", "stiffness"):
        pair = [getattr(each, matrix).toarray() for each in (one, other)]
        assert np.allclose(*pair, rtol=1e-5, atol=1e-9 * np.abs(pair[0]).max())


BEND = {
    "segments": [
        {"kind": "straight", "length_m": 0.3},
        {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.0, 0.0, 1.0]},
        {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.0, 1.0, 0.0]},
        {"kind": "straight", "length_m": 0.3},
    ],
    "points": {"tip": [0.5, 0.5, 0.4], "root": [0.0, 0.0, 0.0]},
}


def test_axes_of_a_section_turn_with_bends_without_twist():
    section = WIDE | {"first_axis": [0.0, 0.0, 1.0]}
    structure = build_structure(bar(section=section, **BEND))
    # x, then up along z: the first axis, towards the centre of the bend, turns to -x. The second
    # bend turns z to y, about x: the first axis stays.
    bend, end = 0.3 + 0.1 * np.pi, structure.centreline.length
    for place, first in (
        (0.2, (0.0, 0.0, 1.0)),
        (0.3 + 0.05 * np.pi, (-np.sqrt(0.5), 0.0, np.sqrt(0.5))),
        (bend, (-1.0, 0.0, 0.0)),
        (end, (-1.0, 0.0, 0.0)),
    ):
        axes = structure.section_axes(place)
        assert axes[0] == pytest.approx(first, abs=1e-12)
        assert axes[1] == pytest.approx(
            np.cross(structure.centreline.direction(place), first), abs=1e-12
        )
    for tangent, first, second in structure.axes:
        assert np.linalg.det([tangent, first, second]) == pytest.approx(1.0, abs=1e-12)


def test_a_square_bar_does_not_depend_on_its_axes():
    square = {"kind": "rectangle", "sides_m": [0.02, 0.02]}
    one, other = (
        build_structure(bar(section=square | {"first_axis": axis}, **BEND))
        for axis in ([0.0, 1.0, 0.0], [0.0, 0.6, 0.8])
    )
    for matrix in ("mass", "stiffness"):
        pair = [getattr(each, matrix).toarray() for each in (one, other)]
        assert np.allclose(*pair, rtol=0, atol=1e-9 * np.abs(pair[0]).max())


def test_a_curved_bar_bends_by_castigliano_in_and_out_of_plane():
    # A quarter circle, clamped, a force at its end across the tangent, along it, and out of plane,
    # where bending and torsion add up. Timoshenko, Strength of Materials, part 1, art. 80.
    quarter = {"kind": "bend", "radius_m": 0.2, "angle_deg": 90.0, "toward": [0.0, 0.0, 1.0]}
    tip = {"points": {"tip": [0.2, 0.0, 0.2], "root": [0.0, 0.0, 0.0]}, "segments": [quarter]}
    section = {"kind": "rectangle", "sides_m": [0.004, 0.008], "first_axis": [0.0, 0.0, 1.0]}
    structure = build_structure(bar(section=section, **tip))
    end = structure.centreline.length
    radial, cross = (2.0e11 * inertia / 12.0 for inertia in (0.008 * 0.004**3, 0.004 * 0.008**3))
    twist = 2.0e11 / 2.6 * 0.229 * 0.008 * 0.004**3
    across, _ = deflection(structure, end, np.array([1.0, 0.0, 0.0]))
    assert across[0] == pytest.approx(0.2**3 * np.pi / (4.0 * radial), rel=1e-3)
    along, _ = deflection(structure, end, np.array([0.0, 0.0, 1.0]))
    assert along[2] == pytest.approx(0.2**3 * (0.75 * np.pi - 2.0) / radial, rel=1e-3)
    out_of_plane, _ = deflection(structure, end, np.array([0.0, 1.0, 0.0]))
    exact = 0.2**3 * (np.pi / (4.0 * cross) + (0.75 * np.pi - 2.0) / twist)
    assert out_of_plane[1] == pytest.approx(exact, rel=2e-3)


def test_a_launched_square_beam_has_its_published_frequencies():
    # R7 (code_aster SDNL32): pinned-free, 0.783 m, square of 14 mm; the roots of a pinned-free beam
    # are those of a clamped-pinned one.
    config = bar(
        section={"kind": "rectangle", "sides_m": [0.014, 0.014]},
        material={"young_modulus_Pa": 6.7e10, "poisson_ratio": 0.3, "density_kg_per_m3": 2400.0},
        segments=[{"kind": "straight", "length_m": 0.783}],
        start={"kind": "pinned"},
        points={"tip": [0.783, 0.0, 0.0]},
    )
    model = build_model(config)
    assert model.omega[:2].tolist() == [0.0, 0.0]  # rigid rotations about y and z
    exact = euler(ROOTS["clamped-pinned"], 6.7e10 * 0.014**4 / 12.0, 2400.0 * 0.014**2, 0.783)
    groups = plane_frequencies(build_structure(config), 1200.0)
    planes = [group for group in groups if len(group) and group[0] == 0.0]
    assert len(planes) == 2
    for plane in planes:
        assert plane[1:] == pytest.approx(exact, rel=1e-5)
