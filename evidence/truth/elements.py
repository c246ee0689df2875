"""Curved cubic beam elements: stiffness, mass and interpolation, in plane and out of plane.

Four nodes on the true centreline. Displacement and rotation are interpolated by cubic Lagrange
polynomials in arc length; the tangent is exact at every integration point. Strains are those of the
general Timoshenko curved beam, Gamma = u' + t x theta and kappa = theta'. Stiffness is integrated
by three Gauss points (reduced, without shear or membrane locking), mass by four (exact). Degrees of
freedom per node, in global axes: plane "y" (out of plane) uy, rx, rz; plane "x" (in plane) ux, uz,
ry. Source: K.-J. Bathe, Finite Element Procedures (1996), section 5.4.
"""

import numpy as np

NODES = np.array([-1.0, -1.0 / 3.0, 1.0 / 3.0, 1.0])
STIFFNESS_RULE = np.polynomial.legendre.leggauss(3)
MASS_RULE = np.polynomial.legendre.leggauss(4)


def lagrange(xi):
    """(4,) values and (4,) slopes d/dxi of the cubic Lagrange polynomials at xi in -1..1."""
    value, slope = np.ones(4), np.zeros(4)
    for i in range(4):
        others = [j for j in range(4) if j != i]
        scale = np.prod(NODES[i] - NODES[others])
        gaps = xi - NODES[others]
        value[i] = np.prod(gaps) / scale
        slope[i] = (gaps[0] * gaps[1] + gaps[0] * gaps[2] + gaps[1] * gaps[2]) / scale
    return value, slope


def strain_rows(plane, tangent, value, slope):
    """(3, 12) strains per unit dof.

    Plane "y": shear, torsion, bending. Plane "x": stretch, shear, bending. slope: d/ds [1/m].
    """
    tx, tz = tangent
    zero = np.zeros(4)
    if plane == "y":
        rows = [
            (slope, tz * value, -tx * value),
            (zero, tx * slope, tz * slope),
            (zero, tz * slope, -tx * slope),
        ]
    else:
        rows = [
            (tx * slope, tz * slope, zero),
            (tz * slope, -tx * slope, -value),
            (zero, zero, slope),
        ]
    return np.array([np.column_stack(row).ravel() for row in rows])


def rigidity(section, plane):
    """(3,) stiffness of the strains of a plane: N, N m² and N m² ("y"), or N, N and N m² ("x")."""
    return np.array(
        [section["kGA"], section["GJ"], section["EI"]]
        if plane == "y"
        else [section["EA"], section["kGA"], section["EI"]]
    )


def inertia(section, plane, tangent, fluid):
    """(3, 3) inertia per metre of the dofs of a plane; fluid kg/m is added across the tube only."""
    tx, tz = tangent
    mass, turn, polar = section["mass"], section["inertia"], section["polar"]
    across = np.array([tz, -tx])
    if plane == "x":
        block = np.diag([mass, mass, turn])
        block[:2, :2] += fluid * np.outer(across, across)
        return block
    along = np.array([tx, tz])
    block = np.zeros((3, 3))
    block[0, 0] = mass + fluid
    block[1:, 1:] = polar * np.outer(along, along) + turn * np.outer(across, across)
    return block


class Mesh:
    """A mesh of a beam with elements of at most element_length m, two within each support.

    ends: (element + 1,) arc lengths in m. There are 3 element + 1 nodes; the roots are the first
    and the last.
    """

    def __init__(self, tube, element_length=0.036):
        marks = {0.0, *tube.corners, tube.length}  # elements end where supports end
        for holder in tube.holders:
            ends = holder.arc + 0.5 * holder.height * np.array([-1.0, 1.0])
            marks |= set(np.clip(ends, 0.0, tube.length).tolist())
        marks = sorted(marks)
        pieces = []
        for a, b in zip(marks[:-1], marks[1:], strict=True):
            within = any(abs(0.5 * (a + b) - h.arc) < 0.5 * h.height for h in tube.holders)
            count = 2 if within else max(1, int(np.ceil((b - a) / element_length - 1e-9)))
            pieces.append((a, b, count))
        self.tube = tube
        self.ends = np.concatenate(
            [np.linspace(a, b, n + 1)[:-1] for a, b, n in pieces] + [[tube.length]]
        )
        self.nodes = 3 * (len(self.ends) - 1) + 1

    def matrices(self, plane, fluid=0.0):
        """(dof, dof) stiffness and mass of a plane, roots free; fluid kg/m."""
        size = 3 * self.nodes
        stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
        section = self.tube.section
        law = rigidity(section, plane)
        for e, (a, b) in enumerate(zip(self.ends[:-1], self.ends[1:], strict=True)):
            half, dofs = 0.5 * (b - a), slice(9 * e, 9 * e + 12)
            for xi, weight in zip(*STIFFNESS_RULE, strict=True):
                value, slope = lagrange(xi)
                rows = strain_rows(
                    plane, self.tube.tangent(0.5 * (a + b) + half * xi), value, slope / half
                )
                stiffness[dofs, dofs] += weight * half * (rows.T * law) @ rows
            for xi, weight in zip(*MASS_RULE, strict=True):
                value, _ = lagrange(xi)
                block = inertia(section, plane, self.tube.tangent(0.5 * (a + b) + half * xi), fluid)
                mass[dofs, dofs] += weight * half * np.kron(np.outer(value, value), block)
        return stiffness, mass

    def row(self, s, component):
        """(dof,) interpolation of a component of its plane (0, 1 or 2) at arc length s [m]."""
        e = int(np.clip(np.searchsorted(self.ends, s, side="right") - 1, 0, len(self.ends) - 2))
        a, b = self.ends[e], self.ends[e + 1]
        value, _ = lagrange(2.0 * (s - a) / (b - a) - 1.0)
        row = np.zeros(3 * self.nodes)
        row[9 * e + component : 9 * e + 12 : 3] = value
        return row

    def direction_rows(self, s, direction):
        """Rows (dof of "y",), (dof of "x",) of the displacement along direction (3,) at s [m]."""
        x, y, z = direction
        return y * self.row(s, 0), x * self.row(s, 0) + z * self.row(s, 1)
