"""A structure under dead loads, or pressed to its supports, rests before a record begins."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.integration.batch import Schedule, rest_state
from vibroimpact.integration.kernels.lanes import LANES

GAP = 2.8886e-4
RATE = 20480


@pytest.fixture(scope="module")
def schedule():
    return Schedule(RATE, 2048, 0.0, 0.5, "exact")


@pytest.fixture(scope="module")
def sensed(study_model):
    """The model with its sensors alone, as it is compared with a campaign."""
    return replace(
        study_model,
        line_shapes=study_model.line_shapes[:, :0],
        line_positions=np.zeros((0, 3)),
        line_arc_length=np.zeros(0),
    )


def loaded(model, force_N):
    """The model with a dead load of the drive's place and direction."""
    return replace(model, constant_force=force_N * model.drive_shapes[:, 0])


def offset(model, metres):
    """The model with the centres of all supports moved along their second direction."""
    return replace(model, centre_offset=np.tile([0.0, metres], (len(model.support_of_point), 1)))


def at_rest(model, schedule, gap=GAP):
    """Modal amplitudes (mode,) at rest, and the contact displacements (contact_point, 2)."""
    nowhere = np.zeros((len(model.support_of_point), 2, 1))
    rest = rest_state(model, schedule, np.array([gap]), nowhere)[:, 0]
    return rest, np.einsum("mpd,m->pd", model.contact_shapes.reshape(model.modes, -1, 2), rest)


def test_a_centred_tube_without_load_rests_at_zero(study_model, schedule):
    assert (
        rest_state(
            study_model,
            schedule,
            np.array([GAP]),
            np.zeros((len(study_model.support_of_point), 2, 1)),
        )
        is None
    )


def test_free_of_its_supports_it_yields_by_statics(study_model, schedule):
    model = loaded(study_model, 5.0)
    rest, _ = at_rest(model, schedule, gap=1.0)
    np.testing.assert_allclose(
        rest, model.constant_force / model.omega**2, rtol=1e-4, atol=1e-4 * np.abs(rest).max()
    )


def test_pressed_to_its_supports_the_forces_balance(study_model, schedule):
    """A support moved beyond its clearance pushes the tube: omega² q is the force of the contacts,
    along the offset alone.
    """
    model = offset(study_model, 1.5 * GAP)
    rest, moved = at_rest(model, schedule)
    shapes = model.contact_shapes.reshape(model.modes, -1)
    force = np.linalg.lstsq(shapes, model.omega**2 * rest, rcond=None)[0].reshape(-1, 2)
    np.testing.assert_allclose(
        shapes @ force.ravel(),
        model.omega**2 * rest,
        rtol=0.0,
        atol=1e-3 * np.abs(model.omega**2 * rest).max(),
    )
    penetration = np.hypot(*(moved - model.centre_offset).T) - model.gap_factor * GAP
    touching = penetration > 0.0
    assert (
        touching.any()
        and force[:, 1].sum() > 0.0
        and np.abs(force[:, 0]).max() < 1e-3 * np.abs(force[:, 1]).max()
    )
    np.testing.assert_allclose(
        force[touching, 1], (model.contact_stiffness * penetration)[touching], rtol=0.02
    )


@pytest.mark.parametrize(
    "change",
    [lambda model: loaded(model, 20.0), lambda model: offset(model, 1.3 * GAP)],
    ids=["dead load", "offset"],
)
def test_without_a_force_a_record_is_silent(sensed, schedule, change):
    """Nothing moves: no shock of a load that comes suddenly, none of a support that would begin
    inside the tube, none of the output filter.
    """
    model, silent = change(sensed), np.zeros((1, 1, 1024))
    kinds = ["acceleration"] * sensed.sensor_shapes.shape[1]
    runs = [(0, GAP, seed) for seed in range(LANES + 1)]  # a whole batch and one more
    found = simulate_records(model, schedule, silent, runs, kinds)
    assert np.abs(found).max() < 1e-2  # m/s²; 100 and more where it starts at zero


def test_where_it_rests_does_not_shift_the_force(sensed, schedule):
    """Far from its supports the structure is linear: what a force does is the same with and without
    a dead load.
    """
    far, model = 1.0, sensed
    force = np.random.default_rng(2).standard_normal((1, 1, 1024))
    kinds = ["acceleration"] * model.sensor_shapes.shape[1]
    bare, under_load = (
        simulate_records(one, schedule, force, [(0, far, 0)], kinds)
        for one in (model, loaded(model, 20.0))
    )
    np.testing.assert_allclose(under_load, bare, rtol=0.0, atol=1e-3 * np.abs(bare).max())
