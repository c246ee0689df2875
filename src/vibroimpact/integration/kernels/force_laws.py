"""The force laws of contacts and local elements, and all forces at given displacements."""

from .compiled import inlined
from .lanes import (
    any_lane,
    clip,
    fma,
    inverse_square_root,
    larger,
    load,
    magnitude,
    smaller,
    spread,
    square_root,
    store,
    where,
)


@inlined
def radial_offset(contact, p, u1, u2):
    """Displacement at point p from the centre of its obstacle: (d1, d2, d1² + d2²)."""
    d1 = u1 - load(contact.offset_1, p)
    d2 = u2 - load(contact.offset_2, p)
    return d1, d2, fma(d1, d1, d2 * d2)


@inlined
def elastic_circle_force(contact, p, u1, u2):
    """Force on the structure at point p along its two directions: -k (r - gap) d / r if r > gap.

    No branch: with lanes of their own it would be predicted wrong too often.
    """
    d1, d2, r_squared = radial_offset(contact, p, u1, u2)
    gap = load(contact.gap, p)
    # k (gap / r - 1)
    force_per_offset = load(contact.stiffness, p) * fma(gap, inverse_square_root(r_squared), -1.0)
    force_per_offset = where(r_squared > gap * gap, force_per_offset, 0.0)
    return force_per_offset * d1, force_per_offset * d2


@inlined
def penetration(contact, laws, k, u1, u2):
    """Penetration of law k and its gradient: (n1, n2, length of the gradient, p), p < 0 when apart.

    Round: p = r - R(theta) with R = gap + depth (1 - cos(lobes (theta - angle))) / 2; the force
    -k p grad(p) has the potential k p² / 2 and acts along the normal of the profile. Cosine and
    sine of the multiple angle are powers of a complex number.
    """
    one = spread(1.0)
    d1, d2, r_squared = radial_offset(contact, laws.contact_point[k], u1, u2)
    gap = load(laws.gap, k)
    if laws.flat[k] != 0:
        n1, n2 = load(laws.normal_1, k), load(laws.normal_2, k)
        return n1, n2, one, fma(n1, d1, n2 * d2) - gap
    inverse_r = inverse_square_root(r_squared)
    n1, n2 = d1 * inverse_r, d2 * inverse_r
    r = r_squared * inverse_r
    if laws.lobes[k] == 0:
        return n1, n2, one, r - gap
    cos_angle, sin_angle = load(laws.lobe_cosine, k), load(laws.lobe_sine, k)
    c1 = fma(n1, cos_angle, n2 * sin_angle)  # cosine and sine of theta - angle
    s1 = fma(n2, cos_angle, -(n1 * sin_angle))
    c, s = c1, s1
    for _ in range(laws.lobes[k] - 1):
        c, s = fma(c, c1, -(s * s1)), fma(s, c1, c * s1)
    half_depth = 0.5 * load(laws.lobe_depth, k)
    slope = half_depth * spread(1.0 * laws.lobes[k]) * s * inverse_r  # dR/dtheta / r
    return (
        fma(slope, n2, n1),
        fma(-slope, n1, n2),
        square_root(fma(slope, slope, 1.0)),
        r - fma(half_depth, 1.0 - c, gap),
    )


@inlined
def normal_force(laws, k, motion, dt):
    """Force of law k per unit gradient of the penetration, never negative; motion as
    penetration_motion gives it.

    Kelvin-Voigt counts from the part of the step spent in contact, min(c p_rate, c p / dt) while
    closing: it begins at 0, and the implicit equation has a solution at every first touch. Half of
    c p_rate is added a step later: as forces are linear within a step, the damper has then given
    c p in all.
    """
    p, p_rate, last_p, last_rate = motion
    p = larger(p, spread(0.0))
    force = p * fma(load(laws.hertz, k), square_root(p), load(laws.stiffness, k))
    force = force * larger(fma(load(laws.hunt_crossley, k), p_rate, 1.0), spread(0.0))
    c = load(laws.damping, k)
    first_touch = (last_p > 0.0) & (dt * last_rate > last_p)
    missed = where(first_touch, 0.5 * last_rate, 0.0)
    return larger(force + c * (smaller(p_rate, p * (1.0 / dt)) + missed), spread(0.0))


@inlined
def friction_force(laws, state, k, slip, normal):
    """Force along the tangent (-n2, n1) of law k: elastic stick spring from the last step's force,
    limited to the friction coefficient times the normal force.
    """
    trial = fma(-load(laws.stick_stiffness, k), slip, load(state.friction_force, k))
    return clip(trial, load(laws.friction, k) * normal)


