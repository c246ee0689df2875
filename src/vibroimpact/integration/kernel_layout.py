"""The reduced model laid out for the kernel: uncoupled groups of modes, panels, rows and lanes."""

from collections.abc import Sequence
from functools import cache, cached_property

import numpy as np

from vibroimpact.excitation.fluid_elastic import FluidLaws
from vibroimpact.reduction.modal_model import ModalModel

from .kernels.decimation import CHANNEL_BLOCK, RATIO, SLOTS
from .kernels.lanes import LANES
from .kernels.panels import PANEL
from .kernels.tables import (
    QUIET,
    Contact,
    Fluid,
    Hold,
    Laws,
    Modal,
    Output,
    State,
    Tally,
    Trace,
    Work,
)
from .modal_step import StepCoefficients, step_coefficients
from .support_lands import law_lands

FIXED_POINT_TOLERANCE = 1e-4  # relative change of the contact forces in the last pass, at most
FIXED_POINT_ERROR = 1e-6  # relative error left in them: the change times the contraction
FIXED_POINT_PASSES = 40
DIVERGED_DISPLACEMENT = 1e3  # m
STRESS_RATE = 1e4  # Hz at least, of the stresses behind RMS and peak
MODE_COEFFICIENTS = (
    "mode_compliance",
    "force_shift",
    "decay",
    "restoring",
    "force_gain",
    "damping_over_dt",
)

RowKey = tuple[int, int] | int  # (contact point, direction) of a contact row, or a local element


