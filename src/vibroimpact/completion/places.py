"""Where the structure changes with the level: places ranked by how well a support of their own per
level explains all levels.
"""

import numpy as np

from .family import fit_family
from .study import row_of

PASSES = 12
MOST_TRIED = 3  # places at which every law is tried
NEAR = 4.0  # times the squared error of the best place: one above it is not tried


def ranked_places(base, study, levels):
    """Return [{place, error, k_N_per_m (level,), c_N_s_per_m (level,)}], best first: the family of
    linear models with a support at each place.

    error: RMS over fitted levels and channels of the relative error that is left; levels: those
    that names are fitted to.
    """
    rows = []
    for place, weights in study.places.items():
        if weights is None:
            continue
        row = row_of(study, place, base.names)
        if not np.any(base.shapes[~base.residual] @ np.array(row)):
            continue
        family = fit_family(base, row, levels, study.band_Hz, passes=PASSES)
        rows.append(
            {
                "place": place,
                "error": float(np.sqrt(np.mean(family.errors**2))),
                "k_N_per_m": family.k,
                "c_N_s_per_m": family.c,
            }
        )
    return sorted(rows, key=lambda row: row["error"])


def tried_places(ranking):
    """Return the names of the places at which laws are tried: the best, and others hardly worse."""
    return [
        row["place"]
        for row in ranking[:MOST_TRIED]
        if row["error"] ** 2 <= NEAR * ranking[0]["error"] ** 2
    ]
