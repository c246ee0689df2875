"""Least squares: known minima, the solver of scipy, and trial points that fail."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from vibroimpact.identify.least_squares import differences, minimise

TIME = np.linspace(0.0, 4.0, 30)
MEASURED = 2.0 * np.exp(-0.7 * TIME) + 0.05 * np.sin(11.0 * TIME)


def decay(values):
    """Error of a decaying exponential of values (amplitude, rate)."""
    return values[0] * np.exp(-values[1] * TIME) - MEASURED


def with_jacobian(values):
    error = decay(values)
    return error, differences(decay, values, error, np.full(values.size, 1.0e-7))


def test_rosenbrocks_valley_is_followed_to_its_end():
    def valley(x):
        slope = np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])
        return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]]), slope

    found = minimise(valley, np.array([-1.2, 1.0]), passes=200, settled=1.0e-12)
    assert found.values == pytest.approx([1.0, 1.0], abs=1.0e-6) and found.cost < 1.0e-12


def test_the_minimum_is_that_of_scipy():
    found = minimise(with_jacobian, np.array([1.0, 2.0]), passes=50, settled=1.0e-12)
    other = least_squares(decay, [1.0, 2.0], method="lm", xtol=1.0e-12, ftol=1.0e-12)
    assert found.values == pytest.approx(other.x, rel=1.0e-5)
    assert found.cost == pytest.approx(2.0 * other.cost, rel=1.0e-9)


def test_steps_that_fail_are_shortened():
    failed = []

    def decay_below(values):
        """The error, none where the rate is beyond 1."""
        if values[1] > 1.0:
            failed.append(values[1])
            return None
        return decay(values)

    found = minimise(
        with_jacobian, np.array([0.1, 0.05]), passes=80, settled=1.0e-12, error_of=decay_below
    )
    free = minimise(with_jacobian, np.array([1.0, 2.0]), passes=50, settled=1.0e-12)
    assert failed and found.values == pytest.approx(free.values, rel=1.0e-5)


def test_a_start_without_error_is_refused():
    with pytest.raises(ValueError, match="no finite error at their start"):
        minimise(lambda x: (np.array([np.nan]), np.eye(1)), np.zeros(1), passes=3)


def test_differences_of_a_failed_trial_are_zero():
    def error(x):
        return None if x[1] > 0.0 else np.array([3.0 * x[0]])

    slope = differences(error, np.zeros(2), np.zeros(1), np.array([0.5, 0.5]))
    assert slope.tolist() == [[3.0, 0.0]]
