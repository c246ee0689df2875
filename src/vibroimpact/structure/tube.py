"""The finite-element model of a tube or a bar: matrices, and rows for displacement and stress."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy import sparse

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline, build_centreline
from vibroimpact.geometry.directions import transverse_directions, unit_vector
from vibroimpact.geometry.mesh import halved_mesh, mesh_arc_lengths
from vibroimpact.geometry.sections import ROUND, section_kind
from vibroimpact.io.memo import Memo
from vibroimpact.structure.contact.supports import ContactPoints, place_contact_points

from .beam_elements import DOF_PER_NODE, Beam, element_matrices, interpolation, section_beam
from .fluid import FluidStretch, beam_in_fluid, fluid_stretches, transverse_only

STRUCTURES, UNHELD = Memo(), Memo()
ENDS = ("root", "start", "end")


@dataclass(frozen=True, eq=False)
class TubeStructure:
    """The linear tube without contact. A dof is a direction that the ends leave free.

    centreline, contact: its Centreline and ContactPoints.
    beam: its Beam, without fluid.
    node_arc_length: (node,) m.
    nodes: (node, 3) m.
    axes: (element, 3, 3), rows are the tangent of an element and the two axes of its section.
    first_axis: (3,) first axis of the section at the start; None for a round section.
    mass, stiffness: (dof, dof) sparse, SI.
    transformation: (node dof, dof) sparse. Node displacements (ux, uy, uz, rx, ry, rz per node,
        global axes) are transformation @ dofs.
    end_springs: (dof,) N/m and N m/rad, the springs of the ends, which are in the stiffness.
    inertia: (3, dof) kg, minus the force on the dofs per unit acceleration of both ends along x, y,
        z, in fluid that stays in space.
    carried_inertia: (3, dof) kg, the loss of `inertia` if the fluid outside moves with the ends:
        its added mass, and the mass of fluid that the tube displaces.
    viscous: (dof, dof) sparse, N s/m, damping by the fluid outside at 1 Hz; it grows with the
        square root of the frequency.
    two_phase: the same by two phases outside, which grows with the frequency.
    rows: {arc length: displacement rows} computed so far.
    """

    centreline: Centreline
    beam: Beam
    contact: ContactPoints
    node_arc_length: np.ndarray
    nodes: np.ndarray
    axes: np.ndarray
    first_axis: np.ndarray | None
    mass: sparse.csr_array
    stiffness: sparse.csr_array
    transformation: sparse.csr_array
    end_springs: np.ndarray
    inertia: np.ndarray
    carried_inertia: np.ndarray
    viscous: sparse.csr_array
    two_phase: sparse.csr_array
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
            element, xi = self._elements_touching(arc_length)[-1]
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

        Row d is E times the fibre's distance times the curvature of the deflection along transverse
        direction d: of a round section, see `transverse_directions`; of another, axis d of the
        section. At a node the two elements that meet there are averaged: their moments differ by
        the discretisation error.
        """
        tangent = self.centreline.direction(arc_length)
        axes = np.cross(tangent, self.section_axes(arc_length))
        fibres = np.array([plane.fibre_stiffness for plane in self.beam.planes])
        elements = self._elements_touching(arc_length)
        rows = np.zeros((2, self.dofs))
        for element, xi in elements:
            _, gradient = interpolation(self.beam, *self._element_geometry(element), xi)
            stress = fibres[:, None] * axes @ gradient
            rows += self._to_free_dofs(element, stress) / len(elements)
        return rows

    def strain_row(self, arc_length: float, normal: np.ndarray) -> np.ndarray:
        """Return (dof,): axial strain by bending of the outer fibre at an arc length in m, towards
        the outward normal (3,), per unit dof.

        It is minus the fibre's distance times the curvature of the deflection along the normal; the
        strain by an axial force is not part of it. A fibre that bulges outwards is stretched. If
        the section is not round, the normal is one of its axes, of either sense.
        """
        moduli = [plane.fibre_stiffness / plane.outer_fibre for plane in self.beam.planes]
        across = self.section_axes(arc_length) @ unit_vector(normal)
        return -(across / moduli) @ self.stress_rows(arc_length)

    def section_axes(self, arc_length: float) -> np.ndarray:
        """Return (2, 3): the two axes of the section at an arc length in m, along which stresses
        are given. A round section has the transverse directions.
        """
        tangent = self.centreline.direction(arc_length)
        if self.first_axis is None:
            return transverse_directions(tangent)
        first = self.centreline.carried(self.first_axis, arc_length)
        return np.array([first, unit_vector(np.cross(tangent, first))])

    def fluid_damping(self, omega: np.ndarray, shapes: np.ndarray) -> np.ndarray:
        """Return (mode,) 2 zeta omega in 1/s by the fluid outside, each mode at its own frequency.

        omega: (mode,) rad/s. shapes: (dof, mode), mass-orthonormal.
        """
        viscous, two_phase = (
            np.sum(shapes * (matrix @ shapes), axis=0) for matrix in (self.viscous, self.two_phase)
        )
        frequency = omega / (2.0 * np.pi)
        return np.sqrt(frequency) * viscous + frequency * two_phase

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
        length, _ = element_geometry(self.nodes[element], self.nodes[element + 1])
        return length, self.axes[element]

    def _to_free_dofs(self, element: int, rows: np.ndarray) -> np.ndarray:
        """Return (row, dof) from rows (row, 12) over the dofs of an element."""
        first = DOF_PER_NODE * element
        return rows @ self.transformation[first : first + 2 * DOF_PER_NODE].toarray()


