"""Statistical linearisation against the exact table of an oscillator between stops, and the secant
stiffness of a linear support.
"""

import numpy as np
import pytest
from scipy.integrate import quad

from vibroimpact.identify.statistical_linearisation import band_power, statistical_linearisation
from vibroimpact.reduction.modal_model import ModalModel


def oscillator(contact_stiffness, damping=0.2):
    """A unit oscillator (mass, stiffness, gap 1) with one stop on each side, driven at its mass."""
    one, vector = np.ones((1, 1)), np.zeros((1, 3))
    shapes = np.array([[[1.0, 0.0]]])
    return ModalModel(
        omega=np.array([1.0]),
        damping=np.array([damping]),
        contact_shapes=shapes,
        contact_directions=np.eye(3)[None, :2],
        contact_weight=np.ones(1),
        support_of_point=np.zeros(1, dtype=int),
        support_names=("stop",),
        contact_stiffness=np.array([contact_stiffness]),
        gap_factor=np.ones(1),
        centre_offset=np.zeros((1, 2)),
        contact_position=vector,
        drive_shapes=one,
        sensor_shapes=one,
        sensor_names=("mass.x",),
        sensor_positions=vector,
        sensor_directions=np.array([[1.0, 0.0, 0.0]]),
        line_shapes=one,
        line_positions=vector,
        line_arc_length=np.ones(1),
        stress_shapes=np.zeros((1, 0, 2)),
        section_names=(),
        full_mode_frequencies=np.array([0.5 / np.pi]),
    )


@pytest.mark.parametrize(
    "s0, contact_stiffness, k",
    [(0.5, 10.0, 1.2522), (1.0, 10.0, 2.2966), (1.0, 100.0, 4.4632), (2.0, 100.0, 10.8917)],
)
def test_oscillator_between_stops_under_white_noise(s0, contact_stiffness, k):
    # E[w(t) w(t+s)] = 2 pi S0 delta(s), one-sided PSD 4 pi S0 per Hz, T = pi S0 / c = s0²; k there
    # counts the spring, 1.
    damping, band = 0.2, (1.0e-6, 1.0e4)
    force_psd = 4.0 * damping * s0**2
    found = statistical_linearisation(
        oscillator(contact_stiffness, damping), np.sqrt(force_psd * (band[1] - band[0])), 1.0, band
    )
    assert found.settled
    assert found.k + 1.0 == pytest.approx(k, rel=2.0e-3)
    assert found.frequency == pytest.approx(np.sqrt(found.k + 1.0) / (2.0 * np.pi), rel=1.0e-6)


def test_k_depends_on_load_over_gap_only(study_model):
    one, other = (
        statistical_linearisation(study_model, size * 5.0, size * 2.8886e-4, (5.0, 200.0))
        for size in (1.0, 0.31)
    )
    assert one.settled and one.k == pytest.approx(other.k, rel=1.0e-5)
    assert (
        one.k == pytest.approx(study_model.contact_stiffness.sum() / 2.0, rel=1.0)
        and one.k < study_model.contact_stiffness.sum() / 2.0
    )


def test_without_contact_there_is_no_stiffness(study_model):
    found = statistical_linearisation(study_model, 0.05, 2.8886e-4, (5.0, 200.0))
    assert (
        found.settled
        and found.k < 1.0e-6
        and found.frequency == pytest.approx(study_model.frequencies[0])
    )


def test_power_in_a_band_is_the_integral_of_the_spectrum():
    poles = np.array([-0.5 + 40.0j, -0.3 + 90.0j, -20.0 + 300.0j])
    gains = np.array([[1.0, -0.4, 2.0], [0.3, 1.0, -5.0]])

    def psd(frequency, output):
        s = 2j * np.pi * frequency
        return np.abs(np.sum(gains[output] / ((s - poles) * (s - poles.conj())))) ** 2

    for output, power in enumerate(band_power(poles, gains, (5.0, 20.0))):
        assert power == pytest.approx(
            quad(
                psd,
                5.0,
                20.0,
                args=(output,),
                points=[40.0 / 2 / np.pi, 90.0 / 2 / np.pi],
                limit=400,
            )[0],
            rel=1.0e-6,
        )
