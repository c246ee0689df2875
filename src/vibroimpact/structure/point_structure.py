"""Structures that are not tubes: masses on springs, matrices, or measured modes; named points."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.structure.contact.supports import ContactPoints, contacts_at_points

from .massless import Condensed, condense_massless
from .matrix_files import MatrixFileError, read_matrix

AXES = {"x": 0, "y": 1, "z": 2}
GROUND = "ground"


@dataclass(frozen=True, eq=False)
class PointStructure:
    """A linear structure known by its matrices and named points.

    The dofs of one known by its measured modes are modal amplitudes in kg^1/2 m.

    mass, stiffness, damping: (dof, dof) sparse, SI.
    dampers: ((dof,) row, coefficient in N s/m) that are not in `damping`; each acts between
        two dofs, or a dof and the ground.
    directions: {point: {axis: dof}}.
    shapes: of measured modes, {point: (3, dof)} in kg^-1/2; None for a structure with a mass.
    contact: the ContactPoints of its supports.
    contact_points: per contact point, the names of its point and of the other point, None for the
        ground.
    condensed: if directions without mass were condensed; `directions` counts the original dofs.
    """

    mass: sparse.csr_array
    stiffness: sparse.csr_array
    damping: sparse.csr_array
    directions: dict
    contact: ContactPoints
    contact_points: list
    dampers: Sequence[tuple[np.ndarray, float]] = ()
    condensed: Condensed | None = None
    shapes: dict[str, np.ndarray] | None = None

    @property
    def dofs(self) -> int:
        """Return the number of degrees of freedom."""
        return self.mass.shape[0]

    def point_rows(self, name: str) -> np.ndarray:
        """Return (3, dof): the displacement of a named point along x, y and z per unit dof.

        Rows are zero if the point has no dof. Raises ValueError for an unknown point.
        """
        if name not in self.directions:
            raise ValueError(
                f"point '{name}' is not among the structure's: {', '.join(sorted(self.directions))}"
            )
        if self.shapes is not None:
            return self.shapes[name]
        rows = np.zeros((3, self.dofs))
        for axis, dof in self.directions[name].items():
            if self.condensed is None:
                rows[AXES[axis], dof] = 1.0
            else:
                rows[AXES[axis]] = self.condensed.recovery[dof]
        return rows

    def contact_rows(self) -> np.ndarray:
        """Return (contact_point, 2, dof): displacement along the two directions of contact.

        It is relative if a contact point has two ends.
        """
        rows = [
            axes @ (self.point_rows(one) - (self.point_rows(other) if other else 0.0))
            for axes, (one, other) in zip(self.contact.directions, self.contact_points, strict=True)
        ]
        return np.array(rows).reshape(-1, 2, self.dofs)

    @property
    def inertia(self) -> np.ndarray:
        """Return (3, dof) in kg: minus the force on each dof per unit acceleration of the base.

        The base accelerates along x, y, z. Raises ValueError for measured modes.
        """
        if self.shapes is not None:
            raise ValueError(
                "structure.kind identified cannot be driven by its base: its mass is not known,"
                " only its modes"
            )
        whole = self.dofs if self.condensed is None else len(self.condensed.kept)
        rigid = np.zeros((whole, 3))
        for axes in self.directions.values():
            for axis, dof in axes.items():
                rigid[dof, AXES[axis]] = 1.0
        if self.condensed is not None:
            rigid = self.condensed.kept.T @ rigid
        return (self.mass @ rigid).T


def build_point_structure(config: ConfigPart) -> PointStructure:
    """Return the PointStructure of a configuration: a chain, matrices or identified modes.

    Raises ValueError when a spring or support names a mass or point that is not there, and
    MatrixFileError.
    """
    parts = PARTS[config.structure.kind](config.structure)
    directions = parts["directions"]
    for support in config.supports:
        for name in filter(None, (support.point, support.other_point)):
            if name not in directions:
                raise ValueError(
                    f"support {support.name}: point '{name}' is not among the structure's:"
                    f" {', '.join(sorted(directions))}"
                )
    return PointStructure(
        **parts,
        contact=contacts_at_points(config.supports, config.points),
        contact_points=[(each.point, each.other_point) for each in config.supports],
    )


def _chain(chain: ConfigPart) -> dict[str, Any]:
    """Return the fields of a PointStructure of masses on springs."""
    place = {mass.name: dof for dof, mass in enumerate(chain.masses)}
    stiffness, dampers = np.zeros((len(place), len(place))), []
    for spring in chain.springs:
        row = np.zeros(len(place))
        for name, sign in zip(spring.between, (1.0, -1.0), strict=True):
            if name != GROUND:
                row[place[name]] += sign
        stiffness += spring.stiffness_N_per_m * np.outer(row, row)
        if spring.damping_N_s_per_m:
            dampers.append((row, spring.damping_N_s_per_m))
    return {
        "mass": sparse.diags_array([mass.mass_kg for mass in chain.masses], format="csr"),
        "stiffness": sparse.csr_array(stiffness),
        "damping": sparse.csr_array(stiffness.shape),
        "dampers": dampers,
        "directions": {name: {"x": dof} for name, dof in place.items()},
    }


def _matrices(structure: ConfigPart) -> dict[str, Any]:
    """Return the fields of a PointStructure whose matrices are in files."""
    chosen = structure.op4_set
    mass = read_matrix(structure.mass, "mass", chosen)
    stiffness = read_matrix(structure.stiffness, "stiffness", chosen)
    damping = sparse.csr_array(mass.shape)
    if structure.damping:
        damping = read_matrix(structure.damping, "damping", chosen)
    for path, matrix in ((structure.stiffness, stiffness), (structure.damping, damping)):
        if matrix.shape != mass.shape:
            raise MatrixFileError(
                f"{path}: is {matrix.shape}, but {structure.mass} is {mass.shape}: give matrices of"
                " the same dofs"
            )
    directions = {name: dict(axes.items()) for name, axes in structure.points.items()}
    for name, axes in directions.items():
        for axis, dof in axes.items():
            if dof >= mass.shape[0]:
                raise MatrixFileError(
                    f"structure.points.{name}.{axis} = {dof}: {structure.mass} has {mass.shape[0]}"
                    " dofs, counted from 0"
                )
    named = sorted({dof for axes in directions.values() for dof in axes.values()})
    condensed = condense_massless(mass, stiffness, named)
    if condensed is not None:
        mass, stiffness, damping = condensed.mass, condensed.stiffness, condensed.of(damping)
    return {
        "condensed": condensed,
        "mass": mass,
        "stiffness": stiffness,
        "damping": damping,
        "directions": directions,
    }


def _identified(structure: ConfigPart) -> dict[str, Any]:
    """Return the fields of a PointStructure of measured modes."""
    modes = sorted(structure.modes, key=lambda mode: mode.frequency_Hz)
    omega = 2.0 * np.pi * np.array([mode.frequency_Hz for mode in modes])
    ratios = np.array([mode.damping_ratio for mode in modes])
    shapes: dict[str, np.ndarray] = {}
    directions: dict[str, dict[str, int]] = {}
    for number, mode in enumerate(modes):
        for name, axes in mode.shape.items():
            for axis, value in axes.items():
                shapes.setdefault(name, np.zeros((3, len(modes))))[AXES[axis], number] = value
                directions.setdefault(name, {})[axis] = AXES[axis]
    return {
        "mass": sparse.diags_array(np.ones(len(modes)), format="csr"),
        "stiffness": sparse.diags_array(omega**2, format="csr"),
        "damping": sparse.diags_array(2.0 * ratios * omega, format="csr"),
        "directions": directions,
        "shapes": shapes,
    }


PARTS = {"chain": _chain, "matrices": _matrices, "identified": _identified}
