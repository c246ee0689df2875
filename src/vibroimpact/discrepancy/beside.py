"""What completes the model, searched again with the nuisances that a lowest record which something bends tells beside it."""

from dataclasses import replace

import numpy as np
from scipy import linalg

from vibroimpact.discrepancy import nuisance as linear
from vibroimpact.discrepancy.features import compressed
from vibroimpact.discrepancy.finalists import own, refine
from vibroimpact.discrepancy.likelihood import with_law
from vibroimpact.discrepancy.naming import fit_mask

ROUNDS = 3  # of the search that begins anew, where it was found


def told_by(bench, null, measured, found):
    """Return the Nuisance that the lowest record tells beside a Finalist: the most probable along its directions (see nuisance_directions), limited, on top of those of the
    bare model; None where it has none.

    null: the Null; measured (record, feature).
    """
    modes, channels = bench.measured_fit.modes if len(found.free) > 1 else (), len(bench.signals.names)
    if not len(modes):
        return None
    lowest = list(null.records).index(bench.signals.lowest)
    change, residual = (compressed((one - other)[lowest], bench.layout) for one, other in ((found.mean, null.mean), (measured, found.mean)))
    solved = linalg.solve(with_law(found.own(null).covariance[lowest], change, null.groups), residual, assume_a="pos")
    pulls = found.free[1:, lowest] @ solved
    more = linear.nuisance_of(np.array([*pulls[: 2 * len(modes)], *pulls[-channels:]]), modes, channels)  # to first order
    known = bench.nuisance
    return replace(more, frequency=known.frequency * more.frequency, damping=known.damping * more.damping, gain=known.gain * more.gain)


def refined_beside(bench, null, measured, found, scales, first_seed=30000):
    """Return (Finalist, Nuisance) of one searched again with the nuisances beside it, in all records; (the one found, None) where none are told, or where it explains more.

    What nuisances cost by their priors is taken off what they explain. Arguments as of finalists.refine.
    """
    told = told_by(bench, null, measured, found)
    if told is None:
        return found, None
    there, fit = bench.corrected_by(told), fit_mask(bench, null)
    path = own(there, null, measured, found.candidate, found.path, found.unit, scales, fit, first_seed)
    other = None if path is None else refine(there, null, measured, found.candidate, path, scales, fit, ROUNDS, first_seed=first_seed + 1000)
    if other is None or other.total - linear.cost(told) + linear.cost(bench.nuisance) < found.total:
        return found, None
    return replace(other, parts=found.parts), told
