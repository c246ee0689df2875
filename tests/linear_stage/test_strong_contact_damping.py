"""Contact dampers so strong that the exact step would feed them are simulated by Newmark steps."""

from dataclasses import replace

import numpy as np
import pytest

from tests.sound_campaign import sound_campaign
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.observation.simulated_records import Forces, simulate_records

STRONG = {"damping": 1000.0}  # N s/m per plate
ALPHA = 100.0  # s/m
CANDIDATE = candidate_named("contact_damping@all")


@pytest.fixture(scope="module")
def bench(study_config):
    return Workbench(study_config, sound_campaign())


def test_only_what_the_exact_step_feeds_takes_newmark_steps(bench):
    usual, _ = bench.stepped(bench.model())
    assert usual is bench.schedule and usual.scheme == "exact"
    fed, _ = bench.stepped(bench.model(bench.variant(CANDIDATE, STRONG)))
    assert fed.scheme == "newmark" and fed.steps_per_second > usual.steps_per_second


def test_runs_that_diverge_are_marched_with_finer_steps(bench):
    """Hunt-Crossley damping grows with the indentation, so that no check before tells of it."""
    heavy = bench.model(bench.variant(candidate_named("hunt_crossley@all"), {"alpha": ALPHA}))
    record = int(bench.signals.load.argmax())
    runs = bench.runs([record], 8)
    schedule, forces = bench.stepped(heavy)
    with pytest.raises(IntegrationError, match="diverged"):
        simulate_records(heavy, schedule, forces, runs, bench.signals.kinds)
    assert np.isfinite(bench.respond(heavy, runs)).all()  # verification needs whole responses


@pytest.mark.slow
def test_their_response_is_that_of_exact_steps_fine_enough(bench):
    model = bench.model(bench.variant(CANDIDATE, STRONG))
    record = int(bench.signals.load.argmax())
    runs = bench.runs([record], 8)
    ours = bench.respond(model, runs)
    steps = 24 * bench.schedule.steps_per_second  # its highest mode is then as slow as is needed
    fine = replace(bench.schedule, steps_per_second=steps)
    force = Forces(bench.signals.force, fine)
    exact = simulate_records(model, fine, force, runs, bench.signals.kinds)
    rms = [np.sqrt(np.mean(np.asarray(each, float) ** 2, axis=-1)) for each in (ours, exact)]
    along_the_force = [0, 2]
    error = np.log(rms[0] / rms[1]).mean(axis=0)[along_the_force]
    assert np.abs(error).max() < 0.05
