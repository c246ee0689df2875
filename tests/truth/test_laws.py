"""The truth generator's own laws of friction, contact damping, cracks and masses, against closed
forms: dissipated energy per cycle, coefficients of restitution, frequencies, growth rates.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from evidence.truth import kernel
from evidence.truth.geometry import Holder, Straight
from evidence.truth.hidden import breathing_crack
from evidence.truth.march import velocities
from evidence.truth.planes import Planes
from evidence.truth.reduction import reduce_rig
from evidence.truth.rig import FRICTION_LAWS, Rig
from tests.truth.oscillator import simulate

STEP = 1.0e-5
STIFFNESS, LIMIT = 1.0e6, 2.0  # N/m of all bristles, N


def loop(law, amplitude, frequency=1.0, steps=20000, **columns):
    """J per cycle of a node's friction under u = amplitude sin, from the second cycle."""
    table = np.zeros(kernel.PLATE_COLUMNS)
    table[[kernel.MU, kernel.BRISTLE, kernel.FRICTION_LAW]] = 0.2, STIFFNESS, FRICTION_LAWS[law]
    table[[kernel.STATIC, kernel.STRIBECK_SPEED]] = 1.0, 1.0
    for name, value in columns.items():
        table[getattr(kernel, name)] = value
    step, bristle, energy = 1.0 / (frequency * steps), np.zeros(kernel.PARTS), 0.0
    before = 0.0
    for n in range(2 * steps):
        speed = (
            2.0 * np.pi * frequency * amplitude * np.cos(2.0 * np.pi * frequency * (n + 0.5) * step)
        )
        force = kernel.friction_force(
            table, 1.0, bristle, LIMIT / 0.2, step * speed, speed, step, True
        )
        energy -= 0.5 * (before + force) * speed * step if n >= steps else 0.0
        before = force
    return energy


@pytest.mark.parametrize("law", ["dahl", "tanh", "lugre", "iwan", "spring_damper"])
def test_large_slides_lose_four_forces_times_amplitude(law):
    assert loop(law, 1.0e-2, SLIP_SPEED=1.0e-4, MOBILITY=1.0e-3) == pytest.approx(
        4.0 * LIMIT * 1.0e-2, rel=5.0e-3
    )


def test_jenkins_elements_lose_what_slides():
    # limits of 0.1, 0.2, 0.3 and 0.4 of the whole on springs of a quarter: at this amplitude the
    # first two slide
    amplitude = 0.9 * LIMIT / STIFFNESS
    ends = 0.4 * np.arange(1, 5) * LIMIT / STIFFNESS
    lost = np.maximum(4.0 * 0.25 * STIFFNESS * ends * (amplitude - ends), 0.0).sum()
    assert loop("iwan", amplitude) == pytest.approx(lost, rel=1.0e-3)


def test_spring_that_slides_loses_the_area_of_its_loop():
    amplitude, end = 4.0e-6, LIMIT / STIFFNESS
    assert loop("spring_damper", amplitude) == pytest.approx(
        4.0 * LIMIT * (amplitude - end), rel=1.0e-3
    )


def test_damper_of_a_sticking_bristle_loses_pi_c_w_a_a():
    # far below the limit: c = stick_time × stiffness
    amplitude, stick_time = 1.0e-7, 1.0e-3
    lost = np.pi * stick_time * STIFFNESS * 2.0 * np.pi * amplitude**2
    assert loop("spring_damper", amplitude, STICK_TIME=stick_time) == pytest.approx(lost, rel=1e-3)


def test_lugre_without_stribeck_and_damper_is_dahl():
    assert loop("lugre", 3.0e-6) == pytest.approx(loop("dahl", 3.0e-6), rel=1.0e-12)


def test_lugre_slides_slowly_at_its_static_friction():
    slow, fast = (
        loop("lugre", 1.0e-2, frequency, STATIC=1.5, STRIBECK_SPEED=0.1)
        for frequency in (1.0e-3, 1.0e3)
    )
    assert slow == pytest.approx(1.5 * 4.0 * LIMIT * 1.0e-2, rel=1.0e-2)
    assert fast == pytest.approx(4.0 * LIMIT * 1.0e-2, rel=5.0e-2)


