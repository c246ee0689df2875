"""Eigenvalues of a tube under a fluid-elastic force with memory (excitation.fluid_elastic), its
critical velocities on linear supports, and the limit cycles between its gaps.

On mass-orthonormal modes q, each zone of one velocity and density has the overlap
rho/2 int phi phi^T ds of the modes.

Beyond the critical velocity of the open supports a tube grows until the stops hold it. In the first
harmonic a stop of stiffness k at a gap g is a spring N = k nu(g/A) for motion of the amplitude A,

    nu(x) = 1 - (2/pi) (asin x + x sqrt(1 - x²)) for x < 1, else 0

(describing function), and the cycle is at the velocity that is critical for these springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from vibroimpact.excitation.fluid_elastic import FluidForce
from vibroimpact.identify.linear.support_groups import SupportDirection, support_directions
from vibroimpact.reduction.modal_model import ModalModel

STATES = 20  # lowest modes with the supports that the force couples
PASSES = 8  # iterations of a cycle's shape and its springs; three agree to a per cent
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


def lowest_states(
    stiffness: np.ndarray, damping: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return (shapes (mode, state), stiffness, damping) of the lowest STATES modes."""
    squares, vectors = np.linalg.eigh(stiffness)
    kept = vectors[:, :STATES]
    return kept, np.diag(squares[:STATES]), kept.T @ damping @ kept


def contact_stiffness(model: ModalModel, supports: Sequence[SupportDirection]) -> np.ndarray:
    """Return the contact stiffness (support,) in N/m of supports in their directions."""
    own = np.bincount(model.support_of_point, model.contact_stiffness)
    return own[[model.support_names.index(support.group) for support in supports]]


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


@dataclass(frozen=True, eq=False)
class ModelInFlow:
    """A reduced model whose rows of the fluid-elastic force were made at the velocity `acting`.

    highest: m/s, up to which critical velocities are sought.
    """

    model: ModalModel
    force: FluidForce
    acting: float
    highest: float

    @cached_property
    def supports(self) -> list[SupportDirection]:
        """Return each support in each direction that it acts in."""
        return support_directions(self.model, "each")

    @cached_property
    def held(self) -> np.ndarray:
        """Return the contact stiffness (support,) of each support in N/m."""
        return contact_stiffness(self.model, self.supports)

    def critical(self, stiffness: np.ndarray, damping: np.ndarray) -> tuple[float, np.ndarray]:
        """Return (V_c in m/s, motion (support,) of the supports in the mode that begins to grow).

        V_c is NaN if nothing grows up to the highest velocity.
        stiffness, damping: (support,) N/m and N s/m, in the order of `supports`.
        """
        model, contacts = self.model, [support.contact for support in self.supports]
        stiff, drag = np.diag(model.omega**2), np.diag(model.damping)
        for contact, k, c in zip(contacts, stiffness, damping, strict=True):
            stiff, drag = stiff + k * contact @ contact.T, drag + c * contact @ contact.T
        kept, stiff, drag = lowest_states(stiff, drag)
        parts = stiff, drag, self.force, self._zones(kept)
        found = critical_velocity(*parts, self.highest)
        if not np.isfinite(found):
            return found, np.full(len(contacts), np.nan)
        poles, states = np.linalg.eig(system(*parts, found))
        growing = kept @ states[: kept.shape[1], np.argmax(poles.real)]
        return found, np.array([np.linalg.norm(contact.T @ growing) for contact in contacts])

    def limit_cycle(self, gap: float, amplitude: float) -> float:
        """Return the velocity in m/s of the limit cycle between elastic stops at a gap, with a
        given amplitude at the support that moves most, both in m; NaN if there is none.
        """
        contact = self.held
        none = np.zeros(len(contact))
        found, shape = self.critical(none, none)
        for _ in range(PASSES):
            if not np.isfinite(found):
                return found
            own = amplitude * shape / shape.max()
            found, shape = self.critical(contact * describing_stiffness(gap, own), none)
        return found

    def _zones(self, kept: np.ndarray) -> list[Zone]:
        """Return the Zones of one velocity on modes (mode, state)."""
        velocity, rows = self.model.fluid_laws.velocity, kept.T @ self.model.fluid_shapes
        return [
            Zone(own / self.acting, rows[:, velocity == own] @ rows[:, velocity == own].T)
            for own in np.unique(velocity)
        ]


def describing_stiffness(gap: float, amplitude: np.ndarray) -> np.ndarray:
    """Return nu (place,) of stops at a gap for amplitudes (place,), both in m."""
    x = gap / np.maximum(amplitude, gap)
    return 1.0 - (2.0 / np.pi) * (np.arcsin(x) + x * np.sqrt(1.0 - x**2))
