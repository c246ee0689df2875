"""The ModalModel: what it refuses, and the blocks it finds."""

from dataclasses import MISSING, fields

import numpy as np
import pytest

from vibroimpact.io.records import read_record
from vibroimpact.reduction.modal_model import AXES, ModalModel
from vibroimpact.reduction.model_file import MODEL_VARIABLES, write_model


def parts(**changes):
    """Return the fields of a model of 5 modes, 3 contact points on 2 supports; modes 0, 3 move e1
    and 1, 4 move e2, 2 moves none.
    """
    shapes = np.zeros((5, 3, 2))
    shapes[[0, 3], :, 0] = 1.0
    shapes[[1, 4], :, 1] = -1.0
    given = {
        "omega": np.array([10.0, 20.0, 30.0, 40.0, 50.0]),
        "damping": np.ones(5),
        "contact_shapes": shapes,
        "contact_directions": np.tile(np.eye(3)[:2], (3, 1, 1)),
        "contact_weight": np.array([0.25, 0.75, 1.0]),
        "support_of_point": np.array([0, 0, 1]),
        "support_names": ("left", "right"),
        "contact_stiffness": np.full(3, 1e6),
        "gap_factor": np.ones(3),
        "centre_offset": np.zeros((3, 2)),
        "contact_position": np.zeros((3, 3)),
        "drive_shapes": np.ones((5, 1)),
        "sensor_shapes": np.ones((5, 2)),
        "sensor_names": ("apex.x", "apex.y"),
        "sensor_positions": np.zeros((2, 3)),
        "sensor_directions": np.eye(3)[:2],
        "line_shapes": np.ones((5, 4)),
        "line_positions": np.zeros((4, 3)),
        "line_arc_length": np.arange(4.0),
        "stress_shapes": np.ones((5, 1, 2)),
        "section_names": ("root",),
        "full_mode_frequencies": np.array([1.6]),
    }
    return {**given, **changes}


def test_fields_that_are_left_out_are_filled_in():
    required = {field.name for field in fields(ModalModel) if field.default is MISSING}
    model = ModalModel(**{name: parts()[name] for name in required})
    assert all(getattr(model, field.name) is not None for field in fields(ModalModel))
    assert model.contact_shapes.shape == (5, 0, 2) and model.line_positions.shape == (0, 3)
    assert model.modes == 5 and model.frequencies[0] == pytest.approx(10.0 / (2.0 * np.pi))


def test_blocks_are_what_contacts_couple():
    blocks = ModalModel(**parts()).blocks
    assert [modes.tolist() for modes, _ in blocks] == [[0, 3], [1, 4], [2]]
    assert [contacts for _, contacts in blocks] == [
        [(0, 0), (1, 0), (2, 0)],
        [(0, 1), (1, 1), (2, 1)],
        [],
    ]


def test_one_contact_direction_in_both_planes_couples_the_blocks():
    shapes = parts()["contact_shapes"].copy()
    shapes[4, 1, 0] = 1e-300
    blocks = ModalModel(**parts(contact_shapes=shapes)).blocks
    assert [modes.tolist() for modes, _ in blocks] == [[0, 1, 3, 4], [2]]


def test_a_chain_of_couplings_is_one_block():
    shapes = np.zeros((5, 3, 2))
    for mode, contacts in enumerate(([0], [0, 1], [1, 2], [2, 3], [3])):
        shapes.reshape(5, -1)[mode, contacts] = 1.0
    assert [modes.tolist() for modes, _ in ModalModel(**parts(contact_shapes=shapes)).blocks] == [
        [0, 1, 2, 3, 4]
    ]


def test_a_model_without_contact_points_is_one_block():
    at_points = [name for name, axes in AXES.items() if "contact_point" in axes]
    given = {name: value for name, value in parts().items() if name not in at_points}
    model = ModalModel(**given | {"support_names": ()})
    assert [(modes.tolist(), contacts) for modes, contacts in model.blocks] == [
        ([0, 1, 2, 3, 4], [])
    ]


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"damping": np.ones(4)}, "damping has 4 along mode, expected 5"),
        ({"contact_shapes": np.zeros((5, 3, 3))}, "contact_shapes has 3 along 2, expected 2"),
        ({"gap_factor": np.ones((3, 1))}, "gap_factor has 2 axes"),
        ({"sensor_names": ("apex.x",)}, "sensor_names has 1 names for 2 along sensor"),
        ({"omega": np.array([10.0, 20.0, 15.0, 40.0, 50.0])}, "omega must be ascending"),
        ({"damping": np.array([1.0, 1.0, -1.0, 1.0, 1.0])}, "damping must not be negative"),
        ({"line_shapes": np.full((5, 4), np.nan)}, "line_shapes holds values that are not finite"),
        (
            {"contact_weight": np.array([0.25, 0.7, 1.0])},
            "contact_weight must sum to 1 per support",
        ),
        ({"support_of_point": np.array([0, 0, 2])}, "support_of_point must index support_names"),
    ],
)
def test_a_wrong_model_is_refused_with_the_field_named(changes, message):
    with pytest.raises(ValueError, match=message):
        ModalModel(**parts(**changes))


def test_all_problems_are_reported_together():
    with pytest.raises(ValueError, match="damping has 4 .*; .*sensor_names has 1"):
        ModalModel(**parts(damping=np.ones(4), sensor_names=("apex.x",)))


def test_every_variable_of_a_model_file_is_described(study_model, tmp_path):
    write_model(study_model, tmp_path / "model.nc")
    stored = read_record(tmp_path / "model.nc")
    assert {str(name) for name in stored.variables} == set(MODEL_VARIABLES)
    assert stored["omega"].attrs["units"] == "rad s-1"
    assert stored["contact_laws_hertz"].attrs["comment"] == "in N/m^1.5"
