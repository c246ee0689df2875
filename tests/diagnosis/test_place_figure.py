"""Where a found effect is drawn."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.reports.figures.diagnosis.place import Places

QUARTER = np.linspace(0.0, 0.5 * np.pi, 400)
BEND = np.stack([np.sin(QUARTER), 0.0 * QUARTER, 1.0 - np.cos(QUARTER)], axis=1)


def test_an_effect_between_points_is_drawn_at_its_arc_length():
    places = Places(BEND, {}, {}, {}, {}, {})
    (found,) = places.of(SimpleNamespace(id="clearance", location="arc_523_6mm"))
    assert found == pytest.approx([0.5, 0.0, 1.0 - np.sqrt(0.75)], abs=1.0e-3)  # at 30 degrees
    nowhere = Places(None, {}, {}, {}, {}, {})  # no tube to draw it on
    assert nowhere.of(SimpleNamespace(id="clearance", location="arc_523_6mm")) == []


def test_arrows_show_the_plane_of_a_straight_tube():
    line = np.linspace([0.0, 0.0, 0.0], [2.0, 0.0, 0.0], 50)
    along_y = {"s1": np.array([0.0, 1.0, 0.0])}
    places = Places(line, {}, {}, {"s1": np.array([0.5, 0.0, 0.0])}, {}, along_y)
    drawn = np.vstack([places.known(), places.tips(0.1)])
    assert np.ptp(drawn, axis=0) == pytest.approx([2.0, 0.1, 0.0])
