"""Cross-sections: areas, second moments and fibre distances along the two axes of a section.

A quantity of axis d belongs to bending that deflects the beam along axis d. The two axes are the
section's principal axes, and its shear centre is its centroid.

Sources:
- torsion of a rectangle: S. P. Timoshenko and J. N. Goodier, Theory of Elasticity (McGraw-Hill,
  3rd ed. 1970), art. 109.
- shear coefficients: G. R. Cowper, The shear coefficient in Timoshenko's beam theory, J. Applied
  Mechanics 33 (1966) 335-340.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

ROUND = ("tube", "round")  # kinds of section that bend alike in every direction
SERIES_TERMS = 40  # odd terms of the torsion of a rectangle; the last is below 1e-9 of the sum


@dataclass(frozen=True)
class SectionProperties:
    """Constants of a cross-section.

    area: m², of the material.
    second_moments: m⁴ of the two axes; that of axis d is the integral of the squared distance
        along axis d.
    torsion_constant: m⁴, the torsion stiffness is the shear modulus times it.
    shear_coefficients: effective part of the area in shear, of the two axes.
    outer_fibres: m, distance from the centroid to the outermost fibre along the two axes.
    enclosed_area: m², inside the outline: material and hollow.
    """

    area: float
    second_moments: tuple[float, float]
    torsion_constant: float
    shear_coefficients: tuple[float, float]
    outer_fibres: tuple[float, float]
    enclosed_area: float

    @property
    def inner_area(self) -> float:
        """Return the area of the hollow in m²; 0 for a solid section."""
        return self.enclosed_area - self.area


def section_kind(section: Any) -> str:
    """Return the kind of a section of the configuration; a section without one is a tube."""
    return getattr(section, "kind", "tube")


def section_properties(section: Any, poisson_ratio: float) -> SectionProperties:
    """Return the SectionProperties of a section of the configuration.

    poisson_ratio: of the material, for shear coefficients that are not given.

    Raises ValueError for a tube whose wall is thicker than its radius; the message names the value.
    """
    return PROPERTIES[section_kind(section)](section, poisson_ratio)


def outer_width(section: Any) -> float:
    """Return the diameter of a round section in m; of another, its smaller outer width."""
    kind = section_kind(section)
    if kind == "tube":
        return section.outer_diameter_m
    if kind == "round":
        return section.diameter_m
    if kind == "rectangle":
        return min(section.sides_m)
    return 2.0 * min(section.outer_fibres_m)


def _tube(section: Any, poisson_ratio: float) -> SectionProperties:
    """Return the properties of an annulus."""
    outer = 0.5 * section.outer_diameter_m
    inner = outer - section.wall_thickness_m
    if inner < 0.0 or section.wall_thickness_m <= 0.0:
        raise ValueError(
            f"wall thickness {section.wall_thickness_m} m must lie between 0 and the outer radius"
            f" {outer} m"
        )
    return _ring(outer, inner, section.shear_coefficient)


def _round(section: Any, poisson_ratio: float) -> SectionProperties:
    """Return the properties of a solid circle. Shear coefficient: Cowper (1966), table 1."""
    shear = section.shear_coefficient
    if shear is None:
        shear = 6.0 * (1.0 + poisson_ratio) / (7.0 + 6.0 * poisson_ratio)
    return _ring(0.5 * section.diameter_m, 0.0, shear)


def _ring(outer: float, inner: float, shear: float) -> SectionProperties:
    """Return the properties of an annulus between two radii in m."""
    second_moment = 0.25 * np.pi * (outer**4 - inner**4)
    return SectionProperties(
        area=np.pi * (outer**2 - inner**2),
        second_moments=(second_moment, second_moment),
        torsion_constant=2.0 * second_moment,
        shear_coefficients=(shear, shear),
        outer_fibres=(outer, outer),
        enclosed_area=np.pi * outer**2,
    )


def _rectangle(section: Any, poisson_ratio: float) -> SectionProperties:
    """Return the properties of a solid rectangle. Shear coefficient: Cowper (1966), table 1."""
    first, second = section.sides_m
    shear = section.shear_coefficient
    if shear is None:
        shear = 10.0 * (1.0 + poisson_ratio) / (12.0 + 11.0 * poisson_ratio)
    return SectionProperties(
        area=first * second,
        second_moments=(second * first**3 / 12.0, first * second**3 / 12.0),
        torsion_constant=rectangle_torsion_constant(first, second),
        shear_coefficients=(shear, shear),
        outer_fibres=(0.5 * first, 0.5 * second),
        enclosed_area=first * second,
    )


def _general(section: Any, poisson_ratio: float) -> SectionProperties:
    """Return the properties that the configuration states."""
    enclosed = section.enclosed_area_m2
    return SectionProperties(
        area=section.area_m2,
        second_moments=section.second_moments_m4,
        torsion_constant=section.torsion_constant_m4,
        shear_coefficients=section.shear_coefficients,
        outer_fibres=section.outer_fibres_m,
        enclosed_area=section.area_m2 if enclosed is None else enclosed,
    )


PROPERTIES: dict[str, Callable[[Any, float], SectionProperties]] = {
    "tube": _tube,
    "round": _round,
    "rectangle": _rectangle,
    "general": _general,
}


def rectangle_torsion_constant(one: float, other: float) -> float:
    """Return the torsion constant in m⁴ of a rectangle with sides in m.

    a b³ (1 - 192 b / (pi⁵ a) sum over odd n of tanh(n pi a / (2 b)) / n⁵) / 3 with a >= b. Source:
    Timoshenko and Goodier (1970), art. 109, eq. 160.
    """
    long, short = max(one, other), min(one, other)
    orders = np.arange(1, 2 * SERIES_TERMS, 2)
    series = np.sum(np.tanh(0.5 * np.pi * orders * long / short) / orders**5.0)
    return float(long * short**3 / 3.0 * (1.0 - 192.0 * short / (np.pi**5 * long) * series))
