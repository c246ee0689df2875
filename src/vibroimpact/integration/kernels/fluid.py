"""The fluid-elastic force on its rows, see excitation.fluid_elastic.

With x the motion of a row, x' its rate as row_velocity takes it and z_j its lags,

    f = -(stiffness x + damping x' + sum_j lag_stiffness_j z_j),
    z_j+ = decay_j z_j + gain_j (x+ - x),   decay = exp(-rate dt),   gain = (1 - decay) / (rate dt),

which is exact for a motion that is linear in the step. The end x+ is foretold: x_free+ and the
deflection by the forces at the end of the last step, so that x+ - x = x_free+ - x_free. Forces that
begin in a step, as at an impact, are a step late in x+; the next step has them.
"""

from .compiled import inlined
from .lanes import fma, load, spread, store


@inlined
def push_fluid(modal, fluid, state, work):
    """Put the fluid-elastic forces at the end of a step into fluid.force."""
    w0, w1 = spread(modal.velocity_weights[0]), spread(modal.velocity_weights[1])
    w2, w3 = spread(modal.velocity_weights[2]), spread(modal.velocity_weights[3])
    for x in range(fluid.lag_start.size - 1):
        now, free = spread(0.0), spread(0.0)
        for k in range(fluid.row_start[x], fluid.row_start[x + 1]):
            now = now + load(state.row_displacement, fluid.row[k])
            free = free + load(work.u_free, fluid.row[k])
        moved = now - load(fluid.displacement, x)  # in the last step
        moves = free - load(fluid.free, x)  # in this one
        memory = fma(w2, moved, w3 * load(fluid.memory, x))
        force = load(fluid.stiffness, x) * (now + moves)
        force = fma(load(fluid.damping, x), fma(w0, moves, w1 * memory), force)
        for j in range(fluid.lag_start[x], fluid.lag_start[x + 1]):
            decay, gain = load(fluid.decay, j), load(fluid.gain, j)
            z = fma(decay, load(fluid.lag, j), gain * moved)
            store(fluid.lag, j, z)
            force = fma(load(fluid.lag_stiffness, j), fma(decay, z, gain * moves), force)
        store(fluid.force, x, -force)
        store(fluid.memory, x, memory)
        store(fluid.displacement, x, now)
        store(fluid.free, x, free)
