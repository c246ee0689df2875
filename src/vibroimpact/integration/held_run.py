"""Runs whose sensors are held to a measured motion by dampers, a model of its own in every lane.

    q'' + D q' + W q = b F + C^T f(Cq, Cq') + sum_s S_s^T u_s,      u_s = c_s (v_s - S_s q')

v_s is the measured velocity of sensor s, S_s its row and c_s the strength of its damper. If model
and structure agree, the dampers carry noise; the holding force u_s is a force missing in the model.
With all modes held, the observer is passive and collocated. Dampers that act on some modes only can
drive a structure that presses against its supports.

Source: natural observers: D.G. Luenberger, IEEE Trans. Autom. Control 16 (1971)
596-602; M. Demetriou, Math. Control Signals Syst. (natural observers of second-order systems).
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .batch import Run, Schedule, rest_state, start_amplitudes, start_state
from .contact_convergence import CONTRACTION_LIMIT, IntegrationError, checked_contraction
from .entry_points import HALF
from .kernel_layout import MODE_COEFFICIENTS, ModalLayout, aligned
from .kernels.lanes import LANES
from .kernels.tables import Contact, Hold, Laws, Modal, Output, State
from .preload import seated

OWN_COEFFICIENTS = ("shapes", "acting_shapes", "row_compliance", *MODE_COEFFICIENTS)  # by lane
OWN_OBSTACLES = ("stiffness", "gap", "offset_1", "offset_2")  # of Contact
NO_DAMPING = 1e-12  # N s/m: as good as none, and yet a term of the general law
HELD_TURN = 1.0  # rad of a mode in a step: above, displacements do not give its velocity


@dataclass(frozen=True, eq=False)
class HeldLane:
    """One run: a model under a measured force, its sensors held to the measured motion.

    model: its sensors are those of the motion, in the same order.
    gap: nominal gap, m.
    force (step, force_channel): N, from one step before the start on.
    motion (step, sensor): measured displacement in m, at the same times.
    strength (sensor,): of the dampers, N s/m; 0 leaves a sensor free.
    scale (sensor,), force_scale: factors of motion and force.
    """

    model: ModalModel
    gap: float
    force: np.ndarray
    motion: np.ndarray
    strength: np.ndarray
    scale: np.ndarray | float = 1.0
    force_scale: float = 1.0


@dataclass(frozen=True, eq=False)
class HeldRecords:
    """Records of runs, at the sampling frequency of their Schedule.

    force (run, sensor, sample): holding force, N.
    support_force (run, 2 support, sample): resultants of each support on the structure, N.
    motion (run, sensor, sample): displacement of the model, m.
    tally: {name: (.., run)}, see kernels.tables.Tally; steps: steps that it counts. contact_rows
    (contact_point, 2), element_rows (element,): rows in the tally, of the first run's model.
    """

    force: np.ndarray
    support_force: np.ndarray
    motion: np.ndarray
    tally: dict[str, np.ndarray]
    steps: int
    contact_rows: np.ndarray
    element_rows: np.ndarray


def hold(
    runs: Sequence[HeldLane], schedule: Schedule, threads: int = 1, highest_Hz: float = np.inf
) -> HeldRecords:
    """Return the HeldRecords of any number of runs.

    highest_Hz: dampers do not act on modes above it. The measured band ends there: they would only
    drain their ringing. Sensors see all modes: those above move them in the band too.

    The result of a run does not depend on the others. A run that diverges, or whose contact is too
    stiff for the step, is NaN. All runs have the same numbers of sensors and forces; a model with
    more supports than the first one keeps its first ones.
    """
    sensors = runs[0].motion.shape[1]
    supports = len(runs[0].model.support_names)
    prepared = _Prepared(schedule, highest_Hz)
    layout = prepared.layout(runs[0].model)
    out = HeldRecords(
        np.full((len(runs), sensors, schedule.samples), np.nan, np.float32),
        np.full((len(runs), 2 * supports, schedule.samples), np.nan, np.float32),
        np.full((len(runs), sensors, schedule.samples), np.nan, np.float32),
        {},
        schedule.samples * round(schedule.steps_per_second / schedule.sampling_frequency),
        layout.contact_rows(),
        layout.element_rows(),
    )
    batches: dict[tuple, list[int]] = {}
    for number, run in enumerate(runs):
        try:
            batches.setdefault(prepared.signature(run.model), []).append(number)
        except IntegrationError:
            continue  # too stiff for the step
    pieces = []
    first = {id(run.model): number for number, run in reversed([*enumerate(runs)])}
    for numbers in batches.values():
        # lanes of one model side by side: a batch of the same modes takes the shorter way
        numbers.sort(key=lambda number: (first[id(runs[number].model)], number))
        pieces += [numbers[at : at + LANES] for at in range(0, len(numbers), LANES)]
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(lambda piece: _integrate(runs, piece, prepared, out), pieces))
    return out


def _integrate(runs, numbers, prepared, out):
    """Integrate the runs of numbers side by side and put their records into `out`."""
    kept = list(numbers)
    while kept:
        try:
            result = HeldRun([runs[number] for number in kept], prepared).finish()
        except IntegrationError as error:
            if error.case is None:
                return
            del kept[error.case]
            continue
        sensors = out.force.shape[1]
        supports = 2 * len(runs[kept[0]].model.support_names)
        forces = supports + runs[kept[0]].force.shape[1]
        shared = min(supports, out.support_force.shape[1])
        out.force[kept] = result.force[:, forces : forces + sensors]
        out.support_force[kept, :shared] = result.force[:, :shared]
        out.motion[kept] = result.displacement[:, :sensors]
        for name, values in result.tally.items():
            shape = (*values.shape[:-1], len(runs))
            whole = out.tally.setdefault(name, np.full(shape, np.nan))
            if whole.shape[:-1] == values.shape[:-1]:  # rows of contact laws differ between models
                whole[..., kept] = values
        return


class _Prepared:
    """Layouts of models for one schedule, each made once."""

    def __init__(self, schedule: Schedule, highest_Hz: float):
        self.schedule = schedule
        self.highest = min(
            HELD_TURN * schedule.steps_per_second, 2.0 * np.pi * highest_Hz
        )  # rad/s, of the modes that are held
        self.layout = lru_cache(maxsize=None)(self._layout)
        self.contraction = lru_cache(maxsize=None)(self._contraction)
        self.rest = lru_cache(maxsize=None)(self._rest)
        self.signature = lru_cache(maxsize=None)(self._signature)

    def _layout(self, model, lanes=LANES):
        """Return the _HeldLayout of a model."""
        laws = model.contact_laws
        if not laws.plain.all():  # all points take the general law: more models side by side
            laws = laws.with_columns(damping=np.maximum(laws.damping, NO_DAMPING))
        driven = replace(model, contact_laws=laws)
        return _HeldLayout(driven, self.schedule.scheme, lanes, self.highest)

    def _contraction(self, model):
        return checked_contraction(model, self.schedule.steps_per_second, self.schedule.scheme)

    def _rest(self, model, gap):
        """Return (offset (contact_point, 2), modal amplitudes (mode,) at rest or None for zero)."""
        where = model, self.schedule, np.array([gap])
        offset, rest = seated(*where, np.zeros((*model.centre_offset.shape, 1)))
        with suppress(IntegrationError):  # a run from zero tells
            rest = rest_state(*where, offset, rest)
        return offset[..., 0], None if rest is None else rest[:, 0]

    def _signature(self, model):
        """Return the key that models share if they can be integrated side by side.

        Raises IntegrationError if the contact is too stiff for the step.
        """
        self.contraction(model)
        layout = self.layout(model)
        modal = layout.modal(1.0 / self.schedule.steps_per_second)
        laws = layout.laws(np.ones(LANES))
        output = layout.output(self.schedule.filter.phase_weights(), 1, 1.0)
        tables = (
            *(modal.mode_start, modal.row_start, modal.force_row_start, modal.row_force_channel),
            *layout.contact_rows().T,
            *(laws.contact_point, laws.flat, laws.lobes),
            *(laws.element_row, laws.partner_row),
            *(output.channel_start, output.channel),
            layout.model.contact_laws.plain,
        )
        return tuple((table.shape, table.tobytes()) for table in map(np.ascontiguousarray, tables))


class _HeldLayout(ModalLayout):
    """A model whose sensors are its last force channels: they see all modes, and what is put on
    them acts on those below `highest` [rad/s] alone.
    """

    def __init__(self, model: ModalModel, scheme: str, lanes: int, highest: float):
        self.first, self.acting = model.drive_shapes.shape[1], model.omega < highest
        shapes = np.hstack([model.drive_shapes, model.sensor_shapes])
        super().__init__(replace(model, drive_shapes=shapes), scheme, lanes)

    def _group_acting_shapes(self, g):
        modes, driven = self.groups[g]
        shapes = self._group_row_shapes(g)
        own = len(self.implicit_shapes[g]) + np.flatnonzero(self._is_sensor(np.array(driven)))
        shapes[own] *= self.acting[modes]
        return shapes

    def _is_sensor(self, channel):
        return (channel >= self.first) & (channel < self.model.drive_shapes.shape[1])


class _LaneLayout(ModalLayout):
    """The tables of a batch in which each lane has a ModalLayout of its own: the layout of the
    first one, with the numbers of every lane.
    """

    def __init__(self, layouts: list[ModalLayout], strength: np.ndarray, sensors: int, dt: float):
        self.__dict__.update(layouts[0].__dict__)
        self.layouts, self.strength, self.sensors = layouts, strength, sensors
        self.alike = all(_same_modes(lane, layouts[0], dt) for lane in layouts[1:])

    def modal(self, dt: float) -> Modal:
        """The kernel's Modal, by lane if the models differ."""
        return self._stacked([lane.modal(dt) for lane in self.layouts], OWN_COEFFICIENTS)

    def contact(self, gap: np.ndarray, imperfection: np.ndarray, contraction: float) -> Contact:
        """The kernel's Contact, see ModalLayout.contact."""
        tables = [lane.contact(gap, imperfection, contraction) for lane in self.layouts]
        return _own_lanes(tables, OWN_OBSTACLES)

    def laws(self, gap: np.ndarray) -> Laws:
        """The kernel's Laws, see ModalLayout.laws."""
        tables = [lane.laws(gap) for lane in self.layouts]
        columns = tables[0]._asdict().items()
        return _own_lanes(tables, [name for name, column in columns if column.ndim == 2])

    def output(self, weights: np.ndarray, columns: int, steps_per_second: float) -> Output:
        """The kernel's Output, by lane if the models differ."""
        tables = [lane.output(weights, columns, steps_per_second) for lane in self.layouts[:1]]
        if not self.alike:
            tables += [lane.output(weights, 1, steps_per_second) for lane in self.layouts[1:]]
        return self._stacked(tables, ("shapes",))

    def hold(self, modal: Modal) -> Hold:
        """The kernel's Hold: the last force channels are the sensors."""
        total = self.model.drive_shapes.shape[1]
        channels = np.arange(total - self.sensors, total)
        rows = [np.flatnonzero(modal.row_force_channel == channel) for channel in channels]
        return Hold(
            channel=channels.astype(np.int64),
            row_start=np.cumsum([0, *map(len, rows)]).astype(np.int64),
            row=np.concatenate([*rows, np.zeros(0, np.int64)]).astype(np.int64),
            gain=np.stack([self._gain(modal, rows, lane) for lane in range(self.lanes)], axis=-1),
            measured=np.zeros((self.sensors, self.lanes)),
            difference=np.zeros((self.sensors, self.lanes)),
            memory=np.zeros((self.sensors, self.lanes)),
            rate=np.zeros((self.sensors, self.lanes)),
            strength=np.ascontiguousarray(self.strength, float),
            implicit=np.zeros((self.sensors, self.lanes)),
            missed=np.zeros((self.sensors, self.lanes)),
        )

    def _gain(self, modal, rows, lane):
        """Return (sensor, sensor) N s/m: the dampers as the implicit step takes them."""
        compliance = np.zeros((self.sensors, self.sensors))
        own = self.layouts[lane].modal(modal.dt)
        for g in range(modal.row_start.size - 1):
            row0, row1 = modal.row_start[g], modal.row_start[g + 1]
            start, count = modal.compliance_start[g], row1 - row0
            block = own.row_compliance[start : start + count**2].reshape(count, count)
            of_sensor = np.zeros((self.sensors, count))
            for sensor, its in enumerate(rows):
                of_sensor[sensor, its[(its >= row0) & (its < row1)] - row0] = 1.0
            compliance += of_sensor @ block @ of_sensor.T
        c = self.strength[:, lane]
        return np.linalg.solve(
            np.eye(self.sensors) + modal.velocity_weights[0] * c[:, None] * compliance, np.diag(c)
        )

    def _stacked(self, tables, names):
        """Return the first table, its named arrays with an axis of lanes if the models differ."""
        if self.alike:
            return tables[0]
        return tables[0]._replace(
            **{name: _by_lane([getattr(table, name) for table in tables]) for name in names}
        )