@inlined
def element_force(laws, state, e, u, du, v, speed):
    """Force of local element e on the structure, and of its slider alone: (force, slider).

    u, du, v: displacement, its increment over the step, velocity; speed: for the drag.
    """
    slider = fma(-load(laws.slider_stiffness, e), du, load(state.slider_force, e))
    slider = clip(slider, load(laws.slip_limit, e))
    stiffness = fma(
        u, fma(u, load(laws.cubic, e), load(laws.quadratic, e)), load(laws.element_stiffness, e)
    )
    damper = clip(load(laws.element_damping, e) * v, load(laws.damping_limit, e))
    braking = fma(load(laws.drag, e) * speed, v, damper)
    saturating = clip(load(laws.saturation_stiffness, e) * u, load(laws.saturation_limit, e))
    return slider - fma(stiffness, u, braking) - saturating, slider


@inlined
def row_velocity(modal, state, u, r):
    """End-of-step velocity of row r from its displacement and State.row_velocity of the last
    step.

    Newmark: 2 du/dt less the last velocity, exact for the scheme. Exact modal step: second-order
    backward difference 1.5 du/dt - 0.5 (du/dt of the last step).
    """
    du = u - load(state.row_displacement, r)
    return fma(
        spread(modal.velocity_weights[0]),
        du,
        modal.velocity_weights[1] * load(state.row_velocity, r),
    )


@inlined
def penetration_motion(modal, state, n1, n2, p, u1, u2, r1, r2):
    """A penetration p with the gradient (n1, n2) and its rate, at the end of a step and at the end
    of the last one: (p, p_rate, last_p, last_rate).
    """
    rate = fma(n1, row_velocity(modal, state, u1, r1), n2 * row_velocity(modal, state, u2, r2))
    du1 = u1 - load(state.row_displacement, r1)
    du2 = u2 - load(state.row_displacement, r2)
    last_rate = fma(n1, load(state.row_velocity, r1), n2 * load(state.row_velocity, r2))
    return p, rate, p - fma(n1, du1, n2 * du2), last_rate


@inlined
def tangential_slip(state, n1, n2, length, u1, u2, r1, r2):
    """Displacement over the step along the tangent (-n2, n1) / length."""
    du1 = u1 - load(state.row_displacement, r1)
    du2 = u2 - load(state.row_displacement, r2)
    return fma(n1, du2, -(n2 * du1)) / length


@inlined
def all_forces(modal, contact, laws, state, work, u):
    """Forces of every contact and element at displacements u (row, lane), to work.new_force; those
    of friction and sliders to work.friction_force and work.slider_force.
    """
    for p in range(contact.row_1.size):
        r1, r2 = contact.row_1[p], contact.row_2[p]
        f1, f2 = spread(0.0), spread(0.0)
        if contact.plain[p] != 0:
            f1, f2 = elastic_circle_force(contact, p, load(u, r1), load(u, r2))
        store(work.new_force, r1, f1)
        store(work.new_force, r2, f2)
    for k in range(laws.contact_point.size):
        add_contact_law(modal, contact, laws, state, work, u, k)
    for e in range(laws.element_row.size):
        r = laws.element_row[e]
        ur = load(u, r)
        v = row_velocity(modal, state, ur, r)
        speed, partner = magnitude(v), laws.partner_row[e]
        if partner >= 0:
            w = row_velocity(modal, state, load(u, partner), partner)
            speed = square_root(fma(v, v, w * w))
        du = ur - load(state.row_displacement, r)
        force, slider = element_force(laws, state, e, ur, du, v, speed)
        store(work.new_force, r, force)
        store(work.slider_force, e, slider)


@inlined
def add_contact_law(modal, contact, laws, state, work, u, k):
    """Add the force of contact law k at displacements u to work.new_force."""
    point = laws.contact_point[k]
    r1, r2 = contact.row_1[point], contact.row_2[point]
    u1, u2 = load(u, r1), load(u, r2)
    n1, n2, length, p = penetration(contact, laws, k, u1, u2)
    if not any_lane(p > 0.0):
        store(work.friction_force, k, 0.0)
        return
    motion = penetration_motion(modal, state, n1, n2, p, u1, u2, r1, r2)
    f = normal_force(laws, k, motion, modal.dt)
    slip = tangential_slip(state, n1, n2, length, u1, u2, r1, r2)
    friction = friction_force(laws, state, k, slip, f * length)
    store(work.friction_force, k, friction)
    t = friction / length
    store(work.new_force, r1, load(work.new_force, r1) - fma(f, n1, t * n2))
    store(work.new_force, r2, load(work.new_force, r2) - fma(f, n2, -(t * n1)))
