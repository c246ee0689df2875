"""Accuracy of the model at the study's own stiffness: what is flagged, and what is refused."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml

from tests.support.matrix_structure import matrix_study
from tests.support.straight_path import straight_path
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors, require_complete
from vibroimpact.reduction.model_accuracy import (
    ModelAccuracyError,
    mesh_warnings,
    model_accuracy,
    require_accurate,
)

ROOT = Path(__file__).parents[2]
SMOKE = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
FIRST = {"pinned": np.pi**2, "clamped": 4.730040745**2}  # (beta L)² of the ends


def smoke(**structure):
    """The smoke study with keys of its structure changed, as plain values."""
    return {**copy.deepcopy(SMOKE), "structure": {**SMOKE["structure"], **structure}}


def mesh(spans, bend):
    """A mesh section."""
    return {"elements_per_span": spans, "elements_per_bend": bend}


def test_the_default_mesh_is_within_its_stated_error():
    """docs/validation.md: the error of modes 1 to 7 is at most 1.6e-4."""
    rows = model_accuracy(load_config(ROOT / "config" / "study.yaml"))
    first = [row for row in rows if row["mode"] <= 7]
    assert {row["condition"] for row in first} == {"free", "on supports"} and len(first) == 14
    assert max(abs(row["mesh_error"]) for row in first) < 1.6e-4
    assert max(abs(row["basis_error"]) for row in first) < 1e-7
    assert not any(row["flag"] for row in rows) and not mesh_warnings(rows)


@pytest.mark.parametrize("end", FIRST)
def test_a_coarse_straight_mesh_has_the_error_of_a_closed_form(end):
    """Euler-Bernoulli, two and three elements: order 4, which is rated with order 2, 25 % high."""
    section = {"outer_diameter_m": 0.02, "wall_thickness_m": 0.001}
    material = (2.02e11, 0.3, 8330.0)
    keys = {"theory": "euler_bernoulli", "mesh": {"elements_per_span": 2}}
    data = smoke()
    data["structure"] = straight_path(2.0, [0.0, 0.0, 1.0], section, material, (end, end), **keys)
    data |= {"supports": [], "points": {"shaker": [0.0, 0.0, 0.8]}}
    data["record"]["sensors"] = {"points": ["shaker"], "directions": ["y"]}
    for key in ("identification", "overlay"):
        del data[key]
    outer, inner = 0.01, 0.009
    rigidity = 2.02e11 * np.pi / 4.0 * (outer**4 - inner**4)
    per_length = 8330.0 * np.pi * (outer**2 - inner**2)
    exact = FIRST[end] / 4.0 * np.sqrt(rigidity / per_length) / (2.0 * np.pi)
    row = model_accuracy(check_config(data, "beam"))[0]
    error = row["full_Hz"] / exact - 1.0
    assert 1e-3 < error < 0.05
    assert error <= row["mesh_error"] < 1.3 * error
    assert (row["flag"] == "mesh") == (row["mesh_error"] > 3e-3)


def test_one_element_per_span_is_flagged_with_key_and_remedy():
    config = check_config(smoke(mesh=mesh(1, 2)), "coarse")
    rows = model_accuracy(config)
    require_accurate(rows)  # the basis is as good as its mesh
    assert max(abs(row["basis_error"]) for row in rows) < 1e-6
    (sentence,) = mesh_warnings(rows)
    assert "structure.mesh" in sentence and "elements_per_span" in sentence
    worst = max(abs(row["mesh_error"]) for row in rows if row["flag"])
    assert worst > 0.05 and f"{100 * worst:.3g} %" in sentence


def test_a_long_support_of_two_points_hides_nothing_of_the_mesh():
    """One element joins the points of a support, whatever the mesh: it is cut in two as well."""
    data = smoke(mesh=mesh(40, 80), leg_length_m=2.0)
    for support in data["supports"]:
        support.update(height_m=1.6, points=2, at_m=[support["at_m"][0], 0.0, 1.0])
    data["points"] = {
        name: [place[0], place[1], place[2] + 1.3] for name, place in SMOKE["points"].items()
    }
    rows = model_accuracy(check_config(data, "long"))
    assert [row for row in rows if row["flag"] == "mesh"]


def test_a_basis_that_misses_an_excited_mode_is_refused():
    data = smoke()
    data["basis"] = {
        "free_modes_to_Hz": 40.0,
        "constrained_modes_to_Hz": 40.0,
        "attachment_shapes": False,
    }
    rows = model_accuracy(check_config(data, "poor"))
    with pytest.raises(
        ModelAccuracyError, match=r"^basis: mode .* Hz .* raise basis.free_modes_to_Hz"
    ):
        require_accurate(rows)


def test_a_table_of_quality_without_a_mode_is_refused():
    config = load_config(ROOT / "config" / "smoke.yaml")
    rows = basis_frequency_errors(config)
    require_complete(rows, config.basis)
    lost = next(row for row in rows if row["vectors"] == "all" and row["mode"] == 3)
    with pytest.raises(ModelAccuracyError, match="the reduced model has no mode at"):
        require_complete([lost | {"relative_error": np.nan}], config.basis)


def test_rigid_motion_of_a_free_rod_is_no_error():
    rows = model_accuracy(load_config(ROOT / "config" / "examples" / "fuel_rod_grid.yaml"))
    rigid = [row for row in rows if row["condition"] == "free" and row["full_Hz"] == 0.0]
    assert len(rigid) == 6
    assert all(row["basis_error"] == row["mesh_error"] == 0.0 for row in rigid)


def test_reduced_matrices_are_compared_with_the_full_ones(tmp_path):
    size = 500
    chain = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    force = {"kind": "harmonic", "point": "middle", "direction": [1.0, 0.0, 0.0]}
    config = matrix_study(
        tmp_path,
        np.eye(size),
        1.0e8 * chain,
        {"middle": 250, "tip": 499},
        supports=[{"name": "stop", "point": "tip", "stiffness_N_per_m": 1.0e6}],
        basis={"free_modes_to_Hz": 200.0},
        excitation=force | {"frequency_Hz": 20.0},
    )
    rows = model_accuracy(config)
    number = np.arange(1, 8)
    exact = 2.0e4 * np.sin(0.5 * np.pi * number / (size + 1)) / (2.0 * np.pi)
    free = [row for row in rows if row["condition"] == "free"]
    assert [row["full_Hz"] for row in free] == pytest.approx(exact, rel=1e-9)
    assert max(abs(row["basis_error"]) for row in rows) < 1e-6
    assert all(np.isnan(row["mesh_error"]) and not row["flag"] for row in rows)
