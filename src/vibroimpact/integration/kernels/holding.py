"""Dampers that hold the sensors of a model to measured motion.

The damper of sensor s, of strength c_s, bears the force

    u_s = c_s (v_s - S_s q'),

v_s being the measured velocity. It is implicit in the step: with e the measured less the model's
displacement, and the rate of e as row_velocity takes it from displacements,

    rate_free = w0 (e_free - e) + w1 m,        u = (I + w0 c G)^-1 c rate_free = gain rate_free,

with e_free without a damper at the end of the step, under the contact forces of the last one, and G
the compliance between the sensors. What a step misses of c times the rate that it had, as contact
forces change, the next step adds: the impulse of a damper is that of its true rate.

Measured motion and model pass the same difference, so that the difference makes no error between
them.
"""

from .compiled import inlined
from .lanes import fma, load, spread, store


@inlined
def hold_sensors(modal, hold, state, work, drive, first):
    """Put the forces of the dampers in the place of the measured displacements of a step, which
    begin at vector ``first`` of drive.
    """
    sensors = hold.channel.size
    w0, w1 = spread(modal.velocity_weights[0]), spread(modal.velocity_weights[1])
    w2, w3 = spread(modal.velocity_weights[2]), spread(modal.velocity_weights[3])
    for s in range(sensors):
        measured = load(drive, first + hold.channel[s])
        now, free = load(hold.measured, s), measured
        for k in range(hold.row_start[s], hold.row_start[s + 1]):
            now = now - load(state.row_displacement, hold.row[k])
            free = free - load(work.u_free, hold.row[k]) - load(state.row_deflection, hold.row[k])
        moved, memory = now - load(hold.difference, s), load(hold.memory, s)
        last = fma(w0, moved, w1 * memory)  # the rate at the end of the last step
        store(hold.missed, s, load(hold.strength, s) * last - load(hold.implicit, s))
        memory = fma(w2, moved, w3 * memory)
        store(hold.rate, s, fma(w0, free - now, w1 * memory))
        store(hold.memory, s, memory)
        store(hold.difference, s, now)
        store(hold.measured, s, measured)
    for s in range(sensors):
        force = spread(0.0)
        for other in range(sensors):
            force = fma(load(hold.gain, s * sensors + other), load(hold.rate, other), force)
        store(hold.implicit, s, force)
        store(drive, first + hold.channel[s], force + load(hold.missed, s))
