"""Marching a batch of cases through time: checks before, the kernel, statistics and energies
after.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.stopwatch import Stopwatch

from .contact_convergence import IntegrationError, checked_contraction
from .kernel_layout import ModalLayout
from .kernels.decimation import BEHIND, RATIO, decimate
from .kernels.lanes import LANES
from .kernels.march import initial_forces, march
from .output_filter import OutputFilter, output_filter
from .stored_energy import stored_energy

CHUNK_TICKS = (
    2000  # steps between visits to Python, in units of RATIO: its forces fit the second-level cache
)
ROOM, SETTLED = (
    0.7,
    12.0,
)  # damping ratio under which a structure comes to rest, and by how much: exp(-SETTLED)


@dataclass
class BatchResult:
    """What a batch of up to LANES cases leaves behind; the last axis of every sum is the case.

    displacement (case, channel, sample) m: sensors, then the shape line; acceleration (case,
    sensor, sample) m/s²; force (case, channel, sample) N: two resultants per support (on the
    structure), then the drive forces. None, all three, where they were handed over piece by piece.
    stopwatch: CPU seconds of kernel and output filter. tally: sums over the recorded steps (see
    kernels.tables.Tally); steps: how many; energy (case, term, chunk) J at energy_time (chunk,) s; terms
    ENERGY_TERMS, all accumulated from the start of the simulation. fixed_point_residual (case,):
    largest relative change of the contact forces in the last pass of a step; times contraction it
    bounds the error left. contact_rows (contact_point, 2), element_rows (element,): rows in the
    tally.
    """

    displacement: np.ndarray | None
    acceleration: np.ndarray | None
    force: np.ndarray | None
    tally: dict[str, np.ndarray]
    steps: int
    energy: np.ndarray
    energy_time: np.ndarray
    fixed_point_residual: np.ndarray
    contraction: float
    contact_rows: np.ndarray
    element_rows: np.ndarray
    stopwatch: Stopwatch


ENERGY_TERMS = (
    "input_work",
    "dissipated",
    "contact_work",
    "kinetic",
    "elastic",
    "contact_potential",
)


@dataclass(frozen=True)
class Schedule:
    """Rates [Hz] and durations [s] of a run, its scheme (see schemes.py), and the output filter
    between the two rates.
    """

    steps_per_second: float
    sampling_frequency: float
    start_up: float
    duration: float
    scheme: str = "newmark"
    filter: OutputFilter = field(init=False)

    def __post_init__(self):
        object.__setattr__(
            self, "filter", output_filter(self.steps_per_second, self.sampling_frequency)
        )

    @property
    def samples(self) -> int:
        """Samples of the record."""
        return round(self.duration * self.sampling_frequency)

    @property
    def start_ticks(self) -> int:
        """Ticks before the first one whose output the record's second filter stage needs.

        Negative where the filter reaches back before the start of the run, when the structure was
        at rest.
        """
        return round(self.start_up * self.steps_per_second / RATIO) - self.filter.delay + BEHIND

    @property
    def steps(self) -> int:
        """Steps of the whole run; the drive force needs one value more (its value 0 is one step
        before time 0).
        """
        ticks = self.start_ticks + self.filter.second.size + (self.samples - 1) * self.filter.step
        return ticks * RATIO


def integrate_batch(
    model: ModalModel, schedule: Schedule, gap, imperfection, drive, receive=None, initial=None
) -> BatchResult:
    """Integrate up to LANES cases side by side.

    gap (case,) m; imperfection (contact_point, 2, case) m, added to the obstacles' centres; drive:
    function (first, count) -> (count, force_channel, case) force in N at steps first, first + 1,
    ... (0 to schedule.steps). receive: function (first, displacement, acceleration, force) that
    takes the time series as they come: those of BatchResult, float32, from sample first on, in arrays
    that are used again; BatchResult then holds none, and no array grows with the duration. initial:
    (mode, LANES) modal amplitudes in which every lane starts at rest, see `resting`; the model's
    initial state when left out. Raises IntegrationError: the contact is too stiff for the step
    (before anything runs), or the run diverged.
    """
    contraction = checked_contraction(model, schedule.steps_per_second, schedule.scheme)
    return _Run(
        model,
        schedule,
        to_lanes(gap, 1.0),
        to_lanes(imperfection, 0.0),
        drive,
        np.size(gap),
        contraction,
        initial,
    ).finish(receive)


def rest_state(model: ModalModel, schedule: Schedule, gap, imperfection):
    """Return (mode, LANES) modal amplitudes in which each case rests under its dead loads, against
    its supports where it must; arguments as of integrate_batch.

    None where it rests at zero: no dead load, all supports centred; or nowhere: a mode is free.
    Found by a march with the modes damped to ROOM of critical.
    """
    if (
        not (model.constant_force.any() or model.centre_offset.any())
        or not (model.omega > 0.0).all()
    ):
        return None
    damped = replace(
        model,
        damping=2.0 * ROOM * model.omega,
        initial_displacement=np.zeros(model.modes),
        initial_velocity=np.zeros(model.modes),
    )
    contraction = checked_contraction(damped, schedule.steps_per_second, schedule.scheme)
    channels = model.drive_shapes.shape[1]
    run = _Run(
        damped,
        schedule,
        to_lanes(gap, 1.0),
        to_lanes(imperfection, 0.0),
        lambda first, count: np.zeros((count, channels, np.size(gap))),
        np.size(gap),
        contraction,
    )
    for ticks in _chunks(
        round(SETTLED / (ROOM * model.omega.min()) * schedule.steps_per_second / RATIO), run.chunk
    ):
        run.advance(ticks, 0, recorded=False)
    return run.state.q[-1][run.layout.place]


def to_lanes(values, padding):
    """values (..., case) padded to LANES along the last axis."""
    values = np.asarray(values, float)
    out = np.full((*values.shape[:-1], LANES), padding)
    out[..., : values.shape[-1]] = values
    return out


class _Run:
    """One batch on its way: the kernel's arrays and the sums carried from chunk to chunk."""

    def __init__(self, model, schedule, gap, imperfection, drive, cases, contraction, initial=None):
        self.model, self.schedule, self.drive, self.cases, self.contraction = (
            model,
            schedule,
            drive,
            cases,
            contraction,
        )
        self.layout = ModalLayout(model, schedule.scheme)
        self.dt = 1.0 / schedule.steps_per_second
        self.modal = self.layout.modal(self.dt)
        self.contact, self.laws = (
            self.layout.contact(gap, imperfection, contraction),
            self.layout.laws(gap),
        )
        self.state, self.tally, self.work = (
            self.layout.state(),
            self.layout.tally(),
            self.layout.work(),
        )
        start_state(
            self.layout,
            self.modal,
            self.contact,
            self.laws,
            self.state,
            self.work,
            self.forces(0, 1)[0],
            None if initial is None else (initial, np.zeros_like(initial)),
        )
        tail = schedule.filter.second.size - schedule.filter.step
        self.chunk = CHUNK_TICKS - CHUNK_TICKS % schedule.filter.step
        self.output = self.layout.output(
            schedule.filter.phase_weights(), tail + self.chunk, schedule.steps_per_second
        )
        self.tail = tail
        self.done, self.stopwatch = 0, Stopwatch()
        self.totals = {
            name: np.zeros(LANES) for name in ("input_work", "dissipated", "contact_work")
        }
        self.sums = None
        self.residual = np.zeros(LANES)
        self.energies, self.times = [], []
        self.take_energies()

    def finish(self, receive=None) -> BatchResult:
        """Start-up, filling of the filter, record."""
        schedule, layout_output = self.schedule, self.output
        for ticks in _chunks(schedule.start_ticks, self.chunk):
            self.advance(ticks, 0, recorded=False)
        at_rest = max(-schedule.start_ticks, 0)
        layout_output.values[:, :at_rest] = 0.0
        self.advance(self.tail - at_rest, at_rest, recorded=False)
        sensors = self.model.sensor_shapes.shape[1]
        samples, shapes = schedule.samples, layout_output.stress_start
        pieces = [
            np.empty((self.cases, channels, self.chunk // schedule.filter.step), np.float32)
            for channels in (layout_output.values.shape[0], sensors)
        ]
        whole = (
            [np.empty((*piece.shape[:2], samples), np.float32) for piece in pieces]
            if receive is None
            else None
        )
        taps, curvature_taps = (
            np.pad(taps, 3 * schedule.filter.step)
            for taps in (schedule.filter.second, schedule.filter.second_derivative)
        )
        first, buffer = 0, np.zeros((4, LANES))
        for ticks in _chunks(samples * schedule.filter.step, self.chunk):
            self.advance(ticks, self.tail, recorded=True)
            with self.stopwatch("output filter"):
                values = np.ascontiguousarray(layout_output.values[:, : self.tail + ticks])
                decimate(values, taps, pieces[0], 0, schedule.filter.step, buffer)
                decimate(
                    values[:sensors], curvature_taps, pieces[1], 0, schedule.filter.step, buffer
                )
                layout_output.values[:, : self.tail] = values[:, ticks : ticks + self.tail]
            count = ticks // schedule.filter.step
            outputs, acceleration = (piece[..., :count] for piece in pieces)
            if receive is None:
                whole[0][..., first : first + count], whole[1][..., first : first + count] = (
                    outputs,
                    acceleration,
                )
            else:
                receive(first, outputs[:, :shapes], acceleration, outputs[:, shapes:])
            first += count
        return BatchResult(
            displacement=whole and whole[0][:, :shapes],
            acceleration=whole and whole[1],
            force=whole and whole[0][:, shapes:],
            tally={name: value[..., : self.cases] for name, value in self.sums.items()},
            steps=samples * schedule.filter.step * RATIO,
            energy=np.array(self.energies).transpose(2, 1, 0)[: self.cases],
            energy_time=np.array(self.times),
            fixed_point_residual=self.residual[: self.cases],
            contraction=self.contraction,
            contact_rows=self.layout.contact_rows(),
            element_rows=self.layout.element_rows(),
            stopwatch=self.stopwatch,
        )

    def advance(self, ticks, column, recorded):
        """March ``ticks`` ticks, their outputs to ``column`` on; keep the sums when recorded."""
        for array in self.tally:
            array[...] = 0.0
        force = self.forces(self.done + 1, ticks * RATIO)
        output = self.output._replace(column=column)
        with self.stopwatch("kernel"):
            steps = march(
                self.modal,
                self.contact,
                self.laws,
                self.state,
                self.tally,
                output,
                self.layout.trace(0),
                self.work,
                force,
            )
        if steps < ticks * RATIO:
            self.fail(steps)
        self.done += steps
        self.account(recorded)

    def forces(self, first, count):
        """Drive forces (count, force_channel, LANES) N at steps first, first + 1, ..."""
        channels, total = self.model.drive_shapes.shape[1], self.layout.drive_shapes.shape[1]
        given = self.drive(first, count)
        if given.shape == (count, total, LANES):
            return np.ascontiguousarray(given)
        out = np.zeros((count, total, LANES))
        for channel in range(channels):
            for lane in range(
                self.cases
            ):  # long strided copies: many times faster than one of blocks of a few lanes
                out[:, channel, lane] = given[:, channel, lane]
        out[:, channels:] = 1.0  # the dead load, see ModalLayout.drive_shapes
        return out

    def account(self, recorded):
        """Add the chunk's tally to the totals and take the energies."""
        tally = self.tally
        self.totals["input_work"] += tally.input_work[0]
        self.totals["contact_work"] += tally.contact_work[0]
        self.totals["dissipated"] += tally.dissipated[0]
        self.residual = np.maximum(self.residual, tally.residual[0])
        self.take_energies()
        if recorded:
            if self.sums is None:
                self.sums = {name: np.zeros_like(array) for name, array in tally._asdict().items()}
            for name, array in tally._asdict().items():
                largest = name.startswith(("peak", "impact_velocity_peak", "residual"))
                self.sums[name] = (
                    np.maximum(self.sums[name], array) if largest else self.sums[name] + array
                )

    def take_energies(self):
        """Note the energies of the present state."""
        kinetic, elastic = modal_energies(self.layout, self.dt, self.state)
        stored = {
            "kinetic": kinetic,
            "elastic": elastic,
            "contact_potential": stored_energy(self.contact, self.laws, self.state),
        }
        terms = self.totals | stored
        self.energies.append(np.array([terms[name] for name in ENERGY_TERMS]))
        self.times.append((self.done - 1) * self.dt - self.schedule.start_up)

    def fail(self, steps):
        """Say where the run diverged."""
        displacement = np.abs(self.state.row_displacement)
        displacement[~np.isfinite(displacement)] = np.inf
        row, lane = np.unravel_index(np.argmax(displacement), displacement.shape)
        points = np.flatnonzero((self.contact.row_1 == row) | (self.contact.row_2 == row))
        raise IntegrationError(
            f"diverged at t = {(self.done + steps - 1) * self.dt - self.schedule.start_up:.4f} s of"
            f" the record, case {lane} of the batch, contact point"
            f" {points[0] if points.size else row}: raise integration.steps_per_second (now"
            f" {self.schedule.steps_per_second:g}, highest mode kept"
            f" {self.model.omega.max() / (2 * np.pi):.0f} Hz) or check the contact stiffness and"
            " the force",
            case=int(lane),
        )


def start_state(
    layout: ModalLayout, modal, contact, laws, state, work, drive, initial=None
) -> None:
    """Put the initial displacement and velocity, and the force drive (force_channel, LANES) N of
    that time, into the state.

    initial: (displacement, velocity), modal amplitudes (mode, LANES) each; the model's own, the
    same in every lane, when left out.
    """
    model, shapes = layout.model, layout.row_shapes
    q, v = initial or (
        np.outer(values, np.ones(LANES))
        for values in (model.initial_displacement, model.initial_velocity)
    )
    if np.any(q) or np.any(v):
        state.q[-1] = layout.per_mode(q)
        state.row_displacement[...], state.row_velocity[...] = shapes @ q, shapes @ v
        initial_forces(modal, contact, laws, state, work)
    driven = modal.row_force_channel >= 0
    state.row_force[driven] = drive[modal.row_force_channel[driven]]
    ahead, change = layout.step(modal.dt).start(q, v, shapes.T @ state.row_force)
    state.q_next_free[...], state.dq[...] = layout.per_mode(ahead), layout.per_mode(change)
    moves = np.any(state.q_next_free, axis=1) | np.any(state.dq, axis=1)
    state.group_active[...] |= [
        np.any(moves[first:last])
        for first, last in zip(layout.mode_start[:-1], layout.mode_start[1:], strict=True)
    ]


def modal_energies(layout: ModalLayout, dt: float, state) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic and elastic energy of the modes, each (lane,) J."""
    force = layout.row_shapes.T @ state.row_force
    velocity = layout.step(dt).velocity(
        state.q_next_free[layout.place], state.dq[layout.place], force
    )
    displacement = state.q[-1][layout.place]
    return 0.5 * (velocity**2).sum(axis=0), 0.5 * (
        (layout.model.omega[:, None] * displacement) ** 2
    ).sum(axis=0)


def _chunks(total, size):
    """total cut into pieces of at most size; none when it is not positive."""
    return [min(size, total - start) for start in range(0, total, size)]
