"""The race runs what may explain a measurement until it is known, on changes that are made up."""

from dataclasses import replace

import numpy as np
import pytest

from tests.white_null import white_null
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.missing_effect.alike import (
    at_its_place,
    elsewhere_too,
    laws_of,
    similar_too,
    turned_too,
)
from vibroimpact.missing_effect.effort import Effort
from vibroimpact.missing_effect.first_points import first_points
from vibroimpact.missing_effect.gauss_newton import descend
from vibroimpact.missing_effect.race import leaders, look_wider, race
from vibroimpact.missing_effect.screening import led
from vibroimpact.missing_effect.search import Search
from vibroimpact.missing_effect.two_effects import exchanged_too, parts_alone
from vibroimpact.missing_effect.verdict import ended_early, left_out
from vibroimpact.run_cost import count_simulated

VALUES, NOISE = 200, 1.0e-2
AXES = np.linalg.qr(np.random.default_rng(9).standard_normal((VALUES, 6)))[0].T
STOP_THERE = "clearance@span_1"
STIFFNESS, HERTZ, FRICTION = "contact_stiffness@all", "hertz@all", "dry_friction@all"
MASS = "added_mass@apex"
SCALES = (
    "one",
    "searched_from",
    "searched_length",
    "contact_stiffness",
    "hertz",
    "displacement",
    "tube_translation",
    "cubic",
)
STEPS = 10**9  # of a run
PLATES = {"supports": [{"name": "left"}, {"name": "right"}]}
SPENT = Effort(compared_s=10.0, rounds=8, width=3, pairs=2)


def changed(name, unit):
    """Return (value,): the stiffness softens one direction, Hertz's law bends on to another below
    a fifth of its range, friction changes a third.
    """
    at = unit[0]
    if name == STIFFNESS:
        return 60.0 * (1.0 - at) * AXES[0]
    if name == HERTZ:
        return 60.0 * np.exp(-(at**2) / 0.02) * (0.5 * AXES[0] + AXES[1])
    return 40.0 * at * AXES[2]


class Made(Search):
    """A Search whose runs are looked up."""

    def _changes(self, candidate, unit, first_seed):
        count_simulated(1, STEPS)
        mean = sum(changed(part.name, own) for part, own in candidate.parts(unit))
        signs = np.random.default_rng(int(1.0e6 * unit[0])).choice([-1.0, 1.0], VALUES)
        return mean + np.sqrt(NOISE) * np.outer([1.0, -1.0], signs)


@pytest.fixture
def searched():
    measured = np.random.default_rng(2).standard_normal(VALUES) + changed(HERTZ, [0.05])
    search = Made(None, white_null(measured), dict.fromkeys(SCALES, 1.0))
    for name in (STIFFNESS, HERTZ, FRICTION):
        search.screen([search.first(name, 2)])
        search.fit(name)
    return search


def test_law_that_did_nothing_at_first_is_found(searched):
    assert leaders(searched, 1) == [STIFFNESS]  # Hertz's law is as good as rigid at 0.3 and 0.75
    similar_too(searched, PLATES, STIFFNESS)
    race(searched, SPENT)
    race(searched, SPENT, laws=laws_of(searched, STIFFNESS))
    assert leaders(searched, 1) == [HERTZ]
    assert searched.fits[HERTZ].left / VALUES == pytest.approx(1.0, abs=0.3)
    assert searched.fits[HERTZ].unit[0] == pytest.approx(0.05, abs=0.03)


def test_what_is_like_a_law_at_one_support_is_run_there(searched):
    there = "contact_stiffness@left"
    searched.screen([searched.first(there, 2)])
    assert similar_too(searched, PLATES, there)
    assert len(searched.trials["hertz@left"].noise) == len(first_points(candidate_named(HERTZ)))
    assert "hertz@right" not in searched.trials and "dry_friction@left" not in searched.trials


