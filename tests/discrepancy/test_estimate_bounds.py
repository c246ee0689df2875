"""Intervals of estimates with few simulated points about them."""

from types import SimpleNamespace

import numpy as np

from vibroimpact.discrepancy.estimate_scatter import EXCLUDED, _as_simulated


def test_interval_stays_where_worse_points_enclose_the_estimate():
    """The best simulated point lies beyond a worse one: nothing that was simulated is left within
    the bounds, and the interval is that of the likelihood, cut to them.
    """
    path = SimpleNamespace(parameters=np.array([[0.1], [0.4], [0.6]]))
    scores = np.array([10.0, 8.0 - EXCLUDED, 9.0 - EXCLUDED])
    interval = _as_simulated(path, scores, np.array([0.5]), np.array([[0.3, 0.7]]), ())
    np.testing.assert_allclose(interval, [[0.4, 0.6]])
