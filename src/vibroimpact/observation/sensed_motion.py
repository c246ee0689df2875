"""What each channel of a campaign measures, in terms of what a simulation gives: the displacement
of a point differentiated in time, the strain of an outer fibre, or the force of a support on the
structure.
"""

import numpy as np

from vibroimpact.units import TIME_DERIVATIVES

from .strain import STRAIN, as_displacements

CONTACT_FORCE = "contact_force"
SENSED = ("acceleration", "velocity", "displacement", STRAIN, CONTACT_FORCE)
AT_SUPPORT_M = 5.0e-3  # from the line through a support's contact points


def moving(kinds):
    """Return (channel,) bool: whether channels of kinds (channel,) measure a motion."""
    return np.array([kind in TIME_DERIVATIVES for kind in kinds], bool)


def of_modes(kinds):
    """Return (channel,) bool: whether channels of kinds (channel,) show the modes by themselves, a
    motion or a strain; a contact force does not, which there is none of until a support is touched.
    """
    return moving(kinds) | np.array([kind == STRAIN for kind in kinds], bool)


def orders(kinds):
    """Return (channel,) int: how often each channel's displacement is differentiated; 0 for a
    strain, which is in phase with displacements, and for a contact force.
    """
    return np.array([TIME_DERIVATIVES.get(kind, 0) for kind in kinds], int)


def differentiated(omega, kind):
    """Return (line,) the factor from displacement, or strain, to what a channel of a kind measures
    at omega (line,) in rad/s; 0 for a contact force, which a linear structure has none of.
    """
    if kind == STRAIN:
        return np.ones_like(omega)
    if kind not in TIME_DERIVATIVES:
        return 0.0 * omega
    order = TIME_DERIVATIVES[kind]
    return -(omega**2) if order == 2 else (1j * omega) ** order


def kind_groups(kinds):
    """Return {kind: (channel,) bool} of the kinds that channels of kinds (channel,) have."""
    kinds = np.asarray(kinds)
    return {str(kind): kinds == kind for kind in dict.fromkeys(kinds.tolist())}


def support_at(model, position):
    """Return the index of the support whose contact points lie about a position (3,) m, None where
    there is none within AT_SUPPORT_M of the line through them.
    """
    away = [
        _distance(
            np.asarray(position, float), model.contact_position[model.support_of_point == own]
        )
        for own in range(len(model.support_names))
    ]
    return int(np.argmin(away)) if away and min(away) < AT_SUPPORT_M else None


def across(model, support):
    """Return (2, 3): the directions of the two resultants of a support, those at its middle."""
    points = np.flatnonzero(model.support_of_point == support)
    return model.contact_directions[points[len(points) // 2]]


def force_weights(model, kinds):
    """Return (force channel, 2 support): what each channel of kind CONTACT_FORCE measures of the
    two resultants of every support on the structure, positive along its direction.

    model: attached to the campaign, whose sensors are the channels. Raises ValueError for a channel
    that is at no support.
    """
    pressed = np.flatnonzero(~of_modes(kinds))
    weights = np.zeros((len(pressed), 2 * len(model.support_names)))
    for row, channel in zip(weights, pressed, strict=True):
        support = support_at(model, model.sensor_positions[channel])
        if kinds[channel] != CONTACT_FORCE or support is None:
            raise ValueError(
                f"channel {model.sensor_names[channel]} of kind {kinds[channel]} can not be"
                f" simulated: give {', '.join(TIME_DERIVATIVES)}, {STRAIN}, or {CONTACT_FORCE} at a"
                " support"
            )
        row[2 * support : 2 * support + 2] = (
            across(model, support) @ model.sensor_directions[channel]
        )
    return weights


def motion_there(model, kinds):
    """Return (mode, channel): the displacement that each channel measures, for a strain one that is
    as large (see strain.as_displacements), and for a contact force that of its support's points
    along it, which is what the force answers to.
    """
    shapes = as_displacements(model).copy()
    pressed = np.flatnonzero(~of_modes(kinds))
    resultants = np.zeros((model.modes, 2 * len(model.support_names)))
    for support in range(len(model.support_names)):
        own = model.support_of_point == support
        resultants[:, 2 * support : 2 * support + 2] = model.contact_shapes[:, own].mean(axis=1)
    shapes[:, pressed] = resultants @ force_weights(model, kinds).T
    return shapes


def _distance(position, points):
    """Return the distance in m of a position (3,) from the line through points (point, 3)."""
    if not len(points):
        return np.inf
    ends = points[[0, -1]] if len(points) > 1 else points[[0, 0]]
    along = ends[1] - ends[0]
    share = np.clip((position - ends[0]) @ along / max(along @ along, 1.0e-300), 0.0, 1.0)
    return float(np.linalg.norm(position - ends[0] - share * along))
