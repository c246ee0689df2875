"""A Null of one record whose values are its features, white as long as nothing is told of them."""

from types import SimpleNamespace

import numpy as np

from vibroimpact.missing_effect.null import Null


def white_null(measured, groups=None):
    """Return the Null of a measurement (value,)."""
    values = len(measured)
    return Null(
        records=np.array([0]),
        layout=SimpleNamespace(blend=1.0e9),  # nothing is drawn in
        mean=np.zeros((1, values)),
        features=np.zeros((1, 2, values)),
        seeds_per_draw=1,
        free=np.zeros((1, values, values)),
        factor=np.eye(values)[None],
        measured=measured,
        groups=np.zeros(values, int) if groups is None else groups,
        along=np.zeros((0, values)),
        rescaled=np.zeros((0, 0)),
    )
