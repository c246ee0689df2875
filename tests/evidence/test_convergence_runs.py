"""Runs converge with the step: linear modes and the energy of impacts at order 2, statistics within
their scatter.
"""

import numpy as np
import pytest

from evidence.validation.convergence import (
    period as convergence_period,
)
from evidence.validation.convergence import (
    runs as convergence_runs,
)
from evidence.validation.convergence.statistics import (
    energy_checks,
    seeds_of,
    statistics_checks,
    statistics_rows,
)
from vibroimpact.integration.batch import Schedule
from vibroimpact.study.simulation import seed_forces

# Chaos takes other paths on other processors: of 14 equal means with 32 seeds, one is beyond four
# standard errors in 1 of 200 runs; with 16 seeds, in 1 of 60.
SEEDS = 32
SHORT = {
    "record.duration_s": 5.0,
    "integration.start_up_s": 1.0,
    "spectra.segment_s": 2.0,
    "grid.seeds": SEEDS,
}


@pytest.fixture(scope="module")
def rows(study_config):
    """Return short runs at two steps, 20 N."""
    patch = pytest.MonkeyPatch()
    for key, value in SHORT.items():
        patch.setitem(convergence_runs.RUN, key, value)
    found = convergence_runs.run_rows(
        study_config, "step", values=(25600, 51200), loads=(20.0,), seeds=SEEDS
    )
    patch.undo()
    return found


def test_modes_shift_as_the_trapezoidal_rule_does(study_config):
    rows = convergence_period.period_rows(study_config, rates=(51200, 102400, 204800))
    assert [
        check.row() for check in convergence_period.period_checks(rows) if not check.passed
    ] == []
    assert [row["shift"] for row in rows] == pytest.approx([row["exact"] for row in rows], rel=1e-3)


def test_a_seed_has_the_same_force_at_every_step(study_config):
    # The same lines: what is left is the one step by which the first sample precedes the run, and
    # the normalisation over the record.
    forces = []
    for rate in convergence_runs.STEP_RATES:
        run, _ = convergence_runs.step_variant(study_config, rate)
        schedule = Schedule(
            rate,
            run.record.sampling_frequency_Hz,
            run.integration.start_up_s,
            run.record.duration_s,
        )
        first = round(schedule.start_up * rate) + 1
        forces.append(
            seed_forces(run, schedule, 0, 1)[0].values(first, 16 * rate)[:: rate // 25600]
        )
    assert all(np.sqrt(np.mean((force - forces[-1]) ** 2)) < 0.03 for force in forces)


def test_impact_energy_balance_is_second_order_in_the_step(rows):
    checks = energy_checks(statistics_rows(rows))
    assert len(checks) == 1 and checks[0].passed, checks[0].row()


def test_halving_the_step_leaves_statistics_unchanged(rows):
    table = [
        row
        for row in statistics_rows(rows)
        if not row["statistic"].startswith(("rms_stress", "peak_stress"))
    ]  # filtered: see the captions
    compared = [
        row | {"value": 51200, "axis": "step"} if row["value"] == 25600 else row | {"value": 0}
        for row in table
    ]
    checks = statistics_checks(compared)
    assert len(checks) > 8 and [check.row() for check in checks if not check.passed] == []


def test_shifted_statistic_is_detected(rows):
    moved = [
        row | {"rms_force_N": row["rms_force_N"] * (1.5 if row["value"] == 25600 else 1.0)}
        for row in rows
    ]
    row = next(
        row
        for row in statistics_rows(moved)
        if row["statistic"] == "rms_force_N" and row["value"] == 25600
    )
    assert row["difference"] > 4.0 * row["standard_error"]


def test_seeds_are_paired_by_their_number(rows):
    assert np.array_equal(seeds_of(rows, "step", 51200, 20.0, "seed"), np.arange(SEEDS))
    assert np.array_equal(
        seeds_of(rows[::-1], "step", 51200, 20.0, "rms_force_N"),
        seeds_of(rows, "step", 51200, 20.0, "rms_force_N"),
    )
