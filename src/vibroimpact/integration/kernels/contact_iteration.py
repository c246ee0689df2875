"""The implicit contact equation of a step, u = u_free + G f(u), solved by fixed-point iteration."""

from .compiled import inlined
from .force_laws import all_forces, elastic_circle_force, penetration, radial_offset
from .lanes import (
    LANES,
    all_lanes,
    any_lane,
    fma,
    in_every_lane,
    load,
    magnitude,
    raise_to,
    spread,
    spread_from,
    store,
    where,
)
from .panels import PANEL, store_tile, tile_plus_vector, tile_zero
from .tables import QUIET, STEPS_WITHOUT_FORCE

NO_FORCE = 1e-300  # N, below which a force is none


@inlined
def apply_compliance(modal, force, deflection, bearing):
    """deflection = G force on the contact and element rows of every group, each (row, lane); five
    rows at a time, of one run PANEL rows. Rows without a force in any lane add nothing.

    bearing: room for the numbers of the rows with a force.
    """
    G = modal.row_compliance
    for g in range(modal.row_start.size - 1):
        row0, row_f = modal.row_start[g], modal.force_row_start[g]
        count = rows_with_force(force, row0, row_f, bearing)
        if LANES == 1:
            at = modal.block_compliance_start[g]
            for r in range(row0, row_f, PANEL):
                rows = tile_zero()
                for k in range(count):
                    s = bearing[k]
                    from_force = at + (s - row0) * PANEL
                    rows = tile_plus_vector(
                        modal.block_compliance, from_force, load(force, s), rows
                    )
                at += (row_f - row0) * PANEL
                store_tile(deflection, r, rows)
            continue
        stride = modal.row_start[g + 1] - row0
        at = modal.compliance_start[g] - row0
        r = row0
        while r + 5 <= row_f:
            a, b, c, d, e = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            for k in range(count):
                s = bearing[k]
                f = load(force, s)
                a = fma(spread_from(G, at + s), f, a)
                b = fma(spread_from(G, at + stride + s), f, b)
                c = fma(spread_from(G, at + 2 * stride + s), f, c)
                d = fma(spread_from(G, at + 3 * stride + s), f, d)
                e = fma(spread_from(G, at + 4 * stride + s), f, e)
            store(deflection, r, a)
            store(deflection, r + 1, b)
            store(deflection, r + 2, c)
            store(deflection, r + 3, d)
            store(deflection, r + 4, e)
            r += 5
            at += 5 * stride
        while r < row_f:
            a = spread(0.0)
            for k in range(count):
                a = fma(spread_from(G, at + bearing[k]), load(force, bearing[k]), a)
            store(deflection, r, a)
            r += 1
            at += stride


@inlined
def rows_with_force(force, first, end, bearing):
    """Put the numbers of the rows from first to end with a force in any lane into ``bearing``;
    their number. One that is not a number counts as a force.
    """
    count = 0
    for r in range(first, end):
        if not all_lanes(spread(NO_FORCE) > magnitude(load(force, r))):
            bearing[count] = r
            count += 1
    return count


@inlined
def solve_contact(modal, contact, laws, special, state, tally, work):
    """Forces and displacements of the contact and element rows at the end of the step, to
    work.force, work.deflection and work.u; True if a force may act in any lane.

    special: there are Laws. Without them, if nothing is near and no force has acted for QUIET
    steps, nothing is written: u is u_free, and all forces are zero as they were.
    """
    near = lanes_in_contact(contact, laws, work)
    any_near = any_lane(near)
    if not special and not any_near and state.counter[STEPS_WITHOUT_FORCE] >= QUIET:
        return False
    extrapolate_forces(modal, state, work, near)
    if not any_near:
        return False
    fixed_point(modal, contact, laws, special, near, state, tally, work)
    return True


@inlined
def lanes_in_contact(contact, laws, work):
    """Mask of the lanes in which a force may act: a point penetrates at u_free, or there is an
    element.
    """
    near = in_every_lane(laws.element_row.size > 0)
    for p in range(contact.row_1.size):
        if contact.plain[p] == 0:
            continue
        u1, u2 = load(work.u_free, contact.row_1[p]), load(work.u_free, contact.row_2[p])
        _, _, r_squared = radial_offset(contact, p, u1, u2)
        gap = load(contact.gap, p)
        near = near | (r_squared > gap * gap)
    for k in range(laws.contact_point.size):
        point = laws.contact_point[k]
        u1, u2 = load(work.u_free, contact.row_1[point]), load(work.u_free, contact.row_2[point])
        _, _, _, p = penetration(contact, laws, k, u1, u2)
        near = near | (p > 0.0)
        store(work.friction_force, k, 0.0)
    return near


