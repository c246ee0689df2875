"""The rate at which the frequency error of a straight beam falls with the element size.

Euler-Bernoulli: fourth power. Timoshenko: second power, because a shear angle constant along an
element follows the varying one of a vibration to first order only; the constant is small for a
slender tube (below 1e-5 of the first frequency at 20 elements per metre).
"""

import numpy as np
import pytest

from evidence.validation.reference.frequencies import (
    MATERIAL,
    ROOTS,
    SECTION,
    plane_frequencies,
    straight_tube,
)
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.structure.beam_elements import section_beam

TUBE, INCONEL = StageSettings(SECTION), StageSettings(MATERIAL)


def straight_beam(ends, theory, elements, length=1.0):
    """Return (mode,) Hz of bending in one plane of a straight tube of `length` m."""
    one, other = plane_frequencies(
        straight_tube(ends, elements, length, theory), 5000.0 / length**2
    )[:2]
    assert one == pytest.approx(other, rel=1e-6)  # a circular tube bends alike in both planes
    return one


def pinned_timoshenko(order, length):
    """Return Hz of mode `order` of a simply supported Timoshenko beam with rotary inertia, the
    lower root of the exact quadratic.
    """
    beam = section_beam(TUBE, INCONEL, "timoshenko").planes[0]
    wave = (order * np.pi / length) ** 2
    coupling = beam.mass_per_length + wave * (
        beam.rotary_inertia + beam.mass_per_length * beam.bending_stiffness / beam.shear_stiffness
    )
    squares = np.roots(
        [
            beam.mass_per_length * beam.rotary_inertia / beam.shear_stiffness,
            -coupling,
            beam.bending_stiffness * wave**2,
        ]
    )
    return np.sqrt(squares.min()) / (2.0 * np.pi)


def measured_rates(error_at, sizes):
    """Return the exponents of the error's fall between successive numbers of elements."""
    errors = np.array([error_at(size) for size in sizes])
    return (
        np.log(errors[:-1] / errors[1:])
        / np.log(np.array(sizes[1:]) / np.array(sizes[:-1]))[:, None]
    )


@pytest.mark.parametrize("ends", ROOTS)
def test_euler_bernoulli_beam_converges_with_order_four(ends):
    beam = section_beam(TUBE, INCONEL, "euler_bernoulli").planes[0]
    exact = (
        np.array(ROOTS[ends][:3]) ** 2
        * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
        / (2.0 * np.pi)
    )
    rates = measured_rates(
        lambda size: straight_beam(ends, "euler_bernoulli", size)[:3] / exact - 1.0, (10, 14, 20)
    )
    assert rates == pytest.approx(np.full((2, 3), 4.0), abs=0.15)
    assert straight_beam(ends, "euler_bernoulli", 40)[:3] == pytest.approx(exact, rel=1e-5)


def test_timoshenko_beam_converges_with_order_two():
    length = 0.1  # 4.5 diameters: shear matters
    exact = np.array([pinned_timoshenko(order, length) for order in (1, 2, 3)])
    assert exact[0] < 0.9 * straight_beam("pinned-pinned", "euler_bernoulli", 20, length)[0]
    rates = measured_rates(
        lambda size: straight_beam("pinned-pinned", "timoshenko", size, length)[:3] / exact - 1.0,
        (16, 24, 32),
    )
    assert rates == pytest.approx(np.full((2, 3), 2.0), abs=0.05)


def test_slender_timoshenko_beam_is_accurate_at_the_study_mesh():
    exact = np.array([pinned_timoshenko(order, 1.0) for order in (1, 2, 3)])
    assert straight_beam("pinned-pinned", "timoshenko", 20)[:3] == pytest.approx(exact, rel=3e-4)
    assert straight_beam("pinned-pinned", "timoshenko", 20)[0] == pytest.approx(exact[0], rel=5e-6)
