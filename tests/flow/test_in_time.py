"""Motion under a fluid-elastic force in time, against eigenvalues, closed forms and a solver.

The oscillator of the reference cases: 1 m of 0.6 kg, 30 Hz, 1 % damping, in a flow of 1000 kg/m3
across 20 mm, C_D 0.3, C_y -20, mu 1.
"""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.oscillator import oscillator
from vibroimpact.config.flow import ConnorsForce, NegativeDamping, QuasiSteady
from vibroimpact.excitation.fluid_elastic import fluid_force
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.every_step import integrate_every_step

MASS, OMEGA, RATIO, DIAMETER, DENSITY = 0.6, 2.0 * np.pi * 30.0, 0.01, 0.02, 1000.0
STIFFNESS, DAMPING = MASS * OMEGA**2, 2.0 * RATIO * MASS * OMEGA
GAP, RATE, CRITICAL = 1.0e-3, 20480.0, 0.682912
QUASI_STEADY = fluid_force(
    QuasiSteady(kind="quasi_steady", lift_slope=-20.0, drag=0.3, delay=1.0), DIAMETER
)


def in_flow(model, force, velocity):
    """The model with a fluid-elastic force along its first direction."""
    shape = np.sqrt(0.5 * DENSITY / MASS) * np.eye(2)[:, :1]
    return replace(model, fluid_shapes=shape, fluid_laws=force.laws(np.array([velocity])))


def run(model, seconds, gap=GAP, scheme="exact"):
    """Every step of a free run, and its energies."""
    return integrate_every_step(
        model,
        RATE,
        round(seconds * RATE),
        np.array([gap]),
        np.zeros((len(model.support_of_point), 2, 1)),
        lambda first, count: np.zeros((count, 1, 1)),
        scheme,
    )


def motion(traces):
    """Displacement along the first direction, of the contact point or of the element."""
    contact = traces.contact_displacement
    return contact[0, 0, 0] if contact.shape[1] else traces.element_displacement[0, 0]


def peaks(values):
    """The local maxima of |values|, each refined by a parabola."""
    size = np.abs(values)
    inner = np.flatnonzero((size[1:-1] > size[:-2]) & (size[1:-1] >= size[2:])) + 1
    left, right = size[inner - 1], size[inner + 1]
    return size[inner] - (right - left) ** 2 / (8.0 * (left - 2.0 * size[inner] + right))


def amplitude(traces, last_s=0.5):
    """Mean amplitude at the end."""
    return float(np.mean(peaks(motion(traces)[-round(last_s * RATE) :])))


def damping_ratio(traces, first_s=0.3):
    """Damping ratio from the peaks after the lag has settled."""
    found = np.log(peaks(motion(traces)[round(first_s * RATE) :]))
    decrement = -np.polyfit(np.arange(len(found)), found, 1)[0] / np.pi
    return decrement / np.hypot(1.0, decrement)


@pytest.mark.parametrize("scheme", ["exact", "newmark"])
@pytest.mark.parametrize(("velocity", "ratio"), [(0.65, 0.00210036), (0.80, -0.00929546)])
def test_growth_is_that_of_the_eigenvalues(velocity, ratio, scheme):
    free = oscillator(MASS, STIFFNESS, DAMPING, element={}, displacement=(1e-4, 0.0))
    traces = run(in_flow(free, QUASI_STEADY, velocity), 2.0, scheme=scheme)
    assert damping_ratio(traces) == pytest.approx(ratio, rel=2e-3)


@pytest.mark.parametrize(
    "coupling",
    [
        ConnorsForce(kind="connors", constant=3.0, band_Hz=(5.0, 200.0)),
        NegativeDamping(kind="negative_damping", constant=3.0, frequency_Hz=30.0),
    ],
    ids=lambda own: own.kind,
)
def test_connors_velocity_holds_the_motion(coupling):
    """V_c is 0.552596 m/s for K = 3; at 0.8 V_c 36 % of the damping is left."""
    free = oscillator(MASS, STIFFNESS, DAMPING, element={}, displacement=(1e-4, 0.0))
    force = fluid_force(coupling, DIAMETER)
    for share, left in ((1.0, 0.0), (0.8, 0.36)):
        traces = run(in_flow(free, force, share * 0.552596), 2.0)
        assert damping_ratio(traces) == pytest.approx(left * RATIO, abs=5e-3 * RATIO)


def stopped(**keys):
    """The oscillator with an elastic stop of 5 k around it, from a displacement."""
    return oscillator(MASS, STIFFNESS, DAMPING, contact_stiffness=5.0 * STIFFNESS, **keys)


def test_a_limit_cycle_closes_its_energy_balance():
    traces = run(in_flow(stopped(displacement=(2.5e-3, 0.0)), QUASI_STEADY, 1.3 * CRITICAL), 4.0)
    assert amplitude(traces) == pytest.approx(1.4436e-3, rel=1e-2)
    energy = {name: float(value[0]) for name, value in traces.energy.items()}
    assert energy["fluid_work"] == energy["input_work"] > 0.0
    lost = energy["fluid_work"] - energy["dissipated"] - energy["mechanical"] - energy["stored"]
    assert abs(lost) < 5e-3 * energy["fluid_work"]


NET = NegativeDamping(kind="negative_damping", constant=1.0, frequency_Hz=30.0)


def test_a_force_too_fast_for_the_step_is_refused():
    model = in_flow(oscillator(MASS, STIFFNESS, element={}), QUASI_STEADY, 400.0)
    with pytest.raises(IntegrationError, match=r"400 m/s.*raise integration.steps_per_second"):
        run(model, 0.01)
