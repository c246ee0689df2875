"""The linear structure whose supports each have a stiffness and damping of their own.

With B (mode, contact_row) the contact shapes and s (contact_row,) the dynamic stiffness k + i omega
c of the group and direction of each row, the structure without supports gives the compliance
G = B^T R B and the contact displacements g_d and g_o per unit force at the drive and at an output,
with R the modal receptances. Woodbury's formula leaves

    h = h_free - g_o^T diag(s) y_d,    (I + G diag(s)) y_d = g_d,
    dh/ds_row = -y_o,row y_d,row,      (I + G diag(s)) y_o = g_o.

One small solve per frequency gives the response and its derivatives with respect to all
stiffnesses and dampings.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .modes import transfer
from .support_groups import SupportDirection

RIGID = 1.0  # (rad/s)², so that a rigid motion has a static compliance


@dataclass(frozen=True, eq=False)
class Observed:
    """Outputs of the structure without supports on some frequencies.

    free: (frequency, output, channel) m/N.
    contact: (frequency, contact_row, output) m/N, output per unit contact force.
    part: selects the frequencies.
    """

    free: np.ndarray
    contact: np.ndarray
    part: slice | np.ndarray

    def outputs(self, chosen: np.ndarray) -> "Observed":
        """Return the Observed of some outputs: (output,) bool."""
        return Observed(self.free[:, chosen], self.contact[:, :, chosen], self.part)


class SupportedStructure:
    """The responses of a structure to its force channels with any support stiffness and damping.

    directions: the SupportDirections that the force reaches.
    modes: (mode,) indices of the modes that it moves.
    frequency: (frequency,) Hz.
    owner: (contact_row,) index into directions.
    """

    def __init__(
        self,
        model: ModalModel,
        directions: Sequence[SupportDirection],
        modes: np.ndarray,
        frequency: np.ndarray,
        force_psd: np.ndarray | None = None,
    ) -> None:
        """Compute the compliances of the structure without supports.

        force_psd: (frequency,) relative PSD of the forces, whose root is part of all responses;
            None for white ones.
        """
        self._root = None if force_psd is None else np.sqrt(force_psd)[:, None, None]
        self.directions, self.modes, self.frequency = tuple(directions), modes, frequency
        self.omega, self.damping = model.omega[modes], model.damping[modes]
        self.drive = model.drive_shapes[modes]
        self.contact = np.hstack([direction.contact[modes] for direction in directions])
        sizes = [direction.contact.shape[1] for direction in directions]
        self.owner = np.repeat(np.arange(len(directions)), sizes)
        laplace = 2j * np.pi * frequency[:, None]
        self._receptance = 1.0 / (laplace**2 + laplace * self.damping + self.omega**2)
        self._compliance = transfer(self._receptance, self.contact, self.contact)
        self._reached = self._driven(self.contact)

    def _driven(self, shapes: np.ndarray, part: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Return (frequency, output, channel) the motion of outputs by the forces."""
        moved = transfer(self._receptance[part], shapes, self.drive)
        return moved if self._root is None else moved * self._root[part]

    def observed(self, shapes: np.ndarray, part: slice | np.ndarray = slice(None)) -> Observed:
        """Return the Observed of outputs with shapes (mode of the model, output)."""
        outputs = shapes[self.modes]
        free = self._driven(outputs, part)
        return Observed(free, transfer(self._receptance[part], self.contact, outputs), part)

    def frf(self, observed: Observed, k: np.ndarray, c: np.ndarray) -> np.ndarray:
        """Return the responses (frequency, output, channel) in m/N; k N/m, c N s/m (direction,)."""
        support, matrix = self._coupled(k, c, observed.part)
        moved = np.linalg.solve(matrix, self._reached[observed.part])
        return observed.free - observed.contact.swapaxes(1, 2) @ (support[..., None] * moved)

    def frf_slope(
        self, observed: Observed, k: np.ndarray, c: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (responses (frequency, output, channel), their derivatives (direction, ...)).

        The derivatives are by the dynamic stiffness of each direction.
        """
        support, matrix = self._coupled(k, c, observed.part)
        reached = self._reached[observed.part]
        channels = reached.shape[2]
        moved = np.linalg.solve(matrix, np.concatenate([reached, observed.contact], axis=2))
        driven, seen = moved[..., :channels], moved[..., channels:].swapaxes(1, 2)
        response = observed.free - observed.contact.swapaxes(1, 2) @ (support[..., None] * driven)
        slopes = [
            -seen[:, :, rows] @ driven[:, rows]
            for rows in (self.owner == index for index in range(len(self.directions)))
        ]
        return response, np.array(slopes)

    def _coupled(
        self, k: np.ndarray, c: np.ndarray, part: slice | np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (s = k + i omega c (frequency, contact_row) in N/m, I + G diag(s) (frequency,
        contact_row, contact_row)); k, c (direction,).
        """
        support = k[self.owner] + 2j * np.pi * self.frequency[part, None] * c[self.owner]
        matrix = self._compliance[part] * support[:, None, :]
        rows = np.arange(matrix.shape[1])
        matrix[:, rows, rows] += 1.0
        return support, matrix

    def undamped_modes(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return (omega (value,) rad/s ascending, vectors (mode, value)) with k (direction,)."""
        stiffness = np.diag(self.omega**2) + (self.contact * k[self.owner]) @ self.contact.T
        squares, vectors = np.linalg.eigh(stiffness)
        return np.sqrt(np.maximum(squares, 0.0)), vectors

    def own_compliance(self, k: np.ndarray) -> np.ndarray:
        """Return (direction,) m/N, the static compliance along each direction.

        The other directions have their stiffness k (direction,) in N/m.
        """
        found = np.zeros(len(self.directions))
        for index in range(len(found)):
            own = self.owner == index
            others = np.where(own, 0.0, k[self.owner])
            stiffness = np.diag(self.omega**2 + RIGID) + (self.contact * others) @ self.contact.T
            contact = self.contact[:, own]
            compliance = contact.T @ np.linalg.solve(stiffness, contact)
            found[index] = np.linalg.eigvalsh(compliance)[-1]
        return found

    def pole(self, k: np.ndarray, c: np.ndarray, near: complex) -> tuple[complex, np.ndarray]:
        """Return (the pole nearest to `near` in rad/s, its derivatives (direction,) by k).

        The derivative by c is the pole times that by k.

        k, c: (direction,) N/m and N s/m.
        """
        stiffness = np.diag(self.omega**2) + (self.contact * k[self.owner]) @ self.contact.T
        damping = np.diag(self.damping) + (self.contact * c[self.owner]) @ self.contact.T
        size = len(self.omega)
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -damping]])
        poles, vectors = np.linalg.eig(state)
        chosen = int(np.argmin(np.abs(poles - near)))
        pole, shape = poles[chosen], vectors[:size, chosen]
        # The matrices are symmetric: the left vector is the right one, not conjugated.
        scale = shape @ (2.0 * pole * shape + damping @ shape)
        moved = (self.contact.T @ shape) ** 2
        in_phase, across = (np.bincount(self.owner, part) for part in (moved.real, moved.imag))
        return complex(pole), -in_phase / scale - 1j * across / scale
