"""Three-dimensional beam elements of a tube: stiffness, consistent mass and shape functions.

Two nodes of six degrees of freedom (three translations, three rotations, global axes). Bending
follows the exact static solution of a Timoshenko beam between its nodes, so that shear does not
lock; Euler-Bernoulli is the same element with an infinite shear stiffness and no rotary inertia.
Frequencies converge with the fourth power of the element length for Euler-Bernoulli and with the
second for Timoshenko, whose shear angle is constant along an element; for a slender tube that
second-order part is small.

Sources: J. S. Przemieniecki, Theory of Matrix Structural Analysis (McGraw-Hill 1968), chapter 5
(stiffness with shear parameter phi); Z. Friedman and J. B. Kosmatka, An improved two-node
Timoshenko beam finite element, Computers and Structures 47 (1993) 473-481 (shape functions, from
which the consistent mass follows); G. R. Cowper, The shear coefficient in Timoshenko's beam theory,
J. Applied Mechanics 33 (1966) 335-340.
"""

from dataclasses import dataclass

import numpy as np

DOF_PER_NODE = 6
ROTATION_SIGN = np.array(
    [1.0, -1.0, 1.0, -1.0]
)  # second bending plane: the rotation about the first transverse axis is -w'

# The integrands of the mass matrix are polynomials of degree six: four Gauss points integrate them
# exactly.
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(4)
GAUSS_POINTS, GAUSS_WEIGHTS = 0.5 * (GAUSS_POINTS + 1.0), 0.5 * GAUSS_WEIGHTS


@dataclass(frozen=True)
class Beam:
    """Constants of a uniform beam with a circular section; SI units.

    axial_stiffness EA [N], bending_stiffness EI [N m²], torsion_stiffness GJ [N m²],
    shear_stiffness kGA [N] (infinite for Euler-Bernoulli), mass_per_length [kg/m], rotary_inertia
    rho I [kg m] (0 for Euler-Bernoulli), torsion_inertia rho J [kg m], fibre_stiffness E r [N/m]:
    outer-fibre bending stress per unit curvature.
    """

    axial_stiffness: float
    bending_stiffness: float
    torsion_stiffness: float
    shear_stiffness: float
    mass_per_length: float
    rotary_inertia: float
    torsion_inertia: float
    fibre_stiffness: float

    def shear_parameter(self, length):
        """Return phi = 12 EI / (kGA L²) (dimensionless), 0 for Euler-Bernoulli; `length` in m."""
        return 12.0 * self.bending_stiffness / (self.shear_stiffness * length**2)


def tube_beam(section, material, theory):
    """Return the Beam of a circular tube.

    section: outer_diameter_m, wall_thickness_m, shear_coefficient. material: young_modulus_Pa,
    poisson_ratio, density_kg_per_m3. theory: "timoshenko" or "euler_bernoulli".

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


def bending_shapes(xi, length, phi):
    """Return (deflection, rotation, curvature), each (4, point): static shapes of the dofs (v1,
    theta1, v2, theta2).

    xi: (point,) position on the element, 0 to 1. Deflection in m, rotation in rad, curvature in 1/m
    per unit dof. The shear angle v' - theta is constant along the element. Source: Friedman and
    Kosmatka (1993).
    """
    xi = np.asarray(xi, dtype=float)
    one = np.ones_like(xi)
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
    curvature = (
        np.array(
            [
                6.0 / length * (2.0 * xi - 1.0),
                6.0 * xi - 4.0 - phi * one,
                -6.0 / length * (2.0 * xi - 1.0),
                6.0 * xi - 2.0 + phi * one,
            ]
        )
        / length
    )
    return deflection / (1.0 + phi), rotation / (1.0 + phi), curvature / (1.0 + phi)


def bending_stiffness(beam, length):
    """Return the 4 × 4 stiffness of one bending plane, dofs (v1, theta1, v2, theta2). Source:
    Przemieniecki (1968), eq. 5.116.
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


def bending_mass(beam, length):
    """Return the 4 × 4 consistent mass of one bending plane (translation and rotary inertia), dofs
    (v1, theta1, v2, theta2).
    """
    deflection, rotation, _ = bending_shapes(GAUSS_POINTS, length, beam.shear_parameter(length))
    weights = GAUSS_WEIGHTS * length
    return (
        beam.mass_per_length * (deflection * weights) @ deflection.T
        + beam.rotary_inertia * (rotation * weights) @ rotation.T
    )


def element_matrices(beam, length, axes):
    """Return (stiffness, mass), each (12, 12) in global axes, of an element of `length` m.

    axes: (3, 3), rows = unit tangent, first and second transverse axis (right-handed). Dofs per
    node: ux, uy, uz, rx, ry, rz.
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
    turn = np.kron(np.eye(4), axes)
    return turn.T @ stiffness @ turn, turn.T @ mass @ turn


def interpolation(beam, length, axes, xi):
    """Return (displacement, rotation_gradient), each (3, 12): rows of global components at xi (0 to
    1) per unit element dof.

    displacement in m; rotation_gradient is the derivative of the rotation vector along the element
    in rad/m, whose transverse components are the bending curvatures. axes as in `element_matrices`.
    """
    deflection, _, curvature = (
        shape[:, 0] for shape in bending_shapes([xi], length, beam.shear_parameter(length))
    )
    displacement, gradient = np.zeros((3, 12)), np.zeros((3, 12))
    displacement[0, [0, 6]] = 1.0 - xi, xi
    displacement[1, [1, 5, 7, 11]] = deflection
    displacement[2, [2, 4, 8, 10]] = deflection * ROTATION_SIGN
    gradient[0, [3, 9]] = -1.0 / length, 1.0 / length
    gradient[2, [1, 5, 7, 11]] = curvature
    gradient[1, [2, 4, 8, 10]] = -curvature * ROTATION_SIGN
    turn = np.kron(np.eye(4), axes)
    return axes.T @ displacement @ turn, axes.T @ gradient @ turn