@inlined
def extrapolate_forces(modal, state, work, near):
    """Start the iteration: forces and deflections extrapolated from the last two steps in the lanes
    of the mask, zero in the others.
    """
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            f, d = load(state.row_force, r), load(state.row_deflection, r)
            f = where(near, f + f - load(state.row_force_before, r), 0.0)
            d = where(near, d + d - load(state.row_deflection_before, r), 0.0)
            store(work.force, r, f)
            store(work.deflection, r, d)
            store(work.u, r, load(work.u_free, r) + d)


@inlined
def fixed_point(modal, contact, laws, special, iterating, state, tally, work):
    """Iterate f = f(u), u = u_free + G f until the forces of every lane have converged.

    Each lane by itself: once its forces change by less than the tolerance it is frozen, so it does
    not see how many passes its neighbours need. The contraction of the iteration is checked before
    a run (contact_convergence).
    """
    last_change, size = spread(0.0), spread(0.0)
    for k in range(laws.contact_point.size):
        store(work.frozen_friction_force, k, 0.0)
    for _ in range(contact.max_passes):
        if special:
            change, size = update_all_forces(modal, contact, laws, state, work, iterating)
        else:
            change, size = update_plain_forces(contact, work, iterating)
        last_change = where(iterating, change, last_change)
        apply_compliance(modal, work.force, work.deflection, work.bearing)
        for g in range(modal.row_start.size - 1):
            for r in range(modal.row_start[g], modal.force_row_start[g]):
                store(work.u, r, load(work.u_free, r) + load(work.deflection, r))
        iterating = iterating & (change > contact.tolerance * size)
        if not any_lane(iterating):
            break
    for k in range(laws.contact_point.size):
        store(work.friction_force, k, load(work.frozen_friction_force, k))
    for e in range(laws.element_row.size):
        store(work.slider_force, e, load(work.frozen_slider_force, e))
    raise_to(tally.residual, 0, where(size > 0.0, last_change / size, 0.0))


@inlined
def update_plain_forces(contact, work, iterating):
    """Put the forces of elastic circles at work.u into work.force in the iterating lanes; sums of
    their absolute change and of their size: (change, size).
    """
    change, size = spread(0.0), spread(0.0)
    for p in range(contact.row_1.size):
        r1, r2 = contact.row_1[p], contact.row_2[p]
        f1, f2 = elastic_circle_force(contact, p, load(work.u, r1), load(work.u, r2))
        old1, old2 = load(work.force, r1), load(work.force, r2)
        f1, f2 = where(iterating, f1, old1), where(iterating, f2, old2)
        change = change + magnitude(f1 - old1) + magnitude(f2 - old2)
        size = size + magnitude(f1) + magnitude(f2)
        store(work.force, r1, f1)
        store(work.force, r2, f2)
    return change, size


@inlined
def update_all_forces(modal, contact, laws, state, work, iterating):
    """update_plain_forces if there are Laws: all contacts and elements."""
    change, size = spread(0.0), spread(0.0)
    all_forces(modal, contact, laws, state, work, work.u)
    for k in range(laws.contact_point.size):
        frozen = load(work.frozen_friction_force, k)
        frozen = where(iterating, load(work.friction_force, k), frozen)
        store(work.frozen_friction_force, k, frozen)
    for e in range(laws.element_row.size):
        frozen = load(work.frozen_slider_force, e)
        frozen = where(iterating, load(work.slider_force, e), frozen)
        store(work.frozen_slider_force, e, frozen)
    for g in range(modal.row_start.size - 1):
        for r in range(modal.row_start[g], modal.force_row_start[g]):
            old = load(work.force, r)
            f = where(iterating, load(work.new_force, r), old)
            change = change + magnitude(f - old)
            size = size + magnitude(f)
            store(work.force, r, f)
    return change, size
