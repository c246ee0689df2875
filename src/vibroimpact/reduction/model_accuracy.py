"""Accuracy of the reduced model in the states of the study: its basis and its mesh.

Frequencies are compared without contact, and with every contact and local element as a spring of
its own stiffness. Reduced against full frequencies on the same mesh give the error of the basis;
full frequencies on the mesh, and on one with each element cut in two, that of the mesh.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy import linalg, sparse

from vibroimpact.config.excitation import highest_frequency
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.structure.contact.local_elements import element_laws

from .reduced_model import full_structure, keeps_all_modes, reduced_basis, spring_rows

COLUMNS = (
    *("condition", "mode", "full_Hz", "reduced_Hz", "basis_error"),
    *("halved_mesh_Hz", "mesh_error", "flag"),
)
CONDITIONS = ("free", "on supports")
# Relative error of a frequency. The methods of identification take a model's frequencies as right
# within this (identify.estimate.FREQUENCY_ERROR): beyond it, their stated errors would be too low.
LARGEST_ERROR = 3.0e-3
# Frequencies of the elements converge with the second power of their length, or with a higher one
# (docs/validation.md, Convergence). With the second the error is not rated too low.
MESH_ORDER = 2
MODES = (7, 40)  # of a condition: at least, at most
DENSE_DOFS = 60  # a smaller structure has no use for a sparse solution
RIGID = 1.0e-3  # of the lowest elastic frequency; rigid motions of free tubes have 1e-4 at most

# Stiffness and mass (dof, dof), sparse, and displacements of the springs (spring, dof).
System = tuple[Any, Any, np.ndarray]


class ModelAccuracyError(ValueError):
    """A reduced model that does not stand for the full one; the message names key and remedy."""


def model_accuracy(config: ConfigPart) -> list[dict[str, Any]]:
    """Return rows that compare the frequencies of the reduced model, of the full one, and of a
    finer mesh.

    The keys of a row are COLUMNS:

    condition: "free", or "on supports": contacts and local elements are springs of their stiffness.
    mode: from 1, in ascending frequency, those of rigid motion included.
    full_Hz, reduced_Hz: of the full and of the reduced model; NaN if the basis has fewer modes.
    basis_error: reduced over full, minus 1; 0 for rigid motion that is rigid in both.
    halved_mesh_Hz: of the full model with each element cut in two; NaN for matrices.
    mesh_error: full over exact, minus 1; the exact one is extrapolated from the two meshes.
    flag: "basis" or "mesh" if that error of an excited mode is above LARGEST_ERROR, or NaN;
        else "". The first elastic mode always counts as excited.

    There is a row for every mode in the excited band, see MODES. Empty for a structure whose model
    has all its modes.
    """
    structure, local_rows = full_structure(config)
    if keeps_all_modes(structure):
        return []
    known = reduced_basis(config)
    omega, shapes = known.omega, known.shapes
    scale = float(omega[omega > 0.0].min()) if np.any(omega > 0.0) else 1.0  # lowest elastic mode
    moved = spring_rows(structure, local_rows)
    meshes = [(structure.stiffness, structure.mass, moved)]
    if config.structure.kind in TUBES:
        finer, finer_rows = full_structure(config, halved=True)
        meshes.append((finer.stiffness, finer.mass, spring_rows(finer, finer_rows)))
    basis = (sparse.diags_array(omega**2), sparse.eye_array(len(omega)), moved @ shapes)
    _, laws = element_laws(config.elements, np.zeros(len(getattr(structure, "dampers", ()))))
    contact = np.repeat(structure.contact.stiffness, 2)
    stiffness = np.concatenate([contact, np.maximum(laws.stiffness, 0.0)])  # N/m of all springs
    excited = highest_frequency(config.excitation)
    rows = []
    for condition in CONDITIONS:
        springs = stiffness if condition == "on supports" else np.zeros(len(stiffness))
        count = min(_count(basis, springs, scale, excited), structure.dofs)
        full, *others = (_lowest_Hz(each, springs, scale, count) for each in (*meshes, basis))
        reduced, halved = others[-1], others[0] if len(others) > 1 else np.full(count, np.nan)
        rows += _rows(condition, (full, reduced, halved), excited)
    return rows


def require_accurate(rows: Iterable[dict[str, Any]]) -> None:
    """Raise ModelAccuracyError if the basis misses an excited mode by more than LARGEST_ERROR.

    rows: of model_accuracy.
    """
    for row in rows:
        if row["flag"] == "basis":
            found = (
                "is missing"
                if np.isnan(row["reduced_Hz"])
                else f"has {row['reduced_Hz']:.6g} Hz (at most {100 * LARGEST_ERROR:g} % off)"
            )
            raise ModelAccuracyError(
                f"basis: mode {row['mode']} {row['condition']}, {row['full_Hz']:.6g} Hz of the full"
                f" model, {found} in the reduced one: raise basis.free_modes_to_Hz or"
                " basis.constrained_modes_to_Hz, or set basis.attachment_shapes: true"
            )


def mesh_warnings(rows: Iterable[dict[str, Any]]) -> list[str]:
    """Return a sentence about the mesh if its error is above LARGEST_ERROR, else none.

    rows: of model_accuracy.
    """
    flagged = [row for row in rows if row["flag"] == "mesh"]
    if not flagged:
        return []
    worst = max(flagged, key=lambda row: abs(row["mesh_error"]))
    return [
        f"structure.mesh is coarse: the frequency of mode {worst['mode']} {worst['condition']},"
        f" {worst['full_Hz']:.4g} Hz, is off by {100.0 * abs(worst['mesh_error']):.3g} % (at most"
        f" {100.0 * LARGEST_ERROR:g} %): give more elements_per_span or elements_per_bend"
    ]


def _count(basis: System, springs: np.ndarray, scale: float, excited: float) -> int:
    """Return how many modes a condition has rows for, see MODES.

    excited: Hz, of the highest excited frequency.
    """
    frequencies = _lowest_Hz(basis, springs, scale, basis[0].shape[0])
    rigid, low = np.sum(frequencies == 0.0), np.sum(frequencies <= excited)
    return int(min(max(rigid + MODES[0], low + 1), rigid + MODES[1]))


def _lowest_Hz(system: System, springs: np.ndarray, scale: float, count: int) -> np.ndarray:
    """Return (count,) Hz of the lowest modes on springs; NaN beyond those that there are.

    The problem is solved for the flexibility 1 / (omega² + shift): round-off is relative to the
    lowest modes. Below RIGID of the scale, in rad/s, a mode is rigid-body motion.
    """
    stiffness, mass, rows = system
    size, shift = mass.shape[0], (0.5 * scale) ** 2
    moved = sparse.csr_array(np.sqrt(springs)[:, None] * rows)
    shifted = (stiffness + shift * mass + moved.T @ moved).tocsc()
    if size <= DENSE_DOFS or count >= size // 2:
        flexibility = linalg.eigh(mass.toarray(), shifted.toarray(), eigvals_only=True)
    else:
        from scipy.sparse.linalg import eigsh  # half a second that other runs save

        start = np.random.default_rng(0).normal(size=size)  # the same in every run
        flexibility = 1.0 / eigsh(
            shifted, k=count, M=mass.tocsc(), sigma=0.0, v0=start, return_eigenvectors=False
        )
    squares = np.sort(1.0 / flexibility - shift)[:count]
    frequencies = np.full(count, np.nan)
    rigid = squares < (RIGID * scale) ** 2
    frequencies[: len(squares)] = np.sqrt(np.where(rigid, 0.0, squares)) / (2.0 * np.pi)
    return frequencies


def _rows(
    condition: str, frequencies: tuple[np.ndarray, np.ndarray, np.ndarray], excited: float
) -> list[dict[str, Any]]:
    """Return the rows of a condition.

    frequencies: (full, reduced, halved mesh), each (mode,) Hz.
    """
    full, reduced, halved = frequencies
    exact = halved - (full - halved) / (2**MESH_ORDER - 1)
    basis_error, mesh_error = _relative(reduced, full), _relative(full, exact)
    first = int(np.argmax(full > 0.0))
    flags = [""] * len(full)
    for mode in range(len(full)):
        if mode > first and not full[mode] <= excited:
            continue
        if not abs(basis_error[mode]) <= LARGEST_ERROR:
            flags[mode] = "basis"
        elif abs(mesh_error[mode]) > LARGEST_ERROR:
            flags[mode] = "mesh"
    values = zip(full, reduced, basis_error, halved, mesh_error, flags, strict=True)
    return [
        dict(zip(COLUMNS, (condition, mode, *row), strict=True))
        for mode, row in enumerate(values, start=1)
    ]


def _relative(value: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """Return value over reference, minus 1; 0 if both are 0, infinite if one is."""
    out = np.where(value == reference, 0.0, np.inf)
    both = (value != 0.0) & (reference != 0.0)
    out[both] = value[both] / reference[both] - 1.0
    return out