def _by_lane(values):
    """Return (coefficient, lane) of flat arrays, one of each lane."""
    out = aligned((len(values[0]), len(values)))
    return np.stack(values, axis=-1, out=out)


def _same_modes(one: ModalLayout, other: ModalLayout, dt: float) -> bool:
    """Return whether two layouts have the same modes, rows and sensors: models that differ in their
    contacts alone. The kernel then reads one value for all lanes, which is faster.
    """
    if one is other:
        return True
    own, known = one.modal(dt), other.modal(dt)
    return np.array_equal(one._channel_shapes(), other._channel_shapes()) and all(
        np.array_equal(getattr(own, name), getattr(known, name)) for name in OWN_COEFFICIENTS
    )


def _own_lanes(tables, names):
    """Return the first table with the named arrays filled lane by lane from each lane's table."""
    return tables[0]._replace(
        **{
            name: np.ascontiguousarray(
                np.stack([getattr(t, name)[..., lane] for lane, t in enumerate(tables)], axis=-1)
            )
            for name in names
        }
    )


class HeldRun(Run):
    """Up to LANES HeldLanes in progress."""

    def __init__(self, runs: Sequence[HeldLane], prepared: _Prepared):
        schedule, self.runs = prepared.schedule, runs
        count = HALF if len(runs) <= HALF else LANES
        lanes = [*runs, *[runs[0]] * (count - len(runs))]
        self.places = [prepared.rest(run.model, run.gap) for run in lanes]
        self.layouts = [prepared.layout(run.model, count) for run in lanes]
        layout = _LaneLayout(
            self.layouts,
            np.stack([run.strength for run in lanes], axis=-1),
            runs[0].motion.shape[1],
            1.0 / schedule.steps_per_second,
        )
        super().__init__(
            layout,
            schedule,
            np.array([run.gap for run in runs]),
            np.stack([offset for offset, _ in self.places[: len(runs)]], axis=-1),
            self._drive,
            CONTRACTION_LIMIT,  # the same in every batch, so that neighbours do not matter
        )

    def _drive(self, first, count):
        """Return (step, force channel, lane): forces, measured motion, and 1 of the dead load."""
        own, total = self.model.drive_shapes.shape[1], self.layout.drive_shapes.shape[1]
        out = np.zeros((count, total, self.lanes))
        for lane, run in enumerate(self.runs):
            forces = run.force.shape[1]
            out[:, :forces, lane] = run.force_scale * run.force[first : first + count]
            held = slice(forces, forces + run.motion.shape[1])
            out[:, held, lane] = run.scale * run.motion[first : first + count]
        out[:, own:] = 1.0
        return out

    def begin(self, initial: np.ndarray | None) -> None:
        """Start at rest under constant forces and obstacles that press; `initial` is ignored."""
        sensors = self.hold.channel
        for lane, (_, rest) in enumerate(self.places):
            if rest is not None:
                own = self.layouts[lane]
                state, amplitudes = own.state(), np.outer(rest, np.ones(LANES))
                still = np.zeros((own.drive_shapes.shape[1], self.lanes))
                still[own.model.drive_shapes.shape[1] :] = 1.0  # the dead load
                fluid = own.fluid(own.modal(self.dt), self.lanes)
                start_state(
                    *(own, own.modal(self.dt), self.contact, self.laws, fluid),
                    *(state, own.work(), still),
                    start_amplitudes(own.model, amplitudes),
                )
                for name in State._fields:
                    if name not in ("counter", "group_active"):
                        getattr(self.state, name)[..., lane] = getattr(state, name)[..., lane]
                for name in ("force", "displacement", "free"):
                    getattr(self.fluid, name)[..., lane] = getattr(fluid, name)[..., lane]
                self.state.group_active[...] |= state.group_active
        self.hold.measured[...] = self._drive(0, 1)[0][sensors]
        self.hold.difference[...] = self.hold.measured
        for sensor in range(len(sensors)):
            rows = slice(*self.hold.row_start[sensor : sensor + 2])
            self.hold.difference[sensor] -= self.state.row_displacement[self.hold.row[rows]].sum(0)

    def take_energies(self) -> None:
        """Energies are not counted: the dampers put any amount in."""
        self.energies, self.times = [np.zeros((1, LANES))], [0.0]
