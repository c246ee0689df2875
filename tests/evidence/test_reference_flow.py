"""F1 to F12: flow and wear, each against its reference."""

from pathlib import Path

import numpy as np
import pytest

from evidence.validation.reference import flow_in_time
from evidence.validation.reference.runs import reference_group
from vibroimpact.excitation.fluid_elastic import fluid_force

FOLDER = Path(__file__).resolve().parents[2] / "config" / "reference"
COUNT = {1: 3, 2: 3, 3: 6, 4: 4, 5: 2, 6: 6, 7: 3, 8: 5, 9: 3, 10: 3, 11: 2, 12: 3}


@pytest.fixture(scope="module")
def checks():
    """All checks, run once."""
    return reference_group("flow", None, FOLDER)[0]


@pytest.mark.parametrize(("number", "count"), COUNT.items())
def test_reference_case_of_a_flow(checks, number, count):
    chosen = [check for check in checks if check.case == f"F{number}"]
    assert len(chosen) == count
    assert [check.row() for check in chosen if not check.passed] == []


def test_rows_are_in_the_order_of_their_cases(checks):
    assert [check.case for check in checks] == [f"F{n}" for n, k in COUNT.items() for _ in range(k)]


def test_a_stop_that_pulls_holds_the_cycle_closer():
    """Without the pull of its damper a stop lets the mass move 17 % further."""
    k, c = 2.0e4, 4.5
    pulls, pushes = (flow_in_time.solved_cycle(k, c, least) for least in (-float("inf"), 0.0))
    assert 1.1 * pulls < pushes


def test_stiffness_of_lags_drifts_with_their_damping():
    """Causality: at a constant p C_d the slope of C_k over ln(omega) is 2/pi of it."""
    force = fluid_force(flow_in_time.LAGGED, flow_in_time.DIAMETER)
    omega = 2.0 * np.pi * 30.0 * np.exp([-0.01, 0.0, 0.01])[:, None]
    lags = (1j * omega / (1j * omega + np.array(force.fixed_rates))) @ np.array(force.amplitudes)
    slope = (lags[2] - lags[0]).real / 0.02
    assert slope == pytest.approx(2.0 / np.pi * lags[1].imag, rel=0.03)
    share = 0.64 * 0.01 * slope / lags[1].imag  # of the stiffness, at 0.8 V_c and 1 % damping
    assert share == pytest.approx(flow_in_time.DRIFT, rel=0.03)
