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


def test_a_law_that_reads_too_low_opens_the_interval_upwards(by_any_law):
    assert by_any_law(0.5, 0.47) == pytest.approx([0.49, 0.54])


def test_a_law_that_reads_too_high_opens_it_downwards(by_any_law):
    assert by_any_law(0.5, 0.47, 0.52) == pytest.approx([0.47, 0.54])


def test_what_the_own_law_reads_of_its_own_runs_is_no_difference_of_laws(by_any_law):
    assert by_any_law(0.46, 0.46, 0.43) == pytest.approx([0.49, 0.54])


def test_a_reading_at_the_end_of_where_it_was_looked_for_is_none(by_any_law):
    assert by_any_law(0.5, 0.7, 0.47) == pytest.approx([0.49, 0.54])
    assert by_any_law(0.5, 0.3) == pytest.approx([0.49, 0.51])


def test_an_effect_of_one_law_keeps_its_interval(by_any_law):
    assert by_any_law() == pytest.approx([0.49, 0.51])
