"""Nuisances where a cubic spring bends the lowest record: left free, they are what is left beside the spring, and beside no other."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.campaign import Channel, Level, campaign_dataset
from vibroimpact.config import check_config
from vibroimpact.discrepancy import naming, priors
from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.attach import attach, with_channel_points
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.forward import Forces, schedule_of, simulate_records
from vibroimpact.discrepancy.null import UNSEEN, null_of, unseen_damping
from vibroimpact.discrepancy.nuisance_directions import nuisance_directions
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.excitation import band_limited_noise

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
PLACES = {"apex_y": (0.0, 0.0, 1.0), "bend_y": (0.2121, 0.0, 0.9121), "leg_y": (-0.3, 0.0, 0.55)}
SPRING, COEFFICIENT = candidate_named("cubic_stiffness@left_leg"), {"coefficient": 6.0e10}
TRUE = linear.Nuisance(np.array([0, 2]), np.array([1.003, 0.998]), np.array([1.15, 0.88]), np.array([1.03, 0.98, 1.0]))


@pytest.fixture(scope="module")
def bench(study_config):
    """Workbench of a tube with a cubic spring at a leg, whose modes and gains are not the model's, with noise."""
    samples = int(RATE * SECONDS)
    force = (np.array([[0.5], [5.0]]) * band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0)))[:, None]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")

    def campaign(response):
        channels = [Channel(name, point, (0.0, 1.0, 0.0), "m s-2", "acceleration") for name, point in PLACES.items()]
        return campaign_dataset(force, response, channels, [drive], [Level("low", GAP), Level("high", GAP)], RATE, start_up="rest")

    blank = campaign(np.zeros((2, len(PLACES), samples)))
    config = with_channel_points(study_config, blank)
    model = attach(check_config(SPRING.variant(config.model_dump(mode="json"), COEFFICIENT), "model"), blank)
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    response = simulate_records(linear.corrected(model, TRUE), schedule, Forces(force, schedule), [(0, GAP, 0)], ["acceleration"] * 3)[0] * TRUE.gain[:, None]
    response = response + 0.01 * np.random.default_rng(4).standard_normal(response.shape) * response.std(axis=-1).max()
    out = Workbench(study_config, campaign(np.stack([response, response])), SECONDS)
    out.nuisance, out.nonlinear_low = linear.neutral(out.measured_fit.modes, len(PLACES)), True
    return out


@pytest.fixture(scope="module")
def null(bench):
    """Null of both records under the bare model."""
    records = np.arange(2)

    def features(model, seeds=4):
        return bench.features(model, bench.runs(records, seeds)).reshape(2, seeds, -1)

    others = (features(unseen_damping(bench, bench.values, factor)) for factor in UNSEEN)
    return null_of(bench, records, nuisance_directions(bench, bench.values, records, 50), features(bench.model()), *others)


def at(bench, null, coefficient):
    """What the spring of a coefficient leaves: a Finalist as far as its likelihood goes."""
    values = bench.variant(SPRING, {"coefficient": coefficient})
    mean = bench.features(bench.model(values), bench.runs(null.records, 4, 100)).reshape(2, 4, -1).mean(axis=1)
    free = np.concatenate([np.zeros((1, *null.mean.shape)), nuisance_directions(bench, values, null.records, 200)])
    return SimpleNamespace(mean=mean, free=free, own=lambda null: null.freed(free))


def test_alone_the_record_is_none_of_the_bare_model(bench, null):
    assert bench.measured_fit.residual.max() > 3.0
    assert naming.bare_explained(bench, null, bench.measured_features)[0] < priors.EXPLAINED_Z


def test_directions_are_of_the_lowest_record_but_for_gains(bench, null):
    count = 2 * len(bench.measured_fit.modes)
    directions = nuisance_directions(bench, bench.values, null.records, 50)
    assert directions.shape == (2 * count + len(PLACES), *null.mean.shape)
    first, second, gains = np.split(directions, [count, 2 * count])
    assert np.linalg.norm(first[:, 0], axis=-1).min() > 0.05
    # the bare structure is linear, and its damping small: what a per cent of a frequency changes in bands of 15 % is first order but at their edges
    assert np.linalg.norm(second[count // 2 :, 0]) < 0.2 * np.linalg.norm(first[count // 2 :, 0])
    assert not np.concatenate([first, second])[:, 1].any()
    np.testing.assert_allclose(gains.max(axis=-1), 20.0 * np.log10(1.02), rtol=1e-12)


def test_a_linear_record_leaves_nothing_free(bench, null):
    linear_bench = bench.corrected_by(bench.nuisance)
    linear_bench.nonlinear_low = False
    assert nuisance_directions(linear_bench, bench.values, null.records, 50).shape == (0, *null.mean.shape)


def test_beside_the_spring_nuisances_are_what_is_left(bench, null):
    found = at(bench, null, COEFFICIENT["coefficient"])
    without = naming.explained(bench, null.freed(found.free[:1]), found.mean, bench.measured_features)[0]
    assert without < priors.EXPLAINED_Z < naming.explained(bench, found.own(null), found.mean, bench.measured_features)[0]


@pytest.mark.parametrize("coefficient", [6.0e6, 6.0e9])
def test_beside_another_spring_nuisances_are_not_what_is_left(bench, null, coefficient):
    found = at(bench, null, coefficient)
    assert naming.explained(bench, found.own(null), found.mean, bench.measured_features)[0] < 3.0 * priors.EXPLAINED_Z
