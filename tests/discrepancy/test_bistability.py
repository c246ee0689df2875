"""What parts two ways that a record may go: told from pairs of runs, along the jump and as long as
it, and from no scatter.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy.branches import (
    branch_direction,
    deviations,
    pair_deviations,
    searched_by,
    with_branch,
)
from vibroimpact.discrepancy.likelihood import log_likelihood
from vibroimpact.discrepancy.null import Null
from vibroimpact.discrepancy.screening import Path

SIZE, POINTS, UNIT = 120, 10, np.array([0.5])
JUMP = np.where(
    np.arange(SIZE) < 20, -5.0, 0.0
)  # of every seed's scatter, in a sixth of the features
MEASURED, NOTHING = np.tile(JUMP, (2, 1)), np.zeros((0, 2, SIZE))


@pytest.fixture
def runs():
    """Return the function (share of runs that jump, seed) -> (Null, Path): two records, only the
    second of which has two ways.
    """

    def draw(share, seed=5, at=0.5, jump=JUMP):
        rng = np.random.default_rng(seed)
        both = rng.standard_normal((2, POINTS, 2, SIZE))
        both[:, :, 1] += (rng.random((2, POINTS)) < share)[..., None] * jump
        null = SimpleNamespace(
            covariance=np.tile(np.eye(SIZE), (2, 1, 1)), blend=np.full(SIZE, 1.0e6)
        )
        null.freed = lambda free: null
        path = Path(
            np.full((POINTS, 1), at),
            both.mean(axis=0),
            np.full(POINTS, 2),
            [None] * POINTS,
            both[0] - both[1],
        )
        return null, path

    return draw


def test_scatter_alone_shows_no_bistability(runs):
    null, path = runs(0.0)
    assert not branch_direction(NOTHING, null, MEASURED, path, UNIT, ()).any()


def test_jump_is_found_with_its_size_in_its_record(runs):
    null, path = runs(0.3)
    first, second = branch_direction(NOTHING, null, MEASURED, path, UNIT, ())[0]
    assert not first.any()
    assert abs(second @ JUMP) / np.linalg.norm(second) / np.linalg.norm(JUMP) > 0.8
    assert np.linalg.norm(second) == pytest.approx(np.linalg.norm(JUMP), rel=0.25)


def test_run_on_the_other_branch_is_no_contrary_evidence(runs):
    null, path = runs(0.3)
    direction = branch_direction(NOTHING, null, MEASURED, path, UNIT, ())[0, 1]
    measured = JUMP + np.random.default_rng(9).standard_normal(SIZE)
    free = np.eye(SIZE) + np.outer(direction, direction)
    assert log_likelihood(measured, np.eye(SIZE))[1] > SIZE + 100.0
    assert log_likelihood(measured, free)[1] < SIZE + 0.15 * JUMP @ JUMP
    other = np.roll(JUMP, 60) + np.random.default_rng(9).standard_normal(SIZE)
    assert log_likelihood(other, free)[1] > SIZE + 100.0


def test_small_jump_is_found_along_the_measurement(runs):
    null, path = runs(0.3, jump=0.4 * JUMP)
    assert np.sum(path.differences[:, 1] ** 2 / 2.0, axis=1).max() < SIZE + 90.0
    assert (
        abs(branch_direction(NOTHING, null, MEASURED, path, UNIT, ())[0, 1] @ JUMP)
        > 0.5 * 0.4 * JUMP @ JUMP
    )
    elsewhere = np.roll(MEASURED, 60, axis=1)
    assert not branch_direction(NOTHING, null, elsewhere, path, UNIT, ()).any()


def test_distant_points_show_no_bistability(runs):
    null, path = runs(0.3, at=0.9)
    assert not branch_direction(NOTHING, null, MEASURED, path, UNIT, ()).any()


def test_fixed_directions_stay_fixed(runs):
    null, path = runs(0.3)
    assert with_branch(NOTHING, null, MEASURED, path, UNIT, ()) is NOTHING
    assert with_branch(np.zeros((1, 2, SIZE)), null, MEASURED, path, UNIT, ()).shape == (2, 2, SIZE)


def test_path_runs_give_single_run_deviations(runs):
    null, path = runs(0.0)
    features = np.random.default_rng(3).standard_normal((2, 8, SIZE))
    rows = deviations(null, features, path, UNIT, ())
    assert rows.shape == (2, 8 + POINTS, SIZE)
    assert np.mean(rows[:, :8] ** 2) == pytest.approx(1.0, rel=0.1)
    assert np.mean(rows[:, 8:] ** 2) == pytest.approx(1.0, rel=0.1)


def test_point_with_one_run_gives_no_pair(runs):
    null, path = runs(0.0)
    path.differences[3:] = 0.0
    assert pair_deviations(null, path, UNIT, ()).shape == (2, 3, SIZE)


def test_search_covariance_includes_the_jump(runs):
    _, path = runs(0.3)
    features = np.random.default_rng(4).standard_normal((2, 16, SIZE))
    covariance = np.tile(2.0 * np.eye(SIZE), (2, 1, 1))
    null = Null(
        np.arange(2),
        features,
        features.mean(axis=1),
        covariance,
        covariance,
        np.zeros(SIZE, int),
        np.full(SIZE, 1.0e6),
    )
    assert searched_by(null, MEASURED, path, UNIT, (), NOTHING) is null
    own = searched_by(null, MEASURED, path, UNIT, (), np.zeros((1, 2, SIZE)))
    along = JUMP / np.linalg.norm(JUMP)
    first, second = (along @ one @ along for one in own.covariance)
    assert first < 4.0 < 100.0 < second
