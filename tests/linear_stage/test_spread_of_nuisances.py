"""Nuisances have a Student law: a mode off by a little more than most is no effect, one that is off
by far is.
"""

import numpy as np
import pytest

from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.nuisance import spread


@pytest.mark.parametrize("sigma", [0.0, 1.0, 3.0, 4.2, 5.0])
def test_spread_is_that_of_a_student_law(sigma):
    """Of one nuisance that is known exactly the most probable variance is (nu + x^2) / (nu + 1)."""
    found, density = spread(np.array([sigma]), np.array([[1.0e-9]]), np.array([[1.0]]))
    variance = (priors.TAILS + sigma**2) / (priors.TAILS + 1.0)
    assert found[0] ** 2 == pytest.approx(variance, rel=1.0e-5)
    own = 0.5 * (priors.TAILS + 1.0) * np.log(variance)
    score = density - 0.5 * sigma**2 / variance - 0.5 * np.log(variance)
    assert score == pytest.approx(-own - 0.5, abs=1.0e-4)


def test_spread_of_another_structure_is_limited():
    found, _ = spread(np.array([30.0]), np.array([[1.0e-9]]), np.array([[1.0]]))
    assert found[0] == pytest.approx(priors.WIDEST)
