"""Eigenvalues of a tube under a fluid-elastic force with memory (excitation.fluid_elastic).

On mass-orthonormal modes q, each zone of one velocity and density has the overlap
rho/2 int phi phi^T ds of the modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from vibroimpact.excitation.fluid_elastic import FluidForce

SCANNED = 60  # velocities from 0 to the highest; a crossing is sought between neighbours


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
    lags = []
    for zone in zones:
        laws = force.laws(np.array([zone.factor * velocity]))
        stiff += laws.stiffness[0] * zone.overlap
        drag += laws.damping[0] * zone.overlap
        if zone.factor * velocity > 0.0:
            pairs = zip(laws.lag_stiffness[0], laws.lag_rate[0], strict=True)
            lags += [(strength * zone.overlap, rate) for strength, rate in pairs]
    size = modes * (2 + len(lags))
    matrix = np.zeros((size, size))
    eye, first, second = np.eye(modes), slice(0, modes), slice(modes, 2 * modes)
    matrix[first, second] = eye
    matrix[second, first], matrix[second, second] = -stiff, -drag
    for number, (strength, rate) in enumerate(lags):
        lag = slice(modes * (2 + number), modes * (3 + number))
        matrix[second, lag] = -strength
        matrix[lag, lag] = -rate * eye
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
    NaN if none does.
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
