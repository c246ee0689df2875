"""Intervals: the scatter of an estimate over the completed model's own seeds, and where what was
simulated ends them.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import estimate_scatter
from vibroimpact.discrepancy.finalists import Finalist
from vibroimpact.discrepancy.neighbourhood import near, offset
from vibroimpact.discrepancy.screening import Path

NULL = SimpleNamespace(
    blend=np.ones(1), freed=lambda free: SimpleNamespace(scattered=lambda rows: None)
)


def path_at(*points):
    """A Path of points of one parameter that holds nothing else."""
    return Path(
        np.array(points)[:, None],
        np.zeros((len(points), 1, 1)),
        np.full(len(points), 2),
        [None] * len(points),
    )


@pytest.fixture
def widened(monkeypatch):
    """Return the function (estimates of the seeds, scores of the points) -> interval of a Finalist
    at 0.5 that was told within 0.49 to 0.51.
    """

    def run(estimates, scores, points=(0.4, 0.5, 0.6, 0.8)):
        told = iter(estimates)
        monkeypatch.setattr(
            estimate_scatter, "calibrate", lambda *_: SimpleNamespace(unit=np.array([next(told)]))
        )
        monkeypatch.setattr(estimate_scatter, "scores_along", lambda *_: np.array(scores))
        monkeypatch.setattr(estimate_scatter, "fit_mask", lambda *_: None)
        candidate = SimpleNamespace(periodic=())
        found = Finalist(
            candidate,
            np.array([0.5]),
            np.array([[0.49, 0.51]]),
            None,
            0.0,
            np.zeros((1, len(estimates), 1)),
            path_at(*points),
            [],
            np.zeros((0, 1, 1)),
        )
        return estimate_scatter.with_scatter(None, NULL, None, found).interval[0]

    return run


def test_interval_includes_the_scatter_over_seeds(widened):
    low, high = widened([0.45, 0.55, 0.45, 0.55], [0.0, 100.0, 0.0, 0.0])
    assert (0.5 - low, high - 0.5) == pytest.approx((np.hypot(0.01, 1.645 * 0.05),) * 2)


def test_agreeing_seeds_keep_the_interval(widened):
    assert widened([0.5, 0.5], [0.0, 100.0, 0.0, 0.0]) == pytest.approx([0.49, 0.51])


def test_points_not_clearly_worse_belong_to_the_interval(widened):
    assert widened([0.5, 0.5], [0.0, 100.0, 60.0, 90.0]) == pytest.approx([0.49, 0.8])
    assert widened([0.5, 0.5], [0.0, 100.0, 10.0, 90.0]) == pytest.approx(
        [0.49, 0.51]
    )  # beyond one that is


def test_interval_ends_at_clearly_worse_points(widened):
    assert widened([0.1, 0.9], [0.0, 100.0, 80.0, 0.0]) == pytest.approx([0.4, 0.8])


def test_distances_of_angles_wrap_round():
    assert offset(np.array([0.98]), np.array([0.03]), (0,)) == pytest.approx([-0.05])
    assert offset(np.array([0.98]), np.array([0.03]), ()) == pytest.approx([0.95])
    assert near(path_at(0.95, 0.5), np.array([0.05]), (0,)).tolist() == [True, False]
