"""How much of every record each stage of a discrepancy run looks at: statistics need seconds
enough, and every second is simulated a thousand times.
"""

from math import ceil

from vibroimpact.integration.kernels.lanes import LANES

from . import priors


def compared_s(records, duration_s, asked_s=None):
    """Return the seconds of each of so many records, all from rest, that candidates are calibrated
    on; asked_s: where somebody asks for another time.
    """
    if asked_s is not None:
        return min(asked_s, duration_s)
    return min(max(priors.COMPARED_S / ceil(records / LANES), priors.SCREENED_S), duration_s)


def screened_s(compared):
    """Return the seconds that all candidates are screened on."""
    return min(compared, priors.SCREENED_S)
