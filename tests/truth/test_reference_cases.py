"""R1 to R4 and R11 of reference/cases.md, in the truth generator's own march."""

import numpy as np
import pytest

from tests.truth.oscillator import simulate


def crossings(times, force):
    """Times in s at which a stop force sets in and ends, between samples by the line through the
    two next to it in contact.
    """
    touching = np.abs(force) > 0.0
    edges = np.flatnonzero(np.diff(touching.astype(int)))
    found = []
    for n in edges:
        a, b = (n + 1, n + 2) if touching[n + 1] else (n, n - 1)
        found.append(times[a] - force[a] * (times[b] - times[a]) / (force[b] - force[a]))
    return np.array(found)


def test_r1_friction_slide():
    # Dahl bristle of 4e8 N/m under the limit mu N = 1 N; every half cycle loses 2 mu N / k.
    step = 2.0e-6
    x, _ = simulate(
        1.0,
        1.0e4,
        np.zeros(70000),
        step,
        start=(0.85e-3, 0.0),
        laws=[("coulomb", (1.0, 4.0e8))],
        stride=50,
    )
    for n, expected in enumerate((-6.5e-4, 4.5e-4, -2.5e-4, 0.5e-4), 1):
        near = x[
            round((n - 0.2) * np.pi / 100.0 / (50 * step)) : round(
                (n + 0.2) * np.pi / 100.0 / (50 * step)
            )
        ]
        assert near[np.argmax(np.abs(near))] == pytest.approx(expected, abs=0.85e-6)


def test_r2_launch_on_a_stop():
    step = 1.0e-6
    x, force = simulate(
        100.0, 1.0e4, np.zeros(400000), step, start=(0.0, 1.0), stops=[(1.0e6, 0.0, 1)]
    )
    times = step * np.arange(len(x))
    first = times < 0.04
    assert -force[first].min() == pytest.approx(9950.372, rel=1e-6)
    assert times[np.argmin(force[first])] == pytest.approx(0.01563001, abs=2e-6)
    assert crossings(times, force)[1] == pytest.approx(0.03126002, abs=1e-6)
    assert -force[first].sum() * step == pytest.approx(198.01980, rel=1e-5)
    rebound = np.gradient(x, step)[round(0.035 / step)]
    energy = 100.0 * rebound**2 + 1.0e4 * x[round(0.035 / step)] ** 2
    assert energy == pytest.approx(100.0, rel=1e-6)  # the rebound speed at the stop is 1.0
    second = times > 0.3
    assert times[second][np.argmin(force[second])] == pytest.approx(0.36104929, abs=2e-6)


def test_r3_exact_contact_times():
    step, end = 1.0e-6, 0.27
    times = step * np.arange(round(end / step))
    _, force = simulate(
        156.0, 2.0e6, 3000.0 * np.sin(2.0 * np.pi * 5.0 * times), step, stops=[(1.0e10, 1.0e-3, 1)]
    )
    expected = [
        0.024867876,
        0.025260518,
        0.046328519,
        0.046722721,
        0.06625224,
        0.066645834,
        0.208191408,
        0.208581391,
        0.236839728,
        0.237232929,
        0.259783891,
        0.260177191,
    ]
    found = crossings(times, force)
    assert np.abs(found[:6] - expected[:6]).max() < 1e-7
    np.testing.assert_allclose(
        np.array([found[np.abs(found - t).argmin()] for t in expected]), expected, atol=2e-6
    )
    peaks = [
        -force[(times > a - 1e-4) & (times < b + 1e-4)].min()
        for a, b in np.reshape(expected[:6], (3, 2))
    ]
    np.testing.assert_allclose(peaks, [105794.34, 133098.19, 122220.14], rtol=1e-4)


def test_r2_second_order():
    # The end of the contact, pi / w, is known exactly (R3's printed times end at 1e-7 s): its error
    # falls by four when the step is halved.
    errors = []
    for step in (8.0e-5, 4.0e-5, 2.0e-5):
        _, force = simulate(
            100.0,
            1.0e4,
            np.zeros(round(0.035 / step)),
            step,
            start=(0.0, 1.0),
            stops=[(1.0e6, 0.0, 1)],
        )
        times = step * np.arange(len(force))
        part = slice(
            np.flatnonzero(force)[-1] - 3, np.flatnonzero(force)[-1] + 1
        )  # a cubic through the last points, where the force is a sine
        end = np.roots(np.polyfit((times[part] - times[part][-1]) / step, force[part], 3))
        end = times[part][-1] + step * end[np.argmin(np.abs(end - 0.5))].real
        errors.append(abs(end - np.pi / np.sqrt(1.01e6 / 100.0)))
    assert 0.5 * np.log2(errors[0] / errors[2]) == pytest.approx(2.0, abs=0.1)


def test_r4_base_driven_impact():
    mass, stiffness, step = 25.0, 98696.0, 2.0e-6
    damping = 2.0 * 0.07 * np.sqrt(stiffness * mass)
    times = step * np.arange(round(1.0 / step) + 1)
    w = 20.0 * np.pi
    base, speed = -np.sin(w * times) / w**2, -np.cos(w * times) / w
    x, _ = simulate(
        mass,
        stiffness,
        stiffness * base + damping * speed,
        step,
        damping=damping,
        start=(0.0, -1.0 / w),
        stops=[(5.76e7, 5.0e-4, 1)],
    )
    for t, expected in (
        (0.05, -3.580041e-4),
        (0.156, -1.221167e-4),
        (0.25, -1.887019e-4),
        (0.4, -1.898401e-4),
        (0.5, -7.02148e-5),
        (1.0, -1.085591e-4),
    ):
        assert x[round(t / step)] == pytest.approx(expected, abs=1e-9)


# s0, r -> sigma_x, P(contact), RMS stop force
STOPS = {
    (1.0, 10.0): (0.709099, 0.176209, 1.124685),
    (2.0, 100.0): (0.712563, 0.180658, 8.292828),
}


@pytest.mark.parametrize(("s0", "r"), STOPS)
def test_r11_random_vibration_between_stops(s0, r):
    # m = k = g = 1, damping 1: S0 = c T / pi, T = s0². A kick per step has the variance 2 pi S0 /
    # step. Errors from forty batches.
    damping, step, count = 1.0, 0.02, 4_000_000
    kicks = np.random.default_rng(11).standard_normal(count) * np.sqrt(2.0 * damping * s0**2 / step)
    x, force = (
        series.reshape(40, -1)
        for series in simulate(1.0, 1.0, kicks, step, damping=damping, stops=[(r, 1.0, 2)])
    )
    for values, exact in zip(
        (x**2, force != 0.0, force**2),
        (STOPS[s0, r][0] ** 2, STOPS[s0, r][1], STOPS[s0, r][2] ** 2),
        strict=True,
    ):
        batch = values.mean(axis=1)
        error = batch.std(ddof=1) / np.sqrt(40)
        assert error < 0.05 * exact  # of mean squares, the rarest contacts; 2 % of their RMS
        assert abs(batch.mean() - exact) < 3.5 * error + 0.003 * exact
