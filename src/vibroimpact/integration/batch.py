"""Integration of a batch of cases: checks before, the kernel, statistics and energies after."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.excitation.fluid_elastic import FluidLaws
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.modal_model import ModalModel

from .contact_convergence import LARGEST_DECAY, IntegrationError, checked_contraction
from .entry_points import entry_points, in_all_lanes, lanes_of
from .kernel_layout import ModalLayout
from .kernels.decimation import BEHIND, RATIO
from .kernels.lanes import LANES
from .kernels.tables import Contact, Fluid, Laws, Modal, State, Work
from .output_filter import OutputFilter, output_filter
from .run_statistics import LARGEST
from .step_stability import require_stable_step
from .stored_energy import stored_energy

# Ticks (RATIO steps) integrated in one call: their forces fit the second-level cache.
CHUNK_TICKS = 2000
REST_DAMPING = 0.7  # damping ratio under which a structure comes to rest
REST_DECAY = 12.0  # the transient falls by exp(-REST_DECAY)

Drive = Callable[[int, int], np.ndarray]  # (first, count) -> (count, force_channel, case) N
# (first sample, displacement, acceleration, force), the last three as in BatchResult; in place of
# accelerations the time derivatives that Schedule.derivatives asks for
Receive = Callable[[int, np.ndarray, np.ndarray, np.ndarray], None]


@dataclass
class BatchResult:
    """Records and sums of a batch of up to LANES cases; the last axis of every sum is the case.

    displacement (case, channel, sample) m: sensors, then the shape line. None, as the next two, if
        the time series were handed over piece by piece.
    acceleration (case, sensor, sample) m/s².
    force (case, channel, sample) N: two resultants per support, on the structure, then the drive
        forces.
    tally: sums over the recorded steps, see kernels.tables.Tally.
    steps: number of recorded steps.
    energy (case, term, chunk) J: ENERGY_TERMS, accumulated from the start of the run.
    energy_time (chunk,) s.
    fixed_point_residual (case,): largest relative change of the contact forces in the last pass of
        a step; times contraction it bounds their error.
    contraction: factor by which one pass shrinks the error, at most.
    contact_rows (contact_point, 2), element_rows (element,): rows in the tally.
    stopwatch: CPU seconds of kernel and output filter.
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
    """Rates [Hz], durations [s] and scheme of a run (see modal_step), and its output filter.

    derivatives (sensor,): order of the time derivative of each sensor's displacement, 0 to 2,
    recorded in place of its acceleration; empty for accelerations.
    """

    steps_per_second: float
    sampling_frequency: float
    start_up: float
    duration: float
    scheme: str = "newmark"
    derivatives: tuple[int, ...] = ()
    filter: OutputFilter = field(init=False)

    def __post_init__(self) -> None:
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

        Negative if the filter reaches back before the start of the run, when the structure was at
        rest.
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
    model: ModalModel,
    schedule: Schedule,
    gap: np.ndarray,
    imperfection: np.ndarray,
    drive: Drive,
    receive: Receive | None = None,
    initial: np.ndarray | None = None,
    fluid: Sequence[FluidLaws] = (),
) -> BatchResult:
    """Integrate up to LANES cases side by side.

    gap (case,): m.
    imperfection (contact_point, 2, case): offset added to the centres of the obstacles, m.
    drive: gives the force at steps first, first + 1, ... (0 to schedule.steps).
    receive: takes the time series as they come, float32, from a sample on, in arrays that are used
        again. The result then holds none, and no array grows with the duration.
    initial (mode, LANES): modal amplitudes at which every lane rests, see `rest_state`; the
        model's initial state is added to them.
    fluid (case,): the fluid-elastic force of each case; none for the model's in all.

    Raises IntegrationError: the contact is too stiff for the step, or the step makes a motion grow
    by itself (before anything runs), or the run diverged.
    """
    require_stable_step(model, schedule.steps_per_second, schedule.scheme)
    contraction = checked_contraction(model, schedule.steps_per_second, schedule.scheme)
    return Run(
        ModalLayout(model, schedule.scheme, lanes_of(np.size(gap))),
        schedule,
        gap,
        imperfection,
        drive,
        contraction,
        initial,
        fluid,
    ).finish(receive)


