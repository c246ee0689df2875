"""Statistical linearisation against the exact table of an oscillator between stops, and the secant
stiffness of a linear support.
"""

import numpy as np
import pytest
from scipy.integrate import quad

from vibroimpact.identify.statistical_linearisation import band_power, statistical_linearisation


def test_k_depends_on_load_over_gap_only(study_model):
    one, other = (
        statistical_linearisation(study_model, size * 5.0, size * 2.8886e-4, (5.0, 200.0))
        for size in (1.0, 0.31)
    )
    assert one.settled and one.k == pytest.approx(other.k, rel=1.0e-5)
    assert 0.0 <= one.k < study_model.contact_stiffness.sum() / 2.0


def test_without_contact_there_is_no_stiffness(study_model):
    found = statistical_linearisation(study_model, 0.05, 2.8886e-4, (5.0, 200.0))
    assert found.settled and found.k < 1.0e-6
    assert found.frequency == pytest.approx(study_model.frequencies[0])


def test_power_in_a_band_is_the_integral_of_the_spectrum():
    poles = np.array([-0.5 + 40.0j, -0.3 + 90.0j, -20.0 + 300.0j])
    gains = np.array([[1.0, -0.4, 2.0], [0.3, 1.0, -5.0]])

    def psd(frequency, output):
        s = 2j * np.pi * frequency
        return np.abs(np.sum(gains[output] / ((s - poles) * (s - poles.conj())))) ** 2

    peaks = {"points": [40.0 / 2 / np.pi, 90.0 / 2 / np.pi], "limit": 400}
    expected = [quad(psd, 5.0, 20.0, args=(output,), **peaks)[0] for output in (0, 1)]
    assert band_power(poles, gains, (5.0, 20.0)) == pytest.approx(expected, rel=1.0e-6)
