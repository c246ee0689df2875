"""One time step, and the march through a record.

The structure is a set of mass-normalised modes; contact and element forces act on it at rows. In
the form of modal_step.StepCoefficients a step of a mode needs only the force at its end:

    predictor    u_free = Phi q_free + G_d d           displacement of the rows without contact
    contact      u      = u_free + G f(u)              implicit, by fixed-point iteration
    correction   q      = q_free + c p,  p = Phi^T f   end of the step; f with the drive forces d
    next step    dq     = a dq + b (q + s p) + k p     its increment if no force acts at its end
                 q_free = (q + s p) + dq               its end

    symbol   in the code              meaning                                           unit
    q        state.q                  modal displacement                                m kg^1/2
    q_free   state.q_next_free        q at the end of the step, no force acting there   m kg^1/2
    dq       state.dq                 increment of the step that leads to q_free        m kg^1/2
    u        work.u                   displacement of a row                             m
    u_free   work.u_free              u without contact and element forces              m
    f, d     work.force, drive        force on a contact or element row, drive force    N
    G f      work.deflection          displacement of the rows by f                     m
    G, G_d   modal.row_compliance     Phi c Phi^T; G_d its columns of the drive         m/N
    Phi      modal.shapes, .acting_shapes   mode shapes at the rows                     kg^-1/2
    c, k     modal.mode_compliance, .force_gain   q and dq per modal force              s²
    s        modal.force_shift        shift of q that replaces the force at the start   s²
    a, b     modal.decay, .restoring  dq per last dq, per shifted q                     1
"""

from .compiled import entry_point, inlined
from .contact_iteration import apply_compliance, solve_contact
from .decimation import RATIO, filter_forces, filter_modes, finish_output
from .fluid import push_fluid
from .force_laws import all_forces
from .holding import hold_sensors
from .lanes import LANES, clear, fma, load, spread, spread_from, store
from .panels import (
    PANEL,
    ROWS,
    TILE,
    even_and_odd_plus_dot,
    load_rows,
    load_tile,
    plus_dots,
    store_tile,
    tile_difference,
    tile_plus_scaled,
    tile_plus_vector,
    tile_product,
    tile_sum,
    tile_zero,
)
from .references import by_reference
from .subnormals import flush_subnormals, restore_mode
from .tables import QUIET, STEPS_DONE, STEPS_WITHOUT_FORCE
from .tallies import tally_contact, tally_displacement, tally_drive, tally_laws, tally_stress


@inlined
def add_panel_to_rows(modal, g, i, q, rows):
    """Add the displacement of group g's rows by one panel of its modes, q from mode i on."""
    row0, row1 = modal.row_start[g], modal.row_start[g + 1]
    if LANES == 1:
        blocks = (row1 - row0 + PANEL - 1) // PANEL
        at = modal.block_shape_start[g] + (i - modal.mode_start[g]) * blocks * PANEL
        for r in range(row0, row1, PANEL):
            add_modes_to_rows(modal.block_shapes, at, q, i, rows, r)
            at += PANEL * PANEL
    else:
        at = modal.shape_start[g] + (i - modal.mode_start[g]) * (row1 - row0)
        r = row0
        while r + ROWS <= row1:
            sums = plus_dots(modal.shapes, at, PANEL, q, i, load_rows(rows, r))
            for k in range(ROWS):
                store(rows, r + k, sums[k])
            r += ROWS
            at += ROWS * PANEL
        while r < row1:
            store(rows, r, plus_dots(modal.shapes, at, PANEL, q, i, (load(rows, r),))[0])
            r += 1
            at += PANEL


@inlined
def add_modes_to_rows(shapes, at, q, i, rows, r):
    """plus_dots of one run on the PANEL rows from r on, side by side."""
    even, odd = load_tile(rows, r), tile_zero()
    for m in range(0, PANEL, 2):
        even = tile_plus_vector(shapes, at + m * PANEL, load(q, i + m), even)
        odd = tile_plus_vector(shapes, at + (m + 1) * PANEL, load(q, i + m + 1), odd)
    store_tile(rows, r, tile_sum(even, odd))


