"""The family of linear tubes on a bilateral support (k, c), prepared once for fast responses.

With B (mode, contact) the contact shapes scaled by the square root of their weights, the support
adds s B B^T to the dynamic stiffness, s = k + i omega c. Woodbury's formula leaves the small
contact compliance G = B^T Z^-1 B. With its eigenvalues mu_j at each frequency every response is

    h = h_free - sum_j s r_j / (1 + s mu_j).

The eigenvalues serve all outputs, all independent forces and all (k, c).
"""

from dataclasses import dataclass

import numpy as np

from vibroimpact.reduction.modal_model import ModalModel

from .modes import contact_matrix, driven_block


@dataclass(frozen=True)
class DrivenModes:
    """The modes that the forces excite, and the contacts that they move.

    omega, damping: (mode,) rad/s and 1/s.
    contact: (mode, contact) kg^-1/2, scaled by the square root of the contact's weight.
    drive: (mode, force) kg^-1/2.
    indices: (mode,) in the ModalModel.
    block: (mode,) bool, the uncoupled block that the drive moves most; its lowest mode is "the
        first mode".
    """

    omega: np.ndarray
    damping: np.ndarray
    contact: np.ndarray
    drive: np.ndarray
    indices: np.ndarray
    block: np.ndarray

    @property
    def first(self) -> int:
        """Return the index of the first mode."""
        return int(np.argmin(np.where(self.block, self.omega, np.inf)))

    def receptance(self, laplace: np.ndarray | complex) -> np.ndarray:
        """Return the modal receptances (..., mode) in s² at complex laplace (...) in rad/s."""
        laplace = np.asarray(laplace)[..., None]
        return 1.0 / (self.omega**2 + laplace * (self.damping + laplace))

    def compliance(self, laplace: np.ndarray | complex) -> np.ndarray:
        """Return the contact compliance G (..., contact, contact) in m/N at laplace (...)."""
        return (self.contact.T * self.receptance(laplace)[..., None, :]) @ self.contact


def driven_modes(model: ModalModel) -> DrivenModes:
    """Return the DrivenModes of a model.

    Raises ValueError when no force moves a contact.
    """
    block, drive = driven_block(model), model.drive_shapes
    driven = [modes for modes, _ in model.blocks if np.any(drive[modes] != 0.0)]
    indices = np.sort(np.concatenate(driven))
    contact = contact_matrix(model)[indices]
    contact = contact[:, (contact != 0.0).any(axis=0)]
    omega, damping = model.omega[indices], model.damping[indices]
    return DrivenModes(omega, damping, contact, drive[indices], indices, np.isin(indices, block))


@dataclass(frozen=True)
class FamilyResponse:
    """Displacement per unit force of every member of the family on one frequency grid.

    The forces are independent and have the same PSD. A relative PSD that is given is part of the
    responses, by its root.

    frequency: (frequency,) Hz.
    free: (force, output, frequency) m/N, the tube without support.
    residue: (force, output, frequency, contact) m²/N².
    compliance: (frequency, contact) m/N, the eigenvalues mu.
    """

    frequency: np.ndarray
    free: np.ndarray
    residue: np.ndarray
    compliance: np.ndarray

    def of(self, part: slice | np.ndarray, outputs: slice = slice(None)) -> "FamilyResponse":
        """Return the FamilyResponse of some frequencies (a slice or indices) and outputs."""
        free, residue = (each[:, outputs][:, :, part] for each in (self.free, self.residue))
        return FamilyResponse(self.frequency[part], free, residue, self.compliance[part])

    def frf(self, k: float, c: float) -> np.ndarray:
        """Return the responses (force, output, frequency) in m/N for k in N/m and c in N s/m."""
        support = (k + 2j * np.pi * c * self.frequency)[:, None]
        gain = support / (1.0 + support * self.compliance)
        return self.free - (self.residue * gain).sum(axis=-1)

    def frf_slope(self, k: float, c: float) -> tuple[np.ndarray, np.ndarray]:
        """Return (responses (force, output, frequency), derivatives by s = k + i omega c)."""
        support = (k + 2j * np.pi * c * self.frequency)[:, None]
        share = 1.0 / (1.0 + support * self.compliance)
        response = self.free - (self.residue * (support * share)).sum(axis=-1)
        return response, -(self.residue * share**2).sum(axis=-1)

    def psd(self, k: float, c: float) -> np.ndarray:
        """Return the displacement PSDs (output, frequency) in m²/N² per PSD of each force."""
        response = self.frf(k, c)
        return (response.real**2 + response.imag**2).sum(axis=0)


class LinearFamily:
    """The eigenvalues of the contact compliance on one frequency grid.

    Responses at any outputs follow from them.
    """

    def __init__(
        self, modes: DrivenModes, frequency: np.ndarray, force_psd: np.ndarray | None = None
    ) -> None:
        """Solve the eigenvalue problems.

        frequency: (frequency,) Hz.
        force_psd: (frequency,) relative PSD of the forces; None for white ones.
        """
        self.modes = modes
        self.frequency = frequency
        self._root = None if force_psd is None else np.sqrt(force_psd)
        self._receptance = modes.receptance(2j * np.pi * frequency)
        self._compliance, self._vectors = np.linalg.eig(modes.compliance(2j * np.pi * frequency))
        moved = [(self._receptance * drive) @ modes.contact for drive in modes.drive.T]
        self._excited = [np.linalg.solve(self._vectors, each[..., None])[..., 0] for each in moved]

    def response(
        self, shapes: np.ndarray, part: slice | np.ndarray = slice(None)
    ) -> FamilyResponse:
        """Return the FamilyResponse of outputs on a part of the grid.

        shapes: (mode, output), modes as in the ModalModel.
        """
        shapes = shapes[self.modes.indices]
        receptance, vectors = self._receptance[part], self._vectors[part]
        free = np.stack([((receptance * drive) @ shapes).T for drive in self.modes.drive.T])
        observed = np.stack([(receptance * shape) @ self.modes.contact for shape in shapes.T])
        reached = (observed[:, :, None, :] @ vectors)[:, :, 0, :]
        residue = np.stack([reached * excited[part] for excited in self._excited])
        if self._root is not None:
            free, residue = free * self._root[part], residue * self._root[part][:, None]
        return FamilyResponse(self.frequency[part], free, residue, self._compliance[part])
