"""Intervals that hold an estimate by any law of its effect: runs by each other law, read by the
effect's own.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import law_directions
from vibroimpact.discrepancy.finalists import Finalist
from vibroimpact.discrepancy.screening import Path

NULL = SimpleNamespace(
    records=[0], blend=np.ones(1), freed=lambda free: SimpleNamespace(scattered=lambda rows: None)
)
BENCH = SimpleNamespace(corrected_by=lambda nuisance: None)
PATH = Path(np.array([[0.4], [0.5], [0.6]]), np.zeros((3, 1, 1)), np.full(3, 2), [None] * 3)


@pytest.fixture
def by_any_law(monkeypatch):
    """Return the function (estimates of the runs by each law, the own first) -> interval of a
    Finalist at 0.5 that was told within 0.49 to 0.51.
    """

    def run(*estimates):
        means = np.array(estimates)[:, None, None] if estimates else None
        monkeypatch.setattr(law_directions, "law_means", lambda *_: means)
        monkeypatch.setattr(
            law_directions, "calibrate", lambda bench, null, mean, *_: SimpleNamespace(unit=mean[0])
        )
        monkeypatch.setattr(law_directions, "fit_mask", lambda *_: None)
        candidate = SimpleNamespace(periodic=(), physical=lambda unit, scales: {})
        found = Finalist(
            candidate,
            np.array([0.5]),
            np.array([[0.49, 0.51]]),
            None,
            0.0,
            np.zeros((1, 2, 1)),
            PATH,
            [],
            np.zeros((0, 1, 1)),
        )
        return law_directions.within_any_law(BENCH, NULL, found, None).interval[0]

    return run


def test_low_biased_law_widens_the_interval_upwards(by_any_law):
    assert by_any_law(0.5, 0.47) == pytest.approx([0.49, 0.54])


def test_high_biased_law_widens_the_interval_downwards(by_any_law):
    assert by_any_law(0.5, 0.47, 0.52) == pytest.approx([0.47, 0.54])


def test_bias_of_the_fitted_law_itself_is_not_counted(by_any_law):
    assert by_any_law(0.46, 0.46, 0.43) == pytest.approx([0.49, 0.54])


def test_estimate_at_the_search_limit_is_ignored(by_any_law):
    assert by_any_law(0.5, 0.7, 0.47) == pytest.approx([0.49, 0.54])
    assert by_any_law(0.5, 0.3) == pytest.approx([0.49, 0.51])


def test_effect_with_one_law_keeps_its_interval(by_any_law):
    assert by_any_law() == pytest.approx([0.49, 0.51])