def test_first_runs_are_told_from_those_of_the_race(searched):
    race(searched, SPENT)
    trial = searched.trials[STIFFNESS]
    assert trial.refined > 0 and trial.screened == 2
    similar_too(searched, PLATES, HERTZ)  # the stiffness is like it, and was run already
    assert searched.trials[STIFFNESS].screened == 2
    assert trial.unit[: trial.screened] == pytest.approx(
        first_points(candidate_named(STIFFNESS))[:2]
    )


def test_wider_look_is_at_what_did_nothing_so_far(searched):
    search_more = {name: len(searched.trials[name].noise) for name in searched.trials}
    look_wider(searched, 2)
    more = {name: len(searched.trials[name].noise) - runs for name, runs in search_more.items()}
    assert (more[HERTZ], more[FRICTION]) == (2, 0)
    searched.fits[FRICTION] = replace(searched.fits[FRICTION], may_take=1.0e6)
    look_wider(searched, 2)
    trial = searched.trials[FRICTION]  # which leaves room for the race
    assert (trial.screened, trial.strewn, trial.refined) == (2, 4, 0)


def test_what_changes_nothing_that_is_missing_is_not_run(searched):
    race(searched, SPENT)
    assert searched.trials[FRICTION].refined == 0


def test_nothing_is_run_beyond_what_is_to_be_spent(searched):
    ran = searched.ran
    searched.most = ran
    assert searched.over and ended_early(searched) == []  # nothing was left out yet
    searched.most = ran + STEPS
    race(searched, SPENT)
    assert searched.over and ran < searched.ran <= ran + 2 * SPENT.width * STEPS
    known = searched.ran
    similar_too(searched, PLATES, STIFFNESS)
    descend(searched, STIFFNESS)
    searched.run([(f"{STIFFNESS}+{FRICTION}", np.array([[0.5, 0.5]]))])
    assert searched.ran == known and leaders(searched, 1) == [STIFFNESS]
    count_simulated(1, STEPS)  # what is run after the search does not count
    (row,) = ended_early(searched)
    assert f"after {known / 1.0e9:.0f} thousand million time steps" in row["message"]


def test_each_of_two_effects_is_run_alone(searched):
    pair = f"{STIFFNESS}+{FRICTION}"
    searched.run([(pair, np.array([[0.5, 0.5]]))])
    runs = len(searched.trials[FRICTION].noise)
    parts_alone(searched, pair)
    assert len(searched.trials[FRICTION].noise) == runs + 1
    assert searched.trials[FRICTION].unit[-1] == pytest.approx(searched.fits[pair].unit[1:])


def test_each_of_two_effects_is_exchanged_for_what_is_like_it(searched):
    pair = f"{STIFFNESS}+{FRICTION}"
    searched.run([(pair, np.array([[0.5, 0.5], [0.6, 0.6]]))])
    assert exchanged_too(searched, pair, room=lambda _: True)
    exchanged = searched.trials[f"{FRICTION}+{HERTZ}"]  # Hertz's law softens as a softer contact
    kept = searched.fits[pair].unit[1]
    assert exchanged.unit[:, 0] == pytest.approx(kept)
    assert exchanged.unit[:, 1] == pytest.approx(first_points(candidate_named(HERTZ))[:2, 0])
    assert not exchanged_too(searched, pair, room=lambda _: True)  # what is known is not run again


def test_an_effect_without_room_is_not_exchanged_for(searched):
    pair = f"{STIFFNESS}+{FRICTION}"
    searched.run([(pair, np.array([[0.5, 0.5]]))])
    assert not exchanged_too(searched, pair, room=lambda _: False)


def test_effects_at_a_point_are_run_where_one_leads(searched):
    for name in (STOP_THERE, "cubic_stiffness@shaker"):
        searched.screen([searched.first(name, 2)])
    at_its_place(searched, STOP_THERE)
    assert "cubic_stiffness@span_1" in searched.trials  # as the stop; no stiffness of a contact is
    assert {trial.candidate.location for trial in searched.trials.values()} == {
        "all",
        "span_1",
        "shaker",
    }
    at_its_place(searched, STIFFNESS)
    assert "cubic_stiffness@all" not in searched.trials


