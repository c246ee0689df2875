"""Critical velocities against published and derived values."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from vibroimpact.config.flow import ConnorsForce, NegativeDamping
from vibroimpact.excitation.fluid_elastic import FluidForce, fluid_force
from vibroimpact.flow.coupled import Zone, critical_velocity, oscillations, system
from vibroimpact.flow.critical_velocity import (
    Along,
    log_decrement,
    mass_damping,
    tema_factor,
)

CELLS = 4000
PLACES = (np.arange(CELLS) + 0.5) / CELLS  # of a tube of 1 m


def along(factor, density=1000.0, mass=0.6):
    full = np.ones(CELLS)
    return Along(full / CELLS, 1.0, factor * full, density * full, mass * full)


@pytest.mark.parametrize(
    ("factor", "expected"),
    [
        ((PLACES < 0.5).astype(float), 0.707107),
        ((np.abs(PLACES - 0.5) < 0.25).astype(float), 0.904605),
        (4.0 * PLACES * (1.0 - PLACES), 0.883016),
    ],
    ids=["half of the length", "central half", "parabola"],
)
def test_effective_velocity_of_a_pinned_tube(factor, expected):
    assert along(factor).effective(np.sin(np.pi * PLACES)) == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize(
    ("pattern", "ratio", "x", "expected"), [(30, 1.25, 0.5, 2.4499), (45, 1.25, 1.0, 3.0975)]
)
def test_factors_of_tema(pattern, ratio, x, expected):
    assert tema_factor(pattern, ratio, x) == pytest.approx(expected, rel=1e-4)


def test_factors_of_tema_join():
    for pattern in (30, 60):
        assert tema_factor(pattern, 1.4, 1.0) == pytest.approx(
            tema_factor(pattern, 1.4, 1.0 + 1e-9), rel=1e-6
        )


def test_mass_damping_holds_the_logarithmic_decrement():
    assert log_decrement(0.01) == pytest.approx(0.0628350, rel=1e-5)
    assert mass_damping(0.6, 0.01, 1000.0, 0.02) == pytest.approx(0.6 * 0.0628350 / 0.4, rel=1e-5)


MASS, OMEGA, RATIO, DIAMETER = 0.6, 2.0 * np.pi * 30.0, 0.01, 0.02
STIFFNESS, DAMPING = np.array([[OMEGA**2]]), np.array([[2.0 * RATIO * OMEGA]])
WHOLE = [Zone(1.0, np.array([[0.5 * 1000.0 / MASS]]))]
QUASI_STEADY = FluidForce(20.0, 0.3, (-20.0,), (1.0,), DIAMETER)


def test_a_force_with_one_lag_becomes_unstable():
    found = critical_velocity(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, 2.0)
    assert found == pytest.approx(0.682912, rel=1e-5)
    at = oscillations(system(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, found), 1)
    assert at[0][0] == pytest.approx(30.10339, rel=1e-5)
    for velocity, ratio in ((0.65, 0.00210036), (0.80, -0.00929546)):
        own = oscillations(system(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, velocity), 1)
        assert own[1][0] == pytest.approx(ratio, rel=1e-4)


def test_zones_of_one_velocity_are_one():
    half = [Zone(1.0, 0.5 * WHOLE[0].overlap)] * 2
    one, two = (critical_velocity(STIFFNESS, DAMPING, QUASI_STEADY, z, 2.0) for z in (WHOLE, half))
    assert one == pytest.approx(two, rel=1e-8)


def test_without_velocity_nothing_changes():
    frequency, ratio = oscillations(system(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, 0.0), 1)
    assert frequency[0] == pytest.approx(30.0, rel=1e-9) and ratio[0] == pytest.approx(0.01)
    assert np.isnan(critical_velocity(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, 0.5))


@pytest.mark.parametrize("frozen", [False, True])
def test_connors_force_has_the_velocity_of_connors(frozen):
    """K = 3: V_c = 0.552596 m/s. At 0.8 V_c white turbulence moves the tube 1.6667 times as far."""
    coupling = (
        NegativeDamping(kind="negative_damping", constant=3.0, frequency_Hz=30.0)
        if frozen
        else ConnorsForce(kind="connors", constant=3.0, band_Hz=(6.0, 150.0))
    )
    force = fluid_force(coupling, DIAMETER)
    found = critical_velocity(STIFFNESS, DAMPING, force, WHOLE, 2.0)
    assert found == pytest.approx(0.552596, rel=1e-3)
    rms = []
    for velocity in (0.0, 0.8 * 0.552596):
        matrix = system(STIFFNESS, DAMPING, force, WHOLE, velocity)
        pushed = np.zeros((len(matrix),) * 2)
        pushed[1, 1] = 1.0
        rms.append(np.sqrt(solve_continuous_lyapunov(matrix, -pushed)[0, 0]))
    # the lags' stiffness rises with the frequency as 0.4 % more mass would
    assert rms[1] / rms[0] == pytest.approx(5.0 / 3.0, rel=1e-4 if frozen else 3e-3)
