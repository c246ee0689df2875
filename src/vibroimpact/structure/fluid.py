"""Still fluids inside and outside a tube: added mass per length, and viscous damping.

A fluid inside fills the hollow of the section and moves with it in all directions. A fluid outside
adds mass to motion across the tube only. A mixture of vapour and liquid is one fluid of its mean
density. The coupling of neighbouring tubes is left out.

Sources:
- added mass and viscous damping in a confined still fluid: R. J. Rogers, C. Taylor and M. J.
  Pettigrew, Fluid effects on multi-span heat-exchanger tube vibration, ASME PVP Conference, San
  Antonio (1984); M. J. Pettigrew and C. E. Taylor, Vibration analysis of shell-and-tube heat
  exchangers: an overview, part 1, J. Fluids and Structures 18 (2003) 469-483.
- the annulus that they approximate: S. S. Chen, M. W. Wambsganss and J. A. Jendrzejczyk, Added mass
  and damping of a vibrating rod in confined viscous fluids, J. Applied Mechanics 43 (1976) 325-329.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import Centreline
from vibroimpact.geometry.sections import outer_width, section_properties

from .beam_elements import Beam, BendingPlane

# De/D of a tube in a bundle is (a + b P/D) P/D: {pattern: (a, b)}. Source: Pettigrew and Taylor.
PATTERNS = {"triangular": (0.96, 0.5), "square": (1.07, 0.56)}


@dataclass(frozen=True)
class FluidStretch:
    """A still fluid along a stretch of a tube.

    begin, end: arc lengths in m.
    inside: mass per length of the fluid inside in kg/m, moved in all directions.
    outside: (2,) added mass per length in kg/m of motion along the two axes of the section.
    displaced: mass per length in kg/m of the fluid that the tube displaces.
    viscous: damping coefficient per length in N s/m² at 1 Hz; it grows with the square root of the
        frequency.
    two_phase: the same of two phases, which grows with the frequency.
    """

    begin: float
    end: float
    inside: float = 0.0
    outside: tuple[float, float] = (0.0, 0.0)
    displaced: float = 0.0
    viscous: float = 0.0
    two_phase: float = 0.0


def fluid_stretches(structure: ConfigPart, line: Centreline) -> list[FluidStretch]:
    """Return the FluidStretches of a tube; none if its configuration has no fluid.

    structure: section of the configuration.

    Raises ValueError when a position is off the tube.
    """
    stretches = []
    for number, fluid in enumerate(getattr(structure, "fluid", ())):
        begin, end = line.stretch(fluid.from_m, fluid.to_m, f"structure.fluid[{number}]")
        density = fluid.density_kg_per_m3
        section = section_properties(structure.section, structure.material.poisson_ratio)
        if fluid.kind == "inside":
            stretches.append(FluidStretch(begin, end, inside=density * section.inner_area))
            continue
        displaced = density * section.enclosed_area
        first, second = added_mass_coefficients(fluid.confinement, structure.section)
        stretches.append(
            FluidStretch(
                begin,
                end,
                outside=(first * displaced, second * displaced),
                displaced=displaced,
                viscous=_viscous_coefficient(fluid, structure.section),
                two_phase=_two_phase_coefficient(fluid, structure.section),
            )
        )
    return stretches


def added_mass_coefficients(confinement: ConfigPart, section: ConfigPart) -> tuple[float, float]:
    """Return the added mass along the two axes of a section over the mass of fluid displaced.

    A round section: ((De/D)² + 1) / ((De/D)² - 1), 1 if nothing confines the fluid. Source:
    Rogers, Taylor and Pettigrew (1984).
    """
    if confinement.kind == "coefficient":
        first, second = np.broadcast_to(confinement.added_mass_coefficient, 2)
        return float(first), float(second)
    if confinement.kind == "unconfined":
        return 1.0, 1.0
    square = equivalent_diameter_ratio(confinement, section) ** 2
    return (square + 1.0) / (square - 1.0), (square + 1.0) / (square - 1.0)


def equivalent_diameter_ratio(confinement: ConfigPart, section: ConfigPart) -> float:
    """Return De/D: the diameter of the equivalent channel over that of the tube.

    Infinite if nothing confines the fluid. Source: Pettigrew and Taylor (2003).
    """
    diameter = outer_width(section)
    if confinement.kind == "annulus":
        return confinement.equivalent_diameter_m / diameter
    if confinement.kind == "bundle":
        pitch = confinement.pitch_m / diameter
        constant, slope = PATTERNS[confinement.pattern]
        return (constant + slope * pitch) * pitch
    return np.inf


def viscous_damping_ratio(
    frequency: float | np.ndarray,
    diameter: float,
    mass_per_length: float,
    fluid: tuple[float, float],
    confinement: float = np.inf,
) -> float | np.ndarray:
    """Return the damping ratio by viscosity of a round tube in still fluid at frequencies in Hz.

    pi / sqrt(8) (rho D² / m) sqrt(2 nu / (pi f D²)) (1 + (D/De)³) / (1 - (D/De)²)². It holds for a
    boundary layer that is thin compared with the gap of the fluid. Source: Rogers,
    Taylor and Pettigrew (1984); Pettigrew and Taylor (2003).

    diameter: D in m.
    mass_per_length: m in kg/m, of tube, fluid inside and added mass.
    fluid: (density in kg/m³, kinematic viscosity nu in m²/s).
    confinement: De/D.
    """
    density, viscosity = fluid
    factor = confinement_factor(confinement)
    boundary_layer = np.sqrt(2.0 * viscosity / (np.pi * frequency * diameter**2))
    mass_ratio = density * diameter**2 / mass_per_length
    return np.pi / np.sqrt(8.0) * mass_ratio * boundary_layer * factor


def confinement_factor(confinement: float) -> float:
    """Return (1 + (D/De)³) / (1 - (D/De)²)² of De/D.

    Source: Rogers, Taylor and Pettigrew (1984).
    """
    return (1.0 + confinement**-3.0) / (1.0 - confinement**-2.0) ** 2


def _two_phase_coefficient(fluid: ConfigPart, section: ConfigPart) -> float:
    """Return the damping coefficient per length in N s/m² of two phases outside, at 1 Hz.

    It is 2 zeta omega m with the ratio of config.mixture.TwoPhaseDamping, which has m below it.
    """
    mixture, damping = fluid.mixture, fluid.two_phase_damping
    if mixture is None or damping is None:
        return 0.0
    displaced = mixture.liquid_density_kg_per_m3 * outer_width(section) ** 2
    factor = confinement_factor(equivalent_diameter_ratio(fluid.confinement, section))
    share = damping.share(mixture.void_fraction)
    return float(4.0 * np.pi * damping.coefficient * displaced * factor * share)


def _viscous_coefficient(fluid: ConfigPart, section: ConfigPart) -> float:
    """Return the damping coefficient per length in N s/m² of a fluid outside, at 1 Hz.

    It is 2 zeta omega m, which the mass does not enter.
    """
    if not fluid.viscosity_Pa_s or not fluid.density_kg_per_m3:
        return 0.0
    own = fluid.density_kg_per_m3, fluid.viscosity_Pa_s / fluid.density_kg_per_m3
    confinement = equivalent_diameter_ratio(fluid.confinement, section)
    ratio = viscous_damping_ratio(1.0, outer_width(section), 1.0, own, confinement)
    return float(4.0 * np.pi * ratio)


def mean_fluid_mass(structure: ConfigPart, line: Centreline) -> float:
    """Return the mass per length in kg/m that fluids add to motion across a tube, on average over
    its length and the two axes of its section.
    """
    return sum(
        (each.inside + 0.5 * sum(each.outside)) * (each.end - each.begin) / line.length
        for each in fluid_stretches(structure, line)
    )


def beam_in_fluid(beam: Beam, stretches: Sequence[FluidStretch], place: float) -> Beam:
    """Return the Beam with its masses grown by the fluids at an arc length in m."""
    here = [each for each in stretches if each.begin <= place <= each.end]
    inside = sum(each.inside for each in here)

    def grown(axis: int) -> BendingPlane:
        plane, outside = beam.planes[axis], sum(each.outside[axis] for each in here)
        return replace(plane, mass_per_length=plane.mass_per_length + inside + outside)

    return replace(beam, mass_per_length=beam.mass_per_length + inside, planes=(grown(0), grown(1)))


def transverse_only(beam: Beam, per_length: np.ndarray) -> Beam:
    """Return a Beam whose mass is that given along the two axes of the section, and no other.

    Its mass matrix is the integral of per_length times the products of transverse displacements: of
    a distributed damper, for example.

    per_length: (2,).
    """
    first, second = (
        replace(plane, mass_per_length=float(value), rotary_inertia=0.0)
        for plane, value in zip(beam.planes, per_length, strict=True)
    )
    return replace(beam, mass_per_length=0.0, torsion_inertia=0.0, planes=(first, second))
