"""A spring across the force is told by the lowest record, and looked for in its direction."""

import numpy as np
import pytest

from tests.linear_stage.test_linear_effects import ROOTS, file_of
from vibroimpact.effects import places
from vibroimpact.linear_stage.candidates import DIRECTED, candidate_named
from vibroimpact.linear_stage.linear_analysis import prepare

PLACE, DEGREES = 0.3, -70.0
HIDDEN = (
    f"saturation_stiffness@{places.between(PLACE, DEGREES)}",
    {"stiffness": 2.0e5, "limit": 50.0},
)


def turned(names):
    return [name for name in names if places.turned_deg(candidate_named(name).location)]


@pytest.mark.slow
def test_a_spring_across_the_force_is_looked_for_there(study_config, tmp_path):
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", HIDDEN))
    found = turned(prepared.screened)
    assert {candidate_named(name).effect_id for name in found} == DIRECTED
    (location,) = {candidate_named(name).location for name in found}
    assert places.turned_deg(location) == pytest.approx(DEGREES, abs=10.0)
    assert places.arc_length_m(location) == pytest.approx(PLACE, abs=0.1)


@pytest.mark.slow
def test_roots_that_give_are_no_spring_across_the_force(study_config, tmp_path):
    prepared = prepare(study_config, file_of(study_config, tmp_path / "campaign.nc", ROOTS))
    assert prepared.adopted["name"] == "root_stiffness@roots"
    assert turned(prepared.screened) == []


def test_what_is_told_of_a_place_acts_there(study_config):
    """At a place and in a direction that the model has no point for."""
    candidate = candidate_named(HIDDEN[0])
    values = study_config.model_dump(mode="json")
    changed = candidate.variant(values, HIDDEN[1])
    (element,) = [row for row in changed["elements"] if row not in values["elements"]]
    assert places.arc_lengths(changed, [element["point"]]) == pytest.approx([PLACE], abs=1.0e-6)
    along, across = (
        np.array(places.across(places.with_place(values, name), name))
        for name in (places.between(PLACE), element["point"])
    )
    assert np.rad2deg(np.arccos(along @ across)) == pytest.approx(-DEGREES, abs=1.0e-3)
    assert element["direction"] == pytest.approx(list(across))
