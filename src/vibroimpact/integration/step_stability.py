"""Whether a step keeps a structure on linear springs and dampers from growing by itself.

The exact step takes a mode at any frequency, but the velocity at a contact or damper comes from
displacements of past steps: for a mode that turns by more than about pi in a step it has the wrong
sign, and a damper feeds the mode. Springs alone do so for a mode just below pi.
"""

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .contact_convergence import IntegrationError, more_steps
from .kernel_layout import ModalLayout
from .modal_step import step_coefficients, step_matrices

# Of a step. A run has about 1e6 steps: in all of them, a motion that grows by less does not double.
LARGEST_GROWTH = 1.0e-6
LARGEST_FEEDBACK = 0.02  # of a fluid-elastic force, by the motion of a step under it
SAFE_OMEGA_STEP = 2.0  # rad, of the highest mode: no growth was seen below


def step_growth(model: ModalModel, dt: float, scheme: str) -> float:
    """Return the largest growth of a motion in a step, minus twice that of the structure itself.

    All contacts and elements act as the springs and dampers that they are for small motion: once
    all contacts engaged, once all open. Hertz, Hunt-Crossley, cubic and drag terms are left out.

    dt: s. scheme: "exact" or "newmark".
    """
    layout, largest = ModalLayout(model, scheme), 0.0
    for (modes, _), shapes in zip(layout.groups, layout.implicit_shapes, strict=True):
        if not shapes:
            continue
        omega, damping = model.omega[modes], model.damping[modes]
        rows = np.array(list(shapes.values())).reshape(-1, len(modes)).T
        for engaged in (True, False):
            springs, dampers = _row_coefficients(model, list(shapes), engaged)
            acting = (springs != 0.0) | (dampers != 0.0)
            if acting.any():
                laws = rows[:, acting], springs[acting], dampers[acting]
                step = _step_matrix(scheme, (omega, damping), laws, dt)
                if not np.isfinite(step).all():
                    return np.inf
                grown = float(np.abs(np.linalg.eigvals(step)).max()) - 1.0
                own = np.expm1(dt * max(_growth_rate(omega, damping, laws), 0.0))
                # A motion that grows by itself may grow up to twice as fast in steps.
                largest = max(largest, grown - 2.0 * own)
    return largest


def fluid_feedback(model: ModalModel, dt: float, scheme: str) -> float:
    """Return the largest relative change of the fluid-elastic forces by the motion of a step under
    them. A step takes them from a predicted motion, see kernels.fluid.
    """
    laws, step = model.fluid_laws, step_coefficients(scheme, model.omega, model.damping, dt)
    drag = step.velocity_weights[0] * np.abs(laws.damping)
    weight = np.sqrt(np.abs(laws.stiffness) + drag + np.abs(laws.lag_stiffness).sum(axis=1))
    rows = model.fluid_shapes * weight
    values = np.linalg.eigvalsh(rows.T @ (step.mode_compliance[:, None] * rows))
    return float(values.max(initial=0.0))


def require_stable_step(model: ModalModel, steps_per_second: float, scheme: str) -> None:
    """Raise IntegrationError if the step makes a motion grow by itself.

    The message has the steps per second that are enough.
    """
    feedback = fluid_feedback(model, 1.0 / steps_per_second, scheme)
    if feedback > LARGEST_FEEDBACK:
        fastest = model.fluid_laws.velocity.max()
        raise IntegrationError(
            f"integration.steps_per_second = {steps_per_second:g}: in the flow of {fastest:.3g} m/s"
            f" a step changes the fluid-elastic force by {feedback:.2g} of itself, at most"
            f" {LARGEST_FEEDBACK:g}: {more_steps(steps_per_second * feedback / LARGEST_FEEDBACK)}"
        )
    growth = step_growth(model, 1.0 / steps_per_second, scheme)
    if growth > LARGEST_GROWTH:
        highest = model.omega.max()
        raise IntegrationError(
            f"integration.steps_per_second = {steps_per_second:g}: on the springs and dampers of"
            f" the contacts and elements, a motion grows by {growth:.2g} in every step of the"
            f" {scheme} scheme (the highest mode has {highest / (2.0 * np.pi):.4g} Hz, omega x"
            f" step = {highest / steps_per_second:.3g}): {more_steps(highest / SAFE_OMEGA_STEP)},"
            " or give integration.scheme: newmark"
        )