def rest_state(
    model: ModalModel,
    schedule: Schedule,
    gap: np.ndarray,
    imperfection: np.ndarray,
    start: np.ndarray | None = None,
) -> np.ndarray | None:
    """Modal amplitudes (mode, LANES) at which each case rests under its dead loads, against its
    supports if need be; gap, imperfection as of integrate_batch.

    start (mode, LANES): its rest without dead loads, see preload.seated; None for zero.

    None if it rests at zero (no dead load, all supports centred and none pressing) or nowhere
    (a mode is free, and no start is known).
    """
    loaded = model.constant_force.any() or model.centre_offset.any() or model.presses_at_rest
    if not loaded or (start is None and not (model.omega > 0.0).all()):
        return None
    return settled(model, schedule, gap, imperfection, start)


def settled(
    model: ModalModel,
    schedule: Schedule,
    gap: np.ndarray,
    imperfection: np.ndarray,
    start: np.ndarray | None = None,
) -> np.ndarray:
    """Modal amplitudes (mode, LANES) that each case comes to from a start (mode, LANES), by default
    zero; gap, imperfection as of integrate_batch.

    Found by integration with the modes damped to REST_DAMPING of critical and without friction. A
    mode without stiffness is damped as the lowest one with stiffness.
    """
    lowest = model.omega[model.omega > 0.0].min(initial=np.inf)
    if not np.isfinite(lowest):
        return np.zeros((model.modes, LANES)) if start is None else start
    damped = replace(
        model,
        damping=np.minimum(
            2.0 * REST_DAMPING * np.maximum(model.omega, lowest),
            LARGEST_DECAY * schedule.steps_per_second,
        ),
        initial_displacement=np.zeros(model.modes),
        initial_velocity=np.zeros(model.modes),
        contact_laws=model.contact_laws.with_columns(friction=0.0),
    )
    contraction = checked_contraction(damped, schedule.steps_per_second, schedule.scheme)
    channels = model.drive_shapes.shape[1]

    def no_force(first: int, count: int) -> np.ndarray:
        return np.zeros((count, channels, np.size(gap)))

    run = Run(
        ModalLayout(damped, schedule.scheme, lanes_of(np.size(gap))),
        schedule,
        gap,
        imperfection,
        no_force,
        contraction,
        start,
    )
    time = REST_DECAY / (REST_DAMPING * lowest)
    for ticks in _chunks(round(time * schedule.steps_per_second / RATIO), run.chunk):
        run.advance(ticks, 0, recorded=False)
    return in_all_lanes(run.state.q[-1][run.layout.place])


def to_lanes(values: np.ndarray, padding: float, lanes: int = LANES) -> np.ndarray:
    """values (..., case) padded to a number of lanes along the last axis."""
    values = np.asarray(values, float)
    out = np.full((*values.shape[:-1], lanes), padding)
    out[..., : values.shape[-1]] = values
    return out


