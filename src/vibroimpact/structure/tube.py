"""The finite-element model of a tube: matrices, and rows for displacement and stress."""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.contact.supports import ContactPoints, place_contact_points
from vibroimpact.geometry.centreline import (
    SAME_PLACE_M,
    Centreline,
    build_centreline,
)
from vibroimpact.geometry.directions import transverse_directions, unit_vector
from vibroimpact.geometry.mesh import mesh_arc_lengths
from vibroimpact.memo import Memo

from .beam_elements import DOF_PER_NODE, Beam, element_matrices, interpolation, tube_beam

STRUCTURES = Memo()


@dataclass(frozen=True, eq=False)
class TubeStructure:
    """The linear tube without contact. A dof is what the ends leave free.

    centreline, beam, contact: its Centreline, Beam and ContactPoints.
    node_arc_length: (node,) m.
    nodes: (node, 3) m.
    mass, stiffness: (dof, dof) sparse, SI.
    transformation: (node dof, dof) sparse. Node displacements (ux, uy, uz, rx, ry, rz per node,
        global axes) are transformation @ dofs.
    inertia: (3, dof) kg, minus the force on the dofs per unit acceleration of both ends along x, y,
        z.
    rows: {arc length: displacement rows} computed so far.
    """

    centreline: Centreline
    beam: Beam
    contact: ContactPoints
    node_arc_length: np.ndarray
    nodes: np.ndarray
    mass: sparse.csr_array
    stiffness: sparse.csr_array
    transformation: sparse.csr_array
    inertia: np.ndarray
    rows: dict = field(default_factory=dict, repr=False)

    @property
    def dofs(self) -> int:
        """Return the number of free degrees of freedom."""
        return self.mass.shape[0]

    def displacement_rows(self, arc_length: float) -> np.ndarray:
        """Return (3, dof): global displacement in m at an arc length in m, per unit dof.

        The transpose gives the dof forces of a unit point force.
        """
        if arc_length not in self.rows:
            element, xi = self._element_at(arc_length)
            rows, _ = interpolation(self.beam, *self._element_geometry(element), xi)
            self.rows[arc_length] = self._to_free_dofs(element, rows)
        return self.rows[arc_length]

    def contact_rows(self) -> np.ndarray:
        """Return (contact_point, 2, dof): displacement in m along the two directions of contact."""
        points = zip(self.contact.arc_length, self.contact.directions, strict=True)
        rows = [directions @ self.displacement_rows(place) for place, directions in points]
        return np.array(rows).reshape(-1, 2, self.dofs)

    def stress_rows(self, arc_length: float) -> np.ndarray:
        """Return (2, dof): outer-fibre bending stress in Pa at an arc length in m.

        Row d is E r times the curvature of the deflection along transverse direction d (see
        `transverse_directions`). At a node the two elements that meet there are averaged: their
        moments differ by the discretisation error.
        """
        tangent = self.centreline.direction(arc_length)
        axes = np.array(
            [np.cross(tangent, direction) for direction in transverse_directions(tangent)]
        )
        elements = self._elements_touching(arc_length)
        rows = np.zeros((2, self.dofs))
        for element, xi in elements:
            _, gradient = interpolation(self.beam, *self._element_geometry(element), xi)
            stress = self.beam.fibre_stiffness * axes @ gradient
            rows += self._to_free_dofs(element, stress) / len(elements)
        return rows

    def _element_at(self, arc_length: float) -> tuple[int, float]:
        """Return (element, xi) at an arc length in m; xi from 0 to 1, snapped to a near node."""
        return self._elements_touching(arc_length)[-1]

    def _elements_touching(self, arc_length: float) -> list[tuple[int, float]]:
        """Return [(element, xi)]: the element that holds an arc length in m, or both at a node."""
        lengths = self.node_arc_length
        if not -SAME_PLACE_M <= arc_length <= lengths[-1] + SAME_PLACE_M:
            raise ValueError(f"arc length {arc_length} m is not on the tube (0 to {lengths[-1]} m)")
        node = int(np.argmin(np.abs(lengths - arc_length)))
        if abs(lengths[node] - arc_length) < SAME_PLACE_M:
            return [(node - 1, 1.0)] * (node > 0) + [(node, 0.0)] * (node < len(lengths) - 1)
        element = int(np.searchsorted(lengths, arc_length)) - 1
        start, end = lengths[element], lengths[element + 1]
        return [(element, (arc_length - start) / (end - start))]

    def _element_geometry(self, element: int) -> tuple[float, np.ndarray]:
        """Return (length in m, axes (3, 3)) of an element."""
        return element_geometry(self.nodes[element], self.nodes[element + 1])

    def _to_free_dofs(self, element: int, rows: np.ndarray) -> np.ndarray:
        """Return (row, dof) from rows (row, 12) over the dofs of an element."""
        first = DOF_PER_NODE * element
        return rows @ self.transformation[first : first + 2 * DOF_PER_NODE].toarray()


def element_geometry(start: np.ndarray, end: np.ndarray) -> tuple[float, np.ndarray]:
    """Return (length in m, axes (3, 3)) of the straight element between two nodes (3,) in m.

    The rows of axes are the tangent and two transverse axes.
    """
    chord = end - start
    tangent = unit_vector(chord)
    # The global axis least aligned with the element. In a plane tube it is exactly perpendicular,
    # so that the two planes stay uncoupled.
    axis = np.eye(3)[np.argmin(np.abs(tangent))]
    second = unit_vector(axis - (axis @ tangent) * tangent)
    return float(np.linalg.norm(chord)), np.array([tangent, np.cross(second, tangent), second])


