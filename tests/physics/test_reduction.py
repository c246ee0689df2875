"""The reduced model of the study against the full one: frequencies over the whole range of contact
stiffness, shapes, damping.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

from vibroimpact.config.reading import load_config
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors
from vibroimpact.reduction.reduced_model import build_model, modal_damping
from vibroimpact.structure.tube import build_structure

CONFIGURATIONS = Path(__file__).resolve().parents[2] / "config"
STUDY = load_config(CONFIGURATIONS / "study.yaml")


@pytest.fixture(scope="module")
def model():
    """Return the study's ModalModel."""
    return build_model(STUDY)


@pytest.fixture(scope="module")
def rows():
    """Return the rows of the study's quality report."""
    return basis_frequency_errors(STUDY)


@pytest.fixture(scope="module")
def report(rows):
    """Return {vectors: {stiffness: largest relative error}} of the study's quality report."""
    worst = {}
    for row in rows:
        by_stiffness = worst.setdefault(row["vectors"], {})
        error = abs(row["relative_error"])
        by_stiffness[row["stiffness_N_per_m"]] = np.maximum(
            by_stiffness.get(row["stiffness_N_per_m"], 0.0), error
        )  # NaN stays
    return worst


def test_basis_has_the_published_size(model):
    assert 85 <= model.modes <= 105
    assert (model.frequencies < 7500.0).sum() == len(model.full_mode_frequencies) == 75
    assert model.frequencies[:75] == pytest.approx(model.full_mode_frequencies, rel=1e-7)


def test_reduced_frequencies_are_right_from_free_to_clamped(report):
    assert set(report["all"]) >= {1.0, 1.0e3, 4.0e6, 1.0e9}
    assert max(report["all"].values()) < 1.0e-7


def test_each_family_of_shapes_improves_the_basis(report):
    worst = {vectors: max(errors.values()) for vectors, errors in report.items()}
    assert worst["free_modes alone"] == pytest.approx(2.4e-2, rel=0.1)
    assert worst["without attachment_shapes"] > 1.0e-3 > 1.0e-5 > worst["without constrained_modes"]
    assert worst["without free_modes"] > 1.0e-4
    assert not worst["constrained_modes alone"] < 0.1 and not worst["attachment_shapes alone"] < 1.0
    # the paper: bandwidth matters least; with a tenth of it the constrained modes earn their place
    assert worst["free_modes to a tenth"] < 2.0e-5
    assert worst["free_modes to a tenth, without constrained_modes"] > 1.0e-4
    assert worst["free_modes to a tenth, without attachment_shapes"] > 1.0e-3


def test_a_ritz_basis_only_stiffens(rows):
    assert not any(row["relative_error"] < -1.0e-7 for row in rows)


def test_every_basis_of_a_free_tube_has_finite_frequencies():
    # Without the free modes, rigid motion is among the other shapes, but for round-off.
    rod = load_config(CONFIGURATIONS / "examples" / "fuel_rod_grid.yaml")
    rows = basis_frequency_errors(rod)
    seen = [row["reduced_Hz"] for row in rows if row["mode"] <= row["modes"]]
    assert {"all", "without free_modes"} <= {row["vectors"] for row in rows}
    assert seen and np.all(np.isfinite(seen))
    worst = max(abs(row["relative_error"]) for row in rows if row["vectors"] == "all")
    assert worst < 1.0e-5


def test_planes_are_two_blocks_with_exact_zeros_between(model):
    (out_of_plane, along_y), (in_plane, along_x) = sorted(
        model.blocks, key=lambda block: -len(block[0])
    )
    assert {direction for _, direction in along_y} == {1} and {
        direction for _, direction in along_x
    } == {0}
    assert len(out_of_plane) + len(in_plane) == model.modes
    assert (
        np.count_nonzero(model.contact_shapes[in_plane][:, :, 1])
        == np.count_nonzero(model.contact_shapes[out_of_plane][:, :, 0])
        == 0
    )
    assert np.count_nonzero(model.drive_shapes[in_plane]) == 0
    assert np.count_nonzero(model.line_shapes[in_plane]) == 0
    in_one_plane = (model.stress_shapes[in_plane] == 0.0).all(axis=0) ^ (
        model.stress_shapes[out_of_plane] == 0.0
    ).all(axis=0)
    assert in_one_plane.all()  # each of the two bending moments of a section belongs to one plane


