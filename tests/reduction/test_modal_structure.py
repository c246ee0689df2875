"""A structure known by its modes: the same as the matrices they came from, with elements between
points and contacts.
"""

import numpy as np
import pytest
from scipy import linalg, sparse

from tests.support import joint
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.identify.linear.responses import frf
from vibroimpact.reduction.modal_structure import IdentifiedModes, modal_model
from vibroimpact.reduction.reduced_model import build_model

REST = {
    "study": "three",
    "excitation": {
        "kind": "band_limited",
        "point": "a",
        "direction": [1.0, 0.0, 0.0],
        "band_Hz": [4.0, 45.0],
    },
    "integration": {"steps_per_second": 10000, "start_up_s": 1.0},
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    "record": {"duration_s": 1.0, "sampling_frequency_Hz": 400},
    "elements": [
        {
            "name": "joint",
            "point": "c",
            "other_point": "b",
            "direction": [1.0, 0.0, 0.0],
            "cubic_N_per_m3": 1.0e9,
        }
    ],
    "supports": [
        {
            "name": "stop",
            "point": "c",
            "other_point": "b",
            "stiffness_N_per_m": 1.0e5,
            "profile": {"kind": "planes", "normals_deg": [0.0, 180.0]},
        },
        {"name": "wall", "point": "a", "stiffness_N_per_m": 1.0e5},
    ],
}


def modes_of_joint():
    """(frequency (3,) Hz, ratio (3,), shapes (point, mode)) of the three masses, damping taken for
    modal.
    """
    mass, damping, stiffness = joint.matrices()
    squares, shapes = linalg.eigh(stiffness, mass)
    return (
        np.sqrt(squares) / (2.0 * np.pi),
        np.diag(shapes.T @ damping @ shapes) / (2.0 * np.sqrt(squares)),
        shapes,
    )


def identified(extra=None):
    """The structure section of the three masses by their modes."""
    frequency, ratio, shapes = modes_of_joint()
    modes = [
        {
            "frequency_Hz": place,
            "damping_ratio": loss,
            "shape": {
                name: {"x": value} for name, value in zip("abc", shapes[:, mode], strict=True)
            },
        }
        for mode, (place, loss) in enumerate(zip(frequency, ratio, strict=True))
    ]
    return {"kind": "identified", "modes": modes, **(extra or {})}


def test_modes_and_matrices_of_one_structure_make_one_model(tmp_path):
    mass, _, stiffness = joint.matrices()
    frequency, ratio, shapes = modes_of_joint()
    damping = mass @ shapes @ np.diag(4.0 * np.pi * ratio * frequency) @ shapes.T @ mass
    for name, matrix in (("mass", mass), ("stiffness", stiffness), ("damping", damping)):
        sparse.save_npz(tmp_path / f"{name}.npz", sparse.csr_array(matrix))
    files = {name: str(tmp_path / f"{name}.npz") for name in ("mass", "stiffness", "damping")}
    matrices = {
        "kind": "matrices",
        **files,
        "points": {name: {"x": dof} for dof, name in enumerate("abc")},
    }
    none = {"kind": "modal", "other_ratio": 0.0}
    one = build_model(check_config({**REST, "structure": identified()}, "modes"))
    other = build_model(check_config({**REST, "structure": matrices, "damping": none}, "matrices"))
    assert one.omega == pytest.approx(other.omega) and one.damping == pytest.approx(
        other.damping, rel=1.0e-6
    )
    for name in ("drive_shapes", "sensor_shapes", "element_shapes", "contact_shapes"):
        mine, theirs = (np.reshape(getattr(model, name), (3, -1)) for model in (one, other))
        assert np.abs(mine.T @ mine) == pytest.approx(np.abs(theirs.T @ theirs), abs=1.0e-9)
    place = np.linspace(4.0, 45.0, 50)
    assert frf(one, 0.0, 0.0, place, one.sensor_shapes) == pytest.approx(
        frf(other, 0.0, 0.0, place, other.sensor_shapes), rel=1.0e-6
    )


def test_the_damping_of_measured_modes_is_their_own():
    model = build_model(
        check_config(
            {**REST, "structure": identified(), "damping": {"kind": "modal", "other_ratio": 0.2}},
            "modes",
        )
    )
    frequency, ratio, _ = modes_of_joint()
    assert model.damping == pytest.approx(4.0 * np.pi * ratio * frequency)


def test_measured_modes_can_start_in_the_shape_of_one():
    mode = {"kind": "mode", "number": 2, "point": "a", "direction": "x", "amplitude_m": 0.1}
    model = build_model(
        check_config(
            {**REST, "structure": identified(), "initial": {"displacement": mode}}, "modes"
        )
    )
    assert np.flatnonzero(model.initial_displacement).tolist() == [1]
    start = model.sensor_shapes.T @ model.initial_displacement
    assert start[model.sensor_names.index("a.x")] == pytest.approx(0.1)


def test_unsupported_uses_of_measured_modes_are_refused():
    with pytest.raises(ConfigError, match="'d'"):
        check_config(
            {
                **REST,
                "structure": identified(),
                "elements": [{**REST["elements"][0], "point": "d"}],
            },
            "modes",
        )
    with pytest.raises(ConfigError, match="of measured modes mode"):
        check_config(
            {**REST, "structure": identified(), "initial": {"displacement_m": {"a": {"x": 0.1}}}},
            "modes",
        )
    base = {
        "kind": "base_motion",
        "direction": [1.0, 0.0, 0.0],
        "obstacles": "fixed",
        "signal": {"kind": "harmonic", "frequency_Hz": 10.0},
    }
    with pytest.raises(ValueError, match="cannot be driven by its base"):
        build_model(check_config({**REST, "structure": identified(), "excitation": base}, "modes"))


def test_responses_per_force_are_sums_over_modes():
    frequency, ratio, shapes = modes_of_joint()
    modes = IdentifiedModes(
        frequency,
        ratio,
        shapes.T,
        0,
        ("acceleration", "velocity", "displacement"),
        tuple("abc"),
        np.zeros(3, bool),
    )
    place = np.array([5.0, 7.3, 20.0, 41.0])
    model = modal_model(modes, np.zeros((3, 0)))
    kinds = [
        frf(model, 0.0, 0.0, place, model.sensor_shapes, kind)[channel]
        for channel, kind in enumerate(modes.kinds)
    ]
    assert modes.frf(place) == pytest.approx(np.array(kinds), rel=1.0e-9)
