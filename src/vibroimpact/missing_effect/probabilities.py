"""How probable every explanation is, with what its runs do not tell."""

import numpy as np
from scipy.special import logsumexp

from vibroimpact.linear_stage.candidates import candidate_named

from . import constants
from .search import Search


def posterior(search: Search) -> dict[str, float]:
    """Return {name: log probability}, the most probable first, of nothing, something else, every
    explanation, and every one of them beside something else (its name with constants.ELSE).
    """
    else_ = search.something_else()
    families: dict[str, list[str]] = {}
    for name in search.fits:
        families.setdefault(ids_of(name), []).append(name)
    pairs = [family for family in families if "+" in family]
    rest = 1.0 - constants.NOTHING - constants.SOMETHING_ELSE
    out = {
        "nothing": np.log(constants.NOTHING),
        "something else": np.log(constants.SOMETHING_ELSE)
        + else_.log_evidence(np.zeros(search.null.values)),
    }
    catalogue = {candidate_named(name).effect_id for name in search.fits if "+" not in name}
    for family, names in families.items():
        share = (
            constants.PAIRS / max(len(catalogue) ** 2 / 2.0, 1.0)
            if family in pairs
            else (1.0 - constants.PAIRS) / max(len(families) - len(pairs), 1)
        )
        for name in names:
            known = np.log(rest * share / len(names))
            found = search.fits[name]
            if family in pairs and found.left >= least_left_alone(search, name):
                continue
            out[name] = known + found.log_evidence
            # none where all runs are farther from the measurement than nothing is; nor beside a
            # pair: that three are missing is not believed, and where a law does not fit, any
            # second effect seems to help
            if found.left >= search.null.measured @ search.null.measured or family in pairs:
                continue
            out[name + constants.ELSE] = (
                known
                + np.log(constants.SOMETHING_ELSE)
                + else_.beside(found, search.emulator(name))
            )
    return averaged(out, {name: found.doubt for name, found in search.fits.items()})


def least_left_alone(search: Search, name: str) -> float:
    """Return the least chi-square that a run of one part of a pair leaves: a pair of which none
    leaves less shows nothing of its second effect.
    """
    pair = candidate_named(name)
    alone = (search.fits.get(part.name) for part in (pair.first, pair.second))
    return min((found.left for found in alone if found is not None), default=np.inf)


DRAWS = 400  # of what emulators do not know
LEAST_CHANCE = 1.0e-300


def averaged(evidence: dict[str, float], doubt: dict[str, float]) -> dict[str, float]:
    """Return {name: log probability}, the most probable first, of {name: log evidence with prior}:
    the mean over draws of what the emulators do not know. doubt {name: standard deviation of a
    log evidence}.

    Two explanations that leave no more than chance differ in evidence by the scatter of their runs:
    the evidence of each would be sure which of them it is.
    """
    names = list(evidence)
    shifts = np.random.default_rng(1).standard_normal((DRAWS, len(doubt)))
    column = {name: shifts[:, number] * doubt[name] for number, name in enumerate(doubt)}
    drawn = np.array([evidence[name] + column.get(name, np.zeros(DRAWS)) for name in names])
    chance = np.exp(drawn - logsumexp(drawn, axis=0)).mean(axis=1)
    rows = zip(names, np.log(np.maximum(chance, LEAST_CHANCE)).tolist(), strict=True)
    return dict(sorted(rows, key=lambda row: -row[1]))


def ids_of(name: str) -> str:
    """Return the ids of an explanation's effects."""
    return "+".join(sorted(candidate_named(name).ids))
