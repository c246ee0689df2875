"""The quantity of the simulation that each channel of a campaign measures: a displacement
differentiated in time, the strain of an outer fibre, or the force of a support on the structure.

Sensors are compared with each other to see how a mode moves them. A strain has another unit than a
displacement, and grows with another power of the frequency: in free bending of a beam the largest
strain is proportional to the largest velocity (F.V. Hunt, J. Acoust. Soc. Am. 32 (1960) 1123-1128).
"""

from collections.abc import Collection, Sequence

import numpy as np

from vibroimpact.io.units import TIME_DERIVATIVES
from vibroimpact.reduction.modal_model import ModalModel

STRAIN = "strain"
CONTACT_FORCE = "contact_force"
SENSED = ("acceleration", "velocity", "displacement", STRAIN, CONTACT_FORCE)
AT_SUPPORT_M = 5.0e-3  # largest distance from the line through a support's contact points


def moving(kinds: Collection[str]) -> np.ndarray:
    """Return (channel,) bool: whether channels of kinds (channel,) measure a motion."""
    return np.array([kind in TIME_DERIVATIVES for kind in kinds], bool)


def of_modes(kinds: Collection[str]) -> np.ndarray:
    """Return (channel,) bool: whether channels of kinds (channel,) respond linearly to the modes,
    as a motion and a strain do. A contact force does not: it is zero without contact.
    """
    return moving(kinds) | np.array([kind == STRAIN for kind in kinds], bool)


def orders(kinds: Collection[str]) -> np.ndarray:
    """Return (channel,) int: the order of the time derivative of displacement that each measures; 0
    for a strain, which is in phase with displacements, and for a contact force.
    """
    return np.array([TIME_DERIVATIVES.get(kind, 0) for kind in kinds], int)


def displacement_scale(model: ModalModel, kinds: Sequence[str] | np.ndarray) -> np.ndarray:
    """Return (channel,) the displacement equivalent to a unit of a channel's quantity.

    It is 1 except for strains, which are divided by omega, as they go with a velocity, and scaled
    to the largest of the other sensors. model: attached to the campaign.
    """
    shapes, gauges = np.abs(model.sensor_shapes), np.asarray(kinds) == STRAIN
    size, scale = shapes.max(axis=0), np.ones(len(gauges))
    if not gauges.any():
        return scale
    strains = (shapes[:, gauges] / np.maximum(model.omega, 1.0)[:, None]).max(axis=0)
    others, largest = size[~gauges].max(initial=0.0), strains.max()
    factor = others / largest if others > 0.0 and largest > 0.0 else 1.0
    moves = size[gauges] > 0.0
    scale[gauges] = np.where(moves, factor * strains / np.where(moves, size[gauges], 1.0), 1.0)
    return scale


def support_at(model: ModalModel, position: Sequence[float] | np.ndarray) -> int | None:
    """Return the index of the support at a position (3,) in m, None if that is more than
    AT_SUPPORT_M off the line through the contact points of every support.
    """
    away = []
    for support in range(len(model.support_names)):
        points = model.contact_position[model.support_of_point == support]
        if not len(points):
            away.append(np.inf)
            continue
        along, reached = points[-1] - points[0], np.asarray(position, float) - points[0]
        share = np.clip(reached @ along / max(along @ along, 1.0e-300), 0.0, 1.0)
        away.append(float(np.linalg.norm(reached - share * along)))
    return int(np.argmin(away)) if away and min(away) < AT_SUPPORT_M else None


def across(model: ModalModel, support: int) -> np.ndarray:
    """Return (2, 3): the directions of the two resultants of a support, at its middle point."""
    points = np.flatnonzero(model.support_of_point == support)
    return model.contact_directions[points[len(points) // 2]]


def force_weights(model: ModalModel, kinds: Sequence[str] | np.ndarray) -> np.ndarray:
    """Return (contact force channel, 2 support): the weights of the two resultants of every support
    in each channel of kind CONTACT_FORCE, positive along its direction.

    model: attached to the campaign, its sensors are the channels. Raises ValueError for a channel
    of an unknown kind and for a contact force at no support.
    """
    pressed = np.flatnonzero(~of_modes(kinds))
    supports = len(model.support_names)
    weights = np.zeros((len(pressed), supports, 2))
    for row, channel in zip(weights, pressed.tolist(), strict=True):
        support = support_at(model, model.sensor_positions[channel])
        if kinds[channel] != CONTACT_FORCE or support is None:
            raise ValueError(
                f"channel {model.sensor_names[channel]} of kind {kinds[channel]} can not be"
                f" simulated: give {', '.join(TIME_DERIVATIVES)}, {STRAIN}, or {CONTACT_FORCE} at a"
                " support"
            )
        row[support] = across(model, support) @ model.sensor_directions[channel]
    return weights.reshape(len(pressed), 2 * supports)
