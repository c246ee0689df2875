"""Where an effect sits is told from what it does there: at one point of its parameters, or at each that is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import finalists
from vibroimpact.discrepancy.finalists import placed
from vibroimpact.discrepancy.screening import Path


@pytest.fixture
def at(monkeypatch):
    """Return the function (whole) -> (place, points that were simulated there): at the shaker the strongest comes nearest, on the leg the weakest is right."""
    scores = {("shaker", 1.0): -100.0, ("shaker", 0.6): -200.0, ("leg", 1.0): -300.0, ("leg", 0.6): 50.0, ("apex", 1.0): -400.0, ("apex", 0.6): -400.0}

    def path(place, points):
        points = np.atleast_2d(points)
        return Path(points, np.array([[[scores[place, point[0]]]] for point in points]), np.ones(len(points)), [None] * len(points))

    monkeypatch.setattr(finalists, "other_places", lambda candidate, values: ["leg", "apex"])
    monkeypatch.setattr(finalists, "simulate_path", lambda bench, place, points, *_, **__: path(place, points))
    monkeypatch.setattr(finalists, "_scores", lambda bench, null, measured, path, fit: path.features[:, 0, 0])

    def run(whole):
        own = path("shaker", [[1.0], [0.6]])
        place, known = placed(SimpleNamespace(values={}), SimpleNamespace(records=[0]), None, "shaker", own, {}, None, at=own.parameters if whole else None)
        return place, known.parameters[:, 0].tolist()

    return run


def test_at_the_best_point_alone(at):
    assert at(whole=False) == ("shaker", [1.0, 0.6])


def test_at_all_points(at):
    assert at(whole=True) == ("leg", [1.0, 0.6])
