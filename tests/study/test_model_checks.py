"""What the checks of a study say of its model before anything runs."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml

from vibroimpact.cli import main
from vibroimpact.config.reading import ConfigError, changed_config, check_config
from vibroimpact.identify.case_estimates import standard_errors
from vibroimpact.study.model_checks import check_model

ROOT = Path(__file__).parents[2]
SMOKE = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
SPRING = {"name": "spring", "point": "apex", "direction": [0.0, 1.0, 0.0]}
FORCE = {"kind": "harmonic", "point": "a", "direction": [0.0, 1.0, 0.0], "frequency_Hz": 2.0}
CHAIN = {
    "study": "chain",
    "structure": {
        "kind": "chain",
        "masses": [{"name": "a", "mass_kg": 1.0}],
        "springs": [{"between": ["ground", "a"], "stiffness_N_per_m": 1.0e4}],
    },
    "excitation": {"kind": "none"},
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    "record": {"duration_s": 1.0, "sampling_frequency_Hz": 2048},
}


def smoke(place="", value=None):
    """The smoke study with the value at a dotted place changed."""
    data = copy.deepcopy(SMOKE)
    *parts, last = place.split(".") if place else [None]
    level = data
    for part in parts:
        level = level[int(part)] if part.isdigit() else level.setdefault(part, {})
    if last:
        level[last] = value
    return data


@pytest.mark.parametrize(
    ("place", "value", "words"),
    [
        ("supports.0.stiffness_N_per_m", 1.0e12, ["contact stiffness 2e+11", "steps_per_second"]),
        ("supports.1.damping_N_s_per_m", 1.0e6, ["contracts by", "dampers"]),
        ("elements", [SPRING | {"stiffness_N_per_m": -1.0e6}], ["'spring'", "-1e+06 N/m", "cubic"]),
        ("elements", [SPRING | {"other_point": "apex", "stiffness_N_per_m": 1.0}], ["no effect"]),
        ("mode_frequency_factors", [1.0] * 500, ["mode_frequency_factors has 500 values"]),
        (
            "supports.0.plate",
            {"mass_kg": 1.0e-12, "stiffness_N_per_m": 1.0e12, "damping_ratio": 0.01},
            ["rad in a step", "plate"],
        ),
        (
            "structure.root",
            {"kind": "springs", "translation_N_per_m": 1e-6, "rotation_N_m_per_rad": 1e-6},
            ["modes without stiffness", "springs that are not so soft"],
        ),
        (
            "basis",
            {"free_modes_to_Hz": 20.0, "constrained_modes_to_Hz": 1.0, "attachment_shapes": False},
            ["basis: mode 2 free, 28.98", "is missing", "raise basis.free_modes_to_Hz"],
        ),
    ],
)
def test_a_model_that_can_not_run_is_refused(place, value, words):
    (problem,) = check_model(check_config(smoke(place, value), "mine")).problems
    assert [word for word in words if word not in problem] == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"excitation": FORCE}, "excitation: the force has no effect"),
        ({"basis": {"free_modes_to_Hz": 30.0}}, "keeps all its modes"),
        (
            {
                "structure": {
                    "kind": "identified",
                    "modes": [
                        {"frequency_Hz": 1.0, "damping_ratio": 0.01, "shape": {"a": {"z": 1.0}}}
                    ],
                },
                "supports": [{"name": "stop", "point": "a", "stiffness_N_per_m": 1.0}],
            },
            "supports[0]: 'stop' has no effect",
        ),
    ],
)
def test_keys_without_effect_are_refused(changes, words):
    (problem,) = check_model(check_config(CHAIN | changes, "mine")).problems
    assert words in problem


def test_a_negative_spring_that_stiffens_is_allowed():
    spring = SPRING | {"stiffness_N_per_m": -1.0e6, "cubic_N_per_m3": 1.0e12}
    assert check_model(check_config(smoke("elements", [spring]), "mine")).problems == ()


def test_the_study_has_no_problem_and_no_warning(study_config):
    found = check_model(study_config)
    assert (found.problems, found.warnings) == ((), ())


def test_check_says_what_the_model_can_not_do(tmp_path, capsys, reliability):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(smoke("supports.0.stiffness_N_per_m", 1.0e12)))
    assert main(["check", str(path)]) == 1
    assert f"{path}: contact stiffness 2e+11 N/m is too stiff" in capsys.readouterr().err
    reliability.fault(
        "a contact too stiff for the step", "refused by the checks, with the steps that are needed"
    )


def test_check_warns_of_a_coarse_mesh(tmp_path, capsys, reliability):
    path = tmp_path / "mine.yaml"
    mesh = {"elements_per_span": 1, "elements_per_bend": 1}
    path.write_text(yaml.safe_dump(smoke("structure.mesh", mesh)))
    assert main(["check", str(path)]) == 0
    shown = capsys.readouterr()
    assert (
        f"{path}: warning: structure.mesh is coarse" in shown.err and "study 'smoke'" in shown.out
    )
    reliability.fault(
        "a mesh that is too coarse", "a warning in the checks, in the tables and on the page"
    )


def test_exchanged_matrices_are_told(tmp_path):
    for name, value in (("mass", 1.0e6), ("stiffness", 2.0)):
        np.savez(tmp_path / f"{name}.npz", **{name: value * np.array([[2.0, -1.0], [-1.0, 2.0]])})
    files = {name: str(tmp_path / f"{name}.npz") for name in ("mass", "stiffness")}
    points = {"a": {"y": 0}, "b": {"y": 1}}
    force = {"kind": "band_limited", "point": "a", "direction": [0.0, 1.0, 0.0]}
    values = {
        "structure": {"kind": "matrices", "points": points, **files},
        "excitation": {**force, "band_Hz": [5.0, 200.0]},
    }
    problems = check_model(check_config(CHAIN | values, "mine")).problems
    assert "exchange the two matrices" in problems[-1]
    exchanged = dict(zip(files, reversed(files.values()), strict=True))
    values["structure"] |= exchanged
    assert check_model(check_config(CHAIN | values, "mine")).problems == ()


def test_check_names_the_file_of_a_negative_stiffness(tmp_path, capsys, reliability):
    for name, matrix in (("mass", np.eye(2)), ("stiffness", -1.0e4 * np.eye(2))):
        np.savez(tmp_path / f"{name}.npz", **{name: matrix})
    structure = {
        "kind": "matrices",
        "mass": str(tmp_path / "mass.npz"),
        "stiffness": str(tmp_path / "stiffness.npz"),
        "points": {"tip": {"x": 0}},
    }
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(CHAIN | {"structure": structure}))
    assert main(["check", str(path)]) == 1
    assert f"{tmp_path / 'stiffness.npz'}: has a negative eigenvalue" in capsys.readouterr().err
    reliability.fault("matrices with a negative eigenvalue", "refused with file and frequency")


@pytest.mark.parametrize(("duration", "told"), [(4.0, True), (10.0, True), (11.0, False)])
def test_a_record_of_few_segments_is_a_warning(duration, told):
    # Segments of 4 s; at 11 s a bin has 9 degrees of freedom, of which 8 are asked for.
    found = check_model(check_config(smoke("record.duration_s", duration), "mine"))
    words = f"record.duration_s = {duration:g} is"
    assert found.problems == ()
    assert any(words in each and "record 11 s" in each for each in found.warnings) == told


UNSEEN = {  # what identifies nothing: changes -> the sentence that refuses it
    "no supports": ({"supports": []}, "there are no supports: leave identification out"),
    "on the clamp": ({"identification.response_point": "root"}, "'root' does not move along y"),
    "one place": (
        {"identification.lscf.references": ["bend_45", "shaker"]},
        "references[1] = 'shaker' moves as the reference 'bend_45' does",
    ),
    "line across": ({"record.shape_line.direction": "x"}, "the force, along y, moves nothing"),
    "undamped": ({"damping": {"kind": "modal", "other_ratio": 0.0}}, "have none"),
    "one stop": (
        {"supports.profile": {"kind": "planes", "normals_deg": [0.0]}},
        "the force moves no contact point",
    ),
}


@pytest.mark.parametrize(("changes", "words"), UNSEEN.values(), ids=UNSEEN)
def test_what_can_not_be_identified_is_refused(changes, words):
    data = smoke("points.root", [-0.30, 0.0, 0.0])
    data["record"]["sensors"]["points"] = ["apex", "bend_45", "shaker", "root"]
    config = check_config(data, "mine")
    assert check_model(config).problems == ()
    try:
        problems = check_model(changed_config(config, changes)).problems
    except ConfigError as error:
        problems = error.problems
    assert len(problems) == 1 and words in problems[0]


def test_negative_variances_are_errors_without_end():
    covariance = np.array([[4.0, 0.0, 0.0], [0.0, -1e-9, 0.0], [0.0, 0.0, np.nan]])
    assert np.array_equal(standard_errors(covariance), [2.0, np.inf, np.nan], equal_nan=True)


def test_a_remedy_is_one_that_the_key_takes():
    (problem,) = check_model(
        check_config(smoke("supports.0.damping_N_s_per_m", 1e20), "mine")
    ).problems
    assert "no integration.steps_per_second is enough" in problem and "at least" not in problem


def test_supports_that_meet_are_a_model():
    below = smoke("supports.1.at_m", [-0.3, 0.0, 0.38])
    assert check_model(check_config(below, "mine")).problems == ()


def test_a_force_across_a_chain_with_sensors_is_blamed():
    sensors = {"sensors": {"points": ["a"], "directions": ["x"]}}
    force = {"kind": "harmonic", "point": "a", "frequency_Hz": 2.0}
    across = {"excitation": force | {"direction": [0.0, 1.0, 0.0]}}
    mine = CHAIN | across | {"record": CHAIN["record"] | sensors}
    (problem,) = check_model(check_config(mine, "mine")).problems
    assert problem.startswith("excitation: the force has no effect")
