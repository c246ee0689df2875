"""Parts of a configuration without effect on its model, and those that make it unstable."""

from collections.abc import Iterator

import numpy as np
from scipy import linalg

from vibroimpact.config.stage_settings import ConfigPart

from .modal_model import ModalModel

# Of the largest term: an eigenvalue above minus this is round-off.
ROUND_OFF = 1.0e-9


def without_effect(model: ModalModel, excitation: ConfigPart) -> Iterator[str]:
    """Yield a sentence for the force, each support and each element at which nothing can move.

    excitation: section of the configuration.
    """
    if excitation.kind != "none" and not np.any(model.drive_shapes):
        yield (
            "excitation: the force has no effect, nothing moves along it there: give another point"
            " or direction, a factor that is not 0, or kind: none"
        )
    reached = _points_that_close(model)
    for number, name in enumerate(model.support_names):
        if not np.any(reached[model.support_of_point == number]):
            yield (
                f"supports[{number}]: '{name}' has no effect, nothing moves across it there: move"
                " it, or leave it out"
            )
    for number, name in enumerate(model.element_names):
        # Dampers of a damping matrix always move.
        if not np.any(model.element_shapes[:, number]):
            yield (
                f"elements: '{name}' has no effect, its ends do not move along it: give another"
                " point or direction, or leave it out"
            )


def _points_that_close(model: ModalModel) -> np.ndarray:
    """Return (contact_point,) whether the structure moves towards the obstacle or a flat land."""
    laws, shapes = model.contact_laws, model.contact_shapes
    reached = np.any(shapes, axis=(0, 2))
    towards = np.einsum("mla,la->ml", shapes[:, laws.land_point], laws.land_normal)
    least = ROUND_OFF * np.abs(shapes).max(initial=0.0)
    reached[laws.land_point] = False
    np.logical_or.at(reached, laws.land_point, np.abs(towards).max(axis=0, initial=0.0) > least)
    return reached


def runaway(model: ModalModel) -> Iterator[str]:
    """Yield a sentence if negative springs of elements win over structure and supports.

    A cubic term that stiffens holds the motion at some amplitude: then there is none.
    """
    local = model.local_laws
    negative = np.flatnonzero(local.stiffness < 0.0)
    if not negative.size or np.any(local.cubic > 0.0):
        return
    contact = model.contact_shapes.reshape(model.modes, -1)
    held = np.diag(model.omega**2)
    held += (contact * np.repeat(model.contact_stiffness, 2)) @ contact.T
    pulled = (model.element_shapes * local.stiffness) @ model.element_shapes.T
    lowest = linalg.eigvalsh(held + pulled, subset_by_index=[0, 0])[0]
    if lowest < -ROUND_OFF * np.abs(pulled).max():
        names = ", ".join(
            f"'{model.element_names[each]}' with {local.stiffness[each]:g} N/m" for each in negative
        )
        yield (
            f"elements: {names} pushes the structure away, even with every support in contact: give"
            " a stiffness_N_per_m that the structure can hold, or a cubic_N_per_m3 above 0"
        )
