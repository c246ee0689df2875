"""Steps down from the best run, on changes that are made up."""

import numpy as np
import pytest

from tests.white_null import white_null
from vibroimpact.missing_effect.gauss_newton import best_run, descend
from vibroimpact.missing_effect.search import Search

VALUES, NOISE = 200, 1.0e-2
AXES = np.linalg.qr(np.random.default_rng(4).standard_normal((VALUES, 3)))[0].T
SPRING = "cubic_stiffness@along_tube"  # two parameters
ANSWER = np.array([0.62, 0.44])
STOP = "clearance@along_tube"  # three
SCALES = dict.fromkeys(
    (
        "one",
        "searched_from",
        "searched_length",
        "cubic",
        "contact_stiffness",
        "displacement",
        "tube_translation",
    ),
    1.0,
)


def bent(unit):
    """Return (value,): a change along a valley that is bent, its size by the first parameter."""
    size, place = unit[:2]
    return 90.0 * size * AXES[0] + 60.0 * (place - size**2) * AXES[1] + 20.0 * place**2 * AXES[2]


class Valley(Search):
    """A Search whose runs are looked up; it fails where `closed` says so."""

    closed = staticmethod(lambda unit: False)

    def _tried(self, candidate, unit, first_seed):
        if self.closed(unit):
            return "thrown off"
        random = np.random.default_rng(first_seed)
        return bent(unit) + NOISE * random.standard_normal((2, VALUES))


@pytest.fixture
def valley():
    """Return a Valley with one run, far from the answer."""
    null = white_null(bent(ANSWER) + np.random.default_rng(1).standard_normal(VALUES))
    search = Valley(None, null, SCALES)
    search.run([(SPRING, np.array([[0.3, 0.8]]))])
    return search


def test_a_bent_valley_is_followed_to_the_answer(valley):
    before = best_run(valley, SPRING)[2]
    descend(valley, SPRING)
    unit, _, left = best_run(valley, SPRING)
    assert np.abs(unit - ANSWER).max() < 0.03
    assert left < 1.3 * VALUES < before


def test_nothing_is_run_where_no_more_is_left_than_chance(valley):
    valley.run([(SPRING, ANSWER[None])])
    valley.null.measured[:] = bent(ANSWER)
    known = len(valley.trials[SPRING].noise)
    descend(valley, SPRING)
    assert len(valley.trials[SPRING].noise) == known


def test_a_neighbour_that_cannot_be_run_ends_it(valley):
    valley.closed = lambda unit: unit[0] > 0.31
    descend(valley, SPRING)
    trial = valley.trials[SPRING]
    assert len(trial.failed) == 1
    assert len(trial.noise) == 2


def test_it_ends_where_the_search_does(valley):
    """With fewer runs than an explanation has parameters."""
    valley.run([(STOP, np.array([[0.3, 0.8, 0.5], [0.4, 0.8, 0.5]]))])
    valley.most = 0.0
    descend(valley, STOP)
    assert valley.over and len(valley.trials[STOP].noise) == 2


def test_an_answer_out_of_the_searched_range_is_met_at_its_edge(valley):
    valley.null.measured[:] = bent(np.array([1.2, 0.9]))
    descend(valley, SPRING)
    units = valley.trials[SPRING].unit
    assert units.min() >= 0.0 and units.max() == 1.0
    assert best_run(valley, SPRING)[0][0] == pytest.approx(1.0)
