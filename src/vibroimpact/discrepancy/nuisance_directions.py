"""What nuisances change of a lowest record that something bends, left free in its likelihood.

The modes of such a record tell nuisances to no model that does not bend alike, and even to one that
does only by a fit that jumps with its parameters: 0.3 % of a frequency moves the peaks of a tube on
a hardening spring by as much as 20 % of the spring. So every nuisance is one direction in the space
of features, one sigma of its prior long, which the covariance holds (linear marginalisation; C.E.
Rasmussen, C.K.I. Williams, Gaussian Processes, 2006, section 2.7).
"""

from dataclasses import replace

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

from . import priors
from .features import compressed
from .law_directions import law_directions
from .screening import direct_scores

SIGMAS = (("frequency", priors.FREQUENCY_SD), ("damping", priors.DAMPING_SD))


def nuisance_directions(bench, values, records, first_seed, measuring=None):
    """Return (direction, record, compressed feature): what one sigma of the frequency of each mode
    of the lowest record and of their dampings changes to first order, then to second, and of each
    channel's gain; none where nothing bends that record, or where a model of such values (of a
    configuration) is thrown off there.

    Modes change the lowest record alone: in those with impacts two runs differ by more. All runs
    have one seed, and one noise. A resonance that jumps between two branches changes as much to
    second order as to first.
    """
    layout, nothing = bench.layout, np.zeros((0, len(records), len(bench.layout.kind)))
    if not bench.nonlinear_low or bench.signals.lowest not in records:
        return nothing
    lowest = list(records).index(bench.signals.lowest)
    runs = bench.runs([bench.signals.lowest], 1, first_seed)
    start = bench.nuisance
    told = [
        replace(
            start,
            **{name: getattr(start, name) * np.exp(side * (np.arange(len(start.modes)) == mode))},
        )
        for name, sigma in SIGMAS
        for mode in range(len(start.modes))
        for side in (sigma, -sigma)
    ]
    try:
        here, *sides = (
            there.features(there.model(values), runs, measuring)[0]
            for there in map(bench.corrected_by, (start, *told))
        )
    except IntegrationError:
        return nothing
    more, less = (compressed(np.array(sides[first::2]) - here, layout) for first in (0, 1))
    modes = np.zeros((2 * len(more), *nothing.shape[1:]))
    modes[:, lowest] = np.concatenate([0.5 * (more - less), 0.5 * (more + less)])
    gained = 20.0 * np.log10(1.0 + priors.GAIN_SD) * (layout.kind == "power")
    gains = [
        np.tile(np.where(layout.channel == channel, gained, 0.0), (len(records), 1))
        for channel in range(len(bench.signals.names))
    ]
    return np.concatenate([modes, gains]) if np.isfinite(modes).all() else nothing


def unknowns_free(bench, null, measured, found, scales, first_seed=35000):
    """Return a Finalist judged with its nuisance_directions and law_directions free, as it is where
    it was given up or has none.

    It is only judged so: in a search, directions of a point far from the answer forgive what is not
    theirs. bench: with the nuisances of the bare model.
    """
    if not len(found.free):
        return found
    there = bench.corrected_by(found.nuisance)
    physical = found.candidate.physical(found.unit, scales)
    modes = nuisance_directions(
        there,
        bench.variant(found.candidate, physical),
        null.records,
        first_seed,
        found.candidate.measuring(physical, bench.signals.names),
    )
    directions = np.concatenate(
        [modes, law_directions(there, found.candidate, physical, null.records, first_seed)]
    )
    if not len(directions):
        return found
    found = replace(found, free=np.concatenate([found.free, directions]))
    return replace(found, scores=direct_scores(bench, found.own(null), measured, found.mean))
