"""Draws of nuisances scatter as their priors say, and less where the lowest record tells."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.nuisance import Reading
from vibroimpact.missing_effect import constants
from vibroimpact.missing_effect.nuisances import clearance_draws, nuisance_draws

COUNT, MODES, CHANNELS = 4000, 3, 2


def reading(shift=0.0):
    shapes = np.array([[1.0, 0.5], [0.8, -1.0]])
    return Reading(
        np.array([0, 1]),
        np.log([60.0, 150.0]) + shift,
        np.log([0.01, 0.01]),
        shapes,
        np.ones(CHANNELS),
    )


def bench_with(told, scatter=1.0e-4, shift=0.0):
    """Return what the draws ask of a Workbench: two of three modes seen to within `scatter`."""
    return SimpleNamespace(
        linear_stage=told,
        modes_told=told,
        signals=SimpleNamespace(names=("a", "b")),
        bare=SimpleNamespace(modes=MODES, omega=np.array([60.0, 150.0, 400.0])),
        measured_fit=SimpleNamespace(modes=np.array([0, 1])),
        measured_reading=replace(
            reading(shift),
            error=np.diag([scatter**2] * 2 + [1.0e-2] * 2 + [0.0] * 2 * CHANNELS),
        ),
        bare_reading=reading(),
    )


def scattered(bench):
    draws = nuisance_draws(bench, COUNT, seed=1)
    return {
        name: np.array([getattr(draw, name) for draw in draws])
        for name in ("frequency", "damping", "gain")
    }


def test_unseen_modes_scatter_as_their_priors():
    rows = scattered(bench_with(told=False))
    assert np.log(rows["frequency"]).std(axis=0) == pytest.approx(priors.FREQUENCY_SD, rel=0.05)
    damping = np.hypot(np.log(priors.UNSEEN_DAMPING), priors.DAMPING_SD)
    assert np.log(rows["damping"]).std(axis=0) == pytest.approx(damping, rel=0.05)
    assert rows["gain"].std(axis=0) == pytest.approx(priors.GAIN_SD, rel=0.05)
    common = np.corrcoef(np.log(rows["damping"]).T)
    assert common[0, 1] > 0.9  # one cause


@pytest.mark.parametrize("seems", [0.1, 2.0])
def test_untold_damping_is_off_by_what_it_seems(seems):
    bench = bench_with(told=True)
    bench.modes_told = False  # the response is nonlinear, as that to a drag is at any load
    bench.measured_fit.log_damping = np.array([-seems, seems])
    known = min(seems, -np.log(priors.UNSEEN_DAMPING))
    wanted = np.hypot([known, known, np.log(priors.UNSEEN_DAMPING)], priors.DAMPING_SD)
    damping = np.log(scattered(bench)["damping"])
    assert damping.std(axis=0) == pytest.approx(wanted, rel=0.05)
    assert np.corrcoef(damping.T)[0, 2] > 0.5  # one cause


def test_seen_modes_are_where_the_lowest_record_saw_them():
    shift, scatter = 0.004, 4.0e-4
    rows = scattered(bench_with(told=True, scatter=scatter, shift=shift))
    weight = 1.0 / (1.0 + (scatter / priors.FREQUENCY_SD) ** 2)  # of a normal prior and one reading
    seen = np.log(rows["frequency"])[:, :2]
    assert seen.mean(axis=0) == pytest.approx(weight * shift, rel=0.02)
    assert seen.std(axis=0) == pytest.approx(scatter * np.sqrt(weight), rel=0.1)
    assert np.log(rows["frequency"])[:, 2].std() == pytest.approx(priors.FREQUENCY_SD, rel=0.05)


def test_a_mode_three_sigma_off_is_corrected_as_far_as_it_is():
    """No effect is named there: what is left of it would be told as one."""
    shift = 3.0 * priors.FREQUENCY_SD
    rows = scattered(bench_with(told=True, shift=shift))
    assert np.log(rows["frequency"])[:, :2].mean(axis=0) == pytest.approx(shift, rel=0.02)


def test_clearances_are_drawn_about_their_own():
    scales = np.log(clearance_draws(4000, seed=2))
    assert scales.mean() == pytest.approx(0.0, abs=0.1 * constants.CLEARANCE_SD)
    assert scales.std() == pytest.approx(constants.CLEARANCE_SD, rel=0.05)
