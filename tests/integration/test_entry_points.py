"""A run alone, whose vectors lie along modes and rows: the bits that it has in a batch."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

from tests.flow.test_fluid_rows import acting
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.integration import kernels
from vibroimpact.integration.batch import Schedule, integrate_batch
from vibroimpact.integration.entry_points import entry_points, lanes_of
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.reduction.reduced_model import build_model

CASES, LOAD, GAP = 3, 200.0, 3.0e-5


@pytest.fixture(scope="module")
def models(study_model):
    """Models that take every path of the kernel."""
    rubbing = {"friction": 0.3, "stick_stiffness": study_model.contact_stiffness}
    lobes = {"lobes": 4.0, "lobe_depth": 1.0e-5, "lobe_angle": 0.3}

    def with_laws(**columns):
        laws = study_model.contact_laws.with_columns(**columns)
        return replace(study_model, contact_laws=laws)

    return {
        "friction": with_laws(**rubbing),
        "lobes": with_laws(**rubbing, **lobes),
        "flow": build_model(acting(acting_m_per_s=1.4)),
    }


def integrated(model, first, cases):
    """The BatchResult of cases from a first one on."""
    schedule = Schedule(20480, 2048, 0.0, 0.02, "exact")
    noise = [
        LOAD * band_limited_noise(np.random.default_rng(case), schedule.steps + 2, 20480, (5, 200))
        for case in range(first, first + cases)
    ]
    force = np.stack(noise, axis=-1)[:, None]
    offset = np.random.default_rng(7).uniform(-1e-6, 1e-6, (*model.centre_offset.shape, CASES))
    return integrate_batch(
        model,
        schedule,
        np.full(cases, GAP),
        offset[..., first : first + cases],
        lambda at, count: force[at : at + count],
    )


@pytest.mark.parametrize("name", ["friction", "lobes", "flow"])
def test_a_run_alone_has_the_bits_of_its_batch(models, name):
    batch, alone = integrated(models[name], 0, CASES), integrated(models[name], 1, 1)
    assert batch.tally["impacts"][:, 1].sum() > 0
    for series in ("displacement", "acceleration", "force", "energy"):
        assert np.array_equal(getattr(alone, series)[0], getattr(batch, series)[1]), series
    for key, values in alone.tally.items():
        assert np.array_equal(values[..., 0], batch.tally[key][..., 1]), key


def test_a_run_alone_has_kernels_of_its_own():
    assert [lanes_of(cases) for cases in (1, 2, LANES)] == [1, LANES, LANES]
    assert entry_points(1).march is not entry_points(LANES).march
    assert entry_points(1) is entry_points(1)


def test_all_copies_of_the_kernels_say_a_sentence_once():
    entry_points(1)
    copy = importlib.import_module(f"{kernels.__name__}_of_1.compiled")
    assert copy.SAID is kernels.compiled.SAID