def element_geometry(start: np.ndarray, end: np.ndarray) -> tuple[float, np.ndarray]:
    """Return (length in m, axes (3, 3)) of the straight element between two nodes (3,) in m.

    The rows of axes are the tangent and two transverse axes, which a round section does not
    distinguish.
    """
    chord = end - start
    tangent = unit_vector(chord)
    # The global axis least aligned with the element. In a plane tube it is exactly perpendicular,
    # so that the two planes stay uncoupled.
    axis = np.eye(3)[np.argmin(np.abs(tangent))]
    second = unit_vector(axis - (axis @ tangent) * tangent)
    return float(np.linalg.norm(chord)), np.array([tangent, np.cross(second, tangent), second])


def build_structure(
    config: ConfigPart, halved: bool = False, nodes: np.ndarray | None = None
) -> TubeStructure:
    """Return the TubeStructure of a configuration (its parts `structure` and `supports`).

    halved: with each element of the mesh cut in two. nodes (node,): their arc lengths in m, if the
    mesh is that of another configuration; contact points may then lie within elements.

    Raises ValueError when a support is off the tube, or no degree of freedom is left.
    """
    line = build_centreline(config.structure)
    contact = place_contact_points(line, config.supports)
    if nodes is None:
        # There are nodes at contact points and at ends of fluids.
        owner = 2 * contact.support + contact.pair  # the two pairs of bars of a lattice are apart
        groups = [contact.arc_length[owner == number] for number in np.unique(owner)]
        stretches = fluid_stretches(config.structure, line)
        groups += [np.array([place]) for each in stretches for place in (each.begin, each.end)]
        nodes = mesh_arc_lengths(line, config.structure.mesh, groups)
        nodes = halved_mesh(nodes) if halved else nodes
    key = (repr(config.structure), nodes.tobytes())
    built = STRUCTURES.get(key, lambda: _built(config, line, contact, nodes))
    return replace(built, contact=contact)


def _built(
    config: ConfigPart, line: Centreline, contact: ContactPoints, node_arc_length: np.ndarray
) -> TubeStructure:
    """Return the TubeStructure on a mesh of nodes (node,) at arc lengths in m."""
    structure = config.structure
    parts = {name: value for name, value in vars(structure).items() if name not in ENDS}
    key = (repr(parts), node_arc_length.tobytes())
    shared, matrices = UNHELD.get(key, lambda: _unheld(structure, line, node_arc_length))
    transformation, springs = _end_conditions(structure, line, len(node_arc_length))
    rigid = np.tile(np.eye(3, DOF_PER_NODE), len(node_arc_length))

    def held(matrix: sparse.csr_array) -> sparse.csr_array:
        return (transformation.T @ matrix @ transformation).tocsr()

    return TubeStructure(
        centreline=line,
        contact=contact,
        node_arc_length=node_arc_length,
        transformation=transformation,
        end_springs=springs @ transformation,
        inertia=(rigid @ matrices["mass"]) @ transformation,
        carried_inertia=(rigid @ matrices["carried"]) @ transformation,
        mass=held(matrices["mass"]),
        stiffness=held(matrices["stiffness"] + sparse.diags_array(springs, format="csr")),
        viscous=held(matrices["viscous"]),
        two_phase=held(matrices["two_phase"]),
        **shared,
    )


