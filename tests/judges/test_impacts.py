"""OpenSees judges the impacting tube: on the same nodes the two codes solve the same equations,
step by step.
"""

import numpy as np
import pytest

from evidence.validation.judges.impacts import (
    apart,
    impact_config,
    impact_force,
    impacts_of,
    judged_impacts,
    mesh_checks,
    mesh_rows,
    modes_checks,
    modes_rows,
    our_impacts,
)
from evidence.validation.judges.presence import JudgeAbsent
from tests.support.oracle import newmark_contact
from vibroimpact.reduction.reduced_model import build_model

SHORT_S, ALL_HZ = 0.04, 1.0e9
COARSE = {"structure.mesh.elements_per_span": 6, "structure.mesh.elements_per_bend": 16}


@pytest.fixture(scope="module")
def run(study_config):
    """(config, force, gap, Impacts of OpenSees) of a short run on a coarse mesh."""
    config = impact_config(study_config, COARSE)
    force, gap = impact_force(config.integration.steps_per_second, SHORT_S), min(config.grid.gap_m)
    try:
        return config, force, gap, judged_impacts(config, force, gap)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))


def test_the_run_has_impacts_from_both_sides(run):
    _, _, gap, judge = run
    assert impacts_of(judge.force) > 50
    assert judge.displacement.max() > 1.1 * gap and judge.displacement.min() < -1.1 * gap


def test_the_textbook_twin_is_opensees_to_round_off(run):
    config, force, gap, judge = run
    model = build_model(
        config.model_copy(
            update={"basis": config.basis.model_copy(update={"free_modes_to_Hz": ALL_HZ})}
        )
    )
    displacement, pushed = newmark_contact(
        model, gap, np.zeros((10, 2)), force[:, None], 1.0 / config.integration.steps_per_second
    )
    np.testing.assert_allclose(
        displacement[:, :, 1].T,
        judge.displacement[:, 1:],
        rtol=0.0,
        atol=1.0e-8 * np.abs(judge.displacement).max(),
    )
    np.testing.assert_allclose(
        pushed[:, :, 1].T, judge.force[:, 1:], rtol=0.0, atol=1.0e-8 * np.abs(judge.force).max()
    )
    assert np.all(displacement[:, :, 0] == 0.0)


def test_before_the_first_impact_the_two_agree_to_round_off(run):
    config, force, gap, judge = run
    ours = our_impacts(config, force, gap, ALL_HZ)
    before = slice(0, np.flatnonzero(judge.force.any(axis=0))[0])
    assert before.stop > 100
    assert (
        np.abs(ours.displacement[:, before] - judge.displacement[:, before]).max() < 1.0e-11 * gap
    )


def test_with_all_modes_only_the_contact_iteration_is_left(run):
    config, force, gap, judge = run
    assert max(apart(our_impacts(config, force, gap, ALL_HZ), judge).values()) < 1.0e-5


def test_the_difference_falls_with_the_modes(study_config):
    try:
        rows, _ = modes_rows(study_config, SHORT_S, (1000.0, 2000.0, 4000.0, 7500.0, ALL_HZ))
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    assert [check.quantity for check in modes_checks(rows) if not check.passed] == []
    for quantity in ("displacement", "contact force"):
        falling = [row["difference"] for row in rows if row["quantity"] == quantity][:4]
        assert all(
            next_one < before / 5.0 for before, next_one in zip(falling, falling[1:], strict=False)
        ), falling


def test_difference_is_second_order_in_bend_elements(study_config):
    try:
        rows = mesh_rows(study_config)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    (order,) = mesh_checks(rows)
    assert order.passed, order
