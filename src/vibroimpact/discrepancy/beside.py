"""Nuisances beside a candidate: a lowest record that is not that of a linear structure tells of
modes and gains only once what bends it is in the model.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.config.reading import ConfigError
from vibroimpact.integration.contact_convergence import IntegrationError

from . import nuisance as linear
from . import priors
from .finalists import own, refine, with_parts
from .neighbourhood import around

# from no nuisances to those that the record tells: with them, what bends it acts a little otherwise
STEPS = 2
FAR = 25.0  # times a credible chi-square: farther off, nuisances are not why
ROUNDS = 3  # of the search that begins anew, where it was found
TURNS = 2  # nuisances and parameters in turn
CLOSER = (0.12, 0.06)  # of the searched range: looked at round the nearest of a design
MOVED = 0.5  # sigma of the prior: nuisances that move less leave the candidate as it is


def nuisance_beside(bench, candidate, physical):
    """Return the Nuisance that the lowest record tells beside a candidate of parameters {name:
    value}, None where its modes tell none.

    Measurement and simulation are fitted by the same modes: what the candidate does to the fit, it
    does to both.
    """
    fit = bench.measured_fit
    nuisance = linear.neutral(bench.measured_fit.modes, len(bench.signals.names))
    for _ in range(STEPS):
        reading = _reading(bench.corrected_by(nuisance), candidate, physical)
        if reading is None or not linear.credible(
            bench.measured_reading, reading, fit.covariance, FAR
        ):
            return None
        pulls = linear.likelihood(bench.measured_reading, reading, fit.covariance)[2]
        nuisance = linear.nuisance_of(pulls, fit.modes, len(bench.signals.names))
    return nuisance if linear.credible(bench.measured_reading, reading, fit.covariance) else None


def _reading(bench, candidate, physical):
    """Return the Reading of the lowest record with a candidate, nuisances taken out, None where it
    changes nothing, is thrown off, or is none that a model may have.
    """
    try:
        response = bench.respond(
            bench.model(bench.variant(candidate, physical)),
            bench.runs([bench.signals.lowest], 1),
            candidate.measuring(physical, bench.signals.names),
        )[0]
    except (IntegrationError, ConfigError):
        return None
    return (
        None
        if np.isnan(response).any()
        else bench.low_reading(response / bench.gains[:, None].astype(np.float32))
    )


def begun_beside(
    bench, null, measured, candidate, path, scales, fit, least, seeds, first_seed=40000
):
    """Return the Finalist searched from where a candidate brings the lowest record nearest to what
    was measured, with the nuisances told there, None where none are.

    Without them an effect that bends that record is searched where it hides what modes 0.3 % off
    leave: a drag of 33 was looked for from 110 on, and given up. Arguments as of finalists.refine,
    bench with the nuisances of the bare model.
    """
    unit = nearest_lowest(bench, candidate, scales)
    told = (
        None
        if unit is None
        else nuisance_beside(bench, candidate, candidate.physical(unit, scales))
    )
    if told is None:
        return None
    there = bench.corrected_by(told)
    path = own(there, null, measured, candidate, path, unit, scales, fit, first_seed)
    found = (
        None
        if path is None
        else refine(
            there,
            null,
            measured,
            candidate,
            path,
            scales,
            fit,
            least=least,
            seeds=seeds,
            first_seed=first_seed + 1000,
        )
    )
    return None if found is None else charged(found, told, bench.nuisance)


def nearest_lowest(bench, candidate, scales):
    """Return (parameter,) normalised where the Reading of the lowest record comes nearest to the
    measured one, None where no point of a candidate's design gives one.
    """
    there = bench.corrected_by(linear.neutral(bench.measured_fit.modes, len(bench.signals.names)))
    known = {}
    points = candidate.design()
    for step in (*CLOSER, None):
        for unit in map(tuple, np.round(points, 6)):
            if unit not in known:
                reading = _reading(there, candidate, candidate.physical(np.array(unit), scales))
                known[unit] = (
                    np.inf
                    if reading is None
                    else linear.likelihood(
                        bench.measured_reading, reading, bench.measured_fit.covariance
                    )[1]
                )
        best = np.array(min(known, key=known.get))
        points = [] if step is None else around(best, step, candidate.periodic)
    return best if np.isfinite(min(known.values())) else None


def charged(found, nuisance, bare):
    """Return the Finalist of runs with a Nuisance, for what that costs beyond the bare model's."""
    return replace(
        found, nuisance=nuisance, low=found.low - linear.cost(nuisance) + linear.cost(bare)
    )


def with_parts_beside(bench, null, measured, found, scales):
    """Return finalists.with_parts of a Finalist with the nuisances beside it, its parts charged as
    it is; bench: with those of the bare model.
    """
    found = with_parts(bench.corrected_by(found.nuisance), null, measured, found, scales)
    return (
        found
        if found.nuisance is None
        else replace(
            found, parts=found.parts - linear.cost(found.nuisance) + linear.cost(bench.nuisance)
        )
    )


def refined_beside(bench, null, measured, found, scales, fit, least, seeds, first_seed=30000):
    """Return the Finalist searched again with the nuisances beside it, as often as they move; the
    one found where none are told, or where it explains less.

    bench: with the nuisances of the bare model; other arguments as of finalists.refine.
    """
    for turn in range(TURNS):
        told = nuisance_beside(bench, found.candidate, found.candidate.physical(found.unit, scales))
        if told is None or not moved(told, found.nuisance or bench.nuisance):
            break
        there = bench.corrected_by(told)
        path = own(
            there,
            null,
            measured,
            found.candidate,
            found.path,
            found.unit,
            scales,
            fit,
            first_seed + 5000 * turn,
        )
        other = (
            None
            if path is None
            else refine(
                there,
                null,
                measured,
                found.candidate,
                path,
                scales,
                fit,
                ROUNDS,
                least,
                seeds,
                first_seed + 5000 * turn + 1000,
            )
        )
        other = None if other is None else charged(other, told, bench.nuisance)
        if other is None or other.total < found.total:
            break
        found = other
    return found


def moved(nuisance, before):
    """Return whether a Nuisance differs from another by more than MOVED in any of its
    corrections.
    """
    steps = [
        (np.log(nuisance.frequency / before.frequency), priors.FREQUENCY_SD),
        (np.log(nuisance.damping / before.damping), priors.DAMPING_SD),
        (nuisance.gain - before.gain, priors.GAIN_SD),
    ]
    return any(np.abs(step).max(initial=0.0) > MOVED * sigma for step, sigma in steps)