def _unheld(
    structure: ConfigPart, line: Centreline, node_arc_length: np.ndarray
) -> tuple[dict[str, Any], dict[str, sparse.csr_array]]:
    """Return (fields of TubeStructure, matrices (node dof, node dof)) before the ends are held.

    node_arc_length: (node,) m, of the mesh.
    """
    stretches = fluid_stretches(structure, line)
    nodes = np.array([line.position(place) for place in node_arc_length])
    middles = 0.5 * (node_arc_length[1:] + node_arc_length[:-1])
    beam = section_beam(structure.section, structure.material, structure.theory)
    first_axis = _first_axis(structure.section, line)
    lengths, axes = _element_frames(line, nodes, middles, first_axis)
    beams = [beam_in_fluid(beam, stretches, place) for place in middles]
    elements = [element_matrices(*each) for each in zip(beams, lengths, axes, strict=True)]
    stiffness, mass = (_assembled(matrices) for matrices in zip(*elements, strict=True))
    fluid = _fluid_matrices(beam, stretches, middles, (lengths, axes))
    shared = {"beam": beam, "nodes": nodes, "axes": axes, "first_axis": first_axis}
    return shared, {"mass": mass, "stiffness": stiffness, **fluid}


def _first_axis(section: ConfigPart, line: Centreline) -> np.ndarray | None:
    """Return the first axis (3,) of a section at the start of the tube; None for a round one."""
    if section_kind(section) in ROUND:
        return None
    tangent = line.direction(0.0)
    given = section.first_axis
    return line.carried(transverse_directions(tangent)[0] if given is None else given, 0.0)


def _element_frames(
    line: Centreline, nodes: np.ndarray, middles: np.ndarray, first_axis: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return (lengths (element,) in m, axes (element, 3, 3)) of the elements between nodes.

    nodes: (node, 3) m. middles: (element,) arc lengths in m. first_axis: (3,) at the start, carried
    to the middle of each element; None for a round section, whose axes are any two.
    """
    frames = [element_geometry(*ends) for ends in zip(nodes[:-1], nodes[1:], strict=True)]
    lengths, axes = (np.array(values) for values in zip(*frames, strict=True))
    if first_axis is not None:
        for element, place in enumerate(middles):
            tangent, first = axes[element, 0], line.carried(first_axis, place)
            first = unit_vector(first - (first @ tangent) * tangent)
            axes[element, 1:] = first, unit_vector(np.cross(tangent, first))
    return lengths, axes


def _fluid_matrices(
    beam: Beam,
    stretches: Sequence[FluidStretch],
    middles: np.ndarray,
    frames: tuple[np.ndarray, np.ndarray],
) -> dict[str, sparse.csr_array]:
    """Return {carried, viscous, two_phase}, each (node dof, node dof): the masses in kg that a
    fluid outside takes off if it moves with the ends, and its dampings in N s/m at 1 Hz. All act
    across the tube only.
    """
    size = DOF_PER_NODE * (len(middles) + 1)
    found = {name: np.zeros((len(middles), 2)) for name in ("carried", "viscous", "two_phase")}
    for each in stretches:
        inside = (each.begin <= middles) & (middles <= each.end)
        found["carried"][inside] += np.array(each.outside) + each.displaced
        found["viscous"][inside] += each.viscous
        found["two_phase"][inside] += each.two_phase

    def matrix(per_length: np.ndarray) -> sparse.csr_array:
        if not per_length.any():
            return sparse.csr_array((size, size))
        beams = [transverse_only(beam, values) for values in per_length]
        return _assembled([element_matrices(*each)[1] for each in zip(beams, *frames, strict=True)])

    return {name: matrix(values) for name, values in found.items()}


def _assembled(matrices: Sequence[np.ndarray]) -> sparse.csr_array:
    """Return the matrix (node dof, node dof) of elements (12, 12) in a row."""
    size, own = DOF_PER_NODE * (len(matrices) + 1), np.arange(2 * DOF_PER_NODE)
    dofs = DOF_PER_NODE * np.arange(len(matrices))[:, None] + own
    place = np.repeat(dofs, own.size, axis=1).ravel(), np.tile(dofs, own.size).ravel()
    return sparse.coo_array((np.ravel(matrices), place), shape=(size, size)).tocsr()


def _end_conditions(
    structure: ConfigPart, line: Centreline, node_count: int
) -> tuple[sparse.csr_array, np.ndarray]:
    """Return (transformation (node dof, dof), springs (node dof,)) of the two ends.

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
    blocks = []
    for end, (node, tangent) in zip(ends, places, strict=True):
        blocks.append(sparse.csr_array(_free_directions(end.kind, tangent)))
        if end.kind == "springs":
            first = DOF_PER_NODE * node
            springs[first : first + 3] = end.translation_N_per_m
            springs[first + 3 : first + 6] = end.rotation_N_m_per_rad
    between = sparse.eye_array(size - 2 * DOF_PER_NODE, format="csr")
    transformation = sparse.block_diag([blocks[0], between, blocks[1]], format="csr")
    if transformation.shape[1] == 0:
        raise ValueError(
            "both ends are clamped and nothing is between them: use at least two elements"
        )
    return transformation, springs


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
