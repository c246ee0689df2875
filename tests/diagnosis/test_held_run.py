"""Runs whose sensors are held to a measured motion."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.played import played
from vibroimpact.diagnosis.bench import _free_lines, holding_lines, holds, mean_log_power
from vibroimpact.diagnosis.explanations import Point, Term, seen
from vibroimpact.integration.held_run import HeldLane, hold

SOFT = Point((Term("contact_stiffness", "all", (1.0e6,)),))


@pytest.fixture(scope="module")
def bench(comparison):
    """The model as given plays the measurement, through impacts at the higher loads."""
    return played(comparison.fitted(), Point())


def runs_of(bench, model, strength=None):
    """A run of each stretch."""
    held = bench.strength if strength is None else strength
    return [
        HeldLane(model, each.gap, each.force, each.motion, np.full(each.motion.shape[1], held))
        for each in bench.stretches
    ]


def test_dampers_of_the_right_model_bear_hardly_any_force(bench):
    model = bench.structure.model(Point())
    records = hold(runs_of(bench, model), bench.schedule)
    assert records.support_force[-1].std() > 1.0  # it does impact
    # impacts ring above the band of the records, which no damper is told of
    limits = (0.01, 0.1, 0.1)
    for force, each, limit in zip(records.force, bench.stretches, limits, strict=True):
        speed = np.diff(each.motion, axis=0) * bench.schedule.steps_per_second
        moving = each.moving
        ratio = force.std(axis=-1)[moving] / (bench.strength * speed.std(axis=0)[moving])
        assert ratio.max() < limit


def test_what_rings_above_the_band_bears_no_force_within_it(bench):
    """Dampers act on the modes of the band alone. Those above move the sensors in the band as well,
    when the structure is struck, and sensors see all of them.
    """
    lines, free = holding_lines(bench, [Point()])[0, -1], _free_lines(bench)[-1]
    assert np.mean(np.abs(lines) ** 2) < 2e-4 * np.mean(np.abs(free) ** 2)


def test_a_constant_force_rests_against_a_support_from_the_start(bench):
    """Dampers let a structure creep to its place: the run would begin with a force of its own."""
    model = bench.structure.model(Point((Term("preload", "left", (0.0, 100.0)),)))
    still = [
        replace(run, force=np.zeros_like(run.force), motion=np.zeros_like(run.motion))
        for run in runs_of(bench, model)
    ]
    pressed = np.abs(hold(still, bench.schedule).support_force).max(axis=1)[:, 10:]  # of the filter
    assert pressed.min() > 1.0
    np.testing.assert_allclose(pressed, pressed[:, -1:].repeat(pressed.shape[1], 1), rtol=5e-3)


def test_held_motion_follows_the_impacts(bench):
    """The model predicts the measured waveform, which a free run does not for long."""
    model, up = (
        bench.structure.model(Point()),
        round(bench.schedule.steps_per_second / bench.schedule.sampling_frequency),
    )
    records = hold(runs_of(bench, model), bench.schedule)
    measured = bench.stretches[-1].motion[1::up][: bench.schedule.samples].T
    error = records.motion[-1] - measured
    assert error.std() < 0.01 * measured.std()


def test_whether_sensors_hold_the_model_through_impacts(bench, comparison):
    assert holds(bench, comparison.modes).all()
    free = replace(bench, strength=1.0e-6 * bench.strength)
    assert not holds(free, comparison.modes)[-1]


def test_the_modes_of_a_plate_leave_the_others_their_numbers(bench):
    plate = Term("plate_flexibility", "left", (1.0e5, 0.4, 0.02))
    given, moved = (bench.structure.model(Point(terms, (0.01, 0.02))) for terms in ((), (plate,)))
    own = moved.frequencies[seen(moved)][:4]
    assert moved.modes > given.modes
    np.testing.assert_allclose(own, given.frequencies[seen(given)][:4], rtol=1e-6)


def test_a_wrong_contact_shows_in_the_holding_force(bench):
    right, wrong = holding_lines(bench, [Point(), SOFT])
    assert mean_log_power(bench, wrong) - mean_log_power(bench, right) > 2.0


def test_a_run_does_not_depend_on_its_neighbours(bench):
    """Lanes of other models, other laws and other loads beside it change no bit."""
    given, soft = (bench.structure.model(point) for point in (Point(), SOFT))
    rubbing = bench.structure.model(Point((Term("dry_friction", "all", (0.2,)),)))
    alone = hold(runs_of(bench, soft)[-1:], bench.schedule)
    among = hold(
        [*runs_of(bench, given), *runs_of(bench, rubbing), *runs_of(bench, soft)], bench.schedule
    )
    np.testing.assert_array_equal(among.force[-1], alone.force[0])


def test_threads_change_nothing(bench):
    model = bench.structure.model(Point())
    one, two = (hold(runs_of(bench, model) * 4, bench.schedule, threads) for threads in (1, 2))
    np.testing.assert_array_equal(one.force, two.force)


@pytest.mark.parametrize("times", [0.1, 4.0])
def test_dampers_of_any_strength_are_passive(bench, times):
    """Held to nothing at all, a rattling structure loses energy and stays bounded."""
    model = bench.structure.model(Point())
    still = [
        replace(run, motion=np.zeros_like(run.motion))
        for run in runs_of(bench, model, times * bench.strength)
    ]
    free = [replace(run, strength=np.zeros_like(run.strength)) for run in still]
    records, loose = hold(still, bench.schedule), hold(free, bench.schedule)
    assert np.isfinite(records.motion).all()
    assert (records.motion[0].std(axis=-1) <= loose.motion[0].std(axis=-1)).all()


def test_contact_too_stiff_for_the_step_costs_its_run_alone(bench):
    model = bench.structure.model(Point())
    stiff = replace(model, contact_stiffness=1.0e6 * model.contact_stiffness)
    records = hold([*runs_of(bench, model), *runs_of(bench, stiff)], bench.schedule)
    count = len(bench.stretches)
    assert np.isfinite(records.force[:count]).all() and np.isnan(records.force[count:]).all()
