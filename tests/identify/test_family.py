"""The prepared family of linear tubes, and the support that belongs to a pole, against the plain
functions of py.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.layouts import LAYOUT
from vibroimpact.identify.equivalent_support import equivalent_support
from vibroimpact.identify.linear.family import LinearFamily, driven_modes
from vibroimpact.identify.linear.modes import natural_frequencies
from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.reference_tube import ReferenceTube

MEMBERS = [(0.0, 0.0), (1.0e3, -2.0), (1.0e5, 62.0), (4.0e6, 1.0e4), (1.0e9, 0.0)]


@pytest.fixture(scope="module")
def modes(study_model):
    return driven_modes(study_model)


@pytest.mark.parametrize("k, c", MEMBERS)
def test_responses_are_those_of_the_full_solution(study_model, modes, k, c):
    frequency = np.linspace(5.0, 100.0, 57)
    shapes = study_model.sensor_shapes[:, [1, 3]]
    response = LinearFamily(modes, frequency).response(shapes)
    expected = frf(study_model, k, c, frequency, shapes)
    np.testing.assert_allclose(response.frf(k, c)[0], expected, rtol=1.0e-7)
    part = response.of(slice(10, 20), slice(1, 2)).psd(k, c)
    np.testing.assert_allclose(part, np.abs(expected[1:, 10:20]) ** 2, rtol=1.0e-7)


def test_derivative_of_the_response_with_the_support(study_model, modes):
    frequency = np.linspace(15.0, 60.0, 23)
    response = LinearFamily(modes, frequency).response(study_model.sensor_shapes[:, [1]])
    value, slope = response.frf_slope(1.0e5, 60.0)
    np.testing.assert_allclose(value, response.frf(1.0e5, 60.0))
    change = response.frf(1.0e5 + 10.0, 60.0) - response.frf(1.0e5 - 10.0, 60.0)
    np.testing.assert_allclose(slope, change / 20.0, rtol=1.0e-4)


@pytest.mark.parametrize("k, c", [(1.0e3, 20.0), (1.0e5, 60.0), (4.0e6, 9.0e3)])
def test_jacobian_of_the_support(study_model, modes, k, c):
    frequency, ratio = frequency_of(first_pole(study_model, k, c))
    found = equivalent_support(modes, frequency, ratio)
    for column, step in ((0, (1.0e-4, 0.0)), (1, (0.0, 1.0e-6))):
        ahead, behind = (
            equivalent_support(modes, frequency + sign * step[0], ratio + sign * step[1])
            for sign in (1.0, -1.0)
        )
        numeric = np.array([ahead.k - behind.k, ahead.c - behind.c]) / (2.0 * sum(step))
        within = {"rtol": 1.0e-4, "atol": 1.0e-6 * np.abs(found.jacobian).max()}
        np.testing.assert_allclose(found.jacobian[:, column], numeric, **within)


@pytest.fixture(scope="module")
def tube(study_model):
    return ReferenceTube(study_model, LAYOUT)


@pytest.mark.parametrize("k, c", [(1.0e4, 30.0), (1.0e6, 1000.0)])
def test_first_mode_times_residual_modes_is_the_spectrum(study_model, tube, k, c):
    frequency, ratio = frequency_of(first_pole(study_model, k, c))
    index = np.arange(round(40 * frequency) - 60, round(40 * frequency) + 61)
    factor = tube.other_modes(frequency, ratio)(index)
    square = (index / 40.0 / frequency) ** 2
    found = factor / ((1.0 - square) ** 2 + 4.0 * ratio**2 * square)
    apex = study_model.sensor_shapes[:, [study_model.sensor_names.index("apex.y")]]
    whole = np.abs(frf(study_model, k, c, index / 40.0, apex)[0]) ** 2
    np.testing.assert_allclose(found / found[60], whole / whole[60], rtol=1.0e-5)
    assert factor.min() > 0.5 and factor.max() < 2.0


def test_damping_of_the_first_mode_to_first_order(study_model, tube):
    for k in (1.0e3, 1.0e5, 4.0e6):
        c = 0.1 * tube.first_damping_ratio(k) / tube.damping_ratio_slope(k)
        pole = first_pole(study_model, k, c)
        assert -pole.real / abs(pole) == pytest.approx(1.1 * tube.first_damping_ratio(k), rel=0.01)
        assert tube.damping_for(k, 1.1 * tube.first_damping_ratio(k)) == pytest.approx(c)
        own, ahead = (natural_frequencies(study_model, each, 1)[0] for each in (k, 1.01 * k))
        assert tube.first_frequency(k) == pytest.approx(own, rel=1.0e-3)
        slope = np.log(ahead / own) / np.log(1.01)
        assert tube.frequency_slope(k) == pytest.approx(slope, rel=0.02)


def test_errors_of_the_model_near_the_free_tube(tube):
    # 0.3 % of the first frequency is what 570 N/m move; 2 % of gain is a shape's change at some
    # 3500 N/m.
    assert 450.0 < tube.pole_error_at_zero < 700.0
    assert 2.0e3 < tube.shape_error_at_zero < 5.0e3


def test_a_stiff_support_may_lift_every_mode_above_the_spectra(study_model):
    """Spectra to 20 Hz, of a tube at 16 Hz free and above 25 Hz on stiff supports."""
    layout = replace(
        LAYOUT, highest=200, line_last=190, force_band_Hz=(5.0, 20.0), broadband_Hz=(6.0, 19.0)
    )
    narrow = ReferenceTube(study_model, layout)
    assert layout.frequency[-1] == 20.0
    for k in (1.0e3, 1.0e8):
        first = natural_frequencies(study_model, k, 1)[0]
        assert narrow.first_frequency(k) == pytest.approx(first, rel=2e-2)
        # c = -least takes the first mode's own damping, to first order
        least = narrow.lowest_stable_damping(k)
        lost = narrow.first_damping_ratio(k) + least * narrow.damping_ratio_slope(k)
        assert 0.0 < lost < narrow.first_damping_ratio(k)
    assert np.isfinite(narrow.broadband_map[1]).all()