def test_an_effect_is_tried_at_the_other_end_of_a_tube(searched):
    spring, rubbing = "cubic_stiffness@along_tube", "coulomb_friction@along_tube"
    searched.scales |= {"load": 1.0}
    for name in (spring, rubbing):
        searched.screen([searched.first(name)])
        searched.fit(name)
    known = len(searched.trials[spring].noise)
    place = searched.fits[spring].unit[-1]
    assert elsewhere_too(searched, {}, spring)
    assert searched.trials[spring].unit[known, -1] == pytest.approx(1.0 - place)
    assert at_its_place(searched, spring)  # and the other effects where this one is found
    place = searched.fits[spring].unit[-1]
    assert searched.trials[rubbing].unit[-2:, -1] == pytest.approx([place, place])


def test_a_leading_spring_is_turned_about_a_tube(searched):
    spring, stop = "cubic_stiffness@along_tube", "clearance@along_tube"
    for name in (spring, stop):
        searched.screen([searched.first(name)])
        searched.fit(name)
    unit = searched.fits[spring].unit
    assert turned_too(searched, spring)
    trial = searched.trials[f"{spring}_turned"]
    directions = trial.unit[:, 1]
    assert np.ptp(directions) > 0.6 and not np.isclose(directions, 0.5).any()
    np.testing.assert_allclose(trial.unit[:, ::2], np.tile(unit, (len(directions), 1)))
    turned = searched.fits[trial.candidate.name].unit
    assert at_its_place(searched, trial.candidate.name)  # and what else may act in that direction
    other = searched.trials[f"{stop}_turned"]
    np.testing.assert_allclose(other.unit[:, 2:], np.tile(turned[1:], (4, 1)))
    assert not turned_too(searched, trial.candidate.name)
    assert not turned_too(searched, STIFFNESS)


class Seeded(Search):
    """A Search whose runs say with which seed they were run; those of friction fail, those of mass
    by an error of the program.
    """

    def _changes(self, candidate, unit, first_seed):
        if candidate.name == FRICTION:
            raise IntegrationError("thrown off")
        if candidate.name == MASS:
            return {}["apex"]
        return np.full((2, VALUES), first_seed) + unit[0]


@pytest.mark.parametrize("threads", [1, 3])
def test_runs_side_by_side_are_those_in_a_row(threads):
    search = Seeded(None, white_null(np.ones(VALUES)), {}, threads=threads)
    units = np.array([[0.1], [0.2], [0.3]])
    search.screen([(STIFFNESS, units), (FRICTION, units[:1]), (HERTZ, units[:2])])
    seeds = LANES // len(search.null.records)
    first = 1000 + seeds * np.arange(6)
    np.testing.assert_allclose(search.trials[STIFFNESS].change[:, 0], first[:3] + units[:, 0])
    np.testing.assert_allclose(search.trials[HERTZ].change[:, 0], first[4:] + units[:2, 0])
    assert [sentence for _, sentence in search.trials[FRICTION].failed] == ["thrown off"]
    assert search.seed == 1000 + 6 * seeds and search.trials[HERTZ].screened == 2


def test_an_error_of_the_program_costs_its_explanation(capsys):
    search = Seeded(None, white_null(np.ones(VALUES)), {})
    search.screen([(MASS, np.array([[0.1]])), (STIFFNESS, np.array([[0.1], [0.2]]))])
    search.fit(MASS)
    assert MASS not in search.fits and len(search.trials[STIFFNESS].noise) == 2
    (row,) = left_out(search)
    assert MASS in row["message"] and "KeyError: 'apex'" in row["message"]
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize("beside, wanted", [(0.0, True), (45.0, False)])
def test_one_direction_may_take_most_away(beside, wanted):
    """Half of what is missing is the direction of no explanation that was run."""
    noise = np.random.default_rng(2).standard_normal(VALUES)
    measured = noise + changed(STIFFNESS, [0.25]) + beside * AXES[2]
    search = Made(None, white_null(measured), dict.fromkeys(SCALES, 1.0))
    search.screen([search.first(STIFFNESS, 2)])
    assert led(search) == wanted