class Run:
    """A batch in progress: the kernel's arrays and the sums carried from chunk to chunk."""

    def __init__(
        self,
        layout: ModalLayout,
        schedule: Schedule,
        gap: np.ndarray,
        imperfection: np.ndarray,
        drive: Drive,
        contraction: float,
        initial: np.ndarray | None = None,
        fluid: Sequence[FluidLaws] = (),
    ):
        self.model, self.schedule, self.drive = layout.model, schedule, drive
        self.cases, self.contraction = np.size(gap), contraction
        self.dt = 1.0 / schedule.steps_per_second
        self.layout, self.lanes = layout, layout.lanes
        self.kernels = entry_points(self.lanes)
        self.modal = layout.modal(self.dt)
        lane_gap = to_lanes(gap, 1.0, self.lanes)
        offset = to_lanes(imperfection, 0.0, self.lanes)
        self.contact = layout.contact(lane_gap, offset, contraction)
        self.laws = layout.laws(lane_gap)
        self.state, self.tally, self.work = layout.state(), layout.tally(), layout.work()
        self.hold = layout.hold(self.modal)
        self.fluid = layout.fluid(self.modal, self.cases, fluid)
        self.begin(initial)
        # The second filter stage needs this many ticks before the first of a chunk.
        self.history = schedule.filter.second.size - schedule.filter.step
        self.chunk = CHUNK_TICKS - CHUNK_TICKS % schedule.filter.step
        self.output = layout.output(
            schedule.filter.phase_weights(), self.history + self.chunk, schedule.steps_per_second
        )
        self.done, self.stopwatch = 0, Stopwatch()
        self.totals = {
            name: np.zeros(LANES) for name in ("input_work", "dissipated", "contact_work")
        }
        self.sums = {name: np.zeros_like(array) for name, array in self.tally._asdict().items()}
        self.residual = np.zeros(LANES)
        self.energies: list[np.ndarray] = []
        self.times: list[float] = []
        self.take_energies()

    def begin(self, initial: np.ndarray | None) -> None:
        """Put the state at the start into the kernel's arrays; initial: see integrate_batch."""
        start_state(
            self.layout,
            self.modal,
            self.contact,
            self.laws,
            self.fluid,
            self.state,
            self.work,
            self.forces(0, 1)[0],
            start_amplitudes(self.model, initial),
        )

    def finish(self, receive: Receive | None = None) -> BatchResult:
        """Start-up, filling of the filter, record."""
        schedule, output = self.schedule, self.output
        for ticks in _chunks(schedule.start_ticks, self.chunk):
            self.advance(ticks, 0, recorded=False)
        at_rest = max(-schedule.start_ticks, 0)
        output.values[:, :at_rest] = 0.0
        self.advance(self.history - at_rest, at_rest, recorded=False)
        sensors, shapes = self.model.sensor_shapes.shape[1], output.stress_start
        whole: tuple[np.ndarray, np.ndarray] | None = None
        if receive is None:
            whole = (
                self._series(output.values.shape[0], schedule.samples),
                self._series(sensors, schedule.samples),
            )
        pieces = tuple(
            self._series(channels, self.chunk // schedule.filter.step)
            for channels in (output.values.shape[0], sensors)
        )
        first = 0
        for ticks in _chunks(schedule.samples * schedule.filter.step, self.chunk):
            self.advance(ticks, self.history, recorded=True)
            self._filter(ticks, *pieces)
            count = ticks // schedule.filter.step
            outputs, acceleration = (piece[..., :count] for piece in pieces)
            if whole is not None:
                whole[0][..., first : first + count] = outputs
                whole[1][..., first : first + count] = acceleration
            if receive is not None:
                receive(first, outputs[:, :shapes], acceleration, outputs[:, shapes:])
            first += count
        return self._result(whole)

    def _series(self, channels: int, samples: int) -> np.ndarray:
        return np.empty((self.cases, channels, samples), np.float32)

    def _filter(self, ticks: int, outputs: np.ndarray, acceleration: np.ndarray) -> None:
        """Second filter stage of a chunk, of all channels and of the sensors' derivatives."""
        stage, values = self.schedule.filter, self.output.values
        sensors = acceleration.shape[1]
        with self.stopwatch("output filter"):
            chunk = np.ascontiguousarray(values[:, : self.history + ticks])
            buffer = np.zeros((4, self.lanes))

            def filtered(order: int, channels: np.ndarray, out: np.ndarray) -> None:
                taps = np.pad(stage.taps(order), 3 * stage.step)
                self.kernels.decimate(channels, taps, out, 0, stage.step, buffer)

            filtered(0, chunk, outputs)
            orders = np.array(self.schedule.derivatives or (2,) * sensors)
            for order in np.unique(orders):
                if np.all(orders == order):
                    filtered(order, chunk[:sensors], acceleration)
                    break
                some = np.flatnonzero(orders == order)
                own = np.empty((self.cases, some.size, acceleration.shape[2]), np.float32)
                filtered(order, chunk[some], own)
                acceleration[:, some] = own
            values[:, : self.history] = chunk[:, ticks : ticks + self.history]

    def _result(self, series: tuple[np.ndarray, np.ndarray] | None) -> BatchResult:
        shapes = self.output.stress_start
        return BatchResult(
            displacement=None if series is None else series[0][:, :shapes],
            acceleration=None if series is None else series[1],
            force=None if series is None else series[0][:, shapes:],
            tally={name: value[..., : self.cases] for name, value in self.sums.items()},
            steps=self.schedule.samples * self.schedule.filter.step * RATIO,
            energy=np.array(self.energies).transpose(2, 1, 0)[: self.cases],
            energy_time=np.array(self.times),
            fixed_point_residual=self.residual[: self.cases],
            contraction=self.contraction,
            contact_rows=self.layout.contact_rows(),
            element_rows=self.layout.element_rows(),
            stopwatch=self.stopwatch,
        )

    def advance(self, ticks: int, column: int, recorded: bool) -> None:
        """Integrate a number of ticks, their outputs from a column on; add to the sums when
        recorded. Raises IntegrationError when the run diverged.
        """
        for array in self.tally:
            array[...] = 0.0
        force = self.forces(self.done + 1, ticks * RATIO)
        output, trace = self.output._replace(column=column), self.layout.trace(0)
        with self.stopwatch("kernel"):
            steps = self.kernels.march(
                self.modal,
                self.contact,
                self.laws,
                self.hold,
                self.fluid,
                self.state,
                self.tally,
                output,
                trace,
                self.work,
                force,
            )
        if steps < ticks * RATIO:
            self.fail(steps)
        self.done += steps
        self.account(recorded)

    def forces(self, first: int, count: int) -> np.ndarray:
        """Drive forces (count, force_channel, lane) N at steps first, first + 1, ..."""
        channels, total = self.model.drive_shapes.shape[1], self.layout.drive_shapes.shape[1]
        given = self.drive(first, count)
        if given.shape == (count, total, self.lanes):
            return np.ascontiguousarray(given)
        out = np.zeros((count, total, self.lanes))
        # Long strided copies are many times faster than one copy of blocks of a few lanes.
        for channel in range(channels):
            for lane in range(self.cases):
                out[:, channel, lane] = given[:, channel, lane]
        out[:, channels:] = 1.0  # the dead load, see ModalLayout.drive_shapes
        return out

    def account(self, recorded: bool) -> None:
        """Add the chunk's tally to the totals, to the sums when recorded, and take the energies."""
        tally = self.tally
        for name, total in self.totals.items():
            total += in_all_lanes(getattr(tally, name)[0])
        self.residual = np.maximum(self.residual, in_all_lanes(tally.residual[0]))
        self.take_energies()
        if recorded:
            for name, array in tally._asdict().items():
                combine = np.maximum if name.startswith(LARGEST) else np.add
                self.sums[name] = combine(self.sums[name], array)

    def take_energies(self) -> None:
        """Append the energies of the present state."""
        kinetic, elastic = modal_energies(self.layout, self.dt, self.state)
        stored = {
            "kinetic": kinetic,
            "elastic": elastic,
            "contact_potential": stored_energy(self.contact, self.laws, self.state),
        }
        terms = self.totals | stored
        self.energies.append(np.array([terms[name] for name in ENERGY_TERMS]))
        self.times.append((self.done - 1) * self.dt - self.schedule.start_up)

    def fail(self, steps: int) -> None:
        """Raise IntegrationError with the time and place at which the run diverged."""
        displacement = np.abs(self.state.row_displacement[:, : self.cases])
        displacement[~np.isfinite(displacement)] = np.inf
        row, lane = np.unravel_index(np.argmax(displacement), displacement.shape)
        points = np.flatnonzero((self.contact.row_1 == row) | (self.contact.row_2 == row))
        raise IntegrationError(
            f"diverged at t = {(self.done + steps - 1) * self.dt - self.schedule.start_up:.4f} s of"
            " the record, contact point"
            f" {points[0] if points.size else row}: raise integration.steps_per_second (now"
            f" {self.schedule.steps_per_second:g}, highest mode kept"
            f" {self.model.omega.max() / (2 * np.pi):.0f} Hz) or check the contact stiffness and"
            " the force",
            case=int(lane),
        )


def start_amplitudes(
    model: ModalModel, rest: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Modal amplitudes and their rates at the start, (mode, LANES) each: the model's initial state,
    the same in every lane, added to the rest position.

    rest (mode, LANES): see `rest_state`; None for 0.
    """
    ones = np.ones(LANES)
    displacement = np.outer(model.initial_displacement, ones)
    if rest is not None:
        displacement += rest
    return displacement, np.outer(model.initial_velocity, ones)


def start_state(
    layout: ModalLayout,
    modal: Modal,
    contact: Contact,
    laws: Laws,
    fluid: Fluid,
    state: State,
    work: Work,
    drive: np.ndarray,
    initial: tuple[np.ndarray, np.ndarray],
) -> None:
    """Put the initial displacement, velocity and force into the state.

    drive (force_channel, lane): force at that time, N.
    initial: (displacement, velocity), modal amplitudes (mode, LANES) each.
    """
    shapes, own = layout.row_shapes, slice(layout.lanes)
    q, v = initial
    if np.any(q) or np.any(v):
        state.q[-1] = layout.per_mode(q)[:, own]
        state.row_displacement[...] = (shapes @ q)[:, own]
        state.row_velocity[...] = (shapes @ v)[:, own]
        entry_points(layout.lanes).initial_forces(modal, contact, laws, state, work)
    start_fluid(layout, fluid, q, v)
    driven = modal.row_force_channel >= 0
    forces = np.concatenate([drive, fluid.force])
    state.row_force[driven] = forces[modal.row_force_channel[driven]]
    modal_force = shapes.T @ in_all_lanes(state.row_force)
    q_next_free, dq = layout.step(modal.dt).start(q, v, modal_force)
    state.q_next_free[...] = layout.per_mode(q_next_free)[:, own]
    state.dq[...] = layout.per_mode(dq)[:, own]
    moves = np.any(state.q_next_free, axis=1) | np.any(state.dq, axis=1)
    state.group_active[...] |= [
        np.any(moves[first:last])
        for first, last in zip(layout.mode_start[:-1], layout.mode_start[1:], strict=True)
    ]


def start_fluid(layout: ModalLayout, fluid: Fluid, q: np.ndarray, v: np.ndarray) -> None:
    """Put the fluid-elastic force at modal amplitudes and rates (mode, LANES) into its table. The
    lags are 0: the flow begins at this time.
    """
    shapes, own = layout.model.fluid_shapes.T, slice(layout.lanes)
    fluid.displacement[...] = fluid.free[...] = (shapes @ q)[:, own]
    fluid.memory[...] = (shapes @ v)[:, own]
    fluid.force[...] = -(fluid.stiffness * fluid.displacement + fluid.damping * fluid.memory)


def modal_energies(layout: ModalLayout, dt: float, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic and elastic energy of the modes, each (LANES,) J; dt in s."""
    q_next_free, dq, displacement = (
        in_all_lanes(values[layout.place]) for values in (state.q_next_free, state.dq, state.q[-1])
    )
    force = layout.row_shapes.T @ in_all_lanes(state.row_force)
    velocity = layout.step(dt).velocity(q_next_free, dq, force)
    kinetic = 0.5 * (velocity**2).sum(axis=0)
    elastic = 0.5 * ((layout.model.omega[:, None] * displacement) ** 2).sum(axis=0)
    return kinetic, elastic


def _chunks(total: int, size: int) -> list[int]:
    """total cut into pieces of at most size; none when it is not positive."""
    return [min(size, total - start) for start in range(0, total, size)]
