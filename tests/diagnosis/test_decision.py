"""Conclusions from gains, and that they never contradict themselves."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.diagnosis.constants import RIGHT_UNSEEN
from vibroimpact.diagnosis.decision import ambiguity, beside_spectra, decide, weighed
from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.search import Hypothesis, Search
from vibroimpact.diagnosis.verdict.misfit import closed_fraction

VALUES = {"support_offset": (1e-5, 1e-5)}


def hypothesis(gain, *places):
    """A Hypothesis of effects at places, with a gain."""
    terms = tuple(
        Term(effect, location, VALUES.get(effect, (1.5,)))
        for effect, location in (place.split("@") for place in places)
    )
    return Hypothesis(SimpleNamespace(point=Point(terms)), gain, gain, 0.05)


def test_stretches_that_contradict_each_other_leave_two_rivals():
    one, other = hypothesis(1.4, "contact_damping@right"), hypothesis(1.2, "hunt_crossley@right")
    assert decided(one, other).verdict == "named"
    found = decided(one, replace(other, apart=2.0))
    assert found.verdict == "ambiguous" and len(found.leading) == 2


@pytest.mark.parametrize(("spread", "verdict"), [(0.0, "gap+added_mass"), (8.0, "gap")])
def test_a_second_effect_must_gain_beyond_its_error(spread, verdict):
    """It gains 0.3 apart in the mean of all bands; spread: of that from band to band."""
    lines = np.full((1, 10), 20.0)
    gains = 0.3 + spread * np.resize([0.1, -0.1], (1, 10))
    one = replace(hypothesis(1.0, "gap@all"), change=0.0 * lines, lines=lines)
    pair = hypothesis(1.3, "gap@all", "added_mass@arc_100_0mm")
    found = decided(one, replace(pair, change=gains * lines, lines=lines))
    assert "+".join(found.best.point.ids) == verdict


def test_a_second_effect_is_sought_with_other_firsts_too():
    pair = hypothesis(1.2, "gap@all", "hertz@all")
    singles = (
        hypothesis(1.0, "gap@all"),
        hypothesis(0.7, "gap@left"),
        hypothesis(0.5, "hertz@all"),
    )
    found = Search(hypothesis(0.0), (pair, *singles))
    assert found.other_firsts == [*singles[:2]]
    assert replace(found, screened={"nothing": (), "gap@all": ()}).other_firsts == [singles[1]]
    weak = (hypothesis(0.04, "gap@all"), hypothesis(0.03, "gap@left"))
    assert Search(weak[0], weak).other_firsts == []


def misfit(before, after, floor=1.0):
    """The distances of free runs in dB, before and after."""
    closed = None if before is None else closed_fraction(before, after, floor)
    return {"before_dB": before, "after_dB": after, "floor_dB": floor, "closed_fraction": closed}


def decided(*hypotheses, rest=0.3):
    nothing = Hypothesis(SimpleNamespace(point=Point()), 0.0, 0.0, 0.0)
    return decide(Search(nothing, hypotheses), 5.0 + rest, 5.0)


def test_no_gain_is_nothing_missing():
    found = decided(hypothesis(0.01, "gap@all"), hypothesis(-0.2, "hertz@all"))
    assert found.verdict == "none" and found.nothing > 0.95


def test_a_gain_beyond_all_nulls_is_sure_though_bands_differ():
    uneven = {gain: replace(hypothesis(gain, "gap@all"), error=0.25) for gain in (0.16, 0.38)}
    assert [decided(each).verdict for each in uneven.values()] == ["none", "named"]


def test_a_sure_gain_that_nulls_reach_is_none():
    even = {gain: replace(hypothesis(gain, "gap@all"), error=0.013) for gain in (0.09, 0.2)}
    assert [decided(each).verdict for each in even.values()] == ["none", "named"]


def beside(decision, told, fit=None, farther=True):
    return beside_spectra(decision, {"fit": fit or told, "holdout": told}, farther)


@pytest.mark.parametrize(
    ("before", "verdict"), [(1.2, "none"), (2.3, "unknown"), (4.6, "unknown"), (None, "none")]
)
def test_nothing_is_not_said_beside_spectra_that_are_far_off(before, verdict):
    found = beside(decided(), misfit(before, before))
    assert found.verdict == verdict
    assert (found.nothing > 0.5) == (verdict == "none") == (found.open < 0.5)
    assert found.nothing <= RIGHT_UNSEEN


def test_nothing_is_not_said_beside_far_fitted_records():
    near, far = misfit(1.2, 1.2), misfit(5.3, 5.3)
    assert beside(decided(), near, fit=far).verdict == "unknown"
    assert beside(decided(hypothesis(1.0, "gap@all")), near, fit=far).verdict == "named"


def test_probabilities_fall_with_the_excess_that_spectra_keep():
    named = decided(hypothesis(1.5, "contact_damping@all"))
    chances = [beside(named, misfit(16.0, after)).ranked[0][1] for after in (1.0, 3.0, 5.0, 9.0)]
    assert sorted(chances, reverse=True) == chances
    assert chances[0] > 0.95 and chances[-1] < 0.3
    assert beside(named, misfit(1.2, 1.2)).ranked[0][1] > 0.8  # hardly an excess to close


def test_rivals_are_told_apart_by_their_own_spectra():
    one, other = hypothesis(2.0, "saturation_stiffness@arc_1_0mm"), hypothesis(1.97, "gap@left")
    given = decided(one, other)
    assert given.verdict == "ambiguous" and given.rivals == [one, other]
    found = weighed(given, [0.1, 0.9])
    assert found.verdict == "named" and found.best is other
    assert found.open == pytest.approx(given.open)
    assert weighed(given, [0.0, 0.0]).best is one


@pytest.mark.parametrize(("before", "verdict"), [(14.0, "partly_explained"), (8.0, "unknown")])
def test_an_effect_that_leaves_spectra_far_off_is_not_named(before, verdict):
    found = beside(decided(hypothesis(1.5, "contact_damping@all")), misfit(before, 6.0))
    assert found.verdict == verdict and found.best.ids == ("contact_damping",)
    assert found.open > max(0.5, found.something_else)


def test_an_effect_that_spoils_spectra_without_excess_is_nothing():
    found = beside(decided(hypothesis(0.3, "dry_friction@all")), misfit(1.1, 20.0))
    assert found.verdict == "none" and found.nothing > 0.9 and not found.ranked


def test_an_effect_that_spoils_spectra_by_chance_is_not_refuted():
    named, spoiled = decided(hypothesis(1.5, "contact_damping@all")), misfit(1.2, 1.35)
    assert beside(named, spoiled).verdict == "unknown"
    assert beside(named, spoiled, farther=False).verdict == "named"


def test_a_clear_gain_is_named():
    found = decided(hypothesis(1.5, "contact_damping@all"), hypothesis(0.7, "hunt_crossley@all"))
    assert found.verdict == "named" and found.best.ids == ("contact_damping",)


def test_rivals_are_ambiguous():
    found = decided(hypothesis(1.0, "contact_damping@all"), hypothesis(0.99, "hunt_crossley@all"))
    assert found.verdict == "ambiguous"
    assert sorted(map(tuple, ambiguity(found)[0])) == [("contact_damping",), ("hunt_crossley",)]


def test_a_gap_is_told_with_its_exact_alias():
    sets, chances = ambiguity(decided(hypothesis(2.0, "gap@all")))
    assert sets == [["gap"], ["sensor_gain"]] and sum(chances) <= 1.0 + 1e-9
    assert ambiguity(decided(hypothesis(2.0, "gap@left")))[0] == [["gap"]]


def test_a_second_effect_that_gains_nothing_is_left_out():
    found = decided(
        hypothesis(1.5, "contact_damping@all"),
        hypothesis(1.51, "contact_damping@all", "support_offset@left"),
    )
    assert found.best.ids == ("contact_damping",)
    pair = decided(
        hypothesis(1.5, "contact_damping@all"),
        hypothesis(2.5, "contact_damping@all", "support_offset@left"),
    )
    assert pair.best.ids == ("contact_damping", "support_offset")


@pytest.mark.parametrize("gain", [0.0, 0.05, 0.3, 3.0])
@pytest.mark.parametrize("rest", [0.0, 1.0, 2.0, 5.0])
def test_probabilities_and_conclusion_agree(gain, rest):
    found = decided(hypothesis(gain, "gap@left"), hypothesis(0.9 * gain, "hertz@all"), rest=rest)
    total = found.nothing + found.open + sum(chance for _, chance in found.ranked)
    assert total == pytest.approx(1.0) and found.something_else < found.open
    assert (found.open >= 0.5) == (found.verdict in ("unknown", "partly_explained"))
    if found.verdict == "none":
        assert found.nothing > 0.3
    if found.verdict == "named":
        assert found.ranked[0][1] > 0.3


def test_what_stays_far_above_the_floor_is_something_else():
    assert decided(hypothesis(0.01, "gap@left"), rest=4.0).verdict == "unknown"
    assert decided(hypothesis(5.0, "gap@left"), rest=2.5).verdict == "partly_explained"


def test_a_floor_that_is_not_known_decides_nothing():
    search = Search(hypothesis(0.0), (hypothesis(1.0, "gap@left"),))
    assert decide(search, 9.0, np.nan).verdict == "named"
