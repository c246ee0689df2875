"""Critical velocities against published and derived values."""

import numpy as np
import pytest

from vibroimpact.excitation.fluid_elastic import FluidForce
from vibroimpact.flow.coupled import Zone, critical_velocity, oscillations, system
from vibroimpact.flow.critical_velocity import (
    log_decrement,
    mass_damping,
    tema_factor,
)

CELLS = 4000
PLACES = (np.arange(CELLS) + 0.5) / CELLS  # of a tube of 1 m


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


def test_zones_of_one_velocity_are_one():
    half = [Zone(1.0, 0.5 * WHOLE[0].overlap)] * 2
    one, two = (critical_velocity(STIFFNESS, DAMPING, QUASI_STEADY, z, 2.0) for z in (WHOLE, half))
    assert one == pytest.approx(two, rel=1e-8)


def test_without_velocity_nothing_changes():
    frequency, ratio = oscillations(system(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, 0.0), 1)
    assert frequency[0] == pytest.approx(30.0, rel=1e-9) and ratio[0] == pytest.approx(0.01)
    assert np.isnan(critical_velocity(STIFFNESS, DAMPING, QUASI_STEADY, WHOLE, 0.5))
