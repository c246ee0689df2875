"""Critical velocities of a reduced model on linear supports, and the limit cycles between its gaps.

Beyond the critical velocity of the open supports a tube grows until the stops hold it. In the first
harmonic a stop of stiffness k at a gap g is a spring N = k nu(g/A) for motion of the amplitude A,

    nu(x) = 1 - (2/pi) (asin x + x sqrt(1 - x²)) for x < 1, else 0

(describing function), and the cycle is at the velocity that is critical for these springs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vibroimpact.excitation.fluid_elastic import FluidForce
from vibroimpact.identify.linear.support_groups import SupportDirection, support_directions
from vibroimpact.reduction.modal_model import ModalModel

from .coupled import Zone, critical_velocity, system

STATES = 20  # lowest modes with the supports that the force couples
PASSES = 8  # iterations of a cycle's shape and its springs; three agree to a per cent


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
        own = np.bincount(self.model.support_of_point, self.model.contact_stiffness)
        return own[[self.model.support_names.index(support.group) for support in self.supports]]

    def critical(self, stiffness: np.ndarray, damping: np.ndarray) -> tuple[float, np.ndarray]:
        """Return (V_c in m/s, motion (support,) of the supports in the mode that begins to grow).

        V_c is NaN if nothing grows up to the highest velocity.
        stiffness, damping: (support,) N/m and N s/m, in the order of `supports`.
        """
        model, contacts = self.model, [support.contact for support in self.supports]
        stiff, drag = np.diag(model.omega**2), np.diag(model.damping)
        for contact, k, c in zip(contacts, stiffness, damping, strict=True):
            stiff, drag = stiff + k * contact @ contact.T, drag + c * contact @ contact.T
        squares, vectors = np.linalg.eigh(stiff)
        kept = vectors[:, :STATES]
        parts = np.diag(squares[:STATES]), kept.T @ drag @ kept, self.force, self._zones(kept)
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
