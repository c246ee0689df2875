"""Nuisances beside a candidate: a record that a cubic spring bends tells of frequencies, damping
and gains once the spring is in the model.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.config.reading import check_config
from vibroimpact.discrepancy import naming, priors
from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.attach import attach, with_channel_points
from vibroimpact.discrepancy.beside import moved, nearest_lowest, nuisance_beside
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.finalists import Finalist
from vibroimpact.discrepancy.forward import Forces, schedule_of, simulate_records
from vibroimpact.discrepancy.nuisance_directions import nuisance_directions, unknowns_free
from vibroimpact.discrepancy.null import UNSEEN, null_of, unseen_damping
from vibroimpact.discrepancy.screening import Path
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.excitation.random_force import band_limited_noise

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
PLACES = {"apex_y": (0.0, 0.0, 1.0), "bend_y": (0.2121, 0.0, 0.9121), "leg_y": (-0.3, 0.0, 0.55)}
SPRING, COEFFICIENT = candidate_named("cubic_stiffness@left_leg"), {"coefficient": 6.0e10}
TRUE = linear.Nuisance(
    np.array([0, 2]), np.array([1.003, 0.998]), np.array([1.15, 0.88]), np.array([1.03, 0.98, 1.0])
)


@pytest.fixture(scope="module")
def bench(study_config):
    """Workbench of a tube with a cubic spring at a leg, whose modes and gains are not the model's,
    with noise.
    """
    samples = int(RATE * SECONDS)
    force = (
        np.array([[0.5], [5.0]])
        * band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0))
    )[:, None]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")

    def campaign(response):
        channels = [
            Channel(name, point, (0.0, 1.0, 0.0), "m s-2", "acceleration")
            for name, point in PLACES.items()
        ]
        return campaign_dataset(
            force,
            response,
            channels,
            [drive],
            [Level("low", GAP), Level("high", GAP)],
            RATE,
            start_up="rest",
        )

    blank = campaign(np.zeros((2, len(PLACES), samples)))
    config = with_channel_points(study_config, blank)
    model = attach(
        check_config(SPRING.variant(config.model_dump(mode="json"), COEFFICIENT), "model"), blank
    )
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    response = (
        simulate_records(
            linear.corrected(model, TRUE),
            schedule,
            Forces(force, schedule),
            [(0, GAP, 0)],
            ["acceleration"] * 3,
        )[0]
        * TRUE.gain[:, None]
    )
    response = (
        response
        + 0.01
        * np.random.default_rng(4).standard_normal(response.shape)
        * response.std(axis=-1).max()
    )
    return Workbench(study_config, campaign(np.stack([response, response])), SECONDS)


def test_record_with_spring_does_not_fit_the_linear_modes(bench):
    assert bench.measured_fit.residual.max() > 3.0
    assert not linear.credible(
        bench.measured_reading, bench.bare_reading, bench.measured_fit.covariance
    )


def test_modes_and_gains_are_recovered_given_the_spring(bench):
    told = nuisance_beside(bench, SPRING, COEFFICIENT)
    for mode in TRUE.modes:
        here, there = list(told.modes).index(mode), list(TRUE.modes).index(mode)
        assert told.frequency[here] == pytest.approx(TRUE.frequency[there], abs=0.0012)
        assert told.damping[here] == pytest.approx(TRUE.damping[there], abs=0.06)
    np.testing.assert_allclose(told.gain / told.gain[2], TRUE.gain / TRUE.gain[2], atol=0.015)


def test_negligible_spring_gives_no_nuisance_estimate(bench):
    assert nuisance_beside(bench, SPRING, {"coefficient": 6.0e6}) is None


@pytest.mark.slow
def test_spring_is_located_before_nuisances_are_known(bench):
    """Over four decades of the coefficient, modes 0.3 % and dampings 15 % off: to within a third,
    which is where nuisances are told.
    """
    scales = {"cubic": 8.0e10}
    found = nearest_lowest(bench, SPRING, scales)
    assert SPRING.physical(found, scales)["coefficient"] == pytest.approx(
        COEFFICIENT["coefficient"], rel=0.35
    )
    assert nuisance_beside(bench, SPRING, SPRING.physical(found, scales)) is not None


def test_nonlinear_record_pulls_many_nuisances():
    faulty_gain = [
        1.4,
        0.0,
        0.8,
        -1.7,
        0.6,
        1.8,
        0.6,
        0.2,
        0.1,
        0.0,
        0.4,
        0.3,
        0.0,
        -1.2,
        -70.8,
    ]
    bent = [2.9, 1.6, 1.0, -0.3, 2.6, -1.6, 1.6, 0.9, 3.3, 0.0, -0.3, 0.4, 0.0, -1.1, -1.0]
    assert linear.plausible(faulty_gain)
    assert not linear.plausible(bent)


def test_nuisance_cost_is_half_the_sum_of_squared_sigmas():
    assert linear.cost(TRUE) == pytest.approx(
        0.5 * sum(np.square([0.99850, -0.66733, 1.39762, -1.27833, 1.5, -1.0])), rel=1e-4
    )
    assert linear.cost(linear.neutral([0, 2], 3)) == 0.0


def test_nuisance_moves_at_half_a_sigma():
    none = linear.neutral([0], 1)
    assert not moved(
        linear.Nuisance(none.modes, np.array([1.001]), np.array([1.04]), np.array([0.995])), none
    )
    assert moved(linear.Nuisance(none.modes, none.frequency, np.array([1.06]), none.gain), none)


@pytest.fixture(scope="module")
def bent(bench):
    """The Workbench where nothing is told of nuisances, since the record is none of a linear
    structure.
    """
    out = bench.corrected_by(linear.neutral(bench.measured_fit.modes, len(PLACES)))
    out.nonlinear_low, out.modes_told = True, False
    return out


@pytest.fixture(scope="module")
def null(bent):
    """Null of both records under the bare model."""
    records = np.arange(2)

    def features(model, seeds=4):
        return bent.features(model, bent.runs(records, seeds)).reshape(2, seeds, -1)

    others = (features(unseen_damping(bent, bent.values, factor)) for factor in UNSEEN)
    return null_of(bent, records, features(bent.model()), *others)


def at(bent, null, coefficient):
    """What the spring of a coefficient leaves: a Finalist as far as its likelihood goes."""
    values = bent.variant(SPRING, {"coefficient": coefficient})
    mean = (
        bent.features(bent.model(values), bent.runs(null.records, 4, 100))
        .reshape(2, 4, -1)
        .mean(axis=1)
    )
    free = np.concatenate(
        [np.zeros((1, *null.mean.shape)), nuisance_directions(bent, values, null.records, 200)]
    )
    return SimpleNamespace(mean=mean, free=free, own=lambda null: null.freed(free))


def test_linear_model_does_not_explain_the_record(bent, null):
    assert bent.measured_fit.residual.max() > 3.0
    assert naming.bare_explained(bent, null, bent.measured_features)[0] < priors.EXPLAINED_Z


def test_nuisance_directions_act_on_lowest_record_and_gains(bent, null):
    count = 2 * len(bent.measured_fit.modes)
    directions = nuisance_directions(bent, bent.values, null.records, 50)
    assert directions.shape == (2 * count + len(PLACES), *null.mean.shape)
    first, second, gains = np.split(directions, [count, 2 * count])
    assert np.linalg.norm(first[:, 0], axis=-1).min() > 0.05
    # the bare structure is linear, and its damping small: what a per cent of a frequency changes in
    # bands of 15 % is first order but at their edges
    assert np.linalg.norm(second[count // 2 :, 0]) < 0.2 * np.linalg.norm(first[count // 2 :, 0])
    assert not np.concatenate([first, second])[:, 1].any()
    np.testing.assert_allclose(gains.max(axis=-1), 20.0 * np.log10(1.02), rtol=1e-12)


def test_linear_record_leaves_no_free_nuisance(bent, null):
    linear_bench = bent.corrected_by(bent.nuisance)
    linear_bench.nonlinear_low = False
    assert nuisance_directions(linear_bench, bent.values, null.records, 50).shape == (
        0,
        *null.mean.shape,
    )


@pytest.mark.slow
def test_true_spring_leaves_only_nuisances(bent, null):
    found = at(bent, null, COEFFICIENT["coefficient"])
    without = naming.explained(
        bent, null.freed(found.free[:1]), found.mean, bent.measured_features
    )[0]
    assert (
        without
        < priors.EXPLAINED_Z
        < naming.explained(bent, found.own(null), found.mean, bent.measured_features)[0]
    )


@pytest.mark.slow
@pytest.mark.parametrize("coefficient", [6.0e6, 6.0e9])
def test_wrong_spring_leaves_more_than_nuisances(bent, null, coefficient):
    found = at(bent, null, coefficient)
    assert (
        naming.explained(bent, found.own(null), found.mean, bent.measured_features)[0]
        < 3.0 * priors.EXPLAINED_Z
    )


@pytest.mark.slow
def test_finalist_is_scored_again_with_free_nuisances(bent, null):
    scales, seeds = {"cubic": 8.0e10}, 4
    unit = SPRING.normalised(COEFFICIENT, scales)
    features = bent.features(
        bent.model(bent.variant(SPRING, COEFFICIENT)), bent.runs(null.records, seeds, 100)
    ).reshape(2, seeds, -1)
    path = Path(unit[None], features.mean(axis=1)[None], np.array([seeds]), [None])
    before = Finalist(
        SPRING,
        unit,
        None,
        np.zeros(2),
        -3.0,
        features,
        path,
        [],
        np.zeros((1, *null.mean.shape)),
        nuisance=bent.nuisance,
    )
    found = unknowns_free(bent, null, bent.measured_features, before, scales)
    assert (
        naming.explained(bent, before.own(null), found.mean, bent.measured_features)[0]
        < priors.EXPLAINED_Z
    )
    assert (
        naming.explained(bent, found.own(null), found.mean, bent.measured_features)[0]
        > priors.EXPLAINED_Z
    )
    assert found.low == before.low
    given_up = replace(before, free=before.free[:0])
    assert unknowns_free(bent, null, bent.measured_features, given_up, scales) is given_up