@inlined
def predict_rows(modal, state, u_free):
    """u_free = Phi q_free, (row, lane); every later step has it from correct_and_predict."""
    clear(u_free)
    for g in range(modal.mode_start.size - 1):
        for i in range(modal.mode_start[g], modal.mode_start[g + 1], PANEL):
            add_panel_to_rows(modal, g, i, state.q_next_free, u_free)


@inlined
def apply_drive(modal, drive, n, forces, fluid, work):
    """Put the drive forces at the end of step n, and the fluid forces behind them, on their rows
    and add G_d d to u_free.
    """
    for g in range(modal.row_start.size - 1):
        row0, row_f, row1 = modal.row_start[g], modal.force_row_start[g], modal.row_start[g + 1]
        for f in range(row_f, row1):
            channel = modal.row_force_channel[f]
            if channel < forces:
                d = load(drive, n * forces + channel)
            else:
                d = load(fluid.force, channel - forces)
            store(work.force, f, d)
        for r in range(row0, row1):
            at = modal.compliance_start[g] + (r - row0) * (row1 - row0) + row_f - row0
            u_free = load(work.u_free, r)
            for f in range(row_f, row1):
                u_free = fma(spread_from(modal.row_compliance, at), load(work.force, f), u_free)
                at += 1
            store(work.u_free, r, u_free)


@inlined
def correct_and_predict(modal, state, tally, work, in_contact, phase):
    """Correct the modes by the row forces at the end of the step, predict the end of the next and
    project it on the rows: work.u_free. Adds the energy dissipated.
    """
    modes = modal.mode_start[-1]
    before, after = ((phase + RATIO - 1) % RATIO) * modes, phase * modes
    dissipated = load(tally.dissipated, 0)
    clear(work.u_free)
    for g in range(modal.mode_start.size - 1):
        if state.group_active[g] == 0:
            continue
        first = modal.mode_start[g]
        row0, row1 = modal.row_start[g], modal.row_start[g + 1]
        first_row = row0 if in_contact else modal.force_row_start[g]
        for i in range(first, modal.mode_start[g + 1], PANEL):
            at = modal.shape_start[g] + (i - first) * (row1 - row0)
            odd = spread(0.0)
            for tile in range(0, PANEL, TILE):
                j = i + tile
                p = tile_zero()
                for r in range(first_row, row1):
                    from_row = at + tile + (r - row0) * PANEL
                    p = tile_plus_vector(modal.acting_shapes, from_row, load(work.force, r), p)
                q = tile_plus_scaled(modal.mode_compliance, j, p, load_tile(state.q_next_free, j))
                step = tile_difference(q, load_tile(state.q, before + j))
                dissipated, odd = even_and_odd_plus_dot(
                    modal.damping_over_dt, j, tile_product(step, step), dissipated, odd
                )
                store_tile(state.q, after + j, q)
                shifted = tile_plus_scaled(modal.force_shift, j, p, q)
                dq = tile_plus_scaled(modal.force_gain, j, p, tile_zero())
                dq = tile_plus_scaled(modal.decay, j, load_tile(state.dq, j), dq)
                dq = tile_plus_scaled(modal.restoring, j, shifted, dq)
                store_tile(state.dq, j, dq)
                store_tile(state.q_next_free, j, tile_sum(shifted, dq))
            dissipated = dissipated + odd
            add_panel_to_rows(modal, g, i, state.q_next_free, work.u_free)
    store(tally.dissipated, 0, dissipated)


@inlined
def keep_displacements(modal, state):
    """Keep the row displacements of the start of the step, for velocities at its end."""
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            store(state.row_displacement_before, r, load(state.row_displacement, r))


@inlined
def store_rows(modal, special, state, trace, u, work, quiet):
    """Make the end of the step the start of the next on contact and element rows, and record it on
    the trace. quiet: no force, neither now nor before.
    """
    n = state.counter[STEPS_DONE]
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            ur, f = load(u, r), load(work.force, r)
            if n < trace.steps:
                store(trace.displacement, r * trace.steps + n, ur)
                store(trace.force, r * trace.steps + n, f)
            if special:
                du = ur - load(state.row_displacement, r)
                memory = modal.velocity_weights[3] * load(state.row_velocity, r)
                store(state.row_velocity, r, fma(modal.velocity_weights[2], du, memory))
            store(state.row_displacement, r, ur)
            if not quiet:
                store(state.row_force_before, r, load(state.row_force, r))
                store(state.row_force, r, f)
                store(state.row_deflection_before, r, load(state.row_deflection, r))
                store(state.row_deflection, r, load(work.deflection, r))