def test_shapes_read_the_same_displacement_as_the_full_model(model):
    structure = build_structure(STUDY)
    drive = structure.displacement_rows(
        structure.centreline.locate(STUDY.points["shaker"], "shaker")
    )[1]
    dofs = linalg.solve(structure.stiffness.toarray(), drive, assume_a="pos")
    modal = model.drive_shapes[:, 0] / model.omega**2
    # Statics under a force away from the contacts: the modes left out, above 7500 Hz, hold 2.4e-5
    # of the displacement at the force.
    for number, name in enumerate(model.sensor_names):
        point, axis = name.split(".")
        full = (
            structure.displacement_rows(structure.centreline.locate(STUDY.points[point], point))[
                "xyz".index(axis)
            ]
            @ dofs
        )
        assert model.sensor_shapes[:, number] @ modal == pytest.approx(
            full, abs=3e-5 * np.abs(drive @ dofs)
        )
    contact = np.einsum("cdn,n->cd", structure.contact_rows(), dofs)
    assert np.einsum("mcd,m->cd", model.contact_shapes, modal) == pytest.approx(
        contact, rel=1e-7, abs=1e-12 * np.abs(contact).max()
    )
    stress = structure.stress_rows(structure.contact.arc_length[2]) @ dofs
    assert model.stress_shapes[
        :, model.section_names.index("left_middle")
    ].T @ modal == pytest.approx(stress, rel=1e-3, abs=1e-6)


def test_sections_sensors_and_line_are_where_they_should_be(model):
    assert model.section_names == (
        "root_start",
        "root_end",
        "left_start",
        "left_middle",
        "left_end",
        "right_start",
        "right_middle",
        "right_end",
        "shaker",
        "apex",
        "left_leg",
        "right_leg",
    )  # bend_45 is where the shaker is
    assert model.sensor_names[:2] == ("apex.x", "apex.y") and model.sensor_positions[
        1
    ] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert model.sensor_directions[:2].tolist() == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    assert len(model.line_arc_length) == 27 and np.ptp(np.diff(model.line_arc_length)) < 1e-12
    assert model.line_positions[13] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert model.line_arc_length[0] == pytest.approx((1.4 + 0.3 * np.pi) / 28)


def test_symmetric_tube_moves_symmetrically_in_its_first_modes(model):
    shapes = model.line_shapes[(model.line_shapes != 0.0).any(axis=1)]
    assert shapes[0] == pytest.approx(shapes[0][::-1], rel=1e-5)
    assert shapes[1] == pytest.approx(
        -shapes[1][::-1], rel=1e-5, abs=1e-6 * np.abs(shapes[1]).max()
    )


def test_modal_damping_of_first_modes_is_that_of_the_full_tube(model):
    ratios = model.damping / (2.0 * model.omega)
    assert ratios[:2].tolist() == pytest.approx([0.015, 0.015]) and ratios[2:] == pytest.approx(
        np.full(model.modes - 2, 0.002)
    )


def test_damping_of_rigid_modes_and_rayleigh_damping():
    omega = np.array([0.0, 0.0, 10.0, 20.0, 30.0])
    modal = SimpleNamespace(
        kind="modal", first_ratios=[0.1, 0.2], other_ratio=0.01, mass_coefficient_per_s=0.5
    )
    assert modal_damping(omega, modal).tolist() == pytest.approx([0.5, 0.5, 2.5, 8.5, 1.1])
    rayleigh = SimpleNamespace(
        kind="rayleigh", mass_coefficient_per_s=3.0, stiffness_coefficient_s=1e-2
    )
    assert modal_damping(omega, rayleigh).tolist() == pytest.approx([3.0, 3.0, 4.0, 7.0, 12.0])


def test_unknown_and_misplaced_points_are_named():
    with pytest.raises(ValueError, match="point 'shaker' is not among points: apex"):
        build_model(STUDY.model_copy(update={"points": {"apex": [0.0, 0.0, 1.0]}}))
    with pytest.raises(ValueError, match="point apex at .* is 0.2000 m off the tube"):
        build_model(STUDY.model_copy(update={"points": {**STUDY.points, "apex": [0.0, 0.0, 1.2]}}))


def test_a_tube_without_supports_is_its_free_modes(model):
    bare = build_model(STUDY.model_copy(update={"supports": ()}))
    assert bare.frequencies == pytest.approx(bare.full_mode_frequencies, rel=1e-7)
    assert bare.frequencies[:10] == pytest.approx(
        model.full_mode_frequencies[:10], rel=1e-4
    )  # another mesh: no contact points
    assert [contacts for _, contacts in bare.blocks] == [[]]
