"""Spectra of free runs beside measured ones."""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.diagnosis.explanations import Point, Term
from vibroimpact.diagnosis.free_runs import distance, distances, free_runs, regions, surely_off


@pytest.fixture(scope="module")
def compared(comparison):
    """The mean of the model's free runs as the measurement, ten times louder in one channel."""
    signals = comparison.signals
    runs = free_runs(comparison.structure, signals, None)
    measured = runs.before.mean(axis=1)
    measured[:, 1] *= 10.0
    return signals, replace(runs, measured=measured, noise=1.0e-12 + 0.0 * runs.noise)


def test_a_channel_ten_times_louder_is_ten_decibels_off(compared):
    signals, runs = compared
    rows = regions(runs, signals, 5)
    assert {row["channel"] for row in rows} == {signals.names[1]}
    assert np.median([row["discrepancy_dB"] for row in rows]) == pytest.approx(10.0, abs=3.0)


def test_records_and_channels_are_as_far_off_each_on_its_own(compared):
    signals, runs = compared
    rows = distances(runs, signals)
    away, floor = (
        np.array([row[name] for row in rows], float).reshape(len(signals.load), -1)
        for name in ("before_dB", "floor_dB")
    )
    louder = np.arange(len(signals.names)) == 1
    assert (away[:, louder] > 8.0).all()
    known = np.isfinite(away) & ~louder
    assert (away[known] < floor[known] + 0.1).all() and known.any()


def test_a_run_that_failed_spoils_no_other_record(compared):
    signals, runs = compared
    before = runs.before.copy()
    before[0, 2] = np.nan
    rows = regions(replace(runs, before=before), signals, 5)
    assert np.isfinite([row["z"] for row in rows]).all()
    assert signals.record_names[0] not in {row["record"] for row in rows}


def test_a_record_is_off_where_no_run_is_as_far_from_the_others(compared, comparison):
    signals, runs = compared
    given = comparison.structure, signals, Point(), [0]
    assert surely_off(runs, *given) == [0]
    alike = replace(runs, measured=runs.before[:, 0])
    assert surely_off(alike, *given) == []


def test_a_record_is_not_off_where_one_run_whirls_as_it_does(compared, comparison):
    """What one of four runs does is chance."""
    signals, runs = compared
    whirling = runs.after.copy()
    whirling[:, 3] *= 10.0
    chance = replace(runs, measured=whirling[:, 3].copy(), after=whirling)
    assert surely_off(chance, comparison.structure, signals, Point(), [0, 1, 2]) == []


def test_nothing_added_closes_nothing(compared):
    signals, runs = compared
    row = distance(runs, signals, np.arange(len(signals.load)))
    assert row["before_dB"] == row["after_dB"]
    assert row["closed_fraction"] in (None, pytest.approx(0.0, abs=1e-9))


def test_what_the_model_does_not_move_is_compared_with_noise(compared):
    """A channel that a symmetric model leaves at rest is off by its motion over its noise."""
    signals, runs = compared
    still = replace(runs, before=0.0 * runs.before, after=0.0 * runs.after)
    row = distance(still, signals, np.arange(len(signals.load)))
    assert row["before_dB"] is not None and row["before_dB"] < 200.0


def test_a_force_that_was_measured_too_large_is_divided(comparison):
    """Far from contact, a force gain of two halves the response to what was measured."""
    signals = comparison.signals
    quiet = replace(signals, force=1.0e-3 * signals.force)
    doubled = Point((Term("sensor_gain", "force", (2.0,)),))
    runs = free_runs(comparison.structure, quiet, doubled)
    y = [number for number, name in enumerate(signals.names) if name.endswith("_y")]
    ratio = runs.after[0, 0, y].sum(axis=-1) / runs.before[0, 0, y].sum(axis=-1)
    assert ratio == pytest.approx(0.25, rel=1.0e-3)
