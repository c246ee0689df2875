"""How probable the linear effects are that the lowest record tells of by itself."""

import numpy as np

from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.prepared import Prepared

from . import constants
from .decision import Sets


def linear_sets(prepared: Prepared) -> Sets:
    """Return [(ids, probability)], the most probable first, of the effects that a Prepared adopts
    and those that its lowest record cannot tell from them; empty where it adopts none.

    The lowest record is linear: its log likelihoods are exact, and their differences are odds.
    """
    if prepared.adopted is None:
        return []
    out: dict[tuple[str, ...], float] = {}
    for row in prepared.linear:
        ids = tuple(sorted(candidate_named(row["name"]).ids))
        odds = row["gain"] + np.log(constants.PAIRS) * (len(ids) - 1)
        out[ids] = np.logaddexp(out.get(ids, -np.inf), odds)
    top = max(out.values())
    chances = {ids: np.exp(odds - top) for ids, odds in out.items()}
    total = sum(chances.values())
    rows = [(ids, float(chance / total)) for ids, chance in chances.items()]
    return sorted((row for row in rows if row[1] > 1.0e-3), key=lambda row: -row[1])
