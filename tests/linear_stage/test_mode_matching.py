"""Corrections find the tube's modes among those of a plate."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.config.reading import check_config
from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage.linearised import same_modes
from vibroimpact.reduction.reduced_model import build_model

PLATE = {
    "mass_kg": 0.7,
    "stiffness_N_per_m": 2.5e5,
}  # 95.1 Hz, between the third and the fourth mode
SEEN = np.array([0, 2, 4, 5])


@pytest.fixture(scope="module")
def values(study_config):
    """The study's configuration with both plates flexible, in plain values."""
    plain = study_config.model_dump(mode="json")
    return plain | {"supports": [support | {"plate": PLATE} for support in plain["supports"]]}


@pytest.fixture(scope="module")
def with_plates(values):
    """The model of it."""
    return build_model(check_config(values, "with plates"))


def test_modes_are_matched_by_shape(study_model, with_plates):
    found = same_modes(with_plates, SEEN, study_model)
    assert found.tolist() == [0, 2, 8, 9]
    assert with_plates.omega[found] == pytest.approx(study_model.omega[SEEN])


def test_correction_follows_the_mode_not_its_number(study_model, with_plates):
    nuisance = linear.Nuisance(
        SEEN, np.array([1.0, 1.0, 1.01, 1.0]), np.array([1.0, 1.0, 1.2, 1.0]), np.ones(1)
    )
    moved = linear.corrected(with_plates, nuisance, study_model)
    assert np.flatnonzero(moved.damping != with_plates.damping).tolist() == [8]
    assert moved.omega[8] == pytest.approx(1.01 * study_model.omega[4])


def test_close_modes_are_each_where_they_were_seen(study_model):
    """The two planes of a straight tube: the second mode may be the lower one."""
    pair = replace(study_model, omega=np.concatenate([[200.0, 200.0], study_model.omega[2:]]))
    nuisance = linear.Nuisance(np.array([0, 1]), np.array([1.003, 0.999]), np.ones(2), np.ones(1))
    assert linear.corrected(pair, nuisance).omega[:2] == pytest.approx([200.6, 199.8])


@pytest.mark.parametrize("factor", np.linspace(2.0, 12.0, 23))
def test_a_mode_fitted_far_above_the_next_is_a_model(study_model, factor):
    """As of a record that a force nobody measured drives."""
    found = linear.neutral([1, 3], 1)
    moved = linear.corrected(study_model, replace(found, frequency=np.array([factor, 1.0])))
    assert moved.omega[1] == pytest.approx(factor * study_model.omega[1])
