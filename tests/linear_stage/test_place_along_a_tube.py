"""The place of an effect at a point is one of its parameters on a tube."""

import numpy as np
import pytest

from vibroimpact.config.reading import check_config
from vibroimpact.effects import places
from vibroimpact.effects.places import ALONG, TURNED
from vibroimpact.linear_stage.candidates import AT_A_POINT, Candidate, local_candidates
from vibroimpact.linear_stage.scales import searched
from vibroimpact.missing_effect.first_points import first_points
from vibroimpact.missing_effect.search import neutral_unit

SPRING, STOP = Candidate("cubic_stiffness", ALONG), Candidate("clearance", ALONG)


@pytest.fixture
def values(study_config):
    return study_config.model_dump(mode="json")


@pytest.fixture
def scales(values):
    sizes = {"cubic": 1.0e10, "displacement": 1.0e-3, "tube_translation": 1.0e4}
    return sizes | searched((0.1, 1.1))


def test_the_place_is_the_last_parameter(scales):
    physical = SPRING.physical(np.array([0.5, 0.0]), scales)
    assert list(physical) == ["coefficient", "place"]
    assert physical["place"] == pytest.approx(0.1)
    assert SPRING.normalised(physical, scales) == pytest.approx([0.5, 0.0])
    interval = np.array([[0.4, 0.6], [0.45, 0.55]])
    value, low, high = SPRING.estimate(np.array([0.5, 0.5]), interval, scales)["place"]
    assert (value, high - low) == pytest.approx((0.6, 0.1))


def test_the_effect_sits_there(values, scales):
    """At an arc length that no point of the model names, in the element and in the stop."""
    unit = np.array([0.6, 0.3])
    location = SPRING.located(unit, scales)
    at = places.arc_length_m(location)
    assert at == pytest.approx(0.4, abs=1.0e-4)
    changed = SPRING.variant(values, SPRING.physical(unit, scales))
    (element,) = [row for row in changed["elements"] if row not in values["elements"]]
    assert element["point"] == location and element["cubic_N_per_m3"] > 0.0
    assert places.arc_lengths(changed, [location]) == pytest.approx([at], abs=1.0e-6)
    stopped = STOP.variant(values, STOP.physical(np.array([0.5, 0.5, 0.3]), scales))
    assert stopped["supports"][-1]["at_m"] == pytest.approx(changed["points"][location])
    check_config(stopped, "a stop between two points")


@pytest.mark.parametrize("effect_id", sorted(AT_A_POINT))
@pytest.mark.parametrize("location", ["arc_400_0mm", "arc_400_0mm_turned_m9_5deg"])
def test_an_effect_acts_at_a_place_that_was_found(values, effect_id, location):
    """Where the lowest record, or another effect, says: no point of the model is there."""
    candidate = Candidate(effect_id, location)
    parameters = {row.name: 1.0e-3 for row in candidate.effect.parameters}
    changed = candidate.variant(values, parameters)
    assert places.arc_lengths(changed, [location]) == pytest.approx([0.4], abs=1.0e-6)
    check_config(changed, effect_id)


def test_it_is_tried_all_along_and_is_nothing_anywhere(values, scales):
    along = first_points(STOP)[:, -1]
    assert len(np.unique(along)) == len(along) > 5 and np.ptp(along) > 0.7
    nothing = neutral_unit(SPRING, scales)
    assert np.all(nothing[:, 0] < 0.0) and np.ptp(nothing[:, 1]) == 1.0
    assert neutral_unit(STOP, scales) is None  # a stop out of reach is at no place of its range


def test_points_are_tried_where_there_is_no_tube(values):
    def located(structure):
        changed = values | {"structure": values["structure"] | {"kind": structure}}
        found = local_candidates(changed, ())
        return {row.location for row in found if row.effect_id == "cubic_stiffness"}

    assert located("u_tube") == {ALONG}
    assert located("point") <= set(values["points"]) and ALONG not in located("point")


@pytest.mark.parametrize(
    ("force", "wanted"),
    [
        ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),  # along the tube at the apex: across its plane
    ],
)
def test_a_spring_acts_as_the_force_does_turned_with_the_tube(values, force, wanted):
    """Driven at the apex in its plane, the legs of a U tube move across themselves in that plane;
    the direction of the force itself is along them.
    """
    excitation = values["excitation"] | {"point": "apex", "direction": force}
    driven = values | {"excitation": excitation}
    leg = places.between(0.2)
    along = places.across(places.with_place(driven, leg), leg)
    assert np.abs(along) == pytest.approx(wanted, abs=1.0e-6)


def test_the_direction_is_a_parameter_before_the_place(values, scales):
    turned = Candidate("cubic_stiffness", TURNED)
    scales = scales | {"one": 1.0}
    unit = np.array([0.6, 2.0 / 3.0, 0.3])
    physical = turned.physical(unit, scales)
    assert physical["direction"] == pytest.approx(30.0)
    assert turned.normalised(physical, scales) == pytest.approx(unit)
    assert turned.periodic == (1,)
    forward = SPRING.variant(values, SPRING.physical(unit[::2], scales))["elements"][-1]
    changed = turned.variant(values, physical)
    element = changed["elements"][-1]
    assert element["point"] == turned.located(unit, scales)
    assert element["cubic_N_per_m3"] == forward["cubic_N_per_m3"]
    cosine = np.dot(element["direction"], forward["direction"])
    assert cosine == pytest.approx(np.cos(np.deg2rad(30.0)))
    check_config(changed, "a spring that is turned")
    nothing = neutral_unit(turned, scales)
    assert np.ptp(nothing[:, 1]) > 0.5 and np.ptp(nothing[:, 2]) == 1.0
