"""Where an effect sits: places that were not screened are tried at the best point, and all others
again once it is known how strong it is.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import finalists
from vibroimpact.discrepancy.candidates import PLACES, spread
from vibroimpact.discrepancy.screening import Path

BENCH, NULL = SimpleNamespace(values={}), SimpleNamespace(records=[0])
# at the shaker the strongest comes nearest, on the leg the weaker is right, and above it a little
# more of it nearly so
SCORES = {
    "shaker": {1.0: -100.0, 0.6: -200.0},
    "leg": {1.0: -300.0, 0.6: 50.0},
    "upper": {0.6: -90.0, 0.66: -20.0},
    "apex": {},
}


def path(place, points):
    points = np.atleast_2d(points)
    return Path(
        points,
        np.array([[[SCORES[place].get(round(point[0], 2), -400.0)]] for point in points]),
        np.ones(len(points)),
        [None] * len(points),
    )


@pytest.fixture(autouse=True)
def simulated(monkeypatch):
    monkeypatch.setattr(
        finalists,
        "other_places",
        lambda candidate, values: [place for place in SCORES if place != candidate.name],
    )
    monkeypatch.setattr(
        finalists, "simulate_path", lambda bench, place, points, *_, **__: path(place, points)
    )
    monkeypatch.setattr(
        finalists, "scores_of", lambda bench, null, measured, path, fit: path.features[:, 0, 0]
    )


def place_of(at, points):
    """The place of what `placed` makes of a candidate at a place with some points, and its points
    there.
    """
    place, known = finalists.placed(
        BENCH, NULL, None, at, path(at, points), ["leg", "apex"], {}, None
    )
    return place, known.parameters[:, 0].tolist()


def test_other_places_are_tried_at_the_best_point():
    assert place_of("shaker", [[1.0], [0.6]]) == ("shaker", [1.0, 0.6])
    assert place_of("shaker", [[0.6]]) == ("leg", [0.6])


@pytest.mark.parametrize(("at", "expected"), [("shaker", "leg"), ("leg", "upper")])
def test_equally_good_place_is_refined_again(at, expected):
    """Within the scatter of two seeds."""
    candidate = SimpleNamespace(name=at, periodic=())
    found = SimpleNamespace(
        candidate=candidate, unit=np.array([0.6]), path=path(at, [[0.6]]), own=lambda null: null
    )
    assert finalists.placed_again(BENCH, NULL, None, found, {}, None)[0] == expected


def test_no_other_place_is_as_good():
    candidate = SimpleNamespace(name="leg", periodic=())
    found = SimpleNamespace(
        candidate=candidate, unit=np.array([0.3]), path=path("leg", [[0.6]]), own=lambda null: null
    )
    assert finalists.placed_again(BENCH, NULL, None, found, {}, None) is None


def test_screened_places_are_spread_over_the_tube():
    chosen = spread([f"place_{number}" for number in range(25)])
    assert len(chosen) == PLACES and chosen[0] == "place_0" and chosen[-1] == "place_24"
    assert spread(["a", "b"]) == ["a", "b"]
