"""The laws of wear: the volume that a work rate wears away in a time.

Source: code_aster R7.04.10, POST_USURE (usupru), and its coefficients (usuban).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

HALVINGS = 60  # of the interval that holds a time


@dataclass(frozen=True)
class Archard:
    """Archard's law V = K P t. name: such as a pair of materials. coefficient: K, m²/N."""

    coefficient: float
    name: str = "K"

    def seconds(self, volume: np.ndarray, power: np.ndarray) -> np.ndarray:
        """Return the times in s in which powers in W wear volumes in m³ away, inf without power."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(volume > 0.0, volume / (self.coefficient * power), 0.0)


@dataclass(frozen=True)
class EdfMz:
    """The slowing law EDF_MZ: V = A P^B [x t + (1 - x) (1 - exp(-N t)) / N] with x = S / (A P^B).

    initial, exponent: A and B, in W and s. slowing: N, 1/s. final_rate: S, m³/s. Below about
    3.5 mW the law would speed up, x > 1: x is then 1, a departure from the source.
    """

    initial: float = 1e-13
    exponent: float = 1.2
    slowing: float = 2.44e-8
    final_rate: float = 1.14e-16
    name: str = "EDF_MZ"
    coefficient = None

    def seconds(self, volume: np.ndarray, power: np.ndarray) -> np.ndarray:
        """Return the times in s in which powers in W wear volumes in m³ away, inf without power."""
        rate = self.initial * np.asarray(power, dtype=float) ** self.exponent
        final = self.final_rate / np.maximum(rate, self.final_rate)  # x
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = np.where(volume > 0.0, volume / rate, 0.0)
        # x t is below the bracket, and t above it.
        low, high = wanted, wanted / final
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            decay = -np.expm1(-self.slowing * middle) / self.slowing
            late = final * middle + (1.0 - final) * decay > wanted
            low, high = np.where(late, low, middle), np.where(late, middle, high)
        return 0.5 * (low + high)


WearLaw = Archard | EdfMz

# Coefficients K of pairs of materials, tube over support, by the shape of the support. m²/N.
PAIRS = {
    "bars": {"I600/I600": 1.2e-13, "I600/405": 6.2e-14, "I690/405": 4.1e-16, "I690/Z6C13": 7.7e-15},
    "quadrifoil": {"I600/405": 6.5e-14, "I600TT/405": 1.4e-15, "I690/405": 7.8e-15},
    "drilled": {"I690/I600": 5.2e-14},
}


def published_laws(shape: str) -> Sequence[Archard]:
    """Return Archard's law of each pair of PAIRS for a shape; of all shapes if it has one pair.

    One test of one pair is not a range.
    """
    shapes = [shape] if len(PAIRS[shape]) > 1 else list(PAIRS)
    return [Archard(k, f"{name}, {pair}") for name in shapes for pair, k in PAIRS[name].items()]
