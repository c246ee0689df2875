"""Critical velocities of modes: Connors' criterion, and the factors of TEMA.

With phi the component of a mode along the fluid-elastic force and bars for means over the length,

    V_eff² = (int density V² phi² ds / density_bar) / (int m phi² ds / m_bar),
    V_c = K f sqrt(m_bar delta / density_bar),   delta = 2 pi zeta / sqrt(1 - zeta²).

Source: code_aster R4.07.04 and its routine connor.F90. TEMA's factors are second-hand (see
docs/stability.md).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

# {pattern in degrees: (factor of the pitch ratio, exponent below the joint, its mass-damping,
# factor above it)}: D_T = factor X^exponent up to the joint, factor_above X^0.5 beyond.
TEMA: dict[int, tuple[Callable[[float], float], float, float, Callable[[float], float]]] = {
    30: (lambda ratio: 8.86 * (ratio - 0.9), 0.34, 1.0, lambda ratio: 8.86 * (ratio - 0.9)),
    60: (lambda ratio: 2.80, 0.17, 1.0, lambda ratio: 2.80),
    90: (lambda ratio: 2.10, 0.15, 0.7, lambda ratio: 2.35),
    45: (lambda ratio: 4.13 * (ratio - 0.5), 0.5, np.inf, lambda ratio: 4.13 * (ratio - 0.5)),
}


@dataclass(frozen=True, eq=False)
class Along:
    """Velocity, density and mass along a tube in a flow, at Gauss points.

    weight (place,): m of arc length. length: of the tube, m. factor (place,): velocity over that of
    the flow, 0 outside the flow. density, mass (place,): of the fluid outside in kg/m³, and of tube
    and fluids in kg/m.
    """

    weight: np.ndarray
    length: float
    factor: np.ndarray
    density: np.ndarray
    mass: np.ndarray

    def mean(self, values: np.ndarray) -> float:
        """Return the mean of values (place,) over the length."""
        return float(np.sum(self.weight * values) / self.length)

    def effective(self, shape: np.ndarray) -> float:
        """Return V_eff over the velocity of the flow, of a mode with a shape (place,)."""
        square = shape**2
        flow = np.sum(self.weight * self.density * self.factor**2 * square)
        moved = np.sum(self.weight * self.mass * square)
        mass, density = self.mean(self.mass), self.mean(self.density)
        return float(np.sqrt(flow / density / (moved / mass))) if moved > 0.0 else 0.0


def log_decrement(ratio: float) -> float:
    """Return delta of a damping ratio below 1."""
    return float(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2))


def mass_damping(mass: float, ratio: float, density: float, diameter: float) -> float:
    """Return m delta / (density D²); mass in kg/m, diameter in m."""
    return mass * log_decrement(ratio) / (density * diameter**2)


def connors(frequency: float, ratio: float, mass: float, density: float, constant: float) -> float:
    """Return V_c in m/s of a mode in Hz with a damping ratio; mass in kg/m."""
    return constant * frequency * float(np.sqrt(mass * log_decrement(ratio) / density))


def tema_factor(pattern_deg: int, pitch_ratio: float, mass_damping: float) -> float:
    """Return D_T of a pattern with P/D and X = m delta / (density D²)."""
    below, exponent, joint, above = TEMA[pattern_deg]
    if mass_damping <= joint:
        return float(below(pitch_ratio) * mass_damping**exponent)
    return float(above(pitch_ratio) * np.sqrt(mass_damping))