@pytest.mark.parametrize(
    ("law", "parameters"), [("coulomb", (1.0e3, 1.0e6)), ("bouc_wen", (1.0e6, 1.0e3))]
)
def test_bristle_that_sticks_is_a_spring(law, parameters):
    """Bent by a sum of rates, it grew by 5/s until it slid, at however small a load."""
    force = 1.0e-3 * np.random.default_rng(1).standard_normal(200000)
    # an element of bouc_wen makes the structure's own spring hysteretic
    own = 1.0e6 if law == "bouc_wen" else 0.0
    x, _ = simulate(1.0, 1.0e4 + own, force, STEP, damping=20.0, laws=[(law, parameters)])
    spring, _ = simulate(1.0, 1.01e6, force, STEP, damping=20.0)
    assert np.std(x - spring) < 1.0e-3 * np.std(spring)


def test_node_is_bent_by_what_it_moved_since_it_touches():
    table = np.zeros(kernel.PLATE_COLUMNS)
    table[[kernel.MU, kernel.STIFFNESS, kernel.BRISTLE]] = 1.0, 1.0e6, STIFFNESS
    bristle, moved, fast = np.zeros(kernel.PARTS), 1.0e-8, 1.0

    def along(approach, moved_x):
        force = kernel.node_forces(
            table, 1.0, 0.0, 0.0, 1.0e-4, moved_x, 0.0, fast, 0.0, bristle, approach, STEP, True
        )
        return force[0]

    assert along(0.0, 1.0) == 0.0  # first touch: it moved before
    assert along(1.0, 0.0) == 0.0
    assert along(1.0, moved) == pytest.approx(-STIFFNESS * moved, rel=1.0e-3)


def rebound(factor, exponent=1.0):
    """Rate after over before an impact on k p^n (1 + factor rate / rate at first touch)."""
    contact = {kernel.APPROACH: factor}
    if exponent != 1.0:
        contact[kernel.HERTZ] = 1.0e8
    x, force = simulate(
        1.0,
        1.0e-6,
        np.zeros(20000),
        2.0e-7,
        start=(-1.0e-5, 0.5),
        stops=[(1.0e6, 0.0, 1, contact)],
    )
    assert force[-1] == 0.0
    return -(x[-1] - x[-11]) / (10 * 2.0e-7) / 0.5


def restitution(factor):
    """The same, exactly: of any elastic force (K. Hunt and F. Crossley 1975), the root of
    u - ln(1 + factor u) / factor between 1 and -e.
    """

    def lost(u):
        return u - np.log1p(factor * u) / factor

    return brentq(lambda e: lost(1.0) - lost(-e), 1.0e-6, min(1.0, 1.0 / factor) - 1.0e-12)


@pytest.mark.parametrize("exponent", [1.0, 1.5])
def test_rebound_is_that_of_the_energy_integral(exponent):
    for factor in (0.1, 0.5, 2.0):
        assert rebound(factor, exponent) == pytest.approx(restitution(factor), abs=3.0e-3)


def test_flores_gives_the_restitution_that_it_is_named_by():
    # the approximation of the paper: within 0.06 over the whole range
    for e in (0.2, 0.5, 0.9):
        assert restitution(8.0 * (1.0 - e) / (5.0 * e)) == pytest.approx(e, abs=0.06)


def test_lankarani_and_nikravesh_hold_for_hard_impacts_only():
    assert restitution(0.75 * (1.0 - 0.9**2)) == pytest.approx(0.9, abs=0.02)
    assert restitution(0.75 * (1.0 - 0.2**2)) > 0.5


def test_rayleigh_force_ends_in_its_limit_cycle():
    # m x'' + k x = a v - b v³: the rate settles at sqrt(4 a / (3 b))
    a, b, w = 4.0, 1.0, 100.0
    x, _ = simulate(
        1.0, w**2, np.zeros(600000), STEP, start=(1e-2, 0.0), laws=[("self_excited", (a, b))]
    )
    speed = np.abs(np.diff(x[-10000:])).max() / STEP
    assert speed == pytest.approx(np.sqrt(4.0 * a / (3.0 * b)), rel=5.0e-3)


def test_parametric_stiffness_grows_at_the_rate_of_mathieu():
    # x'' + w² (1 + eps cos 2 w t) x: growth eps w / 4
    w, eps = 100.0, 0.04
    x, _ = simulate(
        1.0,
        w**2,
        np.zeros(400000),
        STEP,
        start=(1e-4, 0.0),
        laws=[("parametric", (eps * w**2, w / np.pi, 0.0))],
    )
    late, early = (np.abs(x[part]).max() for part in (slice(-10000, None), slice(200000, 210000)))
    assert np.log(late / early) / (190000 * STEP) == pytest.approx(eps * w / 4.0, rel=2.0e-2)


