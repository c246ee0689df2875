"""The steady response of a model with local elements to a periodic force: its elements' motion and
force over one period.

The elements are integrated by the kernel of every other simulation, through some periods that let
the transient die out and then one that is kept; the response anywhere follows at the lines of the
spectrum from the force and the elements' forces, without a further error.
"""

from dataclasses import dataclass

import numpy as np

from .batch import start_state, to_lanes
from .contact_convergence import IntegrationError, checked_contraction
from .kernel_layout import ModalLayout
from .kernels.decimation import RATIO, SLOTS
from .kernels.lanes import LANES
from .kernels.march import march
from .kernels.tables import STEPS_DONE

SCHEME = "exact"


@dataclass(frozen=True, eq=False)
class PeriodicDrive:
    """A force for each of up to LANES cases with one period: period s; lines (case, line) complex
    amplitudes from line 0; steps a period.
    """

    period: float
    lines: np.ndarray
    steps: int

    def __post_init__(self):
        """Refuse what the kernel can not step through."""
        if self.steps % RATIO or self.steps < 2 * self.lines.shape[1] or len(self.lines) > LANES:
            raise ValueError(
                f"{self.steps} steps a period for {self.lines.shape[1]} lines and {len(self.lines)}"
                f" cases: give a multiple of {RATIO}, twice the lines or more, and at most {LANES}"
                " cases"
            )

    @property
    def omega(self):
        """Return (line,) rad/s."""
        return 2.0 * np.pi / self.period * np.arange(self.lines.shape[1])

    def samples(self):
        """Return (step, 1, LANES) the force at the steps 0, 1, ... of a period."""
        out = np.zeros((self.steps, 1, LANES))
        spectrum = np.zeros((len(self.lines), self.steps // 2 + 1), complex)
        spectrum[:, : self.lines.shape[1]] = self.lines * self.steps
        out[:, 0, : len(self.lines)] = np.fft.irfft(spectrum, self.steps).T
        return out


def steady_elements(model, drive, samples=None, periods_before=1):
    """Return (displacement, force): complex lines (element, case, line) m and N on the structure of
    every local element, in the steady state.

    Starts in the linear steady state without elements, so that few periods_before are needed.
    samples: drive.samples(), when at hand. Raises IntegrationError: too stiff for the step, or
    diverged.
    """
    samples = drive.samples() if samples is None else samples
    rate = drive.steps / drive.period
    contraction = checked_contraction(model, rate, SCHEME)
    layout = ModalLayout(model, SCHEME)
    gap = to_lanes(np.ones(1), 1.0)
    modal = layout.modal(1.0 / rate)
    state = layout.state()
    tally = layout.tally()
    work = layout.work()
    contact = layout.contact(gap, np.zeros((*model.centre_offset.shape, LANES)), contraction)
    laws = layout.laws(gap)
    initial = _linear_steady(model, drive)
    local = model.local_laws
    stuck = np.where(local.slip_limit != 0.0, local.stick_stiffness, 0.0)[:, None] * (
        model.element_shapes.T @ initial[0]
    )
    state.slider_force[...] = np.clip(
        -stuck, -local.slip_limit[:, None], local.slip_limit[:, None]
    )  # as if loaded from nothing: no preload is left
    start_state(
        layout, modal, contact, laws, state, work, _with_dead_load(samples[:1], layout)[0], initial
    )
    ahead = _with_dead_load(np.roll(samples, -1, axis=0), layout)
    output = layout.output(np.zeros((RATIO, SLOTS)), drive.steps // RATIO, rate)
    for period in range(periods_before + 1):
        trace = layout.trace(drive.steps if period == periods_before else 0)
        state.counter[STEPS_DONE] = 0  # the trace starts at step 0
        if march(modal, contact, laws, state, tally, output, trace, work, ahead) < drive.steps:
            raise IntegrationError(
                f"the steady response diverged in period {period}: the element's law has no bounded"
                " motion under this force"
            )
    rows, cases, count = layout.element_rows(), len(drive.lines), drive.lines.shape[1]
    # Step j of the kernel ends at time (j + 1) dt.
    turned = np.exp(-2j * np.pi * np.arange(count) / drive.steps)
    return tuple(
        np.fft.rfft(kept[rows][..., :cases], axis=1)[:, :count].transpose(0, 2, 1)
        * turned
        / drive.steps
        for kept in (trace.displacement, trace.force)
    )


def _with_dead_load(samples, layout):
    """(step, force_channel, LANES): the force, and 1 for the dead load where the model has one."""
    extra = layout.drive_shapes.shape[1] - 1
    return np.ascontiguousarray(
        np.concatenate([samples, np.ones((len(samples), extra, LANES))], axis=1)
        if extra
        else samples
    )


def _linear_steady(model, drive):
    """Return (displacement, velocity), (mode, LANES) each: modal amplitudes at time 0 in the steady
    state without elements.
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
