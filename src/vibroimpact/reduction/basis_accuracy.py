"""Accuracy of the Ritz basis: frequencies on it against those of the full model.

The basis is compared as a whole, family by family, and with each family left out.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
from scipy import linalg

from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.structure.tube import build_structure

from .model_accuracy import ModelAccuracyError
from .ritz_basis import (
    FAMILIES,
    DofGroup,
    basis_vectors,
    eigenmodes,
    orthonormal_basis,
    uncoupled_groups,
)

# N/m per support: the decades from 1 to 1e9, and the contact stiffness of the stand-in tube.
STIFFNESSES = (*(10.0**power for power in range(7)), 4.0e6, 1.0e7, 1.0e8, 1.0e9)
HIGHEST_HZ = 400.0
OTHERS = {family: tuple(each for each in FAMILIES if each != family) for family in FAMILIES}
# Name of a basis -> (families, fraction of the free modes' cut-off).
BASES = {
    "all": (FAMILIES, 1.0),
    **{f"{family} alone": ((family,), 1.0) for family in FAMILIES},
    **{f"without {family}": (OTHERS[family], 1.0) for family in FAMILIES},
    "free_modes to a tenth": (FAMILIES, 0.1),
    **{
        f"free_modes to a tenth, without {family}": (OTHERS[family], 0.1) for family in FAMILIES[1:]
    },
}


def basis_frequency_errors(config: ConfigPart) -> list[dict[str, Any]]:
    """Return rows that compare reduced with full frequencies of a tube on bilateral contact.

    The keys of a row are

    vectors: "all", "free_modes alone", ...: the families of the basis, see BASES;
    modes: number of modes of the basis in the group;
    stiffness_N_per_m: stiffness per support, 1 to 1e9 N/m;
    group: number of the uncoupled group of degrees of freedom;
    mode: number of the mode in its group, from 1;
    full_Hz, reduced_Hz: frequencies up to 400 Hz; NaN if the basis has fewer modes;
    relative_error: positive, because a Ritz basis can only stiffen, up to the round-off of the
        full eigenvalues (about 1e-8). 0 for rigid motion that is rigid on the basis too.

    Empty for a structure other than a tube: all modes are in the model, or the user's matrices set
    the basis.
    """
    if config.structure.kind not in TUBES:
        return []
    structure = build_structure(config)
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    share = np.sqrt(np.repeat(structure.contact.weight, 2))
    rows = []
    for number, group in enumerate(groups):
        contact = share[group.contact_rows][:, None] * group.contact
        bases = _bases(group, config.basis)
        for stiffness in STIFFNESSES:
            supported = group.stiffness + stiffness * contact.T @ contact
            full = eigenmodes(supported, group.mass, HIGHEST_HZ)[0] / (2.0 * np.pi)
            for name, basis in bases.items():
                reduced = _reduced_frequencies(basis, contact, stiffness, len(full))
                rows += [
                    {
                        "vectors": name,
                        "modes": len(basis[0]),
                        "stiffness_N_per_m": stiffness,
                        "group": number,
                        "mode": mode + 1,
                        "full_Hz": full[mode],
                        "reduced_Hz": reduced[mode],
                        "relative_error": _relative_error(reduced[mode], full[mode]),
                    }
                    for mode in range(len(full))
                ]
    return rows


def require_complete(rows: Iterable[dict[str, Any]], basis: ConfigPart) -> None:
    """Raise ModelAccuracyError if the basis as a whole lacks a mode that it should have.

    Supports raise the frequencies of a structure: on them it has no more modes below the cut-off of
    the free modes than without.

    rows: of basis_frequency_errors.
    basis: section of the configuration.
    """
    for row in rows:
        if row["vectors"] != "all" or row["full_Hz"] > basis.free_modes_to_Hz:
            continue
        if np.isnan(row["relative_error"]):
            raise ModelAccuracyError(
                f"basis: the reduced model has no mode at {row['full_Hz']:.6g} Hz (number"
                f" {row['mode']} with supports of {row['stiffness_N_per_m']:g} N/m), the full"
                " one has: raise basis.free_modes_to_Hz, and look for elements that are very short"
                " compared with the tube"
            )


def _relative_error(reduced: float, full: float) -> float:
    """Return the relative error of a frequency; 0 / 0 is none."""
    if full == 0.0:
        return 0.0 if reduced == 0.0 else np.inf
    return reduced / full - 1.0


def _bases(group: DofGroup, basis: ConfigPart) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return {name: (omega (mode,), shapes (dof, mode))}: the bases of BASES for one group."""
    vectors = basis_vectors(group, basis)
    free_Hz = group.free_modes(basis.free_modes_to_Hz)[0] / (2.0 * np.pi)
    bases = {}
    for name, (families, fraction) in BASES.items():
        chosen = {family: vectors[family] for family in families if family in vectors}
        if "free_modes" in chosen:
            low = free_Hz <= fraction * basis.free_modes_to_Hz
            chosen["free_modes"] = chosen["free_modes"][:, low]
        bases[name] = orthonormal_basis(group, chosen)
    return bases


def _reduced_frequencies(
    basis: tuple[np.ndarray, np.ndarray], contact: np.ndarray, stiffness: float, count: int
) -> np.ndarray:
    """Return (count,) Hz of a basis (omega, shapes) on springs; NaN beyond its modes.

    contact: (contact_row, dof).
    stiffness: N/m.
    """
    omega, shapes = basis
    moved = contact @ shapes
    squares = np.zeros(0)
    if len(omega):
        squares = linalg.eigvalsh(np.diag(omega**2) + stiffness * moved.T @ moved)
    frequencies = np.full(count, np.nan)
    frequencies[: len(squares)] = np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi)
    return frequencies
