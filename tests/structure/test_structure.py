"""The finite-element tube: mass, rigid motion, statics at points that are not nodes, ends,
uncoupled planes.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

from vibroimpact.structure.tube import build_structure

SECTION = SimpleNamespace(
    outer_diameter_m=0.02222, wall_thickness_m=0.00127, shear_coefficient=0.53
)
MATERIAL = SimpleNamespace(young_modulus_Pa=2.02e11, poisson_ratio=0.3, density_kg_per_m3=8330.0)
MASS_PER_LENGTH = 8330.0 * np.pi * (0.02222 - 0.00127) * 0.00127
CLAMPED, FREE, PINNED = (SimpleNamespace(kind=kind) for kind in ("clamped", "free", "pinned"))


def tube(
    *,
    segments=None,
    start=CLAMPED,
    end=CLAMPED,
    direction=(0.0, 0.0, 1.0),
    elements=(4, 12),
    supports=(),
    theory="timoshenko",
):
    """Return the Structure of a path; the default is the stand-in U-tube on a coarse mesh."""
    u_tube = [
        SimpleNamespace(kind="straight", length_m=0.7),
        SimpleNamespace(kind="bend", radius_m=0.3, angle_deg=180.0, toward=[1.0, 0.0, 0.0]),
        SimpleNamespace(kind="straight", length_m=0.7),
    ]
    structure = SimpleNamespace(
        kind="path",
        theory=theory,
        section=SECTION,
        material=MATERIAL,
        start_m=[-0.3, 0.0, 0.0],
        start_direction=direction,
        segments=u_tube if segments is None else segments,
        start=start,
        end=end,
        mesh=SimpleNamespace(elements_per_span=elements[0], elements_per_bend=elements[1]),
    )
    return build_structure(SimpleNamespace(structure=structure, supports=supports))


def straight(length):
    return [SimpleNamespace(kind="straight", length_m=length)]


def plate(at_m, points=3):
    return SimpleNamespace(
        name="plate",
        at_m=at_m,
        height_m=0.03,
        points=points,
        stiffness_N_per_m=1.0,
        gap_factor=1.0,
        centre_offset_m=[0.0, 0.0],
    )


def rigid_motions(structure):
    """Return (dof, 6): translations along and rotations about the global axes, for a structure that
    nothing holds.
    """
    motions = np.zeros((len(structure.nodes), 6, 6))
    for axis in range(3):
        motions[:, axis, axis] = 1.0
        motions[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], structure.nodes)
        motions[:, 3 + axis, 3 + axis] = 1.0
    return motions.reshape(-1, 6)


def test_a_free_u_tube_has_its_mass_and_six_rigid_motions():
    structure = tube(start=FREE, end=FREE, elements=(20, 80))
    motions = rigid_motions(structure)
    inertia = motions.T @ (structure.mass @ motions)
    length = 1.4 + 0.3 * np.pi
    assert np.diag(inertia)[:3] == pytest.approx(
        MASS_PER_LENGTH * length, rel=5e-5
    )  # chords are shorter than the arc by 3e-5
    height = (
        1.4 * 0.35 + 0.3 * np.pi * 0.7 + 2.0 * 0.3**2
    ) / length  # centre of mass: legs, and the arc's 2 R / pi above them
    assert inertia[0, 4] == pytest.approx(MASS_PER_LENGTH * length * height, rel=1e-4)
    assert np.abs(structure.stiffness @ motions).max() < 1e-12 * np.abs(structure.stiffness).max()
    squares = linalg.eigh(
        structure.stiffness.toarray(),
        structure.mass.toarray(),
        eigvals_only=True,
        subset_by_index=[0, 6],
    )
    assert np.abs(squares[:6]).max() < 1e-6 * squares[6]


def test_matrices_are_symmetric():
    structure = tube(
        end=SimpleNamespace(kind="springs", translation_N_per_m=1e5, rotation_N_m_per_rad=1e3),
        direction=(1.0, 2.0, 2.0),
    )
    for matrix in (structure.mass, structure.stiffness):
        assert abs(matrix - matrix.T).max() < 1e-12 * abs(matrix).max()


@pytest.mark.parametrize("theory", ["timoshenko", "euler_bernoulli"])
@pytest.mark.parametrize("place", [0.05, 0.25, 0.4137, 0.5])
def test_tip_load_gives_exact_deflection_and_stress(theory, place):
    structure = tube(segments=straight(0.5), end=FREE, theory=theory)
    load, (x, y) = 10.0, np.eye(3)[:2]
    moment_of_area = np.pi / 64.0 * (0.02222**4 - 0.01968**4)
    shear_stiffness = (
        0.53 * 2.02e11 / 2.6 * MASS_PER_LENGTH / 8330.0 if theory == "timoshenko" else np.inf
    )
    solve = linalg.cho_factor(structure.stiffness.toarray())
    for direction, number in ((x, 0), (y, 1)):
        dofs = linalg.cho_solve(solve, structure.displacement_rows(0.5).T @ (load * direction))
        exact = load * (
            place**2 * (1.5 - place) / (6.0 * 2.02e11 * moment_of_area) + place / shear_stiffness
        )
        assert structure.displacement_rows(place) @ dofs == pytest.approx(
            exact * direction, rel=1e-8, abs=1e-12
        )
        expected = np.zeros(2)
        expected[number] = load * (0.5 - place) * 0.01111 / moment_of_area
        assert structure.stress_rows(place) @ dofs == pytest.approx(expected, rel=1e-6, abs=1e-3)


def test_force_between_nodes_acts_as_on_a_node():
    # 0.35 m is the middle of a mesh of 5 and a node of a mesh of 4: deflection there differs by the
    # element's own local part only.
    between, on_node = tube(elements=(5, 12)), tube(elements=(4, 12))
    seen = []
    for structure in (between, on_node):
        rows = structure.displacement_rows(0.35)
        dofs = linalg.solve(structure.stiffness.toarray(), rows.T, assume_a="pos")
        seen.append(structure.displacement_rows(1.0) @ dofs)
    assert seen[0] == pytest.approx(seen[1], rel=1e-8, abs=1e-9 * np.abs(seen[1]).max())


def test_soft_root_springs_carry_the_tube_as_a_rigid_body():
    springs = SimpleNamespace(kind="springs", translation_N_per_m=10.0, rotation_N_m_per_rad=1.0e-9)
    structure = tube(segments=straight(0.5), start=springs, end=springs)
    squares = linalg.eigh(
        structure.stiffness.toarray(),
        structure.mass.toarray(),
        eigvals_only=True,
        subset_by_index=[0, 5],
    )
    bounce, pitch = 20.0 / (0.5 * MASS_PER_LENGTH), 3.0 * 20.0 / (0.5 * MASS_PER_LENGTH)
    assert squares[1:4] == pytest.approx(
        [bounce] * 3, rel=2e-3
    )  # [0] turns about the axis on the weak rotation spring
    assert squares[4:6] == pytest.approx(
        [pitch] * 2, rel=2e-2
    )  # the section's rotary inertia and round-off


def test_stiff_root_springs_are_a_clamp():
    stiff = SimpleNamespace(kind="springs", translation_N_per_m=1.0e11, rotation_N_m_per_rad=1.0e8)
    first = [
        linalg.eigh(
            one.stiffness.toarray(), one.mass.toarray(), eigvals_only=True, subset_by_index=[0, 3]
        )
        for one in (tube(start=stiff, end=stiff), tube())
    ]
    assert first[0] == pytest.approx(first[1], rel=1e-4)


def test_a_pinned_end_holds_translation_and_torsion_only():
    structure = tube(segments=straight(0.5), start=PINNED, end=FREE, direction=(1.0, 2.0, 2.0))
    squares = linalg.eigh(
        structure.stiffness.toarray(),
        structure.mass.toarray(),
        eigvals_only=True,
        subset_by_index=[0, 2],
    )
    assert np.abs(squares[:2]).max() < 1e-3  # swings about two axes, twists about none
    assert squares[2] > 1e4


def test_mistakes_are_named():
    structure = tube()
    with pytest.raises(ValueError, match="arc length 3.0 m is not on the tube"):
        structure.displacement_rows(3.0)
    with pytest.raises(ValueError, match="end kind 'glued' is unknown"):
        tube(end=SimpleNamespace(kind="glued"))
    with pytest.raises(ValueError, match="at least two elements"):
        tube(segments=straight(0.5), elements=(1, 1))
