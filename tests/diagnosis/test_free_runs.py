"""Spectra of free runs beside measured ones."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.free_runs import CHANCE_RUNS, free_runs


@pytest.fixture(scope="module")
def compared(comparison):
    """The mean of the model's free runs as the measurement, ten times louder in one channel."""
    runs = free_runs(comparison.structure, comparison.signals)
    measured = runs.before.mean(axis=1)
    measured[:, 1] *= 10.0
    return replace(runs, measured=measured, noise=1.0e-12 + 0.0 * runs.noise)


def test_a_channel_ten_times_louder_is_ten_decibels_off(compared):
    rows = compared.regions(5)
    assert {row["channel"] for row in rows} == {compared.signals.names[1]}
    assert np.median([row["discrepancy_dB"] for row in rows]) == pytest.approx(10.0, abs=3.0)


def test_records_and_channels_are_as_far_off_each_on_its_own(compared):
    signals = compared.signals
    records, channels = range(len(signals.load)), range(len(signals.names))
    rows = [compared.distance([record], channel) for record in records for channel in channels]
    away, floor = (
        np.array([row[name] for row in rows], float).reshape(len(signals.load), -1)
        for name in ("before_dB", "floor_dB")
    )
    louder = np.arange(len(signals.names)) == 1
    assert (away[:, louder] > 8.0).all()
    known = np.isfinite(away) & ~louder
    assert (away[known] < floor[known] + 0.1).all() and known.any()


def test_a_run_that_failed_spoils_no_other_record(compared):
    before = compared.before.copy()
    before[0, 2] = np.nan
    rows = replace(compared, before=before).regions(5)
    assert np.isfinite([row["z"] for row in rows]).all()
    assert compared.signals.record_names[0] not in {row["record"] for row in rows}


def test_a_record_is_off_where_no_run_is_as_far_from_the_others(compared):
    assert 0 in compared.surely_off()
    assert replace(compared, measured=compared.before[:, 0]).surely_off() == []


def test_a_record_is_not_off_where_one_run_whirls_as_it_does(compared):
    """What one of four runs does is chance."""
    whirling = compared.after.copy()
    whirling[:, 3] *= 10.0
    assert replace(compared, measured=whirling[:, 3].copy(), after=whirling).surely_off() == []


def test_a_completion_is_farther_off_beyond_the_scatter_of_runs(compared):
    records = range(len(compared.signals.load))
    louder = replace(compared, after=4.0 * compared.after, measured=compared.before[:, 0])
    assert louder.farther(records)
    assert not replace(louder, after=compared.before).farther(records)
    one = compared.after.copy()
    one[:, 1:] *= 4.0  # as one of the completed model's runs
    assert not replace(louder, after=one).farther(records)


def test_repeated_runs_begin_with_the_first_ones(compared):
    many = compared.repeated()
    assert many.before.shape[1] == many.after.shape[1] == CHANCE_RUNS
    np.testing.assert_array_equal(many.before[:, : compared.before.shape[1]], compared.before)
    assert len(np.unique(many.before[-1, :, 0, 20])) == CHANCE_RUNS


def test_nothing_added_closes_nothing(compared):
    row = compared.distance(np.arange(len(compared.signals.load)))
    assert row["before_dB"] == row["after_dB"]
    assert row["closed_fraction"] in (None, pytest.approx(0.0, abs=1e-9))


def test_what_the_model_does_not_move_is_compared_with_noise(compared):
    """A channel that a symmetric model leaves at rest is off by its motion over its noise."""
    still = replace(compared, before=0.0 * compared.before, after=0.0 * compared.after)
    row = still.distance(np.arange(len(compared.signals.load)))
    assert row["before_dB"] is not None and row["before_dB"] < 200.0


def test_a_channel_that_rests_in_both_is_not_compared(compared):
    """It measures what a sensor picks up across its axis, a thousandth of the motion."""
    records, factor = range(len(compared.signals.load)), np.ones((len(compared.signals.names), 1))
    factor[1] = 1.0e-8
    quiet = replace(
        compared,
        measured=compared.measured * 100.0 * factor,
        before=compared.before * factor,
        after=compared.after * factor,
        noise=0.0 * compared.noise,
    )
    assert quiet.resting == [compared.signals.names[1]]
    assert quiet.distance(records, 1)["before_dB"] is None
    whirling = replace(quiet, measured=compared.measured)
    assert whirling.resting == [] and whirling.distance(records, 1)["before_dB"] > 60.0


def test_a_force_that_was_measured_too_large_is_divided(comparison):
    """Far from contact, a force gain of two halves the response to what was measured."""
    signals = comparison.signals
    quiet = replace(signals, force=1.0e-3 * signals.force)
    doubled = Point((Term("sensor_gain", "force", (2.0,)),))
    runs = free_runs(comparison.structure, quiet).completed(doubled)
    y = [number for number, name in enumerate(signals.names) if name.endswith("_y")]
    ratio = runs.after[0, 0, y].sum(axis=-1) / runs.before[0, 0, y].sum(axis=-1)
    assert ratio == pytest.approx(0.25, rel=1.0e-3)
