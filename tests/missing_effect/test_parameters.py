"""Where parameters may lie: a valley that even samples step over, against its law."""

import numpy as np
import pytest

from tests.white_null import white_null
from vibroimpact.missing_effect import constants
from vibroimpact.missing_effect.evidence import fit
from vibroimpact.missing_effect.parameters import estimate

VALUES, SIZE = 40, 200.0
AXIS = np.eye(VALUES)[:1]


class Sum:
    """An emulator of a change by the sum of two parameters alone, which is known."""

    directions = AXIS
    excess = np.zeros(1)
    run = np.array([[0.3, 0.5], [0.6, 0.2]])

    def __call__(self, unit):
        unit = np.atleast_2d(unit)
        return SIZE * unit.sum(axis=1, keepdims=True), np.zeros((len(unit), 1))

    def open_along(self, unit, directions, variance):
        return directions, variance


@pytest.fixture
def null(monkeypatch):
    monkeypatch.setattr(constants, "LAWS", ((0.0, 1.0),))
    chance = np.random.default_rng(4).standard_normal(VALUES)
    chance[0] = 0.0
    return white_null(chance + 0.8 * SIZE * AXIS[0])


class Straight(Sum):
    """The change is that of one parameter, which is known."""

    run = np.array([[0.2], [0.6]])


def test_interval_holds_nine_tenths_of_a_normal_law(null):
    unit, interval = estimate(Straight(), null, fit(Straight(), 1, null))
    assert unit == pytest.approx(0.8, abs=0.001)
    assert interval[0] == pytest.approx(0.8 + 1.645 / SIZE * np.array([-1.0, 1.0]), abs=0.0015)


def test_interval_is_as_long_as_the_valley(null):
    """The sum is 0.8, and known to 1 in 200: either parameter is anywhere from 0 to 0.8."""
    unit, interval = estimate(Sum(), null, fit(Sum(), 2, null))
    assert interval == pytest.approx(np.array([[0.04, 0.76]] * 2), abs=0.06)
    assert unit.sum() == pytest.approx(0.8, abs=0.01)


class Bent(Sum):
    """The change is that of the radius: a valley along an arc."""

    run = np.array([[0.0, 0.8], [0.8, 0.0]])

    def __call__(self, unit):
        unit = np.atleast_2d(unit)
        return SIZE * np.hypot(*unit.T)[:, None], np.zeros((len(unit), 1))


def test_value_lies_in_a_bent_valley(null):
    unit, interval = estimate(Bent(), null, fit(Bent(), 2, null))
    assert np.hypot(*unit) == pytest.approx(0.8, abs=0.02)
    assert np.all(interval[:, 0] < 0.15) and np.all(interval[:, 1] > 0.7)
