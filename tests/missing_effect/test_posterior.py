"""Who is believed: nothing, an effect of the catalogue, two of them, or something else."""

import numpy as np
import pytest

from tests.white_null import white_null
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.missing_effect.engine import nothing_near
from vibroimpact.missing_effect.probabilities import averaged, posterior
from vibroimpact.missing_effect.race import contenders
from vibroimpact.missing_effect.search import LITTLE, Search
from vibroimpact.missing_effect.trials import Trial

VALUES = 200
FRICTION, DAMPING, STIFFNESS = "dry_friction@all", "contact_damping@all", "contact_stiffness@all"
DIRECTIONS = dict(
    zip(
        (FRICTION, DAMPING, STIFFNESS, "none of them"),
        np.linalg.qr(np.random.default_rng(6).standard_normal((VALUES, 4)))[0].T,
        strict=True,
    )
)
UNITS = np.array([[0.2], [0.4], [0.5], [0.6], [0.8]])
SIZE = 60.0  # of a change at the end of the range, in units of the scatter


def searched(measured):
    """Return a Search in which three effects were run, each changing one direction evenly."""
    search = Search(None, white_null(measured), dict.fromkeys(("one", "contact_stiffness"), 1.0))
    for name in (FRICTION, DAMPING, STIFFNESS):
        changes = SIZE * UNITS * DIRECTIONS[name]
        trial = Trial.empty(candidate_named(name), VALUES)
        for unit, change in zip(UNITS, changes, strict=True):
            trial.add(unit, change + 0.03 * np.outer([1.0, -1.0], np.ones(VALUES)))
        trial.screened = 5
        search.trials[name] = trial
        search.fit(name)
    return search


def chance():
    return np.random.default_rng(7).standard_normal(VALUES)


def test_chance_alone_is_nothing():
    found = posterior(searched(chance()))
    assert next(iter(found)) == "nothing" and np.exp(found["nothing"]) > 0.8
    assert np.exp(list(found.values())).sum() == pytest.approx(1.0)


@pytest.mark.parametrize("name", [FRICTION, DAMPING])
def test_effect_of_the_catalogue_is_believed(name):
    search = searched(chance() + 30.0 * DIRECTIONS[name])
    found = posterior(search)
    assert next(iter(found)) == name and np.exp(found[name]) > 0.9
    assert search.fits[name].unit[0] == pytest.approx(0.5, abs=0.05)


def test_direction_of_no_effect_is_something_else():
    found = posterior(searched(chance() + 30.0 * DIRECTIONS["none of them"]))
    assert next(iter(found)) == "something else" and np.exp(found["something else"]) > 0.7


def test_effect_beside_another_is_half_of_the_story():
    both = 30.0 * DIRECTIONS[FRICTION] + 30.0 * DIRECTIONS[DAMPING]
    search = searched(chance() + both)
    found = posterior(search)
    assert found[FRICTION] < -5.0 and found[DAMPING] < -5.0  # neither is enough
    explains = search.explains(search.null.measured - search.fits[FRICTION].mean)
    assert max(explains, key=lambda name: explains[name] * (name != FRICTION)) == DAMPING


@pytest.mark.parametrize("second", [0.0, 15.0])
def test_second_effect_is_believed_where_a_run_shows_it(second):
    """A pair was run once; beside friction alone it leaves less only where damping is there."""
    search = searched(chance() + 30.0 * DIRECTIONS[FRICTION] + second * DIRECTIONS[DAMPING])
    pair, own = f"{FRICTION}+{DAMPING}", SIZE * (0.5 * DIRECTIONS[FRICTION])
    search.trials[pair] = Trial.empty(candidate_named(pair), VALUES)
    changes = own + SIZE * 0.25 * DIRECTIONS[DAMPING] + 0.03 * np.array([[1.0], [-1.0]])
    search.trials[pair].add(np.array([0.5, 0.25]), changes)
    search.fit(pair)
    found = posterior(search)
    assert (pair in found) == (second > 0.0)
    assert next(iter(found)) == (pair if second else FRICTION)


def test_race_leaves_out_what_is_known_to_be_worse():
    search = searched(chance() + 30.0 * DIRECTIONS[FRICTION])
    left = contenders(search)
    assert left == [FRICTION]  # until it has been run a few times more


def test_what_takes_most_runs_on_though_its_scatter_hides_it():
    """Few values change, and of many the scatter hides how much."""
    search = searched(9.0 * DIRECTIONS[FRICTION])
    trial = search.trials[FRICTION]
    trial.change, trial.noise = 0.2 * trial.change, np.full(len(UNITS), 0.6)
    search.fit(FRICTION)
    assert search.explains(search.null.measured)[FRICTION] == 0.0
    assert search.fits[FRICTION].takes > LITTLE
    assert FRICTION in contenders(search)


def test_two_that_only_their_scatter_tells_apart_share():
    evidence = {"one": 10.0, "other": 13.0, "nothing": 0.0}
    sure = averaged(evidence, {"one": 0.0, "other": 0.0})
    assert np.exp(sure["other"]) == pytest.approx(1.0 / (1.0 + np.exp(-3.0)), abs=1.0e-3)
    found = averaged(evidence, {"one": 6.0, "other": 6.0})
    wanted = 0.5 + 0.5 * np.tanh(3.0 / 2.0 / np.sqrt(1.0 + np.pi * 72.0 / 8.0))  # of a normal shift
    assert np.exp(found["other"]) == pytest.approx(wanted, abs=0.05)
    assert found["nothing"] < -2.0


def test_a_measurement_within_chance_needs_no_explanation():
    assert not searched(chance()).null.differs
    assert searched(chance() + 15.0 * DIRECTIONS[FRICTION]).null.differs


def test_family_that_holds_most_is_told_though_no_law_of_it_fits():
    measured = chance() + 40.0 * DIRECTIONS[FRICTION] + 25.0 * DIRECTIONS["none of them"]
    families = searched(measured).of_families()
    assert next(iter(families)) == "friction" and families["friction"] > 0.99
    assert sum(families.values()) == pytest.approx(1.0)
    neither = searched(chance() + 40.0 * DIRECTIONS["none of them"]).of_families()
    assert max(neither.values()) < 0.9


@pytest.mark.parametrize(("of_friction", "near"), [(0.0, False), (8.0, False), (30.0, True)])
def test_nothing_is_near_where_no_effect_takes_a_quarter_away(of_friction, near):
    missing = 30.0 * DIRECTIONS["none of them"] + of_friction * DIRECTIONS[FRICTION]
    assert nothing_near(searched(chance() + missing)) != near
