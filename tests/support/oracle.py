"""Slow twins: the same quantities from their definitions, for the compiled code to be held
against.
"""

import numpy as np
from scipy.signal import cont2discrete


def newmark_contact(model, gap, offset, drive, dt):
    """Contact-point displacement (step, contact_point, 2) and force on the structure (step,
    contact_point, 2).

    Textbook Newmark average acceleration in (q, v, a), dense, contact forces iterated to round-off
    at every step. gap m; offset (contact_point, 2) m; drive (step + 1, force_channel) N; from rest.
    """
    shapes = model.contact_shapes.reshape(model.omega.size, -1)
    q, v = np.zeros(model.omega.size), np.zeros(model.omega.size)
    a = model.drive_shapes @ drive[0]
    effective = 4.0 / dt**2 + 2.0 / dt * model.damping + model.omega**2
    contact = np.zeros(shapes.shape[1])
    out_u, out_f = [], []
    for force in drive[1:]:
        known = 4.0 / dt**2 * q + 4.0 / dt * v + a + model.damping * (2.0 / dt * q + v)
        for _ in range(200):
            q_new = (known + model.drive_shapes @ force + shapes @ contact) / effective
            new = radial_force(model, gap, offset, (shapes.T @ q_new).reshape(-1, 2)).ravel()
            settled = np.max(np.abs(new - contact)) <= 1e-13 * max(np.max(np.abs(new)), 1e-30)
            contact = new
            if settled:
                break
        a_new = 4.0 / dt**2 * (q_new - q) - 4.0 / dt * v - a
        v = v + 0.5 * dt * (a + a_new)
        q, a = q_new, a_new
        out_u.append((shapes.T @ q).reshape(-1, 2))
        out_f.append(contact.reshape(-1, 2))
    return np.array(out_u), np.array(out_f)


def exact_contact(model, gap, offset, drive, dt):
    """Like newmark_contact for the exact modal step: the ramp-invariant discrete system of
    scipy.signal, mode by mode.
    """
    systems = [
        cont2discrete(
            (
                np.array([[0.0, 1.0], [-(w**2), -c]]),
                np.array([[0.0], [1.0]]),
                np.eye(2),
                np.zeros((2, 1)),
            ),
            dt,
            "foh",
        )
        for w, c in zip(model.omega, model.damping, strict=True)
    ]
    A, B, through = (np.array([system[index] for system in systems]) for index in (0, 1, 3))
    B, through = B[..., 0], through[..., 0]
    shapes = model.contact_shapes.reshape(model.omega.size, -1)
    f = model.drive_shapes @ drive[0]
    x = -through * f[:, None]  # at rest under the first force
    contact = np.zeros(shapes.shape[1])
    out_u, out_f = [], []
    for force in drive[1:]:
        x = np.einsum("mij,mj->mi", A, x) + B * f[:, None]
        for _ in range(200):
            f = model.drive_shapes @ force + shapes @ contact
            u = shapes.T @ (x[:, 0] + through[:, 0] * f)
            new = radial_force(model, gap, offset, u.reshape(-1, 2)).ravel()
            settled = np.max(np.abs(new - contact)) <= 1e-13 * max(np.max(np.abs(new)), 1e-30)
            contact = new
            if settled:
                break
        f = model.drive_shapes @ force + shapes @ contact
        out_u.append((shapes.T @ (x[:, 0] + through[:, 0] * f)).reshape(-1, 2))
        out_f.append(contact.reshape(-1, 2))
    return np.array(out_u), np.array(out_f)


def radial_force(model, gap, offset, displacement):
    """Unilateral force of a circular obstacle on the structure (contact_point, 2), displacement
    likewise.
    """
    out = np.zeros_like(displacement)
    for p, stiffness in enumerate(model.contact_stiffness):
        arm = displacement[p] - offset[p] - model.centre_offset[p]
        distance = np.hypot(*arm)
        penetration = distance - gap * model.gap_factor[p]
        if penetration > 0.0:
            out[p] = -stiffness * penetration * arm / distance
    return out