def build_structure(config: ConfigPart) -> TubeStructure:
    """Return the TubeStructure of a configuration (its parts `structure` and `supports`).

    Raises ValueError when a support is off the tube, or no degree of freedom is left.
    """
    line = build_centreline(config.structure)
    contact = place_contact_points(line, config.supports)
    key = (
        repr(config.structure),
        contact.arc_length.tobytes(),
        contact.support.tobytes(),
        contact.pair.tobytes(),
    )
    return replace(STRUCTURES.get(key, lambda: _built(config, line, contact)), contact=contact)


def _built(config: ConfigPart, line: Centreline, contact: ContactPoints) -> TubeStructure:
    """Return the TubeStructure on a mesh that has nodes at the contact points."""
    owner = 2 * contact.support + contact.pair  # the two pairs of bars of a lattice are apart
    groups = [contact.arc_length[owner == number] for number in np.unique(owner)]
    node_arc_length = mesh_arc_lengths(line, config.structure.mesh, groups)
    nodes = np.array([line.position(place) for place in node_arc_length])
    beam = tube_beam(config.structure.section, config.structure.material, config.structure.theory)
    mass, stiffness = _assemble(beam, nodes)
    transformation, springs = _end_conditions(config.structure, line, len(nodes))
    return TubeStructure(
        centreline=line,
        beam=beam,
        contact=contact,
        node_arc_length=node_arc_length,
        nodes=nodes,
        transformation=transformation,
        inertia=(np.tile(np.eye(3, DOF_PER_NODE), len(nodes)) @ mass) @ transformation,
        mass=(transformation.T @ mass @ transformation).tocsr(),
        stiffness=(transformation.T @ (stiffness + springs) @ transformation).tocsr(),
    )


def _assemble(beam: Beam, nodes: np.ndarray) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Return (mass, stiffness), each (node dof, node dof), of elements between nodes (node, 3)."""
    size, entries = DOF_PER_NODE * len(nodes), 4 * DOF_PER_NODE**2
    count = len(nodes) - 1
    masses, stiffnesses = np.zeros((count, entries)), np.zeros((count, entries))
    rows, columns = np.zeros((count, entries), dtype=int), np.zeros((count, entries), dtype=int)
    for element in range(count):
        geometry = element_geometry(nodes[element], nodes[element + 1])
        stiffness, mass = element_matrices(beam, *geometry)
        masses[element], stiffnesses[element] = mass.ravel(), stiffness.ravel()
        dofs = DOF_PER_NODE * element + np.arange(2 * DOF_PER_NODE)
        rows[element], columns[element] = np.repeat(dofs, len(dofs)), np.tile(dofs, len(dofs))
    place = (rows.ravel(), columns.ravel())
    return (
        sparse.coo_array((masses.ravel(), place), shape=(size, size)).tocsr(),
        sparse.coo_array((stiffnesses.ravel(), place), shape=(size, size)).tocsr(),
    )


def _end_conditions(
    structure: ConfigPart, line: Centreline, node_count: int
) -> tuple[sparse.csr_array, sparse.csr_array]:
    """Return (transformation (node dof, dof), springs (node dof, node dof)) of the two ends.

    structure.root serves both ends of a u_tube; a path has structure.start and structure.end. Kinds
    of ends: clamped; pinned (translations and torsion fixed); springs (translation_N_per_m and
    rotation_N_m_per_rad, equal in all directions); free.
    """
    if structure.kind == "u_tube":
        ends = (structure.root, structure.root)
    else:
        ends = (structure.start, structure.end)
    places = ((0, line.direction(0.0)), (node_count - 1, line.direction(line.length)))
    size = DOF_PER_NODE * node_count
    springs = np.zeros(size)
    blocks = [sparse.eye_array(DOF_PER_NODE, format="csr") for _ in range(node_count)]
    for end, (node, tangent) in zip(ends, places, strict=True):
        blocks[node] = sparse.csr_array(_free_directions(end.kind, tangent))
        if end.kind == "springs":
            first = DOF_PER_NODE * node
            springs[first : first + 3] = end.translation_N_per_m
            springs[first + 3 : first + 6] = end.rotation_N_m_per_rad
    transformation = sparse.block_diag(blocks, format="csr")
    if transformation.shape[1] == 0:
        raise ValueError(
            "both ends are clamped and nothing is between them: use at least two elements"
        )
    return transformation, sparse.diags_array(springs, format="csr")


def _free_directions(kind: str, tangent: np.ndarray) -> np.ndarray:
    """Return (6, free): the node motions that an end leaves free.

    tangent: (3,), direction of the tube there.
    """
    if kind == "clamped":
        return np.zeros((DOF_PER_NODE, 0))
    if kind == "pinned":
        return np.vstack([np.zeros((3, 2)), transverse_directions(tangent).T])
    if kind in ("springs", "free"):
        return np.eye(DOF_PER_NODE)
    raise ValueError(f"end kind '{kind}' is unknown: choose clamped, pinned, springs or free")
