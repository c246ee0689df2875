"""Deflection shape and broadband correlation on exact spectra: the members of the family come
back.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.layouts import LAYOUT
from vibroimpact.identify.broadband import family_map, identify_broadband
from vibroimpact.identify.linear.family import LinearFamily, driven_modes
from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.linear.responses import frf
from vibroimpact.identify.ods import deflection_shape, mac, match_shape
from vibroimpact.identify.peak import level_edges
from vibroimpact.identify.reference_tube import ReferenceTube
from vibroimpact.identify.spectra.window_leakage import spectral_kernel


@pytest.fixture(scope="module")
def tube(study_model):
    return ReferenceTube(study_model, replace(LAYOUT, window="none"))


def test_mac_sees_neither_size_nor_phase():
    shape = np.array([1.0, 0.5j, -0.3])
    assert mac(shape, (2.0 - 3.0j) * shape) == pytest.approx(1.0)
    assert mac(np.array([1.0, 0.0]), np.array([0.0, 1.0])) == 0.0
    assert mac(np.stack([shape, np.ones(3)]), shape).shape == (2,)


def test_first_singular_vector_is_the_dominant_shape():
    generator = np.random.default_rng(1)
    shape = generator.standard_normal(9)
    shape /= np.linalg.norm(shape)
    frequency = np.arange(5.0, 30.0, 0.1)
    weak = 0.05 * generator.standard_normal((9, 6, frequency.size))
    motion = np.tensordot([1.0, 1j], generator.standard_normal((2, 6, frequency.size)), 1)
    spectra = shape[:, None, None] * motion + weak
    found = deflection_shape(spectra, frequency, (10.0, 20.0))
    inside = (frequency >= 10.0) & (frequency <= 20.0)
    values = np.linalg.svd(spectra[:, :, inside].reshape(9, -1), compute_uv=False)
    np.testing.assert_allclose(found.singular_values, values / values[0], rtol=1.0e-6)
    assert mac(found.shape, shape) > 0.999 and found.segment_shapes.shape == (6, 9)
    with pytest.raises(ValueError, match="no bin"):
        deflection_shape(spectra, frequency, (31.0, 32.0))


@pytest.mark.parametrize("k, c", [(1.0e4, 31.0), (1.0e5, 62.0), (1.0e6, 1018.0), (4.0e6, 1.0e4)])
def test_operating_shapes_give_the_support_stiffness(study_model, tube, k, c):
    frequency, ratio = frequency_of(first_pole(study_model, k, c))
    bins, edges = tube.at_line.frequency, level_edges(frequency, ratio, 25.0)
    line = frf(study_model, k, c, bins, study_model.line_shapes)
    measured = deflection_shape(line[:, None, :], bins, edges)
    match, sure = (
        match_shape(measured, tube.at_line, tube.mode_shapes, tube.shape_members(ratio, error))
        for error in (0.1 * ratio, 0.0)
    )
    assert match.k == pytest.approx(k, rel=0.02)  # the damping's uncertainty is taken out of k
    assert sure.k == pytest.approx(k, rel=1.0e-3) and sure.mac == pytest.approx(1.0, abs=1.0e-9)
    by_mode_shape = match.k_grid[np.argmax(match.mac_grid)]
    assert k != 4.0e6 or by_mode_shape > 1.08 * k
    assert match.model_error > 0.03


@pytest.mark.parametrize("k, c", [(1.0e4, 31.0), (4.0e6, 1.0e4)])
def test_broadband_correlation_returns_a_member_at_any_level(study_model, k, c):
    kernel = spectral_kernel("hann", 10.0)
    bins = np.arange(60, 991) / 10.0
    tubes = LinearFamily(driven_modes(study_model), kernel.fine_index(bins) / 40.0)
    response = tubes.response(study_model.sensor_shapes[:, [3]])
    psd = kernel.smooth(response.psd(k, c)[0])
    grid = np.geomspace(1.0e3, 1.0e8, 16)
    damping = np.interp(grid, [1.0e3, 1.0e5, 1.0e8], [28.0, 62.0, 1.0e5])
    family = family_map(response, kernel, grid, np.outer(damping, (0.0, 1.0, 3.0)))
    for size in (1.0, 1.0e6):
        fit = identify_broadband(size * psd, response, kernel, family, lambda stiffness: -3.0, 18.0)
        assert (fit.k, fit.c) == pytest.approx((k, c), rel=1.0e-5)
        assert fit.correlation == pytest.approx(1.0, abs=1.0e-8)
        np.testing.assert_allclose(fit.curve, size * psd, rtol=1.0e-4)
    assert np.max(fit.correlation_map) < fit.correlation
    assert 0.02 < np.sqrt(fit.covariance[0, 0]) / k < 0.2
