"""When an estimate may be believed, and the standard errors behind it."""

import numpy as np
import pytest
from scipy.linalg import toeplitz

from vibroimpact.identify.estimate import Estimate, grade, mark_weak, unresolved
from vibroimpact.identify.segment_scatter import (
    effective_duration,
    jackknife_influences,
    segment_covariance,
    widened,
)
from vibroimpact.identify.spectra.window_leakage import spectral_kernel

RANGE = (1.0e3, 1.0e8)


@pytest.mark.parametrize(
    "k, error, model_error, free, quality",
    [
        (1.0e5, 2.0e3, 2.0e3, 570.0, "ok"),
        (1.0e5, 2.0e4, 2.0e4, 570.0, "weak"),  # 28 %
        (1.0e5, 5.0e4, 2.0e4, 570.0, "unresolved"),  # 54 %
        (1.0e3, 500.0, 570.0, 570.0, "unresolved"),  # does not differ from 0
        (2.5e3, 400.0, 570.0, 570.0, "unresolved"),  # 2 x 570 + 4 x 400 = 2740
        (2.8e3, 400.0, 600.0, 400.0, "weak"),
        (4.0e6, 5.0e5, 5.6e5, 570.0, "ok"),
        (-2.0e3, 400.0, 570.0, 570.0, "unresolved"),
        (2.0e8, 1.0e6, 1.0e6, 570.0, "unresolved"),
        (np.inf, np.nan, np.nan, 570.0, "unresolved"),
    ],
)
def test_quality_combines_random_and_model_error(k, error, model_error, free, quality):
    found = grade(Estimate("lscf", k, error, 60.0, 5.0, 20.0, 0.02), model_error, free, RANGE)
    assert found.quality == quality and bool(found.note) == (quality != "ok")
    assert np.isnan([found.k, found.c]).tolist() == [quality == "unresolved"] * 2
    assert (found.frequency, found.damping_ratio) == (20.0, 0.02)


def test_uncertain_damping_is_dropped_alone():
    found = grade(Estimate("lscf", 1.0e5, 2.0e3, 60.0, 45.0), 2.0e3, 570.0, RANGE, 40.0)
    assert (found.quality, found.k) == ("ok", 1.0e5) and "c = 60" in found.note
    assert np.isnan([found.c, found.c_standard_error]).all()


def overlapping(generator, segments=12):
    """Values of overlapping segments: correlated with the neighbours as 65 % overlapped Hann
    segments are, and their nu.
    """
    covariance = toeplitz([1.0, 0.35, 0.04] + [0.0] * (segments - 3))
    values = np.linalg.cholesky(covariance) @ generator.standard_normal(segments)
    return values, 2.0 * segments**2 / covariance.sum()


def test_standard_error_from_overlapping_segments():
    generator = np.random.default_rng(1)
    records = [overlapping(generator) for _ in range(4000)]
    means = np.array([values.mean() for values, _ in records])
    claimed = [segment_covariance(values[:, None], averages)[0, 0] for values, averages in records]
    assert np.mean(claimed) == pytest.approx(means.var(), rel=0.06)
    assert np.all(np.isinf(segment_covariance(np.ones((3, 2)), 4.0)))


def test_jackknife_gives_the_pull_of_each_segment():
    values = np.array([1.0, 2.0, 6.0, -1.0])
    without = np.array([np.delete(values, index).mean() for index in range(4)])
    np.testing.assert_allclose(jackknife_influences(without[:, None])[:, 0], values - values.mean())


def test_a_covariance_is_widened_and_never_narrowed():
    covariance = np.diag([1.0, 4.0])
    pulls = np.random.default_rng(2).standard_normal((400, 2)) * (1.0, 2.0)
    assert widened(covariance, 0.01 * pulls, 18.0) == pytest.approx(covariance)
    assert widened(covariance, 10.0 * pulls, 18.0)[0, 0] == pytest.approx(100.0 / 8.0, rel=0.2)
    assert widened(covariance, pulls, np.inf) == pytest.approx(covariance)


def test_independent_values_per_hertz_follow_record_length():
    found = effective_duration(17.817, spectral_kernel("hann", 10.0))
    assert found == pytest.approx(49.0, rel=0.08)


def test_downgrade_never_improves_quality():
    assert mark_weak(Estimate("ods", 1.0, 0.1), "why").quality == "weak"
    lost = mark_weak(unresolved("ods", "no peak"), "why")
    assert (lost.quality, lost.note) == ("unresolved", "no peak; why")
