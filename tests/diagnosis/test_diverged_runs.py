"""Runs of a structure that may be thrown off: those that were are left out, those that were not are
as they were.
"""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.reduction.reduced_model import build_model

RATE, FAR = 20480, 1.0
LOADS = (
    1.0,
    60.0,
)  # N rms: at rest near zero, and over the edge of a spring that pulls beyond one side


@pytest.fixture(scope="module")
def leaning(study_config):
    """The tube with a spring of force k u², which has no bounded motion beyond its edge."""
    effect = EFFECTS["quadratic_stiffness"]
    values = study_config.model_dump(mode="json")
    values = effect.apply(values, {"coefficient": -4.0e6}, effect.locations(values)[0])
    model = build_model(check_config(values, "leaning"))
    return replace(
        model,
        line_shapes=model.line_shapes[:, :0],
        line_positions=np.zeros((0, 3)),
        line_arc_length=np.zeros(0),
    )


@pytest.fixture(scope="module")
def forces():
    schedule = Schedule(RATE, 2048, 0.0, 0.5, "exact")
    unit = np.random.default_rng(3).standard_normal((1, 1024))
    return schedule, np.array([load * unit for load in LOADS])


def runs_of(thrown):
    """A batch of which the last so many are thrown off."""
    return [(int(lane >= LANES - thrown), FAR, 0) for lane in range(LANES)]


def test_diverged_run_does_not_change_the_others(leaning, forces):
    kinds = ["acceleration"] * leaning.sensor_shapes.shape[1]
    found = simulate_records(leaning, *forces, runs_of(2), kinds)
    assert np.isnan(found[-2:]).all()
    np.testing.assert_array_equal(
        found[:-2], simulate_records(leaning, *forces, runs_of(0), kinds)[:-2]
    )


def test_model_with_mostly_diverged_runs_is_rejected(leaning, forces):
    with pytest.raises(IntegrationError, match="diverged"):
        simulate_records(
            leaning, *forces, runs_of(3), ["acceleration"] * leaning.sensor_shapes.shape[1]
        )
