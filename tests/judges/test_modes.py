"""OpenSees and CalculiX judge the tube's frequencies."""

import numpy as np
import pytest

from evidence.validation.judges.calculix import karman_factor, straight_tube_frequencies
from evidence.validation.judges.modes import (
    beam_frequencies,
    calculix_checks,
    opensees_checks,
    oval_bend_rows,
)
from evidence.validation.judges.opensees import tube_nodes
from evidence.validation.judges.presence import JudgeAbsent
from vibroimpact.structure.tube import build_structure


def failed(checks):
    """The quantities of the Checks that failed."""
    return [check.quantity for check in checks if not check.passed]


def test_frequencies_agree_with_opensees_over_nine_decades(study_config):
    try:
        checks = opensees_checks(study_config)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    assert failed(checks) == [] and len(checks) == 22


def test_opensees_nodes_are_those_of_the_mesh(study_config):
    nodes, tube = tube_nodes(study_config), build_structure(study_config)
    np.testing.assert_allclose(nodes.position, tube.nodes, atol=1.0e-12)
    np.testing.assert_allclose(nodes.position[nodes.contact], tube.contact.position, atol=1.0e-12)
    np.testing.assert_allclose(
        nodes.position[nodes.drive], study_config.points["shaker"], atol=1.0e-4
    )
    finer = tube_nodes(study_config, 3)
    np.testing.assert_allclose(finer.position[::3], nodes.position, atol=1.0e-12)
    np.testing.assert_array_equal(finer.contact, 3 * nodes.contact)


def test_calculix_solid_pipe_has_the_beam_frequencies(study_config):
    try:
        checks = calculix_checks(study_config)
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    assert failed(checks) == [] and len(checks) == 27


def test_the_solid_pipe_is_converged(study_config):
    try:
        coarse, fine = (
            straight_tube_frequencies(study_config, 1.0, 6, *bricks)
            for bricks in ((40, 12), (60, 16))
        )
    except JudgeAbsent as absent:
        pytest.skip(str(absent))
    assert np.abs(coarse / fine - 1.0).max() < 1.5e-4


def test_bend_of_beam_flexibility_changes_nothing(study_config):
    np.testing.assert_allclose(
        beam_frequencies(study_config, 1.0, 1.0 + 1.0e-12),
        beam_frequencies(study_config, 1.0),
        rtol=1.0e-9,
    )


def test_karman_factor_by_hand(study_config):
    # h = 1.27 * 300 / (10.475^2 * sqrt(0.91)) = 3.6399; 1 + 9 / (12 h^2 + 1)
    assert karman_factor(study_config.structure) == pytest.approx(1.05625, rel=1.0e-5)


def test_ovalised_bend_lowers_every_frequency_within_bound(study_config):
    changes = np.array([row["relative_change"] for row in oval_bend_rows(study_config)])
    assert np.all(changes < 0.0) and changes.min() > -0.5 * (
        karman_factor(study_config.structure) - 1.0
    )
