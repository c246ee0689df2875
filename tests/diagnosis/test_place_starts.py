"""The place of a missing force by the holding force alone."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.config.problems import ConfigError
from vibroimpact.diagnosis.explanations import Point, Structure, Term
from vibroimpact.diagnosis.place_starts import KEPT, demanded_places, place_terms
from vibroimpact.effects.places import arc_length_m, between, turned_deg
from vibroimpact.effects.registry import EFFECTS


@pytest.mark.parametrize(("place_m", "way_deg"), [(0.9, 0.0), (1.4, 0.0), (0.9, 40.0)])
def test_a_force_is_placed_without_a_run_of_it(comparison, place_m, way_deg):
    """One that acts at an angle moves the tube across the shaker's force too."""
    hidden = Term("one_sided_stop", between(place_m, way_deg), (5.0e-5, 2.0e5))
    bench = played(comparison.screened(), Point((hidden,)))
    (place, turned), *_ = demanded_places(comparison, bench, Point())
    assert turned == pytest.approx(way_deg, abs=15.0)
    assert place == pytest.approx(place_m, abs=0.06 * comparison.sizes["tube_length"])


def test_a_place_that_makes_no_model_is_passed_over(comparison, monkeypatch):
    """Such as one within a root that the structure has as a spring."""
    hidden = Term("one_sided_stop", between(0.9, 0.0), (5.0e-5, 2.0e5))
    bench = played(comparison.screened(), Point((hidden,)))
    model = Structure.model

    def refusing(structure, point):
        if any(arc_length_m(term.location) < 1.2 for term in point.terms):
            raise ConfigError(["no law can act there"])
        return model(structure, point)

    monkeypatch.setattr(Structure, "model", refusing)
    places = [place for place, _ in demanded_places(comparison, bench, Point())]
    assert places and min(places) > 1.2


def test_effects_are_tried_at_the_places_that_are_demanded(comparison):
    hidden = Term("one_sided_stop", "arc_900_0mm_turned_0_0deg", (5.0e-5, 2.0e5))
    bench = played(comparison.screened(), Point((hidden,)))
    effects = [EFFECTS[name] for name in ("one_sided_stop", "clearance", "added_mass", "gap")]
    found = place_terms(comparison, bench, Point(), effects)
    stops = [term for term in found if term.effect_id == "one_sided_stop"]
    assert {term.effect_id for term in found} == {"one_sided_stop", "clearance"}
    assert {0.0, 180.0} <= {turned_deg(term.location) for term in stops}
    assert len({arc_length_m(term.location) for term in stops}) == KEPT


def test_two_sensors_place_nothing(comparison):
    bench = comparison.screened()
    still = [replace(each, motion=each.motion * (np.arange(6) < 2)) for each in bench.stretches]
    assert demanded_places(comparison, replace(bench, stretches=tuple(still)), Point()) == []
