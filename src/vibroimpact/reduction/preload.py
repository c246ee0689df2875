"""Bars that press the tube at rest: the interference that a given force takes.

A flat land with the normal n presses a contact point with the force P at rest, without other
forces. The structure then yields by u = -C (sum of P n over the lands), with its static flexibility
C, and the contact by p = P / k (or the inverse of Hertz' law). The penetration n·(u - c) - g is p
for every land of a point when its gap is g = -p and its centre c = u. A bar on one side with P is
therefore the same as one with the interference P / k + P n·C n (linear statics). Constant forces
come on top, and change the force of the bar.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.contact.laws import ContactLaws, LocalLaws

CONVERGED = 1.0e-12  # relative change of the static displacement in the last Newton step
NEWTON_STEPS = 50
UNHELD = 1.0e-6  # of the largest modal force: more than this left over is no equilibrium


def with_preload(fields: dict[str, Any], supports: Sequence[ConfigPart]) -> dict[str, Any]:
    """Return the fields of a ModalModel with the obstacles of preloaded supports where they press.

    Their gaps are those of contact_laws; their centres move with the structure to its static
    equilibrium. No support without preload is taken to touch there.

    fields: {name: array} of a ModalModel, with the mode axis first.
    supports: entries of the configuration.

    Raises ValueError when nothing holds the structure against the preloads.
    """
    pressed = np.array(
        [supports[number].preload_N is not None for number in fields["support_of_point"]], bool
    )
    if not pressed.any():
        return fields
    shapes = fields["contact_shapes"]
    force = np.zeros(len(fields["omega"]))
    laws = fields["contact_laws"]
    press = contact_press(laws, fields["contact_stiffness"])
    for point, normal in zip(laws.land_point, laws.land_normal, strict=True):
        if pressed[point]:
            force -= press[point] * (shapes[:, point] @ normal)
    rest = static_amplitudes(fields["omega"], force, fields["element_shapes"], fields["local_laws"])
    moved = np.einsum("mpd,m->pd", shapes, rest)
    return fields | {
        "centre_offset": fields["centre_offset"] + np.where(pressed[:, None], moved, 0.0)
    }


def contact_press(laws: ContactLaws, stiffness: np.ndarray) -> np.ndarray:
    """Return (contact_point,) N, the force of each flat land on a structure at the obstacle's
    centre; 0 where the gap is not negative.

    stiffness: (contact_point,) N/m.
    """
    depth = np.maximum(-np.nan_to_num(laws.gap), 0.0)
    return np.where(laws.hertz > 0.0, laws.hertz * depth**1.5, stiffness * depth)


def static_amplitudes(
    omega: np.ndarray, force: np.ndarray, element_shapes: np.ndarray, laws: LocalLaws
) -> np.ndarray:
    """Return (mode,) modal amplitudes in kg^1/2 m of a structure at rest under a force.

    Newton's method on omega² q + forces of the local elements = force. Sliders are taken as free of
    force.

    omega: (mode,) rad/s.
    force: (mode,) N kg^-1/2.
    element_shapes: (mode, element).

    Raises ValueError when there is no equilibrium: nothing holds the structure against the force.
    """
    rest = np.zeros(len(omega))
    for _ in range(NEWTON_STEPS):
        element_force, tangent = _element_forces(laws, element_shapes.T @ rest)
        residual = force - omega**2 * rest - element_shapes @ element_force
        matrix = np.diag(omega**2) + (element_shapes * tangent) @ element_shapes.T
        held = np.diag(matrix) > 0.0
        scale = 1.0 / np.sqrt(np.diag(matrix)[held])  # squared frequencies span twelve decades
        scaled = matrix[np.ix_(held, held)] * scale * scale[:, None]
        step = np.linalg.lstsq(scaled, scale * residual[held])[0]
        rest[held] += scale * step
        if np.linalg.norm(step) <= CONVERGED * np.linalg.norm(rest[held] / scale):
            break
    left = np.abs(residual).max(initial=0.0)
    if left > UNHELD * np.abs(force).max(initial=0.0):
        raise ValueError(
            "supports: there is no static equilibrium under preload_N: hold an end of the"
            " structure, press from both sides, or lower the force"
        )
    return rest


def _element_forces(laws: LocalLaws, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (force (element,) N that resists, tangent (element,) N/m) at displacements u in m."""
    spring = laws.saturation_stiffness * u
    inside = np.abs(spring) < laws.saturation_limit
    force = laws.stiffness * u + laws.quadratic * u**2 + laws.cubic * u**3
    force += np.clip(spring, -laws.saturation_limit, laws.saturation_limit)
    tangent = laws.stiffness + 2.0 * laws.quadratic * u + 3.0 * laws.cubic * u**2
    return force, tangent + np.where(inside, laws.saturation_stiffness, 0.0)