class ModalLayout:
    """The modes, contact rows and force rows of a ModalModel in the kernel's flat arrays.

    groups: list of (mode indices, force channels) of each uncoupled group.
    implicit_shapes: for each group {RowKey: shape (mode of the group,)}, in the order of its rows.
    drive_shapes (mode, force_channel): the model's, then a dead load, if there is one, as a
        channel of constant force 1.
    force_shapes (mode, channel): drive_shapes, then the rows of the fluid-elastic force.
    padded: number of modes after padding every group to whole panels.
    place (mode,): index of each mode among the padded ones.
    lanes: see entry_points.
    """

    def __init__(self, model: ModalModel, scheme: str, lanes: int = LANES):
        self.model, self.scheme, self.lanes = model, scheme, lanes
        self.drive_shapes = model.drive_shapes
        if np.any(model.constant_force):
            self.drive_shapes = np.column_stack([model.drive_shapes, model.constant_force])
        self.force_shapes = np.column_stack([self.drive_shapes, model.fluid_shapes])
        self.groups: list[tuple[np.ndarray, list[int]]] = []
        self.implicit_shapes: list[dict[RowKey, np.ndarray]] = []
        self._make_groups()
        widths = [-(-len(modes) // PANEL) * PANEL for modes, _ in self.groups]
        self.mode_start = np.concatenate([[0], np.cumsum(widths)]).astype(np.int64)
        self.padded = int(self.mode_start[-1])
        self.place = np.zeros(model.omega.size, np.int64)
        for g, (modes, _) in enumerate(self.groups):
            self.place[modes] = self.mode_start[g] + np.arange(len(modes))

    def _make_groups(self) -> None:
        """Distribute the contact directions, elements and force channels over the groups."""
        model = self.model
        points, elements = model.contact_shapes.shape[1], len(model.element_names)
        shapes: dict[RowKey, np.ndarray] = {
            (point, direction): model.contact_shapes[:, point, direction]
            for point in range(points)
            for direction in range(2)
        }
        shapes.update({element: model.element_shapes[:, element] for element in range(elements)})
        taken: set[RowKey] = set()
        for modes, _ in model.blocks:
            moved = {key: shape[modes] for key, shape in shapes.items() if np.any(shape[modes])}
            driven = [
                c for c in range(self.force_shapes.shape[1]) if np.any(self.force_shapes[modes, c])
            ]
            self.groups.append((np.asarray(modes), driven))
            self.implicit_shapes.append(moved)
            taken |= set(moved)
        # A direction that no mode moves, as the second one of a point on a line, still needs a row.
        still = {key: np.zeros(len(self.groups[0][0])) for key in shapes if key not in taken}
        first = self.implicit_shapes[0] | still
        order = sorted(first, key=lambda key: (isinstance(key, int), key))
        self.implicit_shapes[0] = {key: first[key] for key in order}

    def per_mode(self, values: np.ndarray) -> np.ndarray:
        """values (mode, ...) in the padded order, zeros between: (padded mode, ...)."""
        out = np.zeros((self.padded, *values.shape[1:]))
        out[self.place] = values
        return out

    def modal(self, dt: float) -> Modal:
        """The kernel's Modal for a step of dt [s]."""
        return self._modal(dt)

    @cache  # noqa: B019 (a layout lives as long as its run)
    def _modal(self, dt: float) -> Modal:
        step = self.step(dt)
        row_start, force_row_start, channels = [0], [], []
        shapes: list[np.ndarray] = []  # (row, mode) of each group
        acting: list[np.ndarray] = []
        compliance: list[np.ndarray] = []
        for g, (modes, driven) in enumerate(self.groups):
            implicit = len(self.implicit_shapes[g])
            padding = (0, 0), (0, self.mode_start[g + 1] - self.mode_start[g] - len(modes))
            moved, moving = self._group_row_shapes(g), self._group_acting_shapes(g)
            shapes.append(np.pad(moved, padding))
            acting.append(np.pad(moving, padding))
            compliance.append(((moved * step.mode_compliance[modes]) @ moving.T).ravel())
            force_row_start.append(row_start[-1] + implicit)
            row_start.append(row_start[-1] + len(moved))
            channels += [-1] * implicit + driven
        return Modal(
            dt=float(dt),
            mode_start=self.mode_start,
            row_start=np.array(row_start, np.int64),
            force_row_start=np.array(force_row_start, np.int64),
            row_force_channel=np.array(channels, np.int64),
            shapes=np.concatenate([_by_panel(rows) for rows in shapes]),
            acting_shapes=np.concatenate([_by_panel(rows) for rows in acting]),
            shape_start=_starts(shapes),
            row_compliance=np.concatenate([*compliance, np.zeros(1)]),
            compliance_start=_starts(compliance),
            **self._blocks(shapes, compliance),
            velocity_weights=step.velocity_weights,
            **{name: self.per_mode(getattr(step, name)) for name in MODE_COEFFICIENTS},
        )

    def _blocks(
        self, shapes: list[np.ndarray], compliance: list[np.ndarray]
    ) -> dict[str, np.ndarray]:
        """The tables of Modal for one run, from those of every group."""
        by_mode, by_force = [], []
        for g, (moved, square) in enumerate(zip(shapes, compliance, strict=True)):
            implicit = len(self.implicit_shapes[g])
            if self.lanes == 1:
                blocks = _blocks_of_rows(moved)
                panels = blocks.reshape(len(blocks), moved.shape[1] // PANEL, PANEL, PANEL)
                by_mode.append(panels.transpose(1, 0, 2, 3).ravel())
                rows = int(np.sqrt(square.size))
                on_forces = square.reshape(rows, rows)[:implicit, :implicit]
                by_force.append(_blocks_of_rows(on_forces).ravel())
        none = [np.zeros(0)]
        return {
            "block_shapes": np.concatenate(by_mode + none),
            "block_shape_start": _starts(by_mode + none),
            "block_compliance": np.concatenate(by_force + none),
            "block_compliance_start": _starts(by_force + none),
        }

    @cache  # noqa: B019 (a layout lives as long as its run)
    def step(self, dt: float) -> StepCoefficients:
        """The step of the model's modes, dt in s."""
        return step_coefficients(self.scheme, self.model.omega, self.model.damping, dt)

    def _group_row_shapes(self, g: int) -> np.ndarray:
        """Shape of every row of group g over its modes: (row, mode of the group)."""
        modes, driven = self.groups[g]
        drive = self.force_shapes[modes][:, driven].T
        implicit = list(self.implicit_shapes[g].values())
        return np.array([*implicit, *drive]).reshape(-1, len(modes))

    def _group_acting_shapes(self, g: int) -> np.ndarray:
        """The same of the modes that a force on the row moves."""
        return self._group_row_shapes(g)

    @cached_property
    def row_shapes(self) -> np.ndarray:
        """Shape of every row over the model's modes: (row, mode)."""
        out = np.zeros((self._rows_and_supports()[0], self.model.omega.size))
        row = 0
        for g, (modes, _) in enumerate(self.groups):
            for shape in self._group_row_shapes(g):
                out[row, modes] = shape
                row += 1
        return out

    def contact_rows(self) -> np.ndarray:
        """Row of each contact point and direction: (contact_point, 2) int."""
        rows = self._rows()
        points = self.model.support_of_point.size
        return np.array(
            [[rows[point, direction] for direction in range(2)] for point in range(points)],
            np.int64,
        ).reshape(-1, 2)

    def element_rows(self) -> np.ndarray:
        """Row of each local element: (element,) int."""
        rows = self._rows()
        return np.array(
            [rows[element] for element in range(len(self.model.element_names))], np.int64
        )

    def partner_rows(self) -> np.ndarray:
        """Row of the element whose velocity counts in each local element's drag, -1 for none:
        (element,) int.
        """
        partner = np.asarray(self.model.local_laws.drag_partner, np.int64)
        rows = self.element_rows()
        return np.array([rows[other] if other >= 0 else -1 for other in partner], np.int64)

    def _rows(self) -> dict[RowKey, int]:
        rows: dict[RowKey, int] = {}
        row = 0
        for keys, (_, driven) in zip(self.implicit_shapes, self.groups, strict=True):
            rows.update({key: row + r for r, key in enumerate(keys)})
            row += len(keys) + len(driven)
        return rows

    def contact(self, gap: np.ndarray, imperfection: np.ndarray, contraction: float) -> Contact:
        """The kernel's Contact. Points with special laws are never touched in it, see laws().

        gap (lane,): nominal gap, m.
        imperfection (contact_point, 2, lane): offset added to the centres of the obstacles, m.
        contraction: factor of the contact iteration (contact_convergence.contact_contraction); it
            sets the tolerance at which the iteration ends.
        """
        model, rows = self.model, self.contact_rows()
        ones, plain = np.ones(self.lanes), model.contact_laws.plain
        offset = model.centre_offset[:, :, None] + imperfection
        return Contact(
            row_1=rows[:, 0].copy(),
            row_2=rows[:, 1].copy(),
            support=model.support_of_point.astype(np.int64),
            stiffness=np.outer(model.contact_stiffness, ones),
            gap=np.where(plain[:, None], self.gaps(gap), np.inf),
            offset_1=np.ascontiguousarray(offset[:, 0]),
            offset_2=np.ascontiguousarray(offset[:, 1]),
            plain=plain.astype(np.int64),
            tolerance=min(
                FIXED_POINT_TOLERANCE, FIXED_POINT_ERROR / max(contraction, FIXED_POINT_ERROR)
            ),
            max_passes=FIXED_POINT_PASSES,
            limit=DIVERGED_DISPLACEMENT,
        )

    def gaps(self, gap: np.ndarray) -> np.ndarray:
        """Gap of each contact point, (contact_point, lane) m: the law's if it gives one, else the
        nominal gap (lane,) m times the point's factor.
        """
        given = self.model.contact_laws.gap[:, None]
        return np.where(np.isnan(given), np.outer(self.model.gap_factor, gap), given)

    def laws(self, gap: np.ndarray) -> Laws:
        """The kernel's Laws: every contact point that is not plain (once per land), then the local
        elements. gap (lane,): nominal gap, m.
        """
        model, special = self.model, self.model.contact_laws
        round_points = self._round_points()
        point = np.concatenate(
            [np.array(round_points, np.int64), np.asarray(special.land_point, np.int64)]
        )
        normal = np.concatenate([np.zeros((len(round_points), 2)), special.land_normal])
        extra = np.concatenate([np.zeros(len(round_points)), special.land_extra_gap])
        columns = {name: values[point] for name, values in _contact_columns(model).items()}
        columns |= _element_columns(model)
        return Laws(
            contact_point=point,
            land=law_lands(model, round_points)[0],
            flat=np.repeat([0, 1], [len(round_points), len(special.land_point)]).astype(np.int64),
            normal_1=np.outer(normal[:, 0], np.ones(self.lanes)),
            normal_2=np.outer(normal[:, 1], np.ones(self.lanes)),
            lobes=special.lobes[point].astype(np.int64),
            gap=self.gaps(gap)[point] + extra[:, None],
            element_row=self.element_rows(),
            partner_row=self.partner_rows(),
            **{name: np.outer(values, np.ones(self.lanes)) for name, values in columns.items()},
        )

    def _round_points(self) -> list[int]:
        """The contact points with a special law round the centre, without flat lands."""
        laws = self.model.contact_laws
        lands = set(laws.land_point)
        return [int(point) for point in np.flatnonzero(~laws.plain) if point not in lands]

    def trace(self, steps: int) -> Trace:
        """Room for a number of steps of every row, none for 0."""
        rows, _ = self._rows_and_supports()
        shape = rows, steps, self.lanes
        return Trace(aligned(shape), aligned(shape), int(steps))

    def hold(self, modal: Modal) -> Hold:
        """The kernel's Hold: no sensor is held."""
        none = np.zeros(0, np.int64)
        empty = [np.zeros((0, self.lanes)) for _ in range(7)]
        return Hold(none, np.zeros(1, np.int64), none, np.zeros((0, 0, self.lanes)), *empty)

    def fluid(self, modal: Modal, cases: int, laws: Sequence[FluidLaws] = ()) -> Fluid:
        """The kernel's Fluid of the first lanes; lanes without stops nearby would grow.

        laws: those of each case, none for the model's in all.
        """
        drives, rows = self.drive_shapes.shape[1], self.model.fluid_shapes.shape[1]
        own = [np.flatnonzero(modal.row_force_channel == drives + x) for x in range(rows)]
        lanes = laws or [self.model.fluid_laws] * cases
        lags = self.model.fluid_laws.lag_rate.shape[1]

        def stacked(name: str) -> np.ndarray:
            values = np.stack([getattr(lane, name).reshape(-1) for lane in lanes], axis=-1)
            return np.pad(values, ((0, 0), (0, self.lanes - len(lanes))))

        turn = np.maximum(stacked("lag_rate") * modal.dt, 1.0e-300)
        moving = ("force", "displacement", "free", "memory")
        return Fluid(
            row_start=np.cumsum([0, *map(len, own)]).astype(np.int64),
            row=np.concatenate([*own, np.zeros(0, np.int64)]).astype(np.int64),
            lag_start=lags * np.arange(rows + 1, dtype=np.int64),
            decay=np.exp(-turn),
            gain=-np.expm1(-turn) / turn,
            lag=aligned((rows * lags, self.lanes)),
            **{name: stacked(name) for name in ("stiffness", "damping", "lag_stiffness")},
            **{name: aligned((rows, self.lanes)) for name in moving},
        )

    def state(self) -> State:
        """A structure at rest."""
        rows, supports = self._rows_and_supports()
        laws, elements = self._laws_and_elements()
        other_channels = 2 * supports + self.drive_shapes.shape[1]
        return State(
            q=aligned((RATIO, self.padded, self.lanes)),
            q_next_free=aligned((self.padded, self.lanes)),
            dq=aligned((self.padded, self.lanes)),
            group_active=np.array([len(driven) > 0 for _, driven in self.groups], np.int64),
            row_displacement=aligned((rows, self.lanes)),
            row_displacement_before=aligned((rows, self.lanes)),
            row_velocity=aligned((rows, self.lanes)),
            row_force=aligned((rows, self.lanes)),
            row_force_before=aligned((rows, self.lanes)),
            row_deflection=aligned((rows, self.lanes)),
            row_deflection_before=aligned((rows, self.lanes)),
            friction_force=aligned((laws, self.lanes)),
            slider_force=aligned((elements, self.lanes)),
            touching=aligned((supports, self.lanes)),
            filter_sums=aligned((SLOTS, self.padded + other_channels, self.lanes)),
            counter=np.array([QUIET, 0], np.int64),
        )

    def tally(self) -> Tally:
        """Sums at zero."""
        rows, supports = self._rows_and_supports()
        sections, elements = self.model.stress_shapes.shape[1], len(self.model.element_names)
        counts = {
            "element_work": elements,
            "slip_work": elements,
            "land_work": law_lands(self.model, self._round_points())[1],
            "input_work": 1,
            "fluid_work": 1,
            "contact_work": 1,
            "residual": 1,
            "dissipated": 1,
            "force_displacement": rows,
            "square_displacement": rows,
            "row_work": rows,
            "row_force": rows,
            "displacement_sum": rows,
            "square_velocity": rows,
            "product_displacement": self.model.contact_shapes.shape[1],
            "product_velocity": self.model.contact_shapes.shape[1],
            "square_stress": sections,
            "peak_square_stress": sections,
        }
        return Tally(
            **{name: aligned((counts.get(name, supports), self.lanes)) for name in Tally._fields}
        )

    def work(self) -> Work:
        """Work space of a step."""
        rows, supports = self._rows_and_supports()
        laws, elements = self._laws_and_elements()
        counts = {
            "channels": self._channel_shapes().shape[1] + 1,
            "resultant": 2 * supports,
            "friction_force": laws,
            "frozen_friction_force": laws,
            "slider_force": elements,
            "frozen_slider_force": elements,
        }
        space = {
            name: aligned((counts.get(name, rows), self.lanes))
            for name in Work._fields
            if name != "bearing"
        }
        return Work(**space, bearing=np.zeros(rows, np.int64))

    def output(self, weights: np.ndarray, columns: int, steps_per_second: float) -> Output:
        """Output buffers: displacement channels are the sensors, then the shape line; then the
        stresses of each section.

        weights (RATIO, SLOTS): first stage of the output filter.
        columns: ticks that the buffers hold.
        steps_per_second: Hz.
        """
        channels = self._channel_shapes()
        stress_start = channels.shape[1] - 2 * self.model.stress_shapes.shape[1]
        start, stress_entry = [0], []
        entries: list[int] = []
        shapes: list[np.ndarray] = []
        for g, (modes, _) in enumerate(self.groups):
            padding = self.mode_start[g + 1] - self.mode_start[g] - len(modes)
            seen = np.flatnonzero(np.any(channels[modes], axis=0))
            displacements = _whole_blocks(seen[seen < stress_start], channels.shape[1])
            stresses = _whole_blocks(seen[seen >= stress_start], channels.shape[1])
            stress_entry.append(len(entries) + len(displacements))
            for channel in displacements + stresses:
                filler = channel == channels.shape[1]
                shape = np.zeros(len(modes)) if filler else channels[modes, channel]
                entries.append(channel)
                shapes.append(np.pad(shape, (0, padding)))
            start.append(len(entries))
        _, supports = self._rows_and_supports()
        other_channels = 2 * supports + self.drive_shapes.shape[1]
        return Output(
            weights=weights,
            channel_start=np.array(start, np.int64),
            stress_entry=np.array(stress_entry, np.int64),
            channel=np.array(entries, np.int64),
            shapes=np.concatenate([*shapes, np.zeros(1)]),
            shape_start=_starts(shapes),
            stress_start=int(stress_start),
            stress_weight=stress_weight(steps_per_second),
            supports=supports,
            values=aligned((stress_start + other_channels, columns, self.lanes)),
            columns=int(columns),
            column=0,
        )

    def _channel_shapes(self) -> np.ndarray:
        """Shapes of the sensors, the shape line and the stresses: (mode, channel)."""
        model = self.model
        sections = model.stress_shapes.shape[1]
        stresses = model.stress_shapes.reshape(model.omega.size, 2 * sections)
        return np.concatenate([model.sensor_shapes, model.line_shapes, stresses], axis=1)

    def _rows_and_supports(self) -> tuple[int, int]:
        rows = sum(
            len(keys) + len(driven)
            for keys, (_, driven) in zip(self.implicit_shapes, self.groups, strict=True)
        )
        return rows, len(self.model.support_names)

    def _laws_and_elements(self) -> tuple[int, int]:
        laws = len(self._round_points()) + len(self.model.contact_laws.land_point)
        return laws, len(self.model.element_names)


def stress_weight(steps_per_second: float) -> np.ndarray:
    """Steps that a stress taken at each phase of a tick stands for, (RATIO,): as few phases as
    STRESS_RATE needs, evenly spread.
    """
    taken = min(RATIO, int(np.ceil(STRESS_RATE * RATIO / steps_per_second)))
    weights = np.zeros(RATIO)
    weights[np.arange(taken) * RATIO // taken] = RATIO / taken
    return weights


def _contact_columns(model: ModalModel) -> dict[str, np.ndarray]:
    """Parameters of the special contact laws in the kernel's terms, each (contact_point,)."""
    laws = model.contact_laws
    stick = np.where(laws.friction != 0.0, laws.stick_stiffness, 0.0)
    return {
        "lobe_depth": laws.lobe_depth,
        "lobe_cosine": np.cos(laws.lobe_angle),
        "lobe_sine": np.sin(laws.lobe_angle),
        "stiffness": np.where(laws.hertz != 0.0, 0.0, model.contact_stiffness),
        "hertz": laws.hertz,
        "hunt_crossley": laws.hunt_crossley,
        "damping": laws.damping,
        "friction": laws.friction,
        "stick_stiffness": stick,
        "stick_flexibility": _inverse(stick),
    }


def _element_columns(model: ModalModel) -> dict[str, np.ndarray]:
    """Parameters of the local elements in the kernel's terms, each (element,)."""
    laws = model.local_laws
    slider = np.where(laws.slip_limit != 0.0, laws.stick_stiffness, 0.0)
    return {
        "element_stiffness": laws.stiffness,
        "quadratic": laws.quadratic,
        "cubic": laws.cubic,
        "element_damping": laws.damping,
        "damping_limit": np.where(laws.damping_limit != 0.0, laws.damping_limit, np.inf),
        "drag": laws.drag,
        "slider_stiffness": slider,
        "slider_flexibility": _inverse(slider),
        "slip_limit": laws.slip_limit,
        "saturation_stiffness": laws.saturation_stiffness,
        "saturation_limit": laws.saturation_limit,
    }


def _whole_blocks(channels: np.ndarray, filler: int) -> list[int]:
    """The channels, filled up to a multiple of CHANNEL_BLOCK."""
    return [int(channel) for channel in channels] + [filler] * (-len(channels) % CHANNEL_BLOCK)


def _blocks_of_rows(values: np.ndarray) -> np.ndarray:
    """values (row, column) as (block, column, PANEL rows), padded with zeros."""
    padded = np.pad(values, ((0, -len(values) % PANEL), (0, 0)))
    return padded.reshape(len(padded) // PANEL, PANEL, values.shape[1]).transpose(0, 2, 1)


def _by_panel(rows: np.ndarray) -> np.ndarray:
    """(row, mode) flat, as the kernel goes through it: panel by panel, row by row."""
    panels = rows.reshape(len(rows), rows.shape[1] // PANEL, PANEL)
    return panels.transpose(1, 0, 2).ravel()


def _starts(parts: Sequence[np.ndarray]) -> np.ndarray:
    """Index of the first value of each part when they are put end to end."""
    return np.concatenate([[0], np.cumsum([part.size for part in parts])[:-1]]).astype(np.int64)


def _inverse(values: np.ndarray) -> np.ndarray:
    """1 / values, 0 where they are 0."""
    return np.divide(1.0, values, out=np.zeros(np.shape(values)), where=values != 0.0)


def aligned(shape: tuple[int, ...]) -> np.ndarray:
    """Zeros that start on a cache line, so that no vector straddles two; room behind them for a
    block of rows.
    """
    count = int(np.prod(shape))
    raw = np.zeros(count + 8 + PANEL)
    first = (-raw.ctypes.data // 8) % 8
    return raw[first : first + count].reshape(shape)
