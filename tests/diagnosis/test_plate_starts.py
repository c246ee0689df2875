"""The plate behind a support comes back from the force on it and the motion while they touch."""

import numpy as np
import pytest
from scipy import signal

from vibroimpact.diagnosis.plate_starts import plate_of

RATE, SECONDS, FIRST_HZ = 2000.0, 3.0, 20.0
GAP, CONTACT = 1.0e-4, 2.0e6  # m, N/m
MASS, HZ, RATIO = 0.4, 60.0, 0.03  # of the plate: kg, Hz


def bumps(seed):
    """(sample,) N: a force of contact, short pulses of either sign."""
    rng, force = np.random.default_rng(seed), np.zeros(int(RATE * SECONDS))
    for start in rng.choice(len(force) - 40, 60, replace=False):
        length = int(rng.integers(6, 30))
        pulse = rng.choice([-1.0, 1.0]) * rng.uniform(5.0, 30.0)
        force[start : start + length] += pulse * np.sin(np.pi * np.arange(length) / length)
    return force


def motion_at(force, plate):
    """(sample,) m: of a structure at a support that gives way by `plate` (sample,)."""
    return -np.sign(force) * (GAP + np.abs(force) / CONTACT) + plate


def under(force):
    """(sample,) m: the motion of the plate under the reaction of a force."""
    own = 2.0 * np.pi * HZ
    plate = ([1.0 / MASS], [1.0, 2.0 * RATIO * own, own**2])
    return signal.lsim(plate, -force, np.arange(len(force)) / RATE)[1]


def test_mass_frequency_and_damping_come_back():
    rows = [(force, motion_at(force, under(force))) for force in map(bumps, (1, 2))]
    mass, frequency, ratio = plate_of(rows, RATE, FIRST_HZ)
    assert mass == pytest.approx(MASS, rel=0.05)
    assert frequency == pytest.approx(HZ, rel=0.02)
    assert ratio == pytest.approx(RATIO, abs=0.01)


def test_a_rigid_support_has_no_plate():
    rng, force = np.random.default_rng(3), bumps(3)
    motion = motion_at(force, 0.05 * GAP * rng.standard_normal(len(force)))
    assert plate_of([(force, motion)], RATE, FIRST_HZ) is None


def test_without_a_known_force_no_plate_is_told():
    assert plate_of([], RATE, FIRST_HZ) is None
