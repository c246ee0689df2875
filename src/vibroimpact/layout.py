"""The reduced model laid out for the kernel: uncoupled groups of modes, panels, rows and lanes."""

import numpy as np

from .kernels import CHANNEL_BLOCK, LANES, PANEL, RATIO, SLOTS, Contact, Modal, Output, State, Tally, Work
from .model import ModalModel

FIXED_POINT_TOLERANCE = 1e-4
FIXED_POINT_PASSES = 40
DIVERGED_DISPLACEMENT = 1e3  # m


class ModalLayout:
    """Where the modes, contact rows and force rows of a ModalModel sit in the kernel's flat arrays.

    groups: list of (mode indices, contact rows as (contact_point, direction), force channels); padded: modes after
    padding every group to whole panels; place (mode,) position of each mode.
    """

    def __init__(self, model: ModalModel):
        self.model = model
        self.groups = []
        for modes, contacts in model.blocks:
            driven = [c for c in range(model.drive_shapes.shape[1]) if np.any(model.drive_shapes[modes, c])]
            self.groups.append((np.asarray(modes), list(contacts), driven))
        widths = [-(-len(modes) // PANEL) * PANEL for modes, _, _ in self.groups]
        self.mode_start = np.concatenate([[0], np.cumsum(widths)]).astype(np.int64)
        self.padded = int(self.mode_start[-1])
        self.place = np.zeros(model.omega.size, np.int64)
        for g, (modes, _, _) in enumerate(self.groups):
            self.place[modes] = self.mode_start[g] + np.arange(len(modes))

    def per_mode(self, values: np.ndarray) -> np.ndarray:
        """values (mode, ...) moved to the padded order, zeros between: (padded mode, ...)."""
        out = np.zeros((self.padded, *values.shape[1:]))
        out[self.place] = values
        return out

    def modal(self, dt: float) -> Modal:
        """The kernel's Modal for a step of dt [s]."""
        newmark = newmark_coefficients(self.model.omega, self.model.damping, dt)
        row_start, force_row_start, channels = [0], [], []
        shapes, shape_start, compliance, compliance_start = [], [], [], []
        for g, (modes, contacts, driven) in enumerate(self.groups):
            rows = np.zeros((len(contacts) + len(driven), self.mode_start[g + 1] - self.mode_start[g]))
            for r, (point, direction) in enumerate(contacts):
                rows[r, : len(modes)] = self.model.contact_shapes[modes, point, direction]
            for r, channel in enumerate(driven):
                rows[len(contacts) + r, : len(modes)] = self.model.drive_shapes[modes, channel]
            touched = rows[: len(contacts), : len(modes)]
            shape_start.append(sum(map(np.size, shapes)))
            compliance_start.append(sum(map(np.size, compliance)))
            shapes.append(rows.ravel())
            compliance.append(((touched * newmark["displacement_from_force"][modes]) @ touched.T).ravel())
            force_row_start.append(row_start[-1] + len(contacts))
            row_start.append(row_start[-1] + len(rows))
            channels += [-1] * len(contacts) + driven
        return Modal(
            dt=float(dt),
            mode_start=self.mode_start,
            row_start=np.array(row_start, np.int64),
            force_row_start=np.array(force_row_start, np.int64),
            row_force_channel=np.array(channels, np.int64),
            shapes=np.concatenate(shapes),
            shape_start=np.array(shape_start, np.int64),
            compliance=np.concatenate([*compliance, np.zeros(1)]),
            compliance_start=np.array(compliance_start, np.int64),
            **{name: self.per_mode(values) for name, values in newmark.items()},
        )

    def contact_rows(self) -> np.ndarray:
        """Row of each contact point and direction: (contact_point, 2) int."""
        rows = np.zeros((self.model.support_of_point.size, 2), np.int64)
        row = 0
        for _, contacts, driven in self.groups:
            for point, direction in contacts:
                rows[point, direction] = row
                row += 1
            row += len(driven)
        return rows

    def contact(self, gap: np.ndarray, imperfection: np.ndarray) -> Contact:
        """The kernel's Contact: gap (lane,) nominal gap [m]; imperfection (contact_point, 2, lane) [m] added to the centres."""
        model, rows = self.model, self.contact_rows()
        ones = np.ones(LANES)
        offset = model.centre_offset[:, :, None] + imperfection
        return Contact(
            row_1=rows[:, 0].copy(),
            row_2=rows[:, 1].copy(),
            support=model.support_of_point.astype(np.int64),
            stiffness=np.outer(model.contact_stiffness, ones),
            gap=np.outer(model.gap_factor, gap),
            offset_1=np.ascontiguousarray(offset[:, 0]),
            offset_2=np.ascontiguousarray(offset[:, 1]),
            tolerance=FIXED_POINT_TOLERANCE,
            passes=FIXED_POINT_PASSES,
            limit=DIVERGED_DISPLACEMENT,
        )

    def state(self) -> State:
        """A structure at rest."""
        rows, supports = self._sizes()
        extras = 2 * supports + self.model.drive_shapes.shape[1]
        return State(
            displacement=_aligned((RATIO, self.padded, LANES)),
            velocity=_aligned((self.padded, LANES)),
            row_displacement=_aligned((rows, LANES)),
            row_force=_aligned((rows, LANES)),
            row_force_before=_aligned((rows, LANES)),
            row_pull=_aligned((rows, LANES)),
            row_pull_before=_aligned((rows, LANES)),
            touching=_aligned((supports, LANES)),
            average=_aligned((SLOTS, self.padded + extras, LANES)),
            flag=np.zeros(2, np.int64),
        )

    def tally(self) -> Tally:
        """Sums at zero."""
        rows, supports = self._sizes()
        sections = self.model.stress_shapes.shape[1]
        counts = {
            "input_work": 1, "contact_work": 1, "residual": 1, "dissipated": 1,
            "force_displacement": rows, "square_displacement": rows, "square_stress": sections, "peak_square_stress": sections,
        }  # fmt: skip
        return Tally(**{name: _aligned((counts.get(name, supports), LANES)) for name in Tally._fields})

    def work(self) -> Work:
        """Scratch space."""
        rows, _ = self._sizes()
        model = self.model
        channels = model.sensor_shapes.shape[1] + model.line_shapes.shape[1] + 2 * model.stress_shapes.shape[1] + 1
        return Work(*[_aligned((rows, LANES)) for _ in Work._fields[:-1]], _aligned((channels, LANES)))

    def output(self, weights: np.ndarray, columns: int) -> Output:
        """Output buffers: displacement channels are the sensors, then the shape line; then the stresses of each section."""
        model = self.model
        sections = model.stress_shapes.shape[1]
        channels = np.concatenate(
            [model.sensor_shapes, model.line_shapes, model.stress_shapes.reshape(model.omega.size, 2 * sections)], axis=1
        )
        stress_start = channels.shape[1] - 2 * sections
        start, entries, shapes, shape_start = [0], [], [], []
        for g, (modes, _, _) in enumerate(self.groups):
            width = self.mode_start[g + 1] - self.mode_start[g]
            seen = [int(c) for c in np.flatnonzero(np.any(channels[modes], axis=0))]
            for c in seen + [-1] * (-len(seen) % CHANNEL_BLOCK):  # whole blocks; a filler adds zeros to a spare channel
                entries.append(c if c >= 0 else channels.shape[1])
                shape_start.append(sum(map(np.size, shapes)))
                shapes.append(np.pad(channels[modes, c] if c >= 0 else np.zeros(len(modes)), (0, width - len(modes))))
            start.append(len(entries))
        _, supports = self._sizes()
        extras = 2 * supports + model.drive_shapes.shape[1]
        return Output(
            weights=weights,
            channel_start=np.array(start, np.int64),
            channel=np.array(entries, np.int64),
            shapes=np.concatenate([*shapes, np.zeros(1)]),
            shape_start=np.array(shape_start, np.int64),
            stress_start=int(stress_start),
            extra_support=supports,
            values=_aligned((stress_start + extras, columns, LANES)),
            columns=int(columns),
            column=0,
        )

    def _sizes(self):
        rows = sum(len(contacts) + len(driven) for _, contacts, driven in self.groups)
        return rows, len(self.model.support_names)


def _aligned(shape):
    """Zeros that start on a cache line, so that no vector straddles two."""
    count = int(np.prod(shape))
    raw = np.zeros(count + 8)
    first = (-raw.ctypes.data // 8) % 8
    return raw[first : first + count].reshape(shape)


def newmark_coefficients(omega: np.ndarray, damping: np.ndarray, dt: float) -> dict[str, np.ndarray]:
    """Newmark average acceleration, no numerical dissipation, as one linear map per mode: dict of (mode,) arrays.

    With f = f0 + f1 the sum of the modal forces at both ends of the step,
        v1 = velocity_from_velocity v0 + velocity_from_displacement q0 + velocity_from_force f
        q1 = q0 + dt/2 (v0 + v1)
           = displacement_from_displacement q0 + displacement_from_velocity v0 + displacement_from_force f.
    Source: Newmark 1959 with beta = 1/4, gamma = 1/2, the acceleration eliminated by the equation of motion.
    """
    stiff, drag = (0.5 * dt * omega) ** 2, 0.5 * dt * damping
    scale = 1.0 / (1.0 + drag + stiff)
    velocity = {
        "velocity_from_velocity": (1.0 - drag - stiff) * scale,
        "velocity_from_displacement": -dt * omega**2 * scale,
        "velocity_from_force": 0.5 * dt * scale,
    }
    return velocity | {
        "displacement_from_displacement": 1.0 + 0.5 * dt * velocity["velocity_from_displacement"],
        "displacement_from_velocity": 0.5 * dt * (1.0 + velocity["velocity_from_velocity"]),
        "displacement_from_force": 0.5 * dt * velocity["velocity_from_force"],
        "loss": 0.25 * dt * damping,
    }
