"""Sums and largest values of a step: work, contact statistics, stresses; and the trace."""

import math

from .compiled import inlined
from .decimation import project_channels
from .force_laws import (
    normal_force,
    penetration,
    penetration_motion,
    radial_offset,
    tangential_slip,
)
from .lanes import (
    LANES,
    add_to,
    all_lanes,
    any_lane,
    fma,
    in_every_lane,
    larger,
    load,
    magnitude,
    raise_to,
    spread,
    spread_from,
    square_root,
    store,
    where,
)


@inlined
def tally_drive(modal, state, tally, work, in_contact, forces):
    """Add the work of the drive, whose channels are the first ``forces``, and of the fluid; make
    the end of the step the start of the next on their rows.
    """
    input_work = load(tally.input_work, 0)
    for g in range(modal.row_start.size - 1):
        row0, row_f, row1 = modal.row_start[g], modal.force_row_start[g], modal.row_start[g + 1]
        for f in range(row_f, row1):
            u_free = u = load(work.u_free, f)
            if in_contact:
                at = modal.compliance_start[g] + (f - row0) * (row1 - row0)
                for r in range(row0, row_f):
                    u = fma(
                        spread_from(modal.row_compliance, at + r - row0), load(work.force, r), u
                    )
            du = u - load(state.row_displacement, f)
            force = load(work.force, f)
            mean = 0.5 * (force + load(state.row_force, f))
            input_work = fma(mean, du, input_work)
            if modal.row_force_channel[f] >= forces:
                store(tally.fluid_work, 0, fma(mean, du, load(tally.fluid_work, 0)))
            store(state.row_displacement, f, u)
            store(state.row_force, f, force)
            store(state.row_deflection, f, u - u_free)
    store(tally.input_work, 0, input_work)