def test_bilinear_oscillator_has_the_mean_of_two_periods():
    k, taken = 1.0e4, 5.0e3
    x, _ = simulate(
        1.0, k, np.zeros(400000), STEP, start=(1e-3, 0.0), laws=[("breathing", (taken,))]
    )
    ups = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    period = np.pi / np.sqrt(k) + np.pi / np.sqrt(k - taken)
    assert (ups[-1] - ups[0]) * STEP / (len(ups) - 1) == pytest.approx(period, rel=1.0e-4)


def test_mass_that_sticks_on_its_rod_is_an_added_mass():
    x, _ = simulate(
        1.0, 1.0e4, np.zeros(200000), STEP, start=(1e-5, 0.0), sliders=[(0.5, 1e3, 1e9, 0.0)]
    )
    ups = np.flatnonzero((x[:-1] < 0.0) & (x[1:] >= 0.0))
    found = 2.0 * np.pi * (len(ups) - 1) / ((ups[-1] - ups[0]) * STEP)
    assert found == pytest.approx(np.sqrt(1.0e4 / 1.5), rel=1.0e-3)


def test_mass_that_slides_takes_friction_from_every_half_cycle():
    # a heavy mass hardly moves: Coulomb friction on ground, 2 f / k less amplitude per half cycle
    x, _ = simulate(
        1.0, 1.0e4, np.zeros(70000), 2e-6, start=(1e-3, 0.0), sliders=[(1e6, 1.0, 4e8, 0.0)]
    )
    second = x[27500:35000]  # about the end of the first period
    assert second.max() == pytest.approx(1e-3 - 2 * 2e-4, abs=4e-6)


def pinned(**changes):
    """A slender pinned beam with one support that nothing touches."""
    beam = Straight(
        outer_diameter=0.01,
        wall=0.005,
        length=2.0,
        axis="z",
        ends=("pinned", "pinned"),
        holders=(Holder("stop", 0.5, 0.01, 1.0e5, 3),),
        drive=0.9,
    )
    return beam.with_changes(**changes)


@pytest.mark.parametrize(
    ("ends", "first"),
    [
        (("pinned", "pinned"), np.pi),
        (("clamped", "free"), 1.8751041),
        (("clamped", "pinned"), 3.9266023),
        (("clamped", "clamped"), 4.7300407),
    ],
)
@pytest.mark.parametrize("axis", ["x", "z"])
def test_straight_beams_have_the_frequencies_of_slender_beams(ends, first, axis):
    beam = pinned(ends=ends, axis=axis)
    section = beam.section
    expected = (first / 2.0) ** 2 * np.sqrt(section["EI"] / section["mass"]) / (2.0 * np.pi)
    for plane in ("y", "x"):
        found = Planes(Rig.bare(beam)).modes(plane, 200.0)[0][0]
        assert found == pytest.approx(expected, rel=5.0e-4)


def test_open_crack_has_the_frequency_of_a_hinge_with_a_spring():
    # Pinned beam with a rotational spring of compliance c in its middle: with z = beta l / 2, the
    # symmetric modes have tan z - tanh z ... from w'(l/2) = c M / 2 and no shear there.
    beam = pinned()
    section, half = beam.section, 1.0
    compliance = 0.2 * half / section["EI"]

    def characteristic(beta):
        z = beta * half
        # w = sin(b x)/cos z + sinh(b x)/cosh z has no shear in the middle
        slope = 2.0 * beta
        moment = section["EI"] * beta**2 * (np.tan(z) - np.tanh(z))
        return slope - 0.5 * compliance * moment

    beta = brentq(characteristic, 0.5 * np.pi * 0.5, 0.5 * np.pi * 0.99999)
    rig = Rig.bare(beam)
    length = compliance * section["EI"]
    depth = length / (length + beam.outer_diameter)
    breathing_crack(rig, place=half, depth=depth)
    reduced = reduce_rig(rig, [("drive", (0.0, 1.0, 0.0))], highest=8000.0)
    row, taken = reduced.local.row[0], reduced.local.parameters[0, 0]
    matrix = np.diag(reduced.omega2) - taken * np.outer(row, row)
    modes = np.sqrt(np.linalg.eigvalsh(matrix[: reduced.split, : reduced.split]))
    expected = beta**2 * np.sqrt(section["EI"] / section["mass"])
    found = modes[np.argmin(np.abs(modes - expected))]
    assert found == pytest.approx(expected, rel=2.0e-3)


def test_velocity_of_a_sine_is_its_derivative():
    t = np.arange(4096) / 40960.0
    w = 2.0 * np.pi * 1000.0
    found = velocities(np.sin(w * t)[None], 1.0 / 40960.0)[0, 10:-10]
    np.testing.assert_allclose(found, w * np.cos(w * t)[10:-10], atol=3e-5 * w)
