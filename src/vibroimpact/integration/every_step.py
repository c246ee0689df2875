"""Every step of a short run, unfiltered, at each contact point and local element."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .batch import Drive, modal_energies, start_amplitudes, start_state, to_lanes
from .contact_convergence import IntegrationError, checked_contraction
from .entry_points import entry_points, lanes_of
from .kernel_layout import ModalLayout
from .kernels.decimation import RATIO, SLOTS
from .step_stability import require_stable_step
from .stored_energy import stored_energy

WORKS = ("input_work", "dissipated", "contact_work")  # that the kernel sums over a run


@dataclass
class Traces:
    """A batch of up to LANES short runs, step by step; step 0 is the initial state.

    time (step,) s.
    contact_displacement (case, contact_point, 2, step) m, contact_force: N on the structure.
    element_displacement (case, element, step) m, element_force: N on the structure.
    energy {term: (case,)} J over the whole run: input_work; dissipated by modal damping;
        contact_work done by contacts and elements; mechanical, the change of the energy of the
        modes; stored, the change of that in contacts and elements; in a flow fluid_work, its part
        of the input work.
    sliding_work (case, support) J: normal force times slip.
    slip_work (case, element) J: slider force times slip.
    """

    time: np.ndarray
    contact_displacement: np.ndarray
    contact_force: np.ndarray
    element_displacement: np.ndarray
    element_force: np.ndarray
    energy: dict[str, np.ndarray]
    sliding_work: np.ndarray
    slip_work: np.ndarray


def integrate_every_step(
    model: ModalModel,
    steps_per_second: float,
    steps: int,
    gap: np.ndarray,
    imperfection: np.ndarray,
    drive: Drive,
    scheme: str = "newmark",
    rest: np.ndarray | None = None,
) -> Traces:
    """Integrate up to LANES cases side by side from their initial state and record every step.

    steps: rounded up to a multiple of RATIO.
    gap (case,): m.
    imperfection (contact_point, 2, case): offset added to the centres of the obstacles, m.
    drive: gives the force at the times first / steps_per_second, ...; index 0 is the initial state.
    rest (mode, LANES): modal amplitudes from which the initial state counts; None for 0.

    Raises IntegrationError: the contact is too stiff for the step, or the step makes a motion grow
    by itself (before anything runs), or the run diverged.
    """
    require_stable_step(model, steps_per_second, scheme)
    contraction = checked_contraction(model, steps_per_second, scheme)
    cases, ticks = np.size(gap), -(-steps // RATIO)
    layout = ModalLayout(model, scheme, lanes_of(cases))
    modal, lanes_gap = layout.modal(1.0 / steps_per_second), to_lanes(gap, 1.0, layout.lanes)
    contact = layout.contact(lanes_gap, to_lanes(imperfection, 0.0, layout.lanes), contraction)
    laws = layout.laws(lanes_gap)
    state, tally, work = layout.state(), layout.tally(), layout.work()
    force = _forces(layout, drive, ticks * RATIO + 1, cases)
    fluid, start = layout.fluid(modal, cases), start_amplitudes(model, rest)
    start_state(layout, modal, contact, laws, fluid, state, work, force[0], start)
    start_displacement, start_force = state.row_displacement.copy(), state.row_force.copy()
    held_before = _held_energies(layout, modal, contact, laws, state)
    trace = layout.trace(ticks * RATIO)
    output = layout.output(np.zeros((RATIO, SLOTS)), ticks, steps_per_second)
    hold, later = layout.hold(modal), np.ascontiguousarray(force[1:])
    done = entry_points(layout.lanes).march(
        modal, contact, laws, hold, fluid, state, tally, output, trace, work, later
    )
    if done < ticks * RATIO:
        raise _diverged(done / steps_per_second, state.row_displacement[:, :cases])
    displacement = _with_start(start_displacement, trace.displacement)[:cases]
    force_on_rows = _with_start(start_force, trace.force)[:cases]
    contacts, elements = layout.contact_rows(), layout.element_rows()
    held = _held_energies(layout, modal, contact, laws, state)
    energy = {name: getattr(tally, name)[0] for name in WORKS}
    energy |= {name: held[name] - held_before[name] for name in held}
    energy |= {"fluid_work": tally.fluid_work[0]} if len(fluid.force) else {}
    return Traces(
        time=np.arange(ticks * RATIO + 1) / steps_per_second,
        contact_displacement=displacement[:, contacts],
        contact_force=force_on_rows[:, contacts],
        element_displacement=displacement[:, elements],
        element_force=force_on_rows[:, elements],
        energy={name: values[:cases] for name, values in energy.items()},
        sliding_work=tally.sliding_work[:, :cases].T,
        slip_work=tally.slip_work[:, :cases].T,
    )


def _held_energies(
    layout: ModalLayout, modal: Any, contact: Any, laws: Any, state: Any
) -> dict[str, np.ndarray]:
    """Return {term: (lane,)} J of the energies that modes, and contacts and elements, hold."""
    return {
        "mechanical": np.sum(modal_energies(layout, modal.dt, state), axis=0),
        "stored": stored_energy(contact, laws, state),
    }


def _diverged(time_s: float, displacement: np.ndarray) -> IntegrationError:
    """Return the error of the case that moved most, from the displacements (row, case)."""
    moved = np.abs(displacement)
    moved[~np.isfinite(moved)] = np.inf
    return IntegrationError(
        f"diverged at t = {time_s:.4f} s: raise integration.steps_per_second or check forces and"
        " stiffnesses",
        case=int(np.argmax(np.max(moved, axis=0))),
    )


def _forces(layout: ModalLayout, drive: Drive, count: int, cases: int) -> np.ndarray:
    """Return (count, force_channel, lane) N from the start on, and the dead load."""
    channels = layout.model.drive_shapes.shape[1]
    force = np.zeros((count, layout.drive_shapes.shape[1], layout.lanes))
    force[:, :channels, :cases] = drive(0, count)
    force[:, channels:] = 1.0  # the dead load, see ModalLayout.drive_shapes
    return force


def _with_start(start: np.ndarray, rest: np.ndarray) -> np.ndarray:
    """Return (lane, row, 1 + step) of a start (row, lane) and what follows, (row, step, lane)."""
    return np.concatenate([start[:, None], rest], axis=1).transpose(2, 0, 1)
