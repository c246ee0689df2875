"""A mass sits at any place of a tube, told by its arc length."""

import numpy as np
import pytest

from tests.support.effect_values import with_term
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.explanations import Term
from vibroimpact.effects import places
from vibroimpact.reduction.reduced_model import build_model


@pytest.fixture(scope="module")
def values(study_config):
    return study_config.model_dump(mode="json")


def arc_length_of(point, radius=0.3, leg=0.7):
    """Arc length in m of a point on the second leg of the study's tube."""
    return leg + np.pi * radius + leg - point[2] if point[0] > 0.0 else point[2]


def test_place_is_where_its_arc_length_says(values):
    leg = values["points"]["left_leg"]
    arc_length = arc_length_of(leg)
    named = places.with_mass(values, "extra", places.between(arc_length), 0.2)
    point = named["masses"][-1]["point"]
    assert named["points"][point] == pytest.approx(leg, abs=1.0e-4)  # a tenth of a millimetre


def test_mass_between_points_is_one_at_a_point(values):
    arc_length = arc_length_of(values["points"]["left_leg"])
    location = places.between(arc_length)
    there, named = (
        build_model(check_config(with_term(values, Term("added_mass", place, (0.2,))), "x"))
        for place in (location, "left_leg")
    )
    assert np.allclose(there.omega[:6], named.omega[:6], rtol=1.0e-3)


@pytest.mark.parametrize("location", ["left_leg", "arc_of_the_bend", "all"])
def test_other_locations_are_no_arc_lengths(location):
    assert places.arc_length_m(location) is None
    assert places.place_in_words(location) == location


def test_place_in_words():
    assert places.place_in_words(places.between(1.7175)) == "1.7175 m along the tube"


@pytest.mark.parametrize(
    ("location", "words"),
    [
        ("all", ""),
        ("tube", ""),
        ("plate_1", " at plate_1"),
        ("about_tube", " about the tube's axis"),
        ("along_x", " along x"),
        ("mode_3", " of mode 3"),
        ("responses", " of all responses"),
        (places.between(1.7175), " at 1.7175 m along the tube"),
    ],
)
def test_place_in_a_sentence(location, words):
    assert places.at_place(location) == words


@pytest.mark.parametrize("angle", [-90.0, -9.5, 0.0, 30.0])
def test_place_tells_a_direction(angle):
    location = places.between(0.8319, angle)
    assert places.arc_length_m(location) == pytest.approx(0.8319)
    assert places.turned_deg(location) == angle


def test_place_along_the_force_tells_none():
    assert places.turned_deg(places.between(0.8319)) is None


@pytest.mark.parametrize("angle", [-60.0, 20.0, 90.0])
def test_direction_is_turned_about_the_tube(values, angle):
    turned, forward = places.between(1.2, angle), places.between(1.2)
    there = places.with_place(places.with_place(values, turned), forward)
    own, along = (np.array(places.across(there, location)) for location in (turned, forward))
    assert own @ along == pytest.approx(np.cos(np.deg2rad(angle)))
    assert np.linalg.norm(own) == pytest.approx(1.0)
    turn = places.across_deg(there, turned) - places.across_deg(there, forward)
    assert (turn - angle + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1.0e-9)


def test_direction_in_words():
    assert places.place_in_words(places.between(0.8319, -9.5)) == (
        "0.8319 m along the tube, -10 degrees from the force's direction"
    )
