"""Three-dimensional beam elements: stiffness, consistent mass and shape functions.

An element has two nodes of six degrees of freedom: three translations and three rotations about the
global axes. It bends in two planes, along the two transverse axes of its section. Bending follows
the exact static solution of a Timoshenko beam between its nodes, so there is no shear locking.
Euler-Bernoulli is the same element with an infinite shear stiffness and no rotary inertia.

Frequencies converge with the fourth power of the element length for Euler-Bernoulli, and with the
second for Timoshenko, whose shear angle is constant along an element. The second-order part is
small for a slender tube.

Sources:
- stiffness: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), ch. 5.
- shape functions and consistent mass: Z. Friedman and J. B. Kosmatka, An improved two-node
  Timoshenko beam finite element, Computers and Structures 47 (1993) 473-481.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.sections import section_properties

DOF_PER_NODE = 6
# Dofs (v1, theta1, v2, theta2) of the two bending planes. In the second, the rotation about the
# first transverse axis is -w'.
BENDING_DOFS = ([1, 5, 7, 11], [2, 4, 8, 10])
BENDING_SIGNS = (np.ones(4), np.array([1.0, -1.0, 1.0, -1.0]))

# Four Gauss points integrate the mass matrix exactly: its integrands are of degree six.
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)
GAUSS_POINTS, GAUSS_WEIGHTS = 0.5 * (GAUSS_POINTS + 1.0), 0.5 * GAUSS_WEIGHTS


@dataclass(frozen=True)
class BendingPlane:
    """Constants of a uniform beam that deflects along one transverse axis.

    bending_stiffness: EI in N m².
    shear_stiffness: kGA in N; infinite for Euler-Bernoulli.
    mass_per_length: kg/m, moved by the deflection.
    rotary_inertia: rho I in kg m; 0 for Euler-Bernoulli.
    fibre_stiffness: E times the distance of the outer fibre in N/m, its bending stress per unit
        curvature.
    outer_fibre: distance of the outer fibre in m, its bending strain per unit curvature.
    """

    bending_stiffness: float
    shear_stiffness: float
    mass_per_length: float
    rotary_inertia: float
    fibre_stiffness: float
    outer_fibre: float

    def shear_parameter(self, length: float) -> float:
        """Return phi = 12 EI / (kGA L²) for an element length L in m; 0 for Euler-Bernoulli."""
        return 12.0 * self.bending_stiffness / (self.shear_stiffness * length**2)


@dataclass(frozen=True)
class Beam:
    """Constants of a uniform beam.

    axial_stiffness: EA in N.
    torsion_stiffness: GJ in N m².
    mass_per_length: kg/m, moved along the beam.
    torsion_inertia: rho times the polar second moment in kg m.
    planes: its BendingPlanes, along the first and the second transverse axis.
    """

    axial_stiffness: float
    torsion_stiffness: float
    mass_per_length: float
    torsion_inertia: float
    planes: tuple[BendingPlane, BendingPlane]


def section_beam(section: ConfigPart, material: ConfigPart, theory: str) -> Beam:
    """Return the Beam of a section.

    section: of one of the kinds tube, round, rectangle or general.
    material: young_modulus_Pa, poisson_ratio, density_kg_per_m3.
    theory: "timoshenko" or "euler_bernoulli".

    Raises ValueError for another theory or a wall thicker than the radius; the message names the
    value.
    """
    properties = section_properties(section, material.poisson_ratio)
    if theory not in ("timoshenko", "euler_bernoulli"):
        raise ValueError(f"beam theory '{theory}' is unknown: choose timoshenko or euler_bernoulli")
    young, density = material.young_modulus_Pa, material.density_kg_per_m3
    shear_modulus = 0.5 * young / (1.0 + material.poisson_ratio)
    with_shear = theory == "timoshenko"

    def plane(axis: int) -> BendingPlane:
        second_moment = properties.second_moments[axis]
        shear = properties.shear_coefficients[axis] * shear_modulus * properties.area
        return BendingPlane(
            bending_stiffness=young * second_moment,
            shear_stiffness=shear if with_shear else np.inf,
            mass_per_length=density * properties.area,
            rotary_inertia=density * second_moment if with_shear else 0.0,
            fibre_stiffness=young * properties.outer_fibres[axis],
            outer_fibre=properties.outer_fibres[axis],
        )

    return Beam(
        axial_stiffness=young * properties.area,
        torsion_stiffness=shear_modulus * properties.torsion_constant,
        mass_per_length=density * properties.area,
        torsion_inertia=density * sum(properties.second_moments),
        planes=(plane(0), plane(1)),
    )


def bending_shapes(
    xi: Sequence[float] | np.ndarray, length: float, phi: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (deflection, rotation, curvature), each (4, point): static shapes in one plane.

    Rows belong to the dofs (v1, theta1, v2, theta2); values are m, rad and 1/m per unit dof. The
    shear angle v' - theta is constant along the element. Source: Friedman and Kosmatka (1993).

    xi: (point,) position on the element, 0 to 1.
    length: element length in m.
    phi: shear parameter.
    """
    xi = np.asarray(xi, dtype=float)
    deflection = np.array(
        [
            1.0 - 3.0 * xi**2 + 2.0 * xi**3 + phi * (1.0 - xi),
            length * (xi - 2.0 * xi**2 + xi**3 + 0.5 * phi * (xi - xi**2)),
            3.0 * xi**2 - 2.0 * xi**3 + phi * xi,
            length * (xi**3 - xi**2 - 0.5 * phi * (xi - xi**2)),
        ]
    )
    rotation = np.array(
        [
            6.0 / length * (xi**2 - xi),
            3.0 * xi**2 - 4.0 * xi + 1.0 + phi * (1.0 - xi),
            -6.0 / length * (xi**2 - xi),
            3.0 * xi**2 - 2.0 * xi + phi * xi,
        ]
    )
    slope = np.array(
        [
            6.0 / length * (2.0 * xi - 1.0),
            6.0 * xi - 4.0 - phi,
            -6.0 / length * (2.0 * xi - 1.0),
            6.0 * xi - 2.0 + phi,
        ]
    )
    curvature = slope / length
    return deflection / (1.0 + phi), rotation / (1.0 + phi), curvature / (1.0 + phi)


