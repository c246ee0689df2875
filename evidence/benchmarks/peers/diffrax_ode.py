"""diffrax: an adaptive Runge-Kutta method of order 5 on the modal equations, compiled by XLA."""

from functools import partial

import numpy as np

from evidence.benchmarks.peer import INSTALL, Marcher, Peer, PeerAbsent, Tolerance
from evidence.benchmarks.peers.scipy_ivp import ABSOLUTE, RELATIVE
from evidence.benchmarks.problem import RATE, STRIDE

MOST_STEPS, FIRST_STEP_S = 10**8, 1.0e-6


def peers():
    """Return [Peer]. Raises PeerAbsent."""
    try:
        import diffrax
        import jax
    except ImportError as error:
        raise PeerAbsent(f"diffrax cannot be imported ({error}): {INSTALL}") from error
    jax.config.update("jax_enable_x64", True)
    note = (
        "the same reduced model and law; step chosen by the solver, rtol 1e-6, the force linear"
        " between the steps of ours"
    )
    return [Peer("diffrax Tsit5", diffrax.__version__, note, start, 0.1, Tolerance())]


def start(problem, touching=True):
    """Return the Marcher."""
    import diffrax
    import jax
    import jax.numpy as jnp

    model, modes = problem.model, problem.model.modes
    square = jnp.asarray(model.omega**2)
    damping = jnp.asarray(model.damping)
    drive = jnp.asarray(model.drive_shapes[:, 0])
    shapes = jnp.asarray(model.contact_shapes.reshape(model.modes, -1).T)
    sensors = jnp.asarray(problem.sensor_shapes)
    stiffness = jnp.asarray(model.contact_stiffness)
    offset = jnp.asarray(problem.offset.ravel())
    gap = problem.contact_gap(touching)

    def slope(t, y, force):
        q, v = y[:modes], y[modes:]
        place = jnp.clip(t * RATE, 0.0, force.size - 1.0)
        first = jnp.minimum(place.astype(int), force.size - 2)
        f = force[first] + (place - first) * (force[first + 1] - force[first])
        d = (shapes @ q - offset).reshape(-1, 2)
        distance = jnp.sqrt(jnp.sum(d * d, axis=1))
        pull = jnp.where(distance > gap, stiffness * (gap / jnp.maximum(distance, gap) - 1.0), 0.0)
        return jnp.concatenate(
            [v, drive * f - damping * v - square * q + shapes.T @ (pull[:, None] * d).ravel()]
        )

    def run(force):
        last = (force.size - 1) / RATE
        times = jnp.minimum(jnp.arange(0, force.size, STRIDE) / RATE, last)
        control = diffrax.PIDController(
            rtol=RELATIVE, atol=jnp.repeat(jnp.asarray(ABSOLUTE), modes)
        )
        saved = diffrax.SaveAt(ts=times, fn=lambda t, y, args: y[:modes] @ sensors)
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(slope),
            diffrax.Tsit5(),
            0.0,
            last,
            FIRST_STEP_S,
            jnp.zeros(2 * modes),
            args=force,
            saveat=saved,
            stepsize_controller=control,
            max_steps=MOST_STEPS,
        )
        return found.ys

    return Marcher(partial(_march, jax.jit(run)))


def _march(compiled, force):
    return np.asarray(compiled(force))
