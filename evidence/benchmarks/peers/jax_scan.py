"""JAX: the same step in lax.scan, compiled by XLA, for one run and for a batch of them (vmap)."""

from functools import partial

import numpy as np

from evidence.benchmarks.newmark import newmark_map
from evidence.benchmarks.peer import INSTALL, Marcher, Peer, PeerAbsent, Tolerance
from evidence.benchmarks.problem import RATE, STRIDE

PASSES, BATCH = 3, 256


def peers():
    """Return [Peer]. Raises PeerAbsent."""
    try:
        import jax
    except ImportError as error:
        raise PeerAbsent(f"JAX cannot be imported ({error}): {INSTALL}") from error
    jax.config.update("jax_enable_x64", True)
    note = (
        "the same reduced model, step and law in float64 on one core; three displacements kept, no"
        " statistics or energies; a step costs the same with and without contact"
    )
    tolerance = Tolerance()
    return [
        Peer("JAX lax.scan", jax.__version__, note, start, 1.0, tolerance, same_step=True),
        Peer(
            f"JAX lax.scan, batch of {BATCH}",
            jax.__version__,
            note,
            start,
            0.02,
            tolerance,
            same_step=True,
            batch=BATCH,
        ),
    ]


def start(problem, touching=True):
    """Return the Marcher: a force (step + 1,), or (step + 1, batch)."""
    import jax
    import jax.numpy as jnp

    model = problem.model
    c0, c1, c2, c3, c4, c5 = jnp.asarray(newmark_map(model.omega, model.damping, 1.0 / RATE))
    shapes = jnp.asarray(model.contact_shapes.reshape(model.modes, -1).T)
    compliance = (shapes * c5) @ shapes.T
    drive, sensors = jnp.asarray(model.drive_shapes[:, 0]), jnp.asarray(problem.sensor_shapes)
    stiffness = jnp.asarray(model.contact_stiffness)
    offset = jnp.asarray(problem.offset.ravel())
    gap = problem.contact_gap(touching)

    def contact(u):
        d = (u - offset).reshape(-1, 2)
        distance = jnp.sqrt(jnp.sum(d * d, axis=1))
        pull = jnp.where(distance > gap, stiffness * (gap / jnp.maximum(distance, gap) - 1.0), 0.0)
        return (pull[:, None] * d).ravel()

    def step(state, pushed):
        q, v, before = state
        ahead = c3 * q + c4 * v + c5 * drive * pushed
        free = shapes @ ahead + compliance @ before
        force = before
        for _ in range(PASSES):
            force = contact(free + compliance @ force)
        total = drive * pushed + shapes.T @ (before + force)
        return (c3 * q + c4 * v + c5 * total, c0 * v + c1 * q + c2 * total, force), None

    def sample(state, pushed):
        state, _ = jax.lax.scan(step, state, pushed)
        return state, state[0] @ sensors

    def run(force):
        pushed = (force[:-1] + force[1:]).reshape(-1, STRIDE)
        rest = jnp.zeros(model.modes), jnp.zeros(model.modes), jnp.zeros(2 * stiffness.size)
        _, seen = jax.lax.scan(sample, rest, pushed)
        return jnp.concatenate([jnp.zeros((1, sensors.shape[1])), seen])

    one, many = jax.jit(run), jax.jit(jax.vmap(run, in_axes=1))
    return Marcher(partial(_march, one, many))


def _march(one, many, force):
    return np.asarray(one(force) if force.ndim == 1 else many(force)[0])
