"""Three-dimensional beam elements of a tube: stiffness, consistent mass and shape functions.

An element has two nodes of six degrees of freedom: three translations and three rotations about the
global axes. Bending follows the exact static solution of a Timoshenko beam between its nodes, so
there is no shear locking. Euler-Bernoulli is the same element with an infinite shear stiffness and
no rotary inertia.

Frequencies converge with the fourth power of the element length for Euler-Bernoulli, and with the
second for Timoshenko, whose shear angle is constant along an element. The second-order part is
small for a slender tube.

Sources:
- stiffness: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), ch. 5.
- shape functions and consistent mass: Z. Friedman and J. B. Kosmatka, An improved two-node
  Timoshenko beam finite element, Computers and Structures 47 (1993) 473-481.
- shear coefficient: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Applied
  Mechanics 33 (1966) 335-340.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart

DOF_PER_NODE = 6
# In the second bending plane the rotation about the first transverse axis is -w'.
ROTATION_SIGN = np.array([1.0, -1.0, 1.0, -1.0])

# Four Gauss points integrate the mass matrix exactly: its integrands are of degree six.
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)
GAUSS_POINTS, GAUSS_WEIGHTS = 0.5 * (GAUSS_POINTS + 1.0), 0.5 * GAUSS_WEIGHTS


@dataclass(frozen=True)
class Beam:
    """Constants of a uniform beam with a circular section.

    axial_stiffness: EA in N.
    bending_stiffness: EI in N m².
    torsion_stiffness: GJ in N m².
    shear_stiffness: kGA in N; infinite for Euler-Bernoulli.
    mass_per_length: kg/m.
    rotary_inertia: rho I in kg m; 0 for Euler-Bernoulli.
    torsion_inertia: rho J in kg m.
    fibre_stiffness: E r in N/m, the outer-fibre bending stress per unit curvature.
    """

    axial_stiffness: float
    bending_stiffness: float
    torsion_stiffness: float
    shear_stiffness: float
    mass_per_length: float
    rotary_inertia: float
    torsion_inertia: float
    fibre_stiffness: float

    def shear_parameter(self, length: float) -> float:
        """Return phi = 12 EI / (kGA L²) for an element length L in m; 0 for Euler-Bernoulli."""
        return 12.0 * self.bending_stiffness / (self.shear_stiffness * length**2)


def tube_beam(section: ConfigPart, material: ConfigPart, theory: str) -> Beam:
    """Return the Beam of a circular tube.

    section: outer_diameter_m, wall_thickness_m, shear_coefficient.
    material: young_modulus_Pa, poisson_ratio, density_kg_per_m3.
    theory: "timoshenko" or "euler_bernoulli".

    Raises ValueError for another theory or a wall thicker than the radius; the message names the
    value.
    """
    outer = 0.5 * section.outer_diameter_m
    inner = outer - section.wall_thickness_m
    if inner < 0.0 or section.wall_thickness_m <= 0.0:
        raise ValueError(
            f"wall thickness {section.wall_thickness_m} m must lie between 0 and the outer radius"
            f" {outer} m"
        )
    if theory not in ("timoshenko", "euler_bernoulli"):
        raise ValueError(f"beam theory '{theory}' is unknown: choose timoshenko or euler_bernoulli")
    area = np.pi * (outer**2 - inner**2)
    second_moment = 0.25 * np.pi * (outer**4 - inner**4)
    young, density = material.young_modulus_Pa, material.density_kg_per_m3
    shear_modulus = 0.5 * young / (1.0 + material.poisson_ratio)
    with_shear = theory == "timoshenko"
    return Beam(
        axial_stiffness=young * area,
        bending_stiffness=young * second_moment,
        torsion_stiffness=shear_modulus * 2.0 * second_moment,
        shear_stiffness=section.shear_coefficient * shear_modulus * area if with_shear else np.inf,
        mass_per_length=density * area,
        rotary_inertia=density * second_moment if with_shear else 0.0,
        torsion_inertia=density * 2.0 * second_moment,
        fibre_stiffness=young * outer,
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


def bending_stiffness(beam: Beam, length: float) -> np.ndarray:
    """Return the (4, 4) stiffness of one bending plane, dofs (v1, theta1, v2, theta2).

    Source: Przemieniecki (1968), eq. 5.116.
    """
    phi = beam.shear_parameter(length)
    near, far, slope = (4.0 + phi) * length**2, (2.0 - phi) * length**2, 6.0 * length
    pattern = np.array(
        [
            [12.0, slope, -12.0, slope],
            [slope, near, -slope, far],
            [-12.0, -slope, 12.0, -slope],
            [slope, far, -slope, near],
        ]
    )
    return beam.bending_stiffness / (length**3 * (1.0 + phi)) * pattern


def bending_mass(beam: Beam, length: float) -> np.ndarray:
    """Return the (4, 4) consistent mass of one bending plane, dofs (v1, theta1, v2, theta2).

    It holds translation and rotary inertia.
    """
    deflection, rotation, _ = bending_shapes(GAUSS_POINTS, length, beam.shear_parameter(length))
    weights = GAUSS_WEIGHTS * length
    return (
        beam.mass_per_length * (deflection * weights) @ deflection.T
        + beam.rotary_inertia * (rotation * weights) @ rotation.T
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
    for dofs, sign in (([1, 5, 7, 11], np.ones(4)), ([2, 4, 8, 10], ROTATION_SIGN)):
        stiffness[np.ix_(dofs, dofs)] = bending_stiffness(beam, length) * np.outer(sign, sign)
        mass[np.ix_(dofs, dofs)] = bending_mass(beam, length) * np.outer(sign, sign)
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
    shapes = bending_shapes([xi], length, beam.shear_parameter(length))
    deflection, _, curvature = (shape[:, 0] for shape in shapes)
    displacement, gradient = np.zeros((3, 12)), np.zeros((3, 12))
    displacement[0, [0, 6]] = 1.0 - xi, xi
    displacement[1, [1, 5, 7, 11]] = deflection
    displacement[2, [2, 4, 8, 10]] = deflection * ROTATION_SIGN
    gradient[0, [3, 9]] = -1.0 / length, 1.0 / length
    gradient[2, [1, 5, 7, 11]] = curvature
    gradient[1, [2, 4, 8, 10]] = -curvature * ROTATION_SIGN
    to_local = np.kron(np.eye(4), axes)
    return axes.T @ displacement @ to_local, axes.T @ gradient @ to_local
