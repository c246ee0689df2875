"""The linear limits of the tube: without contact, in full contact and held; and the shown band."""

import numpy as np
from scipy import linalg

from vibroimpact.identify.linear.modes import contact_matrix, driven_block, support_stiffness
from vibroimpact.identify.linear.support_groups import grouped_supports

HELD = 1.0e14  # N/m: practically fixed contact points; larger values show round-off
LIMIT_MODES = 12  # of the lowest, looked for in a band


def driven_frequencies(model, stiffness, count=1):
    """Return (k, count) lowest frequencies in Hz of the plane that the drive excites.

    stiffness (k,): N/m per support.
    """
    modes = driven_block(model)
    contact = contact_matrix(model)[modes]
    rows = []
    for k in np.atleast_1d(stiffness):
        squares = linalg.eigvalsh(support_stiffness(model.omega[modes], contact, k))
        rows.append(np.sqrt(np.maximum(squares[:count], 0.0)) / (2.0 * np.pi))
    return np.array(rows)


def limit_modes(model, band):
    """Return [(name, (mode,) Hz)]: the modes of the driven plane inside a band (low, high), of the
    free tube and of the tube in full contact.
    """
    found = []
    for name, k in (("free modes", 0.0), ("modes in full contact", contact_stiffness(model))):
        values = driven_frequencies(model, k, LIMIT_MODES)[0]
        found.append((name, values[(values > band[0]) & (values < band[1])]))
    return found


def contact_stiffness(model, group="all"):
    """Return the contact stiffness in N/m per support, the largest of a group of supports."""
    each = np.bincount(model.support_of_point, model.contact_stiffness)
    members = grouped_supports(model.support_names, "all").get(group, group.split("+"))
    return float(max(each[model.support_names.index(name)] for name in members))


def shown_band(model, highest_Hz=np.inf):
    """Return (low, high) in Hz of the band that figures show.

    It reaches from well below the first free mode to just above the third mode of the driven plane
    in full contact.
    """
    third = driven_frequencies(model, contact_stiffness(model), 3)[0, -1]
    return 0.35 * driven_frequencies(model, 0.0)[0, 0], min(1.1 * third, highest_Hz)