def _row_coefficients(
    model: ModalModel, rows: list, engaged: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return (springs in N/m, dampers in N s/m), each (row,), of small motion.

    rows: (contact point, direction) or the number of an element, see kernel_layout.RowKey.
    """
    own, local = model.contact_laws, model.local_laws
    radial = np.where(own.hertz > 0.0, 0.0, model.contact_stiffness)
    contact = np.maximum(radial, np.where(own.friction > 0.0, own.stick_stiffness, 0.0)) * engaged
    element = (
        local.stiffness
        + np.where(local.slip_limit != 0.0, local.stick_stiffness, 0.0)
        + local.saturation_stiffness
    )
    springs, dampers = np.zeros(len(rows)), np.zeros(len(rows))
    for place, row in enumerate(rows):
        if isinstance(row, tuple):
            springs[place], dampers[place] = contact[row[0]], own.damping[row[0]] * engaged
        else:
            springs[place], dampers[place] = element[row], local.damping[row]
    return springs, dampers


Laws = tuple[np.ndarray, np.ndarray, np.ndarray]


def _growth_rate(omega: np.ndarray, damping: np.ndarray, laws: Laws) -> float:
    """Return the largest growth rate in 1/s of the structure itself, in continuous time."""
    rows, springs, dampers = laws
    system = np.block(
        [
            [np.zeros((omega.size, omega.size)), np.eye(omega.size)],
            [
                -np.diag(omega**2) - (rows * springs) @ rows.T,
                -np.diag(damping) - (rows * dampers) @ rows.T,
            ],
        ]
    )
    return float(np.linalg.eigvals(system).real.max())


def _step_matrix(
    scheme: str, modes: tuple[np.ndarray, np.ndarray], laws: Laws, dt: float
) -> np.ndarray:
    """Return the matrix of a step on modal displacements, velocities dt, row forces and memories.

    The velocity of a row is v = w0 du + w1 m, see modal_step; its force -(k u + c v).

    modes: (omega, damping), each (mode,).
    laws: rows (mode, row), springs and dampers (row,).
    """
    rows, springs, dampers = laws
    count, size = rows.shape[1], modes[0].size
    unit = np.array([1.0, dt])
    A, g0, g1 = step_matrices(scheme, *modes, dt)
    A, g0, g1 = A * unit[:, None, None] / unit[:, None], g0 * unit[:, None], g1 * unit[:, None]
    w = step_coefficients(scheme, *modes, dt).velocity_weights
    none, q = np.zeros((count, size)), slice(0, size)
    # Rows of the state before the step: displacement of the rows, their forces and memories.
    before = np.hstack([rows.T, none, np.zeros((count, 2 * count))])
    force = np.hstack([none, none, np.eye(count), np.zeros((count, count))])
    memory = np.hstack([none, none, np.zeros((count, count)), np.eye(count)])
    free = np.vstack(
        [
            np.hstack([np.diag(A[0, 0]), np.diag(A[0, 1])]),
            np.hstack([np.diag(A[1, 0]), np.diag(A[1, 1])]),
        ]
    )
    free = np.hstack([free, np.zeros((2 * size, 2 * count))])
    free += np.vstack([g0[0][:, None] * rows, g0[1][:, None] * rows]) @ force
    push = np.vstack([g1[0][:, None] * rows, g1[1][:, None] * rows])
    compliance = rows.T @ push[q]
    right = rows.T @ free[q]
    right += compliance @ (dampers[:, None] * (w[0] * before - w[1] * memory))
    moved = np.linalg.solve(np.eye(count) + compliance * (springs + w[0] * dampers), right)
    forces = -springs[:, None] * moved
    forces -= dampers[:, None] * (w[0] * (moved - before) + w[1] * memory)
    return np.vstack([free + push @ forces, forces, w[2] * (moved - before) + w[3] * memory])
