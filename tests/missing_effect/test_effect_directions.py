"""Values have unit variance along what effects change, whatever few runs of the null say of it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import linalg

from tests.white_null import white_null
from vibroimpact.missing_effect import constants
from vibroimpact.missing_effect.effect_directions import EffectDirections, told_of
from vibroimpact.missing_effect.null import Null, scatter
from vibroimpact.missing_effect.search import Search
from vibroimpact.missing_effect.trials import Trial

RECORDS, FEATURES, RUNS = 4, 30, 24
RANDOM = np.random.default_rng(8)
CODES = 0.1 * np.eye(FEATURES)
NUISANCE = RANDOM.standard_normal(FEATURES)  # the same in all records


def runs(count):
    """Return (record, run, feature): white scatter, and a nuisance that all records share."""
    common = RANDOM.standard_normal((count, 1)) * NUISANCE
    return RANDOM.standard_normal((RECORDS, count, FEATURES)) + common


@pytest.fixture
def null():
    features = runs(RUNS)
    return Null(
        records=np.arange(RECORDS),
        layout=SimpleNamespace(blend=1.0e9),  # nothing is drawn in
        mean=np.zeros((RECORDS, FEATURES)),
        features=features,
        seeds_per_draw=1,
        free=np.tile(CODES, (RECORDS, 1, 1)),
        factor=np.array([linalg.cholesky(scatter(row) + CODES, lower=True) for row in features]),
        measured=np.zeros(RECORDS * FEATURES),
        groups=np.zeros(RECORDS * FEATURES, int),
        along=np.zeros((0, RECORDS * FEATURES)),
        rescaled=np.zeros((0, 0)),
    )


def variance(null, along):
    """Return the variance of fresh measurements along a direction (value,)."""
    fresh = runs(2000) + np.sqrt(0.1) * RANDOM.standard_normal((RECORDS, 2000, FEATURES))
    rows = np.array([null.change(fresh[:, run]) for run in range(2000)])
    return np.mean((rows @ along) ** 2)


def test_nuisance_of_all_records_is_known(null, monkeypatch):
    monkeypatch.setattr(constants, "ALIKE", 0.0)
    change = null.change(np.tile(NUISANCE, (RECORDS, 1)))
    change /= np.linalg.norm(change)
    told = told_of(null, EffectDirections(change[None], np.ones(1)))
    assert variance(null, change) > 2.0  # every record's covariance knows a quarter of it
    assert variance(told, change) == pytest.approx(1.0, abs=0.5)  # 24 runs tell no better
    aside = RANDOM.standard_normal(change.size)
    aside -= (aside @ change) * change
    assert null.in_units(aside) == pytest.approx(told.in_units(aside))


def test_what_codes_differ_by_looks_like_effects(null):
    along = np.linalg.qr(RANDOM.standard_normal((RECORDS * FEATURES, 2)))[0].T
    share = np.array([0.8, 0.2])
    variances = []
    for alike in (0.0, constants.ALIKE):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(constants, "ALIKE", alike)
            told = told_of(null, EffectDirections(along, share))
        variances.append(linalg.inv(told.rescaled @ told.rescaled))
    wanted = constants.ALIKE**2 * RECORDS * FEATURES * np.diag(share)
    assert variances[1] - variances[0] == pytest.approx(wanted, abs=1.0e-8)


def test_directions_are_those_of_seen_changes():
    axes = np.eye(5)
    changes = np.array([30.0 * axes[0], -60.0 * axes[0], 40.0 * axes[1], 1.0 * axes[2]])
    effects = EffectDirections.of(changes, np.full(4, 1.0e-6), white_null(np.zeros(5)))
    assert np.abs(effects.along) == pytest.approx(axes[:2], abs=1.0e-9)
    assert effects.share == pytest.approx([2 / 3, 1 / 3], abs=1.0e-6)


def test_without_effects_nothing_is_told():
    null = white_null(np.arange(5.0))
    effects = EffectDirections.of(np.zeros((0, 5)), np.zeros(0), null)
    assert told_of(null, effects).measured == pytest.approx(null.measured)


def test_what_the_mean_is_off_by_is_no_direction(null):
    """It is in the change of every run, as it is in the measurement."""
    off = RANDOM.standard_normal((RECORDS, FEATURES))
    changes = np.array([null.change(row - off) for row in runs(12).transpose(1, 0, 2)])
    null = replace(null, features=null.features - off[:, None])
    none = EffectDirections.of(changes, np.ones(12), null)
    assert np.abs(none.along @ null.change(off)).max(initial=0.0) < 0.3 * np.linalg.norm(
        null.change(off)
    )


def test_an_effect_counts_once_however_often_it_was_run():
    axes = np.eye(5)
    changes = np.array([*[30.0 * axes[0]] * 9, 40.0 * axes[1]])
    weight = np.array([*[1.0 / 9.0] * 9, 1.0])
    effects = EffectDirections.of(changes, np.full(10, 1.0e-6), white_null(np.zeros(5)), weight)
    assert effects.share == pytest.approx([0.5, 0.5], abs=1.0e-6)


def trial(change, screened):
    """A Trial of one explanation that was run once, with hardly any scatter."""
    candidate = SimpleNamespace(effect=SimpleNamespace(parameters=[None]))
    known = Trial.empty(candidate, change.size)
    known.add(np.zeros(1), np.array([change, change]))
    known.screened = screened
    return known


def test_chance_is_learned_along_what_was_run_after_screening(null):
    common = null.change(np.tile(NUISANCE, (RECORDS, 1)))
    common *= 20.0 / np.linalg.norm(common)  # what all records share lies along the later one
    aside = RANDOM.standard_normal(common.size)
    aside *= 20.0 / np.linalg.norm(aside)
    trials = {"first": trial(aside, 1), "later": trial(common, 0)}
    search = Search(None, replace(null, measured=common), {}, trials)
    search.learn()
    assert np.linalg.norm(search.null.measured) < 0.7 * np.linalg.norm(common)
    assert trials["later"].change[0] == pytest.approx(search.null.measured)
    turned = search.null.measured.copy()
    search.learn()  # the same runs tell no more
    assert search.null.measured == pytest.approx(turned)


def test_null_is_known_as_it_was_before_effects_were_run(null):
    null = replace(null, measured=RANDOM.standard_normal(RECORDS * FEATURES))
    along = np.linalg.qr(RANDOM.standard_normal((RECORDS * FEATURES, 2)))[0].T
    told = told_of(null, EffectDirections(along, np.array([0.8, 0.2])))
    assert np.abs(told.measured - null.measured).max() > 0.1
    assert told.plain.measured == pytest.approx(null.measured)
    assert told.plain.probability() == pytest.approx(null.probability())
