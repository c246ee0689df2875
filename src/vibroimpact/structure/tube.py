"""The finite-element model of a tube: matrices with its ends held, and rows that read displacement
and stress at any arc length.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy import sparse

from vibroimpact.contact.supports import ContactPoints, place_contact_points
from vibroimpact.geometry.centreline import (
    SAME_PLACE_M,
    Centreline,
    build_centreline,
)
from vibroimpact.geometry.directions import transverse_directions, unit_vector
from vibroimpact.geometry.mesh import mesh_arc_lengths
from vibroimpact.memo import Kept

from .beam_elements import DOF_PER_NODE, Beam, element_matrices, interpolation, tube_beam

BUILT = Kept()


@dataclass(frozen=True, eq=False)
class Structure:
    """The linear tube without contact.

    mass, stiffness (dof, dof) sparse, SI, in the dofs left free by the ends; held (node dof, dof)
    sparse: node displacements (ux, uy, uz, rx, ry, rz per node, global axes) = held @ dofs;
    node_arc_length (node,) m; nodes (node, 3) m; inertia (3, dof) kg: force on the dofs, with the
    sign turned, per unit acceleration of all ends along x, y, z.
    """

    centreline: Centreline
    beam: Beam
    contact: ContactPoints
    node_arc_length: np.ndarray
    nodes: np.ndarray
    mass: sparse.csr_array
    stiffness: sparse.csr_array
    held: sparse.csr_array
    inertia: np.ndarray
    rows: dict = field(
        default_factory=dict, repr=False
    )  # {arc length: displacement rows} known so far

    @property
    def dofs(self):
        """Return the number of free degrees of freedom."""
        return self.mass.shape[0]

    def displacement_rows(self, arc_length):
        """Return (3, dof): global displacement in m at an arc length in m per unit dof; its
        transpose is a unit point force.
        """
        if arc_length not in self.rows:
            element, xi = self._element_at(arc_length)
            rows, _ = interpolation(self.beam, *self._element_geometry(element), xi)
            self.rows[arc_length] = self._to_free_dofs(element, rows)
        return self.rows[arc_length]

    def contact_rows(self):
        """Return (contact_point, 2, dof): displacement in m of each contact point along its two
        directions per unit dof.
        """
        points = zip(self.contact.arc_length, self.contact.directions, strict=True)
        rows = [directions @ self.displacement_rows(place) for place, directions in points]
        return np.array(rows).reshape(-1, 2, self.dofs)

    def stress_rows(self, arc_length):
        """Return (2, dof): outer-fibre stress in Pa of bending in the two transverse directions at
        an arc length in m.

        Row d is E r times the curvature of the deflection along transverse direction d (see
        `transverse_directions`). At a node the two elements that meet there are averaged: their
        moments differ by the discretisation error.
        """
        tangent = self.centreline.direction(arc_length)
        axes = np.array(
            [np.cross(tangent, direction) for direction in transverse_directions(tangent)]
        )
        reads = self._elements_touching(arc_length)
        rows = np.zeros((2, self.dofs))
        for element, xi in reads:
            _, gradient = interpolation(self.beam, *self._element_geometry(element), xi)
            rows += self._to_free_dofs(element, self.beam.fibre_stiffness * axes @ gradient) / len(
                reads
            )
        return rows

    def _element_at(self, arc_length):
        """Return (element, xi) that holds an arc length in m; xi from 0 to 1, snapped to a node
        within 1e-9 m.
        """
        return self._elements_touching(arc_length)[-1]

    def _elements_touching(self, arc_length):
        """Return [(element, xi)]: the element that holds an arc length in m, or both at a node."""
        lengths = self.node_arc_length
        if not -SAME_PLACE_M <= arc_length <= lengths[-1] + SAME_PLACE_M:
            raise ValueError(f"arc length {arc_length} m is not on the tube (0 to {lengths[-1]} m)")
        node = int(np.argmin(np.abs(lengths - arc_length)))
        if abs(lengths[node] - arc_length) < SAME_PLACE_M:
            return [(node - 1, 1.0)] * (node > 0) + [(node, 0.0)] * (node < len(lengths) - 1)
        element = int(np.searchsorted(lengths, arc_length)) - 1
        return [
            (element, (arc_length - lengths[element]) / (lengths[element + 1] - lengths[element]))
        ]

    def _element_geometry(self, element):
        """Return (length in m, axes (3, 3)) of an element."""
        return element_geometry(self.nodes[element], self.nodes[element + 1])

    def _to_free_dofs(self, element, rows):
        """Return (row, dof): rows (row, 12) on the dofs of an element, carried to the free dofs of
        the structure.
        """
        first = DOF_PER_NODE * element
        return rows @ self.held[first : first + 2 * DOF_PER_NODE].toarray()


def element_geometry(start, end):
    """Return (length in m, axes (3, 3)) of the straight element between two nodes; rows: tangent
    and two transverse axes.
    """
    chord = end - start
    tangent = unit_vector(chord)
    # The global axis least aligned with the element: exactly across it in a plane tube, so that the
    # two planes stay uncoupled.
    across = np.eye(3)[np.argmin(np.abs(tangent))]
    second = unit_vector(across - (across @ tangent) * tangent)
    return float(np.linalg.norm(chord)), np.array([tangent, np.cross(second, tangent), second])


def build_structure(config):
    """Return the Structure of a configuration (its parts `structure` and `supports`).

    Raises ValueError when a support is off the tube, or no degree of freedom is left.
    """
    line = build_centreline(config.structure)
    contact = place_contact_points(line, config.supports)
    key = repr(config.structure), contact.arc_length.tobytes(), contact.support.tobytes()
    return replace(BUILT.get(key, lambda: _built(config, line, contact)), contact=contact)


def _built(config, line, contact):
    """Return the Structure with a mesh that has nodes at the contact points."""
    groups = [
        contact.arc_length[contact.support == number] for number in range(len(config.supports))
    ]
    node_arc_length = mesh_arc_lengths(line, config.structure.mesh, groups)
    nodes = np.array([line.position(place) for place in node_arc_length])
    beam = tube_beam(config.structure.section, config.structure.material, config.structure.theory)
    mass, stiffness = _assemble(beam, nodes)
    held, springs = _hold_ends(config.structure, line, len(nodes))
    return Structure(
        centreline=line,
        beam=beam,
        contact=contact,
        node_arc_length=node_arc_length,
        nodes=nodes,
        held=held,
        inertia=(np.tile(np.eye(3, DOF_PER_NODE), len(nodes)) @ mass) @ held,
        mass=(held.T @ mass @ held).tocsr(),
        stiffness=(held.T @ (stiffness + springs) @ held).tocsr(),
    )


def _assemble(beam, nodes):
    """Return (mass, stiffness), each (node dof, node dof) sparse, of the elements between
    successive `nodes` (node, 3) m.
    """
    size, entries = DOF_PER_NODE * len(nodes), 4 * DOF_PER_NODE**2
    count = len(nodes) - 1
    values = {"mass": np.zeros((count, entries)), "stiffness": np.zeros((count, entries))}
    rows, columns = np.zeros((count, entries), dtype=int), np.zeros((count, entries), dtype=int)
    for element in range(count):
        stiffness, mass = element_matrices(
            beam, *element_geometry(nodes[element], nodes[element + 1])
        )
        values["mass"][element], values["stiffness"][element] = mass.ravel(), stiffness.ravel()
        dofs = DOF_PER_NODE * element + np.arange(2 * DOF_PER_NODE)
        rows[element], columns[element] = np.repeat(dofs, len(dofs)), np.tile(dofs, len(dofs))
    place = (rows.ravel(), columns.ravel())
    matrices = (
        sparse.coo_array((values[kind].ravel(), place), shape=(size, size)).tocsr()
        for kind in ("mass", "stiffness")
    )
    return tuple(matrices)


def _hold_ends(structure, line, node_count):
    """Return (held (node dof, dof), springs (node dof, node dof)), sparse: what the two ends leave
    free, and their root springs.

    structure.root serves both ends of a u_tube; a path has structure.start and structure.end.
    Kinds: clamped; pinned (translations and torsion held); springs (translation_N_per_m,
    rotation_N_m_per_rad, alike in all directions); free.
    """
    ends = (
        (structure.root, structure.root)
        if structure.kind == "u_tube"
        else (structure.start, structure.end)
    )
    places = ((0, line.direction(0.0)), (node_count - 1, line.direction(line.length)))
    size = DOF_PER_NODE * node_count
    springs = np.zeros(size)
    blocks = [sparse.eye_array(DOF_PER_NODE, format="csr") for _ in range(node_count)]
    for end, (node, tangent) in zip(ends, places, strict=True):
        blocks[node] = sparse.csr_array(_free_directions(end.kind, tangent))
        if end.kind == "springs":
            first = DOF_PER_NODE * node
            springs[first : first + 3], springs[first + 3 : first + 6] = (
                end.translation_N_per_m,
                end.rotation_N_m_per_rad,
            )
    held = sparse.block_diag(blocks, format="csr")
    if held.shape[1] == 0:
        raise ValueError(
            "both ends are clamped and nothing is between them: use at least two elements"
        )
    return held, sparse.diags_array(springs, format="csr")


def _free_directions(kind, tangent):
    """Return (6, free): the node motions that an end of `kind` leaves free, tangent (3,) the
    direction of the tube there.
    """
    if kind == "clamped":
        return np.zeros((DOF_PER_NODE, 0))
    if kind == "pinned":
        return np.vstack([np.zeros((3, 2)), transverse_directions(tangent).T])
    if kind in ("springs", "free"):
        return np.eye(DOF_PER_NODE)
    raise ValueError(f"end kind '{kind}' is unknown: choose clamped, pinned, springs or free")
