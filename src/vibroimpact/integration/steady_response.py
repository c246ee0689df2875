"""The steady response to a periodic force of a model with local elements.

The elements are integrated by the kernel of every other simulation, first through some periods in
which the transient dies out, then through one that is recorded. The response anywhere follows at
the lines of the spectrum from the drive force and the elements' forces, without a further error.
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .batch import start_state, to_lanes
from .contact_convergence import IntegrationError, checked_contraction
from .entry_points import entry_points
from .kernel_layout import ModalLayout
from .kernels.decimation import RATIO, SLOTS
from .kernels.lanes import LANES
from .kernels.tables import STEPS_DONE

SCHEME = "exact"


@dataclass(frozen=True, eq=False)
class PeriodicDrive:
    """A force for each of up to LANES cases, all of one period.

    period: s.
    lines (case, line): complex amplitudes from line 0, N.
    steps: time steps per period.

    Raises ValueError if the kernel cannot step through it: steps that are not a multiple of RATIO
    or fewer than twice the lines, more than LANES cases.
    """

    period: float
    lines: np.ndarray
    steps: int

    def __post_init__(self) -> None:
        if self.steps % RATIO or self.steps < 2 * self.lines.shape[1] or len(self.lines) > LANES:
            raise ValueError(
                f"{self.steps} steps a period for {self.lines.shape[1]} lines and {len(self.lines)}"
                f" cases: give a multiple of {RATIO}, twice the lines or more, and at most {LANES}"
                " cases"
            )

    @property
    def omega(self) -> np.ndarray:
        """Angular frequency of each line: (line,) rad/s."""
        return 2.0 * np.pi / self.period * np.arange(self.lines.shape[1])

    def samples(self) -> np.ndarray:
        """The force at the steps 0, 1, ... of a period: (step, 1, LANES) N."""
        out = np.zeros((self.steps, 1, LANES))
        spectrum = np.zeros((len(self.lines), self.steps // 2 + 1), complex)
        spectrum[:, : self.lines.shape[1]] = self.lines * self.steps
        out[:, 0, : len(self.lines)] = np.fft.irfft(spectrum, self.steps).T
        return out


def steady_elements(
    model: ModalModel,
    drive: PeriodicDrive,
    samples: np.ndarray | None = None,
    periods_before: int = 1,
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (m) and force on the structure (N) of every local element in the steady state:
    complex amplitudes (element, case, line) each.

    samples: drive.samples(), if they are at hand.
    periods_before: periods before the one recorded. The start is the linear steady state without
        elements, so that few are needed.

    Raises IntegrationError: an element is too stiff for the step, or the run diverged.
    """
    count = drive.lines.shape[1]
    # Step j of the kernel ends at time (j + 1) dt.
    delay = np.exp(-2j * np.pi * np.arange(count) / drive.steps)
    displacement, force = (
        np.fft.rfft(values, axis=-1)[..., :count] * delay / drive.steps
        for values in steady_series(model, drive, samples, periods_before)
    )
    return displacement, force


def steady_series(
    model: ModalModel,
    drive: PeriodicDrive,
    samples: np.ndarray | None = None,
    periods_before: int = 1,
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement (m) and force on the structure (N) of every local element at every time step of
    a period of the steady state: (element, case, step) each, both of one instant.

    A law without memory is a curve in these. In amplitudes of some lines it is a loop: they lack
    its higher harmonics. Arguments and errors are those of steady_elements.
    """
    samples = drive.samples() if samples is None else samples
    rate = drive.steps / drive.period
    contraction = checked_contraction(model, rate, SCHEME)
    layout = ModalLayout(model, SCHEME)
    gap = to_lanes(np.ones(1), 1.0)
    contact = layout.contact(gap, np.zeros((*model.centre_offset.shape, LANES)), contraction)
    modal, laws = layout.modal(1.0 / rate), layout.laws(gap)
    state, tally, work = layout.state(), layout.tally(), layout.work()
    initial = _linear_steady_state(model, drive)
    state.slider_force[...] = _slider_force(model, initial[0])
    force = _with_dead_load(samples, layout)
    fluid = layout.fluid(modal, LANES)
    start_state(layout, modal, contact, laws, fluid, state, work, force[0], initial)
    force = np.ascontiguousarray(np.roll(force, -1, axis=0))
    output = layout.output(np.zeros((RATIO, SLOTS)), drive.steps // RATIO, rate)
    for period in range(periods_before + 1):
        trace = layout.trace(drive.steps if period == periods_before else 0)
        state.counter[STEPS_DONE] = 0  # the trace starts at step 0
        done = entry_points(LANES).march(
            modal,
            contact,
            laws,
            layout.hold(modal),
            fluid,
            state,
            tally,
            output,
            trace,
            work,
            force,
        )
        if done < drive.steps:
            raise IntegrationError(
                f"the steady response diverged in period {period}: the element's law has no bounded"
                " motion under this force"
            )
    rows, cases = layout.element_rows(), len(drive.lines)
    displacement, pushed = (
        values[rows][..., :cases].transpose(0, 2, 1) for values in (trace.displacement, trace.force)
    )
    return displacement, pushed


def _slider_force(model: ModalModel, displacement: np.ndarray) -> np.ndarray:
    """Force of each slider at modal displacements (mode, LANES), loaded from zero displacement, so
    that no preload is left: (element, LANES) N.
    """
    local = model.local_laws
    stiffness = np.where(local.slip_limit != 0.0, local.stick_stiffness, 0.0)
    trial = stiffness[:, None] * (model.element_shapes.T @ displacement)
    return np.clip(-trial, -local.slip_limit[:, None], local.slip_limit[:, None])


def _with_dead_load(samples: np.ndarray, layout: ModalLayout) -> np.ndarray:
    """The force (step, force_channel, LANES), with 1 for the dead load if the model has one."""
    dead_loads = layout.drive_shapes.shape[1] - 1
    ones = np.ones((len(samples), dead_loads, LANES))
    return np.ascontiguousarray(np.concatenate([samples, ones], axis=1))


def _linear_steady_state(model: ModalModel, drive: PeriodicDrive) -> tuple[np.ndarray, np.ndarray]:
    """Modal displacement and velocity (mode, LANES) at time 0 in the steady state without
    elements.
    """
    laplace = 1j * drive.omega
    response = model.drive_shapes[:, :1] / (
        laplace**2
        + laplace * model.damping[:, None]
        + np.maximum(model.omega[:, None] ** 2, 1.0e-30)
    )
    weight = np.where(np.arange(laplace.size) == 0, 1.0, 2.0)
    # A rigid-body mode has no static response.
    weight = weight * np.where((model.omega[:, None] == 0.0) & (laplace == 0.0), 0.0, 1.0)
    static = np.where(
        model.omega > 0.0, model.constant_force / np.maximum(model.omega, 1.0e-30) ** 2, 0.0
    )
    displacement = (weight * response) @ drive.lines.T
    velocity = (weight * laplace * response) @ drive.lines.T
    return to_lanes(displacement.real + static[:, None], 0.0), to_lanes(velocity.real, 0.0)
