"""Convergence of the contact iteration of a step, and the error raised if it is too slow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .kernel_layout import ModalLayout

CONTRACTION_LIMIT = 0.75  # the passes of a step leave 1e-5 then
LARGEST_TURN = 1.0e6  # rad of a mode in a step; beyond, its phase has lost half of its digits
# damping x step of a mode under the exact scheme, whose shifted state (see modal_step) grows with
# exp(damping step / 2): at 40 it has lost half of its digits.
LARGEST_DECAY = 40.0


MOST_STEPS = 1.0e8  # per second, that integration.steps_per_second takes


def more_steps(needed: float) -> str:
    """Return the remedy of a step that is too long: more steps, as far as the key takes them."""
    if needed <= MOST_STEPS:
        return f"raise integration.steps_per_second to at least {int(np.ceil(needed))}"
    return (
        f"no integration.steps_per_second is enough ({needed:.2g} would be, at most"
        f" {MOST_STEPS:g} are taken): lower that stiffness or damping"
    )


class IntegrationError(Exception):
    """A run that cannot be done, or that diverged; the message names the place and the remedy.

    case: number of the case in the batch, None for all.
    """

    def __init__(self, message: str, case: int | None = None):
        super().__init__(message)
        self.case = case

    def of(self, cases: Sequence[object]) -> IntegrationError:
        """Return the error with its case, one of the batch's, named before the message."""
        if self.case is None:
            return self
        return IntegrationError(f"{cases[self.case]}: {self}", self.case)


def contact_contraction(model: ModalModel, dt: float, scheme: str = "newmark") -> float:
    """Upper bound of the factor by which one pass of the contact iteration shrinks its error.

    The largest eigenvalue of the step's compliance times the tangent stiffness of all contacts and
    elements, all engaged at once; a damper counts by its velocity per displacement. Terms that grow
    with the motion (cubic, drag, Hunt-Crossley) are left out: for them see the residual of the
    iteration in every record. dt in s.
    """
    layout = ModalLayout(model, scheme)
    modal, own, local = layout.modal(dt), model.contact_laws, model.local_laws
    stiffness = np.zeros(modal.row_force_channel.size)
    rate = modal.velocity_weights[0]  # velocity per displacement
    radial = np.where(own.hertz > 0.0, 0.0, model.contact_stiffness) + rate * own.damping
    tangential = np.where(own.friction > 0.0, own.stick_stiffness, 0.0)
    for direction in range(2):
        stiffness[layout.contact_rows()[:, direction]] = np.maximum(radial, tangential)
    stick = np.where(local.slip_limit != 0.0, local.stick_stiffness, 0.0)
    stiffness[layout.element_rows()] = (
        np.abs(local.stiffness)
        + rate * np.abs(local.damping)
        + stick
        + np.abs(local.saturation_stiffness)
    )
    largest = 0.0
    for g in range(modal.row_start.size - 1):
        row, end = modal.row_start[g], modal.force_row_start[g]
        if end == row:
            continue
        start, rows = modal.compliance_start[g], modal.row_start[g + 1] - row
        compliance = modal.row_compliance[start : start + rows * rows].reshape(rows, rows)[
            : end - row, : end - row
        ]
        weight = np.sqrt(stiffness[row:end])
        largest = max(largest, np.linalg.eigvalsh(weight[:, None] * compliance * weight)[-1])
    return float(largest)


def checked_contraction(
    model: ModalModel, steps_per_second: float, scheme: str = "newmark"
) -> float:
    """The contraction factor of the contact iteration.

    Raises IntegrationError above CONTRACTION_LIMIT, with the steps per second that are needed, and
    for a mode without a phase or with too much damping.
    """
    _require_digits(model, steps_per_second, scheme)
    contraction = contact_contraction(model, 1.0 / steps_per_second, scheme)
    if not contraction <= CONTRACTION_LIMIT:  # NaN if the step has no numbers for a mode
        largest = max(
            model.contact_stiffness.max(initial=0.0),
            np.abs(model.local_laws.stiffness).max(initial=0.0),
        )
        raise IntegrationError(
            f"contact stiffness {largest:.3g} N/m is too stiff for a step of"
            f" {1 / steps_per_second:.3g} s: the contact iteration contracts by {contraction:.2g}"
            f" only (limit {CONTRACTION_LIMIT}; the stiffness is that of a point of"
            " supports.stiffness_N_per_m or of an element; dampers, friction springs and light"
            " plates count too):"
            f" {more_steps(steps_per_second * np.sqrt(contraction / CONTRACTION_LIMIT))}"
        )
    return contraction


def _require_digits(model: ModalModel, steps_per_second: float, scheme: str) -> None:
    """Raise IntegrationError for a mode whose step has no digits left."""
    highest = model.omega.max(initial=0.0)
    if highest > LARGEST_TURN * steps_per_second:
        raise IntegrationError(
            f"integration.steps_per_second = {steps_per_second:g}: a mode of"
            f" {highest / (2.0 * np.pi):.3g} Hz turns by {highest / steps_per_second:.3g} rad in a"
            f" step, at most {LARGEST_TURN:g}: make it softer or heavier (contact points"
            " closer than the tube is wide, by height_m over points; a support's plate; a"
            " mode_frequency_factor; the matrices)"
        )
    strongest = model.damping.max(initial=0.0)
    if scheme == "exact" and strongest > LARGEST_DECAY * steps_per_second:
        mode = model.omega[np.argmax(model.damping)] / (2.0 * np.pi)
        raise IntegrationError(
            f"integration.steps_per_second = {steps_per_second:g}: the mode at {mode:.3g} Hz decays"
            f" by exp(-{strongest / steps_per_second:.3g}) in a step of the exact scheme, at most"
            f" exp(-{LARGEST_DECAY:g}): {more_steps(strongest / LARGEST_DECAY)}, give less damping"
            " (modal in place of rayleigh), or integration.scheme: newmark"
        )