@inlined
def tally_contact(modal, contact, state, tally, work):
    """Add the contact work and the statistics of one step and put the forces of the supports into
    work.resultant; True if any lane touches. state still holds the start of the step.
    """
    touched = False
    p = 0
    for s in range(tally.impacts.size // LANES):
        first = p
        resultant_1, resultant_2, contact_force_l1 = spread(0.0), spread(0.0), spread(0.0)
        contact_work, sliding = load(tally.contact_work, 0), load(tally.sliding_work, s)
        while p < contact.row_1.size and contact.support[p] == s:
            r1, r2 = contact.row_1[p], contact.row_2[p]
            u1, u2, f1, f2 = (
                load(work.u, r1),
                load(work.u, r2),
                load(work.force, r1),
                load(work.force, r2),
            )
            du1, du2 = u1 - load(state.row_displacement, r1), u2 - load(state.row_displacement, r2)
            mean1 = 0.5 * (f1 + load(state.row_force, r1))
            mean2 = 0.5 * (f2 + load(state.row_force, r2))
            contact_work = fma(mean1, du1, contact_work)
            contact_work = fma(mean2, du2, contact_work)
            store(tally.row_work, r1, fma(mean1, du1, load(tally.row_work, r1)))
            store(tally.row_work, r2, fma(mean2, du2, load(tally.row_work, r2)))
            add_to(tally.row_force, r1, f1)
            add_to(tally.row_force, r2, f2)
            store(tally.force_displacement, r1, fma(f1, u1, load(tally.force_displacement, r1)))
            store(tally.force_displacement, r2, fma(f2, u2, load(tally.force_displacement, r2)))
            if contact.plain[p] != 0:  # |f| times the slip across it; else see tally_laws
                sliding = sliding + magnitude(fma(f1, du2, -(f2 * du1)))
            contact_force_l1 = contact_force_l1 + magnitude(f1) + magnitude(f2)
            resultant_1, resultant_2 = resultant_1 + f1, resultant_2 + f2
            p += 1
        store(tally.contact_work, 0, contact_work)
        store(work.resultant, 2 * s, resultant_1)
        store(work.resultant, 2 * s + 1, resultant_2)
        touching = contact_force_l1 > 0.0
        if any_lane(touching):
            touched = True
            store(tally.sliding_work, s, sliding)
            tally_support(tally, s, resultant_1, resultant_2, touching)
            onset = touching & (load(state.touching, s) < 0.5)
            if any_lane(onset):
                tally_impact(tally, s, impact_speed(modal, contact, state, work, first, s), onset)
        store(state.touching, s, where(touching, 1.0, 0.0))
    return touched


@inlined
def tally_support(tally, s, resultant_1, resultant_2, touching):
    """Add the resultant force of support s and the lanes that touch it."""
    square = fma(resultant_1, resultant_1, resultant_2 * resultant_2)
    resultant = square_root(square)
    raise_to(tally.peak_force, s, resultant)
    add_to(tally.square_force, s, square)
    add_to(tally.force_sum, s, resultant)
    add_to(tally.contact_steps, s, where(touching, 1.0, 0.0))


@inlined
def tally_impact(tally, s, speed, onset):
    """Count an impact on support s, at a speed, in the lanes of the mask."""
    count = where(onset, 1.0, 0.0)
    speed = count * speed
    add_to(tally.impacts, s, count)
    square = fma(speed, speed, load(tally.impact_velocity_square, s))
    store(tally.impact_velocity_square, s, square)
    raise_to(tally.impact_velocity_peak, s, speed)


@inlined
def impact_speed(modal, contact, state, work, first, s):
    """Largest outward speed over a step among the points of support s (from point ``first`` on)
    that bear a force.
    """
    largest = spread(0.0)
    p = first
    while p < contact.row_1.size and contact.support[p] == s:
        r1, r2 = contact.row_1[p], contact.row_2[p]
        f1, f2 = load(work.force, r1), load(work.force, r2)
        f_squared = fma(f1, f1, f2 * f2)
        du1 = load(work.u, r1) - load(state.row_displacement, r1)
        du2 = load(work.u, r2) - load(state.row_displacement, r2)
        # The force points inwards along the radius.
        outward = -fma(f1, du1, f2 * du2) / square_root(f_squared)
        largest = larger(where(f_squared > 0.0, outward, 0.0), largest)
        p += 1
    return largest * (1.0 / modal.dt)


@inlined
def tally_laws(modal, contact, laws, state, tally, work):
    """Add the work of the elements, the slip of sliders and the wear of special contacts in one
    step, and advance friction and slider forces. state.row_* still hold the start of the step.
    """
    for e in range(laws.element_row.size):
        tally_element(laws, state, tally, work, e)
    for k in range(laws.contact_point.size):
        point = laws.contact_point[k]
        r1, r2 = contact.row_1[point], contact.row_2[point]
        u1, u2, friction = load(work.u, r1), load(work.u, r2), load(work.friction_force, k)
        n1, n2, length, p = penetration(contact, laws, k, u1, u2)
        if any_lane(p > 0.0):
            motion = penetration_motion(modal, state, n1, n2, p, u1, u2, r1, r2)
            normal = normal_force(laws, k, motion, modal.dt) * length
            slip = tangential_slip(state, n1, n2, length, u1, u2, r1, r2)
            spring = friction - load(state.friction_force, k)
            slip = fma(spring, load(laws.stick_flexibility, k), slip)
            s = contact.support[point]
            store(tally.sliding_work, s, fma(normal, magnitude(slip), load(tally.sliding_work, s)))
            if laws.land[k] >= 0:
                tally_land(contact, laws, tally, k, (u1, u2), normal * magnitude(slip))
        store(state.friction_force, k, friction)


@inlined
def tally_land(contact, laws, tally, k, u, sliding):
    """Add the sliding work of law k to its land; with lobes to the land nearest to u."""
    lands = laws.lobes[k]
    if lands == 0:
        add_to(tally.land_work, laws.land[k], sliding)
        return
    d1, d2, _ = radial_offset(contact, laws.contact_point[k], u[0], u[1])
    cos_angle, sin_angle = load(laws.lobe_cosine, k), load(laws.lobe_sine, k)
    c = fma(d1, cos_angle, d2 * sin_angle)  # along the direction of a land, and across it
    s = fma(d2, cos_angle, -(d1 * sin_angle))
    half = math.pi / lands
    cos_half, sin_half = spread(math.cos(half)), spread(math.sin(half))
    cos_next, sin_next = spread(math.cos(2.0 * half)), spread(math.sin(2.0 * half))
    for land in range(lands):
        near = c * sin_half > magnitude(s) * cos_half
        add_to(tally.land_work, laws.land[k] + land, where(near, sliding, 0.0))
        c, s = fma(c, cos_next, s * sin_next), fma(s, cos_next, -(c * sin_next))


@inlined
def tally_element(laws, state, tally, work, e):
    """Add the work of element e and the slip of its slider, and advance the slider's force."""
    r = laws.element_row[e]
    u, f, slider = load(work.u, r), load(work.force, r), load(work.slider_force, e)
    du = u - load(state.row_displacement, r)
    done = 0.5 * (f + load(state.row_force, r)) * du
    add_to(tally.contact_work, 0, done)
    add_to(tally.element_work, e, done)
    slip = fma(slider - load(state.slider_force, e), load(laws.slider_flexibility, e), du)
    store(tally.slip_work, e, fma(magnitude(slider), magnitude(slip), load(tally.slip_work, e)))
    store(tally.force_displacement, r, fma(f, u, load(tally.force_displacement, r)))
    store(state.slider_force, e, slider)


@inlined
def tally_stress(modal, state, tally, output, phase, channels):
    """Add the stresses at the end of the step. Taken before the output filter, which would smooth
    the impacts away.
    """
    sections, weight = tally.peak_square_stress.size // LANES, spread(output.stress_weight[phase])
    for c in range(output.stress_start, output.stress_start + 2 * sections):
        store(channels, c, 0.0)
    first_mode = phase * modal.mode_start[-1]
    for g in range(modal.mode_start.size - 1):
        if state.group_active[g] != 0:
            entries = (output.stress_entry[g], output.channel_start[g + 1])
            project_channels(modal, g, output, state.q, first_mode, entries, channels)
    for s in range(sections):
        s1 = load(channels, output.stress_start + 2 * s)
        s2 = load(channels, output.stress_start + 2 * s + 1)
        square = fma(s1, s1, s2 * s2)
        store(tally.square_stress, s, fma(weight, square, load(tally.square_stress, s)))
        raise_to(tally.peak_square_stress, s, square)


@inlined
def tally_displacement(modal, state, contact, tally):
    """Add the moments of the row displacements and velocities; False when a lane has diverged: a
    row is beyond the limit or not a number.
    """
    within = in_every_lane(True)
    per_step = 1.0 / modal.dt
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            u = load(state.row_displacement, r)
            store(tally.square_displacement, r, fma(u, u, load(tally.square_displacement, r)))
            within = within & (contact.limit > magnitude(u))
            add_to(tally.displacement_sum, r, u)
            v = per_step * (u - load(state.row_displacement_before, r))
            store(tally.square_velocity, r, fma(v, v, load(tally.square_velocity, r)))
    for p in range(contact.row_1.size):
        r1, r2 = contact.row_1[p], contact.row_2[p]
        u1, u2 = load(state.row_displacement, r1), load(state.row_displacement, r2)
        v1 = per_step * (u1 - load(state.row_displacement_before, r1))
        v2 = per_step * (u2 - load(state.row_displacement_before, r2))
        product = load(tally.product_displacement, p)
        store(tally.product_displacement, p, fma(u1, u2, product))
        store(tally.product_velocity, p, fma(v1, v2, load(tally.product_velocity, p)))
    return all_lanes(within)
