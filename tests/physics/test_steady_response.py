"""The steady state under a periodic force: closed forms of a spring, a damper, a hysteresis loop
and a cubic backbone.
"""

import numpy as np
import pytest

from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.steady_response import PeriodicDrive, steady_elements
from vibroimpact.reduction.modal_structure import IdentifiedModes, modal_model
from vibroimpact.structure.contact.laws import LocalLaws

PERIOD, STEPS = 4.0, 16000


def oscillator(**laws):
    """A mass of 1 kg at 5 Hz and 3 % with one element to the ground."""
    local = LocalLaws.neutral(1)
    for name, value in laws.items():
        getattr(local, name)[0] = value
    modes = IdentifiedModes(
        np.array([5.0]),
        np.array([0.03]),
        np.ones((1, 1)),
        0,
        ("displacement",),
        ("mass",),
        np.zeros(1, bool),
    )
    return modes, modal_model(modes, np.ones((1, 1)), local)


def sine(line, size):
    """A drive of one line: size N amplitude."""
    lines = np.zeros((1, 400), complex)
    lines[0, line] = 0.5 * size
    return PeriodicDrive(PERIOD, lines, STEPS)


def test_a_spring_and_a_damper_shift_the_receptance():
    k, c, line = 300.0, 4.0, 22
    modes, model = oscillator(stiffness=k, damping=c)
    motion, force = (
        lines[0, 0, line] for lines in steady_elements(model, sine(line, 2.0), periods_before=6)
    )
    s = 2j * np.pi * line / PERIOD
    exact = 1.0 / (s**2 + s * (modes.damping[0] + c) + modes.omega[0] ** 2 + k)
    assert motion == pytest.approx(exact, rel=2.0e-4)
    assert force == pytest.approx(-(k + s * c) * exact, rel=1.0e-3)


def test_linear_steady_state_needs_no_iteration():
    modes, model = oscillator()
    motion, _ = steady_elements(model, sine(18, 2.0), periods_before=0)
    assert motion[0, 0, 18] == pytest.approx(modes.frf(np.array([18 / PERIOD]))[0, 0], rel=1.0e-5)


def test_a_slider_takes_the_area_of_its_loop():
    stick, limit, line = 400.0, 1.0, 10  # well below the resonance: nearly a prescribed motion
    _, model = oscillator(stick_stiffness=stick, slip_limit=limit)
    motion, force = (
        lines[0, 0] for lines in steady_elements(model, sine(line, 40.0), periods_before=6)
    )
    amplitude = 2.0 * np.abs(motion[line])
    power = -2.0 * np.sum(
        np.real(force * np.conj(2j * np.pi * np.arange(force.size) / PERIOD * motion))
    )
    assert power == pytest.approx(
        line / PERIOD * 4.0 * limit * (amplitude - limit / stick), rel=0.02
    )


def test_a_stuck_slider_is_its_spring_without_preload():
    stick, line = 400.0, 10
    modes, model = oscillator(stick_stiffness=stick, slip_limit=1.0e6)
    motion, _ = steady_elements(model, sine(line, 40.0), periods_before=6)
    s = 2j * np.pi * line / PERIOD
    assert motion[0, 0, line] == pytest.approx(
        20.0 / (s**2 + s * modes.damping[0] + modes.omega[0] ** 2 + stick), rel=3.0e-4
    )
    assert abs(motion[0, 0, 0]) < 1.0e-3 * abs(motion[0, 0, line])


def test_a_cubic_spring_follows_the_duffing_curve():
    cubic, line = 1.5e5, 18
    modes, model = oscillator(cubic=cubic)
    motion, _ = steady_elements(model, sine(line, 24.0), periods_before=8)
    amplitude, omega = 2.0 * np.abs(motion[0, 0, line]), 2.0 * np.pi * line / PERIOD
    # One term of the harmonic balance (Nayfeh and Mook 1979, 4.1): |(w0² - w² + 3/4 c a²) + i w d|
    # a = F.
    stiffness = modes.omega[0] ** 2 - omega**2 + 0.75 * cubic * amplitude**2
    assert 0.75 * cubic * amplitude**2 > 0.1 * modes.omega[0] ** 2
    assert np.hypot(stiffness, omega * modes.damping[0]) * amplitude == pytest.approx(
        24.0, rel=0.03
    )


def test_unbounded_motion_is_reported():
    _, model = oscillator(cubic=-5.0e6)
    with pytest.raises(IntegrationError, match="no bounded motion"):
        steady_elements(model, sine(20, 500.0))
