"""Growth of a motion by the step itself: the prediction, runs that show it, and the refusal."""

import numpy as np
import pytest

from vibroimpact.config.reading import check_config
from vibroimpact.integration import every_step
from vibroimpact.integration.contact_convergence import IntegrationError, contact_contraction
from vibroimpact.integration.step_stability import (
    LARGEST_GROWTH,
    SAFE_OMEGA_STEP,
    require_stable_step,
    step_growth,
)
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import all_cases
from vibroimpact.study.model_checks import check_model
from vibroimpact.study.simulation import simulate_cases

MASSES = 12
HIGHEST_HZ = 99.0e3
STEPS_PER_SECOND = 100000


def chain_with_dampers(folder, **integration):
    """Matrices of masses on springs, with dampers that differ and modes to 99 kHz."""
    stiffness = 2.0 * np.eye(MASSES) - np.eye(MASSES, k=1) - np.eye(MASSES, k=-1)
    stiffness *= (2.0 * np.pi * HIGHEST_HZ) ** 2 / np.linalg.eigvalsh(stiffness)[-1]
    matrices = {
        "mass": np.eye(MASSES),
        "stiffness": stiffness,
        "damping": np.diag(np.linspace(0.0, 1.0e4, MASSES)),
    }
    for name, matrix in matrices.items():
        np.savez(folder / f"{name}.npz", **{name: matrix})
    return check_config(
        {
            "study": "bench",
            "structure": {
                "kind": "matrices",
                **{name: str(folder / f"{name}.npz") for name in matrices},
                "points": {"tip": {"x": 5}},
            },
            "supports": [{"name": "stop", "point": "tip", "stiffness_N_per_m": 1.0e9}],
            "damping": {"kind": "modal", "other_ratio": 0.0},
            "excitation": {"kind": "none"},
            "initial": {"displacement_m": {"tip": {"x": 1.0e-9}}},
            "integration": {
                "steps_per_second": STEPS_PER_SECOND,
                "start_up_s": 0.0,
                "imperfection": 0.0,
                **integration,
            },
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0], "seeds": 1},
            "record": {"duration_s": 0.05, "every_step": True},
        },
        "bench",
    )


def test_a_damped_run_grows_as_the_step_predicts(tmp_path, monkeypatch):
    """Unchecked, dampers on modes beyond half a turn per step feed them: 4e5 times in 0.05 s."""
    monkeypatch.setattr(every_step, "require_stable_step", lambda *_: None)
    config = chain_with_dampers(tmp_path)
    model = build_model(config)
    predicted = step_growth(model, 1.0 / STEPS_PER_SECOND, "exact")
    ((_, record),) = simulate_cases(config, model, all_cases(config.grid))
    size = np.abs(record["element_displacement"].values).max(axis=0)
    late = [size[first : first + 500].max() for first in (2000, 4500)]
    assert predicted == pytest.approx(np.log(late[1] / late[0]) / 2500, rel=0.05)
    assert predicted > 1000 * LARGEST_GROWTH


def test_a_step_that_feeds_a_motion_is_refused(tmp_path, reliability):
    config = chain_with_dampers(tmp_path)
    (problem,) = check_model(config).problems
    assert problem.startswith("integration.steps_per_second = 100000: ")
    assert "9.9e+04 Hz" in problem and "integration.scheme: newmark" in problem
    with pytest.raises(IntegrationError, match="grows by"):
        list(simulate_cases(config, build_model(config), all_cases(config.grid)))
    reliability.fault(
        "a step of the exact scheme that feeds a motion", "refused before any job, with the remedy"
    )


@pytest.mark.parametrize(
    "integration",
    [
        {"scheme": "newmark"},
        {"steps_per_second": int(np.ceil(2.0 * np.pi * HIGHEST_HZ / SAFE_OMEGA_STEP))},
    ],
)
def test_the_remedies_of_an_unstable_step_hold(tmp_path, integration):
    config = chain_with_dampers(tmp_path, **integration)
    assert check_model(config).problems == ()
    ((_, record),) = simulate_cases(config, build_model(config), all_cases(config.grid))
    size = np.abs(record["element_displacement"].values)
    assert size[:, -100:].max() < size[:, :100].max()


def test_springs_alone_can_feed_a_mode_near_half_a_turn(tmp_path):
    """Of one mode: growth 7.6e-3 at omega x step = 3.14 with a spring of k step² / m = 1."""
    from tests.support.oscillator import oscillator

    step = 1.0e-3
    near, below = (
        oscillator(1.0, (turn / step) ** 2, contact_stiffness=1.0 / step**2)
        for turn in (3.141, 2.8)
    )
    assert contact_contraction(near, step, "exact") < 0.5
    assert step_growth(near, step, "exact") > 1.0e-3
    assert step_growth(below, step, "exact") < 1.0e-9
    with pytest.raises(IntegrationError, match="omega x step = 3.14"):
        require_stable_step(near, 1.0 / step, "exact")


def test_an_unstable_structure_is_no_fault_of_the_step():
    """A negative element of -2 k on a spring k: the motion grows with sqrt(k / m), as it should."""
    from tests.support.oscillator import oscillator

    model = oscillator(1.0, 100.0, element={"stiffness": -200.0})
    assert abs(step_growth(model, 1.0e-3, "exact")) < LARGEST_GROWTH
    assert abs(step_growth(model, 1.0e-3, "newmark")) < LARGEST_GROWTH


def test_steps_of_the_study_feed_nothing(study_config, study_model):
    rate = study_config.integration.steps_per_second
    for scheme in ("exact", "newmark"):
        assert step_growth(study_model, 1.0 / rate, scheme) < 1.0e-9


@pytest.mark.parametrize(("coefficient", "refused"), [(1.0e-6, False), (3.0e-6, True)])
def test_damping_that_takes_the_digits_of_a_mode_is_refused(study_config, coefficient, refused):
    """C = b K of a mode at 130 kHz decays by exp(-100) in a step: unchecked, a force of 18 kN."""
    damping = {"kind": "rayleigh", "mass_coefficient_per_s": 0.5}
    data = study_config.model_dump(mode="json")
    data["damping"] = damping | {"stiffness_coefficient_s": coefficient}
    problems = check_model(check_config(data, "stiff")).problems
    assert len(problems) == refused
    if refused:
        assert "decays by exp(-100)" in problems[0] and "scheme: newmark" in problems[0]
        data["integration"] |= {"scheme": "newmark", "steps_per_second": 51200}
        assert check_model(check_config(data, "stiff")).problems == ()
