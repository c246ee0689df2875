"""The reduced model of a structure: uncoupled modes, and their shapes at contacts and sensors."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vibroimpact.excitation.fluid_elastic import FluidLaws
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws

# Fields whose axes are checked: name -> axis names. An axis has the same length in all fields.
AXES = {
    "omega": ("mode",),
    "damping": ("mode",),
    "contact_shapes": ("mode", "contact_point", 2),
    "contact_directions": ("contact_point", 2, 3),
    "contact_weight": ("contact_point",),
    "support_of_point": ("contact_point",),
    "contact_stiffness": ("contact_point",),
    "gap_factor": ("contact_point",),
    "centre_offset": ("contact_point", 2),
    "contact_position": ("contact_point", 3),
    "preload": ("contact_point",),
    "drive_shapes": ("mode", "force_channel"),
    "sensor_shapes": ("mode", "sensor"),
    "sensor_positions": ("sensor", 3),
    "sensor_directions": ("sensor", 3),
    "line_shapes": ("mode", "line_point"),
    "line_positions": ("line_point", 3),
    "line_arc_length": ("line_point",),
    "stress_shapes": ("mode", "section", 2),
    "full_mode_frequencies": ("full_mode",),
    "element_shapes": ("mode", "element"),
    "initial_displacement": ("mode",),
    "initial_velocity": ("mode",),
    "initial_residual": (2,),
    "constant_force": ("mode",),
    "fluid_shapes": ("mode", "fluid_row"),
}
MODE_FIELDS = tuple(name for name, axes in AXES.items() if axes[0] == "mode")
NAMES = {
    "support_names": "support",
    "sensor_names": "sensor",
    "section_names": "section",
    "element_names": "element",
}


NEAR = 0.05  # of a frequency: largest difference of a measured structure from its model
ROUNDING = 1.0e-9  # of a frequency: a mode that is put NEAR below another is valid
NEUTRAL: Any = None  # default of a field that __post_init__ fills in: there is nothing of it


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalModel:
    """A linear structure on mass-orthonormal, stiffness-orthogonal shapes, with local forces.

    Modal amplitudes are in kg^1/2 m. A shape is a displacement in m per unit amplitude, kg^-1/2.

    Modes:

    omega: (mode,) rad/s, ascending; of two within NEAR of each other the second may be the lower.
    damping: (mode,) 2 zeta omega in 1/s.
    full_mode_frequencies: (full_mode,) Hz, the lowest of the full model without contact.
    initial_displacement, initial_velocity: (mode,) kg^1/2 m and kg^1/2 m/s, state at the start.
    initial_residual: (2,) part of the fields wanted that these do not represent, of displacement
        and velocity, in the norm of the mass.
    constant_force: (mode,) N kg^-1/2.

    Contact points:

    contact_shapes: (mode, contact_point, 2) along the two contact_directions.
    contact_directions: (contact_point, 2, 3) unit vectors.
    contact_weight: (contact_point,) share of the support's stiffness; sums to 1 per support.
    support_of_point: (contact_point,) int, index into support_names.
    contact_stiffness: (contact_point,) N/m.
    gap_factor: (contact_point,), times the case's gap.
    centre_offset: (contact_point, 2) m along the contact directions.
    contact_position: (contact_point, 3) m.
    contact_laws: the terms of the contacts beyond the elastic circle; None for nothing.
    preload: (contact_point,) N, force at rest of each flat land of the point, whose gap is minus
        the indentation that it takes; 0 for none. integration.preload puts the obstacles there.

    Local elements:

    element_shapes: (mode, element) along the element, relative if it has two ends.
    element_names, local_laws: their names and LocalLaws.

    Fluid-elastic force of a flow:

    fluid_shapes: (mode, fluid_row) m^-1/2, see excitation.fluid_rows; fluid_laws: their FluidLaws.

    Force, sensors, shape line and stresses:

    drive_shapes: (mode, force_channel) along the force.
    sensor_shapes: (mode, sensor) along sensor_directions (sensor, 3) at sensor_positions
        (sensor, 3) m; sensor_names like "apex.y".
    line_shapes: (mode, line_point) at line_positions (line_point, 3) m and line_arc_length
        (line_point,) m.
    stress_shapes: (mode, section, 2), outer-fibre stress of the two bending moments in Pa per unit
        modal amplitude, at section_names.

    Raises ValueError that lists every field with a wrong shape or value.
    """

    omega: np.ndarray
    damping: np.ndarray
    contact_shapes: np.ndarray = NEUTRAL
    contact_directions: np.ndarray = NEUTRAL
    contact_weight: np.ndarray = NEUTRAL
    support_of_point: np.ndarray = NEUTRAL
    support_names: tuple[str, ...] = ()
    contact_stiffness: np.ndarray = NEUTRAL
    gap_factor: np.ndarray = NEUTRAL
    centre_offset: np.ndarray = NEUTRAL
    contact_position: np.ndarray = NEUTRAL
    drive_shapes: np.ndarray
    sensor_shapes: np.ndarray
    sensor_names: tuple[str, ...]
    sensor_positions: np.ndarray
    sensor_directions: np.ndarray
    line_shapes: np.ndarray = NEUTRAL
    line_positions: np.ndarray = NEUTRAL
    line_arc_length: np.ndarray = NEUTRAL
    stress_shapes: np.ndarray = NEUTRAL
    section_names: tuple[str, ...] = ()
    full_mode_frequencies: np.ndarray
    contact_laws: ContactLaws = NEUTRAL
    preload: np.ndarray = NEUTRAL
    element_shapes: np.ndarray = NEUTRAL
    element_names: tuple[str, ...] = ()
    local_laws: LocalLaws = NEUTRAL
    initial_displacement: np.ndarray = NEUTRAL
    initial_velocity: np.ndarray = NEUTRAL
    initial_residual: np.ndarray = NEUTRAL
    constant_force: np.ndarray = NEUTRAL
    fluid_shapes: np.ndarray = NEUTRAL
    fluid_laws: FluidLaws = NEUTRAL

    def __post_init__(self) -> None:
        """Fill in the neutral values and check all shapes and values."""
        points = np.size(() if self.support_of_point is NEUTRAL else self.support_of_point)
        elements = len(self.element_names)
        sizes = {"mode": np.size(self.omega), "contact_point": points, "element": elements}
        laws: dict[str, Callable[[], Any]] = {  # made where needed: models are replaced often
            "contact_laws": lambda: ContactLaws.neutral(points),
            "local_laws": lambda: LocalLaws.neutral(elements),
            "fluid_laws": FluidLaws.neutral,
        }
        for name in filter(lambda name: getattr(self, name) is NEUTRAL, (*laws, *AXES)):
            if name in laws:
                value = laws[name]()
            else:
                shape = [
                    each if isinstance(each, int) else sizes.get(each, 0) for each in AXES[name]
                ]
                value = np.zeros(shape, int if name == "support_of_point" else float)
            object.__setattr__(self, name, value)
        problems = [*self._wrong_shapes()] or [*self._wrong_values()]
        if problems:
            raise ValueError("the modal model is not valid: " + "; ".join(problems))

    @property
    def modes(self) -> int:
        """Return the number of modes."""
        return len(self.omega)

    @property
    def frequencies(self) -> np.ndarray:
        """Return (mode,) undamped frequencies in Hz."""
        return self.omega / (2.0 * np.pi)

    @property
    def conservative(self) -> bool:
        """Return True when no contact and no local element dissipates energy."""
        contact, local = self.contact_laws, self.local_laws
        lossy = (
            contact.damping,
            contact.hunt_crossley,
            contact.friction,
            local.damping,
            local.drag,
            local.slip_limit,
        )
        return not any(np.any(column) for column in lossy)

    @property
    def presses_at_rest(self) -> bool:
        """Return True when a flat land begins inside the structure at rest."""
        return bool(np.any(self.contact_laws.gap < 0.0))

    @property
    def preload_force(self) -> np.ndarray:
        """Return (mode,) N kg^-1/2, the force of all preloaded lands on the structure at rest."""
        laws = self.contact_laws
        shapes = self.contact_shapes[:, laws.land_point]  # (mode, land, 2)
        return -np.einsum("mld,ld,l->m", shapes, laws.land_normal, self.preload[laws.land_point])

    @cached_property
    def blocks(self) -> list[tuple[np.ndarray, list[tuple[int, int]]]]:
        """Return [(mode indices (mode,), [(contact_point, direction), ...])]: uncoupled blocks.

        Two modes are in the same block when the same contact point and direction, or the same local
        element, moves in both. A shape of exactly 0.0 is not a motion: the reduction treats
        uncoupled degrees of freedom separately, so zeros are exact. Modes that move no contact
        point and no element form a last block without contacts.
        """
        points = 2 * self.contact_shapes.shape[1]
        shapes = np.hstack([self.contact_shapes.reshape(self.modes, points), self.element_shapes])
        moved = shapes != 0.0
        unassigned = set(range(self.modes))
        groups = []
        while unassigned:
            modes, reached = {min(unassigned)}, np.zeros(moved.shape[1], dtype=bool)
            while True:
                contacts = moved[sorted(modes)].any(axis=0)
                if (contacts == reached).all():
                    break
                reached = contacts
                modes |= set(np.flatnonzero(moved[:, contacts].any(axis=1)).tolist())
            unassigned -= modes
            pairs = [divmod(int(contact), 2) for contact in np.flatnonzero(reached[:points])]
            groups.append((sorted(modes), pairs, reached.any()))
        coupled = [(np.array(members), pairs) for members, pairs, local in groups if local]
        free = sorted(mode for members, _, local in groups if not local for mode in members)
        return coupled + ([(np.array(free), [])] if free else [])

    def _wrong_shapes(self) -> Iterator[str]:
        """Yield a sentence for every array or tuple whose axes disagree."""
        sizes: dict[str, int] = {}
        for name, axes in AXES.items():
            shape = np.shape(getattr(self, name))
            if len(shape) != len(axes):
                yield f"{name} has {len(shape)} axes, expected {axes}"
                continue
            for axis, size in zip(axes, shape, strict=True):
                expected = axis if isinstance(axis, int) else sizes.setdefault(axis, size)
                if size != expected:
                    yield f"{name} has {size} along {axis}, expected {expected}"
        for name, axis in NAMES.items():
            if axis in sizes and len(getattr(self, name)) != sizes[axis]:
                yield f"{name} has {len(getattr(self, name))} names for {sizes[axis]} along {axis}"

    def _wrong_values(self) -> Iterator[str]:
        """Yield a sentence for every value that makes no physical sense."""
        for name in AXES:
            if not np.isfinite(getattr(self, name)).all():
                yield f"{name} holds values that are not finite"
        least = (1.0 - NEAR - ROUNDING) * self.omega[:-1]
        if (self.omega[1:] < least).any() or (self.omega < 0.0).any():
            yield "omega must be ascending and not negative"
        if (self.damping < 0.0).any():
            yield "damping must not be negative"
        points, elements = len(self.support_of_point), len(self.element_names)
        rows = self.fluid_shapes.shape[1]
        for name, column, what, count in (
            ("fluid_laws", self.fluid_laws.velocity, "rows, fluid_shapes", rows),
            ("contact_laws", self.contact_laws.gap, "points, the model", points),
            ("local_laws", self.local_laws.stiffness, "elements, the model", elements),
        ):
            if len(column) != count:
                yield f"{name} are for {len(column)} {what} has {count}"
        if not points:
            return
        count, support = len(self.support_names), self.support_of_point
        if support.min() < 0 or support.max() >= count:
            yield "support_of_point must index support_names"
            return
        shares = np.bincount(support, self.contact_weight, count)
        if not np.abs(shares - 1.0).max() <= 1.0e-9:
            yield f"contact_weight must sum to 1 per support, sums are {shares.tolist()}"
