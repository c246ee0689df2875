"""The spectra of a turbulent force per length: printed values, tables, and noise that has them."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.excitation.force_stream import ForceStream, SpectralForce
from vibroimpact.excitation.line_force_spectrum import (
    line_force_psd,
    line_force_rms,
    log_interpolation,
    tube_bundle_spectrum,
    two_phase_spectrum,
)
from vibroimpact.excitation.random_force import noise_lines


def section(spectrum, band=(5.0, 200.0)):
    """The section of a turbulent force."""
    return SimpleNamespace(band_Hz=band, spectrum=SimpleNamespace(**spectrum))


@pytest.mark.parametrize(
    ("shape", "reduced", "printed"),
    [  # the factors and exponents of SPEC_LONG_COR_3 and _2 in the manual of code_aster
        ("two_slopes", 0.01, 5.0e-2),
        ("two_slopes", 0.04, 2.5e-2),
        ("two_slopes", 1.0, 4.0e-5),
        ("two_slopes", 4.0, 4.0e-5 / 128.0),
        ("low_pass", 1.0e-9, 1.5e-3),
        ("low_pass", 0.1, 0.75e-3),
        ("low_pass", 1.0e9, 1.5e-3 * 1.0e-27),
    ],
)
def test_dimensionless_spectra_have_the_published_values(shape, reduced, printed):
    got = tube_bundle_spectrum(np.array([reduced]), shape)[0]
    assert got == pytest.approx(printed, rel=1e-6)


def test_the_two_phase_spectrum_at_a_void_fraction_of_a_quarter():
    """By hand: 12.021 - 6.302625 + 1.98384375 - 0.26003125 = 7.4421875, at 500 kg/m2/s."""
    force = section(
        {
            "kind": "two_phase",
            "void_fraction": 0.25,
            "velocity_m_per_s": 2.0,
            "fluid_density_kg_per_m3": 250.0,
        }
    )
    level = 10.0**7.4421875 / 0.068
    assert two_phase_spectrum(0.5, 0.25, 500.0) == pytest.approx(4.0 * level / 6.25e10, rel=1e-12)
    got = line_force_psd(force, 0.02, np.array([50.0]))[0]
    assert got == pytest.approx(2.0 * 10.0**2 * 0.01 * 4.0 * level / 6.25e10, rel=1e-12)


def test_the_force_per_length_has_the_scale_of_the_flow():
    """At 2 m/s, 750 kg/m3 and 20 mm, by hand: 30 N/m squared, 0.01 s, fr = 0.1."""
    flow = {"velocity_m_per_s": 2.0, "fluid_density_kg_per_m3": 750.0}
    force = section({"kind": "tube_bundle", "shape": "two_slopes", **flow})
    got = line_force_psd(force, 0.02, np.array([10.0]))[0]
    assert got == pytest.approx(2.0 * 30.0**2 * 0.01 * 5.0e-3 / np.sqrt(0.1), rel=1e-12)


def test_a_reduced_table_holds_the_two_slopes():
    flow = {"velocity_m_per_s": 3.0, "fluid_density_kg_per_m3": 900.0}
    places = np.array([1.0e-3, 0.2, 0.2 * (1.0 + 1e-9), 10.0])
    table = {
        "kind": "reduced_table",
        "reduced_frequency": tuple(places),
        "reduced_psd": tuple(2.0 * tube_bundle_spectrum(places, "two_slopes")),
    }
    frequency = np.array([5.0, 29.0, 31.0, 200.0])
    np.testing.assert_allclose(
        line_force_psd(section(table | flow), 0.02, frequency),
        line_force_psd(
            section({"kind": "tube_bundle", "shape": "two_slopes"} | flow), 0.02, frequency
        ),
        rtol=1e-5,
    )


def test_the_rms_of_a_power_law_is_its_integral():
    table = {"kind": "table", "frequency_Hz": (1.0, 1e3), "psd_N2_per_m2_Hz": (1.0, 1e-6)}
    assert line_force_rms(section(table), 0.02) == pytest.approx(
        np.sqrt(1.0 / 5.0 - 1.0 / 200.0), rel=1e-6
    )


def test_a_line_on_logarithmic_axes_is_a_power_law():
    at = np.array([2.0, 5.0, 50.0])
    got = log_interpolation(at, (1.0, 100.0), (7.0, 7.0e-3))
    np.testing.assert_allclose(got, 7.0 * at**-1.5, rtol=1e-12)


def test_noise_of_a_spectrum_has_it_line_by_line():
    """Mean power of 400 realisations in three bands of a steep spectrum, within four errors."""
    band, rate, samples = (5.0, 200.0), 1000.0, 4000
    lines = [
        noise_lines(np.random.default_rng(seed), samples, rate, band, lambda f: f**-3.0)
        for seed in range(400)
    ]
    first, length = lines[0][1], lines[0][2]
    frequency = (first + np.arange(lines[0][0].size)) * rate / length
    power = 2.0 * np.mean([np.abs(values) ** 2 for values, _, _ in lines], axis=0)
    expected = frequency**-3.0 / np.sum(frequency**-3.0)
    for low, high in ((5.0, 20.0), (20.0, 80.0), (80.0, 200.0)):
        inside = (frequency >= low) & (frequency < high)
        error = 1.0 / np.sqrt(400 * inside.sum())
        assert abs(np.mean(power[inside] / expected[inside]) - 1.0) < 4.0 * error


def test_a_spectral_force_has_a_variance_of_one_on_average():
    force = SpectralForce((5.0, 200.0), lambda frequency: frequency**-1.0)
    streams = [
        ForceStream(force, np.random.default_rng(seed), 40_000, 10_000.0, slice(0, 40_000))
        for seed in range(60)
    ]
    squares = [np.mean(stream.values(0, 40_000) ** 2) for stream in streams]
    error = np.std(squares) / np.sqrt(len(squares))
    assert abs(np.mean(squares) - 1.0) < 4.0 * error and error < 0.05
    assert np.std(squares) > 0.05  # not scaled record by record


def test_a_spectral_force_does_not_depend_on_the_requested_range():
    def stream():
        force = SpectralForce((5.0, 200.0), lambda frequency: frequency**-1.0)
        return ForceStream(force, np.random.default_rng(9), 90_000, 51200.0, slice(0, 90_000))

    whole, pieces = stream().values(0, 90_000), stream()
    for first, count in [(0, 1), (7000, 30_000), (37_000, 53_000), (25_599, 2)]:
        assert np.array_equal(pieces.values(first, count), whole[first : first + count])
