"""The reduced model laid out for the kernel: uncoupled groups of modes, panels, rows and lanes."""

from functools import cache, cached_property

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .kernels.decimation import CHANNEL_BLOCK, RATIO, SLOTS
from .kernels.lanes import LANES
from .kernels.panels import PANEL
from .kernels.tables import QUIET, Contact, Laws, Modal, Output, State, Tally, Trace, Work
from .modal_step import StepCoefficients, step_coefficients

FIXED_POINT_TOLERANCE = 1e-4  # relative change of the contact forces in the last pass, at most
FIXED_POINT_ERROR = (
    1e-6  # relative error that may be left in them: the change times the contraction
)
FIXED_POINT_PASSES = 40
DIVERGED_DISPLACEMENT = 1e3  # m
STRESS_RATE = 1e4  # Hz at least, of the stresses behind RMS and peak


class ModalLayout:
    """Where the modes, contact rows and force rows of a ModalModel sit in the kernel's flat arrays.

    groups: list of (mode indices, force rows); padded: modes after padding every group to whole
    panels; place (mode,) position of each mode; implicit_shapes: for each group {row key: (mode of
    the group,)} with the key (contact_point, direction) of a contact or the index of an element, in
    the order of their rows; drive_shapes (mode, force_channel): the model's channels, then, where
    there is one, the dead load as a channel of constant 1.
    """

    def __init__(self, model: ModalModel, scheme: str):
        self.model, self.scheme = model, scheme
        self.drive_shapes = model.drive_shapes
        if np.any(model.constant_force):
            self.drive_shapes = np.column_stack([model.drive_shapes, model.constant_force])
        self.groups, self.implicit_shapes = [], []
        shapes = {
            (point, direction): model.contact_shapes[:, point, direction]
            for point in range(model.contact_shapes.shape[1])
            for direction in range(2)
        }
        shapes |= {
            element: model.element_shapes[:, element] for element in range(len(model.element_names))
        }
        taken = set()
        for modes, _ in model.blocks:
            moved = {key: shape[modes] for key, shape in shapes.items() if np.any(shape[modes])}
            driven = [
                c for c in range(self.drive_shapes.shape[1]) if np.any(self.drive_shapes[modes, c])
            ]
            self.groups.append((np.asarray(modes), driven))
            self.implicit_shapes.append(moved)
            taken |= set(moved)
        # A direction that nothing moves, as the second one of a point on a line, still needs a row
        # to read.
        still = {key: np.zeros(len(self.groups[0][0])) for key in shapes if key not in taken}
        self.implicit_shapes[0] = dict(
            sorted(
                (self.implicit_shapes[0] | still).items(),
                key=lambda item: (isinstance(item[0], int), item[0]),
            )
        )
        widths = [-(-len(modes) // PANEL) * PANEL for modes, _ in self.groups]
        self.mode_start = np.concatenate([[0], np.cumsum(widths)]).astype(np.int64)
        self.padded = int(self.mode_start[-1])
        self.place = np.zeros(model.omega.size, np.int64)
        for g, (modes, _) in enumerate(self.groups):
            self.place[modes] = self.mode_start[g] + np.arange(len(modes))

    def per_mode(self, values: np.ndarray) -> np.ndarray:
        """values (mode, ...) moved to the padded order, zeros between: (padded mode, ...)."""
        out = np.zeros((self.padded, *values.shape[1:]))
        out[self.place] = values
        return out

    def modal(self, dt: float) -> Modal:
        """The kernel's Modal for a step of dt [s]."""
        step = self.step(dt)
        row_start, force_row_start, channels = [0], [], []
        shapes, shape_start, compliance, compliance_start = [], [], [], []
        for g, (modes, driven) in enumerate(self.groups):
            implicit = list(self.implicit_shapes[g].values())
            rows = np.zeros(
                (len(implicit) + len(driven), self.mode_start[g + 1] - self.mode_start[g])
            )
            for r, shape in enumerate([*implicit, *self.drive_shapes[np.ix_(modes, driven)].T]):
                rows[r, : len(modes)] = shape
            moved = rows[:, : len(modes)]
            shape_start.append(sum(map(np.size, shapes)))
            compliance_start.append(sum(map(np.size, compliance)))
            shapes.append(rows.ravel())
            compliance.append(((moved * step.mode_compliance[modes]) @ moved.T).ravel())
            force_row_start.append(row_start[-1] + len(implicit))
            row_start.append(row_start[-1] + len(rows))
            channels += [-1] * len(implicit) + driven
        return Modal(
            dt=float(dt),
            mode_start=self.mode_start,
            row_start=np.array(row_start, np.int64),
            force_row_start=np.array(force_row_start, np.int64),
            row_force_channel=np.array(channels, np.int64),
            shapes=np.concatenate(shapes),
            shape_start=np.array(shape_start, np.int64),
            row_compliance=np.concatenate([*compliance, np.zeros(1)]),
            compliance_start=np.array(compliance_start, np.int64),
            velocity_weights=step.velocity_weights,
            **{
                name: self.per_mode(getattr(step, name))
                for name in (
                    "mode_compliance",
                    "force_shift",
                    "decay",
                    "restoring",
                    "force_gain",
                    "damping_over_dt",
                )
            },
        )

    @cache  # noqa: B019 (a layout lives as long as its run)
    def step(self, dt: float) -> StepCoefficients:
        """The step of the model's modes."""
        return step_coefficients(self.scheme, self.model.omega, self.model.damping, dt)

    @cached_property
    def row_shapes(self) -> np.ndarray:
        """Shape of every row over the model's modes: (row, mode)."""
        out = np.zeros((self._sizes()[0], self.model.omega.size))
        row = 0
        for (modes, driven), implicit in zip(self.groups, self.implicit_shapes, strict=True):
            for shape in [*implicit.values(), *self.drive_shapes[np.ix_(modes, driven)].T]:
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
        """Row of the element whose rate counts in the speed of each local element's drag, -1 for
        none: (element,) int.
        """
        partner = np.asarray(self.model.local_laws.drag_partner, np.int64)
        rows = self.element_rows()
        return np.array([rows[other] if other >= 0 else -1 for other in partner], np.int64)

    def _rows(self):
        rows, row = {}, 0
        for keys, (_, driven) in zip(self.implicit_shapes, self.groups, strict=True):
            rows |= {key: row + r for r, key in enumerate(keys)}
            row += len(keys) + len(driven)
        return rows

    def contact(self, gap: np.ndarray, imperfection: np.ndarray, contraction: float) -> Contact:
        """The kernel's Contact: gap (lane,) nominal gap [m]; imperfection (contact_point, 2, lane)
        [m] added to the centres; contraction of the fixed point (contraction.contact_contraction),
        which sets how far it is followed.

        Points with special laws are out of reach here, see laws().
        """
        model, rows = self.model, self.contact_rows()
        ones, plain = np.ones(LANES), model.contact_laws.plain
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
        """Gap [m] of each contact point, (contact_point, lane): its own where it has one, else the
        case's times its factor.
        """
        own = self.model.contact_laws.gap
        return np.where(np.isnan(own)[:, None], np.outer(self.model.gap_factor, gap), own[:, None])

    def laws(self, gap: np.ndarray) -> Laws:
        """The kernel's Laws: every contact point that is not plain (once per land), then the local
        elements.
        """
        model, own, local = self.model, self.model.contact_laws, self.model.local_laws
        round_points = [
            point for point in np.flatnonzero(~own.plain) if point not in set(own.land_point)
        ]
        point = np.concatenate(
            [np.array(round_points, np.int64), np.asarray(own.land_point, np.int64)]
        )
        normal = np.concatenate([np.zeros((len(round_points), 2)), own.land_normal])
        contact = {
            "lobe_depth": own.lobe_depth,
            "lobe_cosine": np.cos(own.lobe_angle),
            "lobe_sine": np.sin(own.lobe_angle),
            "stiffness": np.where(own.hertz != 0.0, 0.0, model.contact_stiffness),
            "hertz": own.hertz,
            "hunt_crossley": own.hunt_crossley,
            "damping": own.damping,
            "friction": own.friction,
            "stick_stiffness": np.where(own.friction != 0.0, own.stick_stiffness, 0.0),
            "stick_flexibility": _inverse(np.where(own.friction != 0.0, own.stick_stiffness, 0.0)),
        }
        slider = np.where(local.slip_limit != 0.0, local.stick_stiffness, 0.0)
        element = {
            "element_stiffness": local.stiffness,
            "quadratic": local.quadratic,
            "cubic": local.cubic,
            "element_damping": local.damping,
            "drag": local.drag,
            "slider_stiffness": slider,
            "slider_flexibility": _inverse(slider),
            "slip_limit": local.slip_limit,
            "saturation_stiffness": local.saturation_stiffness,
            "saturation_limit": local.saturation_limit,
        }
        return Laws(
            contact_point=point,
            flat=np.repeat([0, 1], [len(round_points), len(own.land_point)]).astype(np.int64),
            normal_1=normal[:, 0].copy(),
            normal_2=normal[:, 1].copy(),
            lobes=own.lobes[point].astype(np.int64),
            gap=np.ascontiguousarray(self.gaps(gap)[point]),
            element_row=self.element_rows(),
            partner_row=self.partner_rows(),
            **{name: np.outer(values[point], np.ones(LANES)) for name, values in contact.items()},
            **{name: np.outer(values, np.ones(LANES)) for name, values in element.items()},
        )

    def trace(self, steps: int) -> Trace:
        """Room for `steps` steps of every row, none for 0."""
        rows, _ = self._sizes()
        return Trace(_aligned((rows, steps, LANES)), _aligned((rows, steps, LANES)), int(steps))

    def state(self) -> State:
        """A structure at rest."""
        rows, supports = self._sizes()
        laws, elements = self._law_sizes()
        extras = 2 * supports + self.drive_shapes.shape[1]
        return State(
            q=_aligned((RATIO, self.padded, LANES)),
            q_next_free=_aligned((self.padded, LANES)),
            dq=_aligned((self.padded, LANES)),
            group_active=np.array([len(driven) > 0 for _, driven in self.groups], np.int64),
            row_displacement=_aligned((rows, LANES)),
            row_velocity=_aligned((rows, LANES)),
            row_force=_aligned((rows, LANES)),
            row_force_before=_aligned((rows, LANES)),
            row_deflection=_aligned((rows, LANES)),
            row_deflection_before=_aligned((rows, LANES)),
            friction_force=_aligned((laws, LANES)),
            slider_force=_aligned((elements, LANES)),
            touching=_aligned((supports, LANES)),
            filter_sums=_aligned((SLOTS, self.padded + extras, LANES)),
            counter=np.array([QUIET, 0], np.int64),
        )

    def tally(self) -> Tally:
        """Sums at zero."""
        rows, supports = self._sizes()
        sections, elements = self.model.stress_shapes.shape[1], len(self.model.element_names)
        counts = {
            "element_work": elements,
            "slip_work": elements,
            "input_work": 1,
            "contact_work": 1,
            "residual": 1,
            "dissipated": 1,
            "force_displacement": rows,
            "square_displacement": rows,
            "square_stress": sections,
            "peak_square_stress": sections,
        }
        return Tally(
            **{name: _aligned((counts.get(name, supports), LANES)) for name in Tally._fields}
        )

    def work(self) -> Work:
        """Scratch space."""
        rows, _ = self._sizes()
        laws, elements = self._law_sizes()
        model = self.model
        channels = (
            model.sensor_shapes.shape[1]
            + model.line_shapes.shape[1]
            + 2 * model.stress_shapes.shape[1]
            + 1
        )
        counts = {
            "channels": channels,
            "resultant": 2 * len(model.support_names),
            "friction_force": laws,
            "frozen_friction_force": laws,
            "slider_force": elements,
            "frozen_slider_force": elements,
        }
        return Work(**{name: _aligned((counts.get(name, rows), LANES)) for name in Work._fields})

    def output(self, weights: np.ndarray, columns: int, steps_per_second: float) -> Output:
        """Output buffers: displacement channels are the sensors, then the shape line; then the
        stresses of each section.
        """
        model = self.model
        sections = model.stress_shapes.shape[1]
        channels = np.concatenate(
            [
                model.sensor_shapes,
                model.line_shapes,
                model.stress_shapes.reshape(model.omega.size, 2 * sections),
            ],
            axis=1,
        )
        stress_start = channels.shape[1] - 2 * sections
        start, stress_entry, entries, shapes, shape_start = [0], [], [], [], []
        for g, (modes, _) in enumerate(self.groups):
            width = self.mode_start[g + 1] - self.mode_start[g]
            seen = np.flatnonzero(np.any(channels[modes], axis=0))
            for part in (seen[seen < stress_start], seen[seen >= stress_start]):
                for c in [int(c) for c in part] + [-1] * (
                    -len(part) % CHANNEL_BLOCK
                ):  # whole blocks; a filler adds zeros to a spare channel
                    entries.append(c if c >= 0 else channels.shape[1])
                    shape_start.append(sum(map(np.size, shapes)))
                    shapes.append(
                        np.pad(
                            channels[modes, c] if c >= 0 else np.zeros(len(modes)),
                            (0, width - len(modes)),
                        )
                    )
                stress_entry.append(len(entries))
            start.append(len(entries))
        _, supports = self._sizes()
        extras = 2 * supports + self.drive_shapes.shape[1]
        return Output(
            weights=weights,
            channel_start=np.array(start, np.int64),
            stress_entry=np.array(stress_entry[::2], np.int64),  # behind the first of the two parts
            channel=np.array(entries, np.int64),
            shapes=np.concatenate([*shapes, np.zeros(1)]),
            shape_start=np.array(shape_start, np.int64),
            stress_start=int(stress_start),
            stress_weight=stress_weight(steps_per_second),
            supports=supports,
            values=_aligned((stress_start + extras, columns, LANES)),
            columns=int(columns),
            column=0,
        )

    def _sizes(self):
        rows = sum(
            len(keys) + len(driven)
            for keys, (_, driven) in zip(self.implicit_shapes, self.groups, strict=True)
        )
        return rows, len(self.model.support_names)

    def _law_sizes(self):
        own = self.model.contact_laws
        at_lands = np.isin(np.arange(len(own.gap)), own.land_point)
        return int(np.sum(~own.plain & ~at_lands)) + len(own.land_point), len(
            self.model.element_names
        )


def stress_weight(steps_per_second: float) -> np.ndarray:
    """Steps that a stress taken at each phase of a tick stands for, (RATIO,): as few phases as
    STRESS_RATE needs, evenly spread.
    """
    taken = min(RATIO, int(np.ceil(STRESS_RATE * RATIO / steps_per_second)))
    weights = np.zeros(RATIO)
    weights[np.arange(taken) * RATIO // taken] = RATIO / taken
    return weights


def _inverse(values):
    """1 / values, 0 where they are 0."""
    return np.divide(1.0, values, out=np.zeros(np.shape(values)), where=values != 0.0)


def _aligned(shape):
    """Zeros that start on a cache line, so that no vector straddles two."""
    count = int(np.prod(shape))
    raw = np.zeros(count + 8)
    first = (-raw.ctypes.data // 8) % 8
    return raw[first : first + count].reshape(shape)
