"""Eigenvalues of a tube under a fluid-elastic force with memory.

On mass-orthonormal modes q, in each zone of one velocity V and density rho,

    force = -Q (a0 q + a1 (D/V) q' + sum_j b_j z_j),   z_j' = -gamma_j (V/D) z_j + q',
    Q = rho V²/2 int phi phi^T ds.

The lags make it a system of ordinary differential equations: its eigenvalues need no frequency to
be assumed, as tables of coefficients do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

SCANNED = 60  # velocities between 0 and the highest, between which a crossing is looked for


@dataclass(frozen=True, eq=False)
class FluidForce:
    """Coefficients of the force.

    stiffness, damping: a0, a1. amplitudes, rates (lag,): b, gamma. diameter: D in m.
    """

    stiffness: float
    damping: float
    amplitudes: tuple[float, ...]
    rates: tuple[float, ...]
    diameter: float


@dataclass(frozen=True, eq=False)
class Zone:
    """A part of the tube with one velocity and density.

    factor: velocity over that of the flow. overlap (mode, mode): density/2 int phi phi^T ds, in
    kg^-1 kg/m = 1/m.
    """

    factor: float
    overlap: np.ndarray


def system(
    stiffness: np.ndarray,
    damping: np.ndarray,
    force: FluidForce,
    zones: Sequence[Zone],
    velocity: float,
) -> np.ndarray:
    """Return the matrix (state, state) of the motion at a velocity of the flow in m/s.

    stiffness, damping (mode, mode): of the structure, in 1/s² and 1/s.
    """
    modes = len(stiffness)
    stiff, drag = stiffness.copy(), damping.copy()
    lags = [
        (zone, amplitude, rate)
        for zone in zones
        for amplitude, rate in zip(force.amplitudes, force.rates, strict=True)
        if zone.factor * velocity > 0.0
    ]
    size = modes * (2 + len(lags))
    matrix = np.zeros((size, size))
    eye, first, second = np.eye(modes), slice(0, modes), slice(modes, 2 * modes)
    for zone in zones:
        own = zone.factor * velocity
        stiff += force.stiffness * own**2 * zone.overlap
        drag += force.damping * own * force.diameter * zone.overlap
    matrix[first, second] = eye
    matrix[second, first], matrix[second, second] = -stiff, -drag
    for number, (zone, amplitude, rate) in enumerate(lags):
        own, at = zone.factor * velocity, modes * (2 + number)
        lag = slice(at, at + modes)
        matrix[second, lag] = -amplitude * own**2 * zone.overlap
        matrix[lag, lag] = -rate * own / force.diameter * eye
        matrix[lag, second] = eye
    return matrix


def oscillations(matrix: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return (frequencies in Hz, damping ratios), each (mode,), of the lowest oscillations."""
    poles = np.linalg.eigvals(matrix)
    poles = poles[poles.imag > 1.0e-6 * np.abs(poles)]
    poles = poles[np.argsort(np.abs(poles))][:count]
    return np.abs(poles) / (2.0 * np.pi), -poles.real / np.abs(poles)


def critical_velocity(
    stiffness: np.ndarray,
    damping: np.ndarray,
    force: FluidForce,
    zones: Sequence[Zone],
    highest: float,
) -> float:
    """Return the lowest velocity in m/s, up to `highest`, at which an eigenvalue crosses to growth;
    NaN where none does.
    """

    def growth(velocity: float) -> float:
        matrix = system(stiffness, damping, force, zones, velocity)
        return float(np.linalg.eigvals(matrix).real.max())

    velocities = np.linspace(0.0, highest, SCANNED + 1)[1:]
    before = 0.0
    for velocity in velocities:
        if growth(velocity) > 0.0:
            return float(brentq(growth, max(before, 1.0e-9 * highest), velocity, rtol=1.0e-10))
        before = velocity
    return float("nan")
