"""The evidence of a diagnosis, against the independent code and its contact forces."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import resample_poly

import vibroimpact as vi
from vibroimpact.diagnosis.comparison import Comparison
from vibroimpact.diagnosis.evidence import _modelled, evidence_of
from vibroimpact.diagnosis.explanations import Point, Structure, Term
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.io.records import read_record, write_record

NO_PLACES = SimpleNamespace(names=())
WRONG = Point((Term("gap", "all", (0.6,)),))  # a clearance that the structure does not have


@pytest.fixture(scope="module")
def comparison(measured):
    """The Comparison of that campaign."""
    campaign, config = vi.read_campaign(measured[0]), vi.load_config(measured[1])
    return Comparison(signals_of(campaign), Structure(config, campaign))


@pytest.fixture(scope="module")
def evidence(comparison):
    """The evidence: as given with a wrong clearance, and the right model as the completed one."""
    return evidence_of(comparison, WRONG, Point())


def test_demanded_forces_are_those_of_the_other_code(measured, comparison, evidence):
    truth = measured[2]
    for row, stretch in enumerate(evidence["law_of_stretch"].values):
        record = int(
            np.flatnonzero(
                [
                    str(evidence["record_name"].values[stretch]) == name
                    for name in comparison.signals.record_names
                ]
            )[0]
        )
        time = evidence["start"].values[stretch] + evidence["sample_time"].values
        samples = np.round(time * truth.rate).astype(int)
        true = truth.measured[record][:, samples]
        found = evidence["demanded_force"].values[row]
        y = [1, 3]
        assert correlation(found[y], true[y]) > 0.9
        assert np.std(found[y]) == pytest.approx(np.std(true[y]), rel=0.1)


def test_the_law_shows_where_contact_begins(evidence):
    gap = 1.3e-2 * 0.02222
    force, motion = (evidence[f"demanded_{part}"].values[0, 1] for part in ("force", "motion"))
    pressed = np.abs(force) > 0.3 * np.abs(force).max()
    assert 0.75 * gap < np.median(np.abs(motion[pressed])) < 1.4 * gap
    assert np.mean(force[pressed] * motion[pressed] < 0.0) > 0.95  # obstacles push back


def test_a_place_that_the_given_model_lacks_is_empty(comparison):
    """A beam without a support, and the same with a stop."""
    bench = comparison.fitted()
    none = np.zeros((2, 0, bench.schedule.samples))
    bare = SimpleNamespace(bench=bench, at_places=lambda stretch: none, places=NO_PLACES)
    found = _modelled(comparison.band, bare, SimpleNamespace(names=("stop",)), [0, 1])
    assert found.shape[:3] == (2, 2, 1) and np.isnan(found).all()


def test_the_right_model_needs_less_holding_force(evidence):
    power = np.sum(evidence["holding_force"].values ** 2, axis=(2, 3))
    touching = evidence["load"].values > 5.0
    assert (power[1, touching] < 0.3 * power[0, touching]).all()
    assert power.shape[1] == evidence.sizes["stretch"] and np.isfinite(power).all()


def test_a_free_sensor_is_predicted_by_the_right_model(evidence):
    error = evidence["free_error"].values[:, 0]
    assert np.nanmedian(error[1]) < 0.15 and np.nanmedian(error[0]) > 2.0 * np.nanmedian(error[1])


def test_the_waveform_is_that_of_the_record(comparison, evidence):
    """The velocity of the waveform is the integral of the accelerations that were measured."""
    channel, stretch = (int(evidence[f"waveform_{name}"].values) for name in ("channel", "stretch"))
    signals = comparison.signals
    record = [*signals.record_names].index(str(evidence["record_name"].values[stretch]))
    time = evidence["moment_time"].values
    lines = np.fft.rfft(signals.response[record, channel])
    lines[
        comparison.band[1] * signals.response.shape[-1] / signals.rate < np.arange(len(lines))
    ] = 0
    finer = resample_poly(np.fft.irfft(lines, signals.response.shape[-1]), 8, 1)
    measured = np.interp(time, np.arange(len(finer)) / (8.0 * signals.rate), finer)
    velocity = evidence["waveform"].values[0]
    assert evidence["waveform"].attrs["units"] == "m/s"
    own = np.gradient(velocity, time)
    assert correlation(own - own.mean(), measured - measured.mean()) > 0.97


def test_evidence_comes_back_from_a_file(evidence, tmp_path):
    write_record(evidence, tmp_path / "evidence.nc")
    again = read_record(tmp_path / "evidence.nc")
    assert set(again.variables) == set(evidence.variables)
    for name in evidence.variables:
        assert again[name].dims == evidence[name].dims
        assert again[name].attrs.get("units") == evidence[name].attrs.get("units")
    assert again.attrs["after"] == "nothing" and str(again["state"].values[1]) == "after"


def correlation(one, other):
    """The correlation of two series about zero."""
    return np.sum(one * other) / np.sqrt(np.sum(one**2) * np.sum(other**2))