def bending_stiffness(plane: BendingPlane, length: float) -> np.ndarray:
    """Return the (4, 4) stiffness of one bending plane, dofs (v1, theta1, v2, theta2).

    Source: Przemieniecki (1968), eq. 5.116.
    """
    phi = plane.shear_parameter(length)
    near, far, slope = (4.0 + phi) * length**2, (2.0 - phi) * length**2, 6.0 * length
    pattern = np.array(
        [
            [12.0, slope, -12.0, slope],
            [slope, near, -slope, far],
            [-12.0, -slope, 12.0, -slope],
            [slope, far, -slope, near],
        ]
    )
    return plane.bending_stiffness / (length**3 * (1.0 + phi)) * pattern


def bending_mass(plane: BendingPlane, length: float) -> np.ndarray:
    """Return the (4, 4) consistent mass of one bending plane, dofs (v1, theta1, v2, theta2).

    It holds translation and rotary inertia.
    """
    deflection, rotation, _ = bending_shapes(GAUSS_POINTS, length, plane.shear_parameter(length))
    weights = GAUSS_WEIGHTS * length
    return (
        plane.mass_per_length * (deflection * weights) @ deflection.T
        + plane.rotary_inertia * (rotation * weights) @ rotation.T
    )


def element_matrices(beam: Beam, length: float, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (stiffness, mass), each (12, 12), of an element in global axes.

    Dofs per node: ux, uy, uz, rx, ry, rz.

    length: element length in m.
    axes: (3, 3), rows are the unit tangent and the two transverse axes (right-handed).
    """
    stiffness, mass = np.zeros((12, 12)), np.zeros((12, 12))
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]]) / length
    rod = np.array([[2.0, 1.0], [1.0, 2.0]]) * length / 6.0
    for dofs, rigidity, inertia in (
        ([0, 6], beam.axial_stiffness, beam.mass_per_length),
        ([3, 9], beam.torsion_stiffness, beam.torsion_inertia),
    ):
        stiffness[np.ix_(dofs, dofs)] = rigidity * bar
        mass[np.ix_(dofs, dofs)] = inertia * rod
    for plane, dofs, sign in zip(beam.planes, BENDING_DOFS, BENDING_SIGNS, strict=True):
        stiffness[np.ix_(dofs, dofs)] = bending_stiffness(plane, length) * np.outer(sign, sign)
        mass[np.ix_(dofs, dofs)] = bending_mass(plane, length) * np.outer(sign, sign)
    to_local = np.kron(np.eye(4), axes)
    return to_local.T @ stiffness @ to_local, to_local.T @ mass @ to_local


def interpolation(
    beam: Beam, length: float, axes: np.ndarray, xi: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return (displacement, rotation_gradient), each (3, 12), at a point of an element.

    Rows are global components per unit element dof. displacement is in m. rotation_gradient is the
    derivative of the rotation vector along the element in rad/m; its transverse components are the
    bending curvatures.

    xi: position on the element, 0 to 1; other arguments as in element_matrices.
    """
    displacement, gradient = np.zeros((3, 12)), np.zeros((3, 12))
    displacement[0, [0, 6]] = 1.0 - xi, xi
    gradient[0, [3, 9]] = -1.0 / length, 1.0 / length
    for axis, plane in enumerate(beam.planes):
        shapes = bending_shapes([xi], length, plane.shear_parameter(length))
        deflection, _, curvature = (shape[:, 0] * BENDING_SIGNS[axis] for shape in shapes)
        displacement[1 + axis, BENDING_DOFS[axis]] = deflection
        # A deflection along the first axis turns about the second, one along the second about
        # minus the first.
        gradient[2 - axis, BENDING_DOFS[axis]] = curvature if axis == 0 else -curvature
    to_local = np.kron(np.eye(4), axes)
    return axes.T @ displacement @ to_local, axes.T @ gradient @ to_local
