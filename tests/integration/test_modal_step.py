"""The step of a mode in the kernel's form against the scheme in its own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from vibroimpact.config import checks as config_checks
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.modal_step import step_coefficients
from vibroimpact.integration.output_filter import LEAST_STAGES, PASS_FRACTION

STEP = 1.0 / 20480
OMEGA = 2.0 * np.pi * np.array([0.0, 12.0, 300.0, 5000.0, 40.0])
DAMPING = np.array([0.0, 0.1, 7.0, 120.0, 2000.0])  # rigid, weak, ..., overdamped


def march(scheme, q, v, force):
    """(displacement, velocity) (step, mode) of the kernel's recursion under force (step + 1,
    mode).
    """
    step = step_coefficients(scheme, OMEGA, DAMPING, STEP)
    q_next_free, dq = step.start(q, v, force[0])
    out = []
    for f in force[1:]:
        q = q_next_free + step.mode_compliance * f
        shifted = q + step.force_shift * f
        dq = step.decay * dq + step.restoring * shifted + step.force_gain * f
        q_next_free = shifted + dq
        out.append((q, step.velocity(q_next_free, dq, f)))
    return np.array(out).transpose(1, 0, 2)


@pytest.fixture(scope="module")
def start():
    generator = np.random.default_rng(0)
    return (
        1e-3 * generator.normal(size=5),
        generator.normal(size=5),
        generator.normal(size=(301, 5)),
    )


def test_newmark_is_the_textbook_average_acceleration(start):
    q, v, force = start
    displacement, velocity = march("newmark", q, v, force)
    a = force[0] - DAMPING * v - OMEGA**2 * q
    for n, f in enumerate(force[1:]):
        effective = 4.0 / STEP**2 + 2.0 / STEP * DAMPING + OMEGA**2
        new = (
            f + 4.0 / STEP**2 * q + 4.0 / STEP * v + a + DAMPING * (2.0 / STEP * q + v)
        ) / effective
        a_new = 4.0 / STEP**2 * (new - q) - 4.0 / STEP * v - a
        q, v, a = new, v + 0.5 * STEP * (a + a_new), a_new
        assert displacement[n] == pytest.approx(q, rel=1e-9, abs=1e-13)
        assert velocity[n] == pytest.approx(v, rel=1e-8, abs=1e-9)


def test_exact_is_the_solution_for_a_force_linear_in_the_step(start):
    q, v, force = start
    displacement, velocity = march("exact", q, v, force[:12])
    for n in range(11):
        for m in range(5):

            def motion(t, y, m=m, n=n):
                f = force[n, m] + (force[n + 1, m] - force[n, m]) * t / STEP
                return [y[1], f - DAMPING[m] * y[1] - OMEGA[m] ** 2 * y[0]]

            end = solve_ivp(
                motion, (0.0, STEP), [q[m], v[m]], method="DOP853", rtol=1e-12, atol=1e-16
            ).y[:, -1]
            assert displacement[n, m] == pytest.approx(end[0], rel=1e-8)
            assert velocity[n, m] == pytest.approx(end[1], rel=1e-7)
            q[m], v[m] = displacement[n, m], velocity[n, m]


@pytest.mark.parametrize("scheme", ["newmark", "exact"])
def test_a_constant_force_is_answered_by_the_static_displacement(scheme):
    step = step_coefficients(scheme, OMEGA[1:4], DAMPING[1:4], STEP)
    still = 1.0 / OMEGA[1:4] ** 2
    q_next_free, dq = step.start(still, np.zeros(3), np.ones(3))
    assert q_next_free + step.mode_compliance == pytest.approx(still, rel=1e-12)
    assert step.velocity(q_next_free, dq, np.ones(3)) == pytest.approx(
        np.zeros(3), abs=1e-12 * still.max() / STEP
    )


@pytest.mark.parametrize("scheme", ["newmark", "exact"])
def test_the_free_step_has_its_determinant_and_distance_from_one(scheme):
    step = step_coefficients(scheme, OMEGA, DAMPING, STEP)
    determinant = step.A[0, 0] * step.A[1, 1] - step.A[0, 1] * step.A[1, 0]
    assert step.decay == pytest.approx(determinant, rel=1e-10)
    assert step.restoring == pytest.approx(
        -(1.0 - step.A[0, 0] - step.A[1, 1] + determinant), abs=1e-12
    )


def test_config_checks_use_the_filter_ratio():
    assert config_checks.FILTER_RATIO == RATIO
    assert config_checks.FILTER_STAGES == LEAST_STAGES
    assert config_checks.FILTER_PASSES == PASS_FRACTION