@entry_point
def initial_forces(modal, contact, laws, state, work):
    """Fill state.row_force, row_deflection and their values of the step before with the forces of
    contacts and elements at the initial state.row_displacement and row_velocity.
    """
    modal, contact, laws = by_reference(modal), by_reference(contact), by_reference(laws)
    state, work = by_reference(state), by_reference(work)
    rows = state.row_velocity.size // LANES
    memory_weight = modal.velocity_weights[1]
    clear(work.new_force)
    for r in range(rows):
        store(work.u, r, load(state.row_displacement, r))
        # so that row_velocity, with no increment, gives the velocity itself
        store(state.row_velocity, r, load(state.row_velocity, r) / memory_weight)
    all_forces(modal, contact, laws, state, work, work.u)
    for r in range(rows):
        store(state.row_velocity, r, load(state.row_velocity, r) * memory_weight)
        store(state.row_force, r, load(work.new_force, r))
        store(state.row_force_before, r, load(work.new_force, r))
    apply_compliance(modal, state.row_force, state.row_deflection, work.bearing)
    apply_compliance(modal, state.row_force_before, state.row_deflection_before, work.bearing)
    state.counter[STEPS_WITHOUT_FORCE] = 0


@entry_point
def march(modal, contact, laws, hold, fluid, state, tally, output, trace, work, drive):
    """Integrate whole ticks of RATIO steps; the number of steps, without the tick that diverged.

    drive (step, force_channel, lane) N: the force at the end of every step; see Hold for the
    input and output of the channels of held sensors. Fills output.values (one column per tick: the
    filter output centred BEHIND ticks before), adds to ``tally`` and advances ``state`` in place.
    """
    modal, contact, laws = by_reference(modal), by_reference(contact), by_reference(laws)
    hold, fluid, state = by_reference(hold), by_reference(fluid), by_reference(state)
    tally, output = by_reference(tally), by_reference(output)
    trace, work = by_reference(trace), by_reference(work)
    mode = flush_subnormals()
    forces = drive.shape[1]
    special = laws.contact_point.size + laws.element_row.size > 0
    predict_rows(modal, state, work.u_free)
    for at_tick in range(drive.shape[0] // RATIO):
        tick = state.counter[STEPS_DONE] // RATIO
        for phase in range(RATIO):
            n = at_tick * RATIO + phase
            if hold.channel.size > 0:
                hold_sensors(modal, hold, state, work, drive, n * forces)
            if fluid.lag_start.size > 1:
                push_fluid(modal, fluid, state, work)
            apply_drive(modal, drive, n, forces, fluid, work)
            in_contact = solve_contact(modal, contact, laws, special, state, tally, work)
            since = state.counter[STEPS_WITHOUT_FORCE]
            quiet = not special and not in_contact and since >= QUIET
            touched = False
            if in_contact or since == 0:
                touched = tally_contact(modal, contact, state, tally, work)
                if special:
                    tally_laws(modal, contact, laws, state, tally, work)
                    touched = touched or laws.element_row.size > 0
            if in_contact:
                state.group_active[:] = 1
            tally_drive(modal, state, tally, work, in_contact, forces)
            if phase == RATIO - 1:
                keep_displacements(modal, state)
            u = work.u_free if quiet else work.u
            store_rows(modal, special, state, trace, u, work, quiet)
            correct_and_predict(modal, state, tally, work, in_contact, phase)
            if output.stress_weight[phase] > 0.0:
                tally_stress(modal, state, tally, output, phase, work.channels)
            first = n * forces
            filter_forces(modal, state, output, work, drive, first, forces, touched, phase, tick)
            state.counter[STEPS_WITHOUT_FORCE] = 0 if touched else min(since + 1, QUIET)
            state.counter[STEPS_DONE] += 1
        if not tally_displacement(modal, state, contact, tally):
            restore_mode(mode)
            return at_tick * RATIO
        filter_modes(modal, state, output, tick)
        finish_output(modal, state, output, tick, at_tick, work.channels)
    restore_mode(mode)
    return drive.shape[0]
