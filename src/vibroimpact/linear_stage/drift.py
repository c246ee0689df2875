"""Check of the lowest record for drift: shifts of its modes from its first half to its last."""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, stats

from vibroimpact.observation.linear_record import DISCARDED, LinearRecord
from vibroimpact.observation.sensor_chain import Measuring

from .mode_identification import fit_modes
from .nearest_model import at_modes
from .workbench import Workbench

LEAST = 1.0e-4  # of a frequency, one sigma: scatter of the fit of a half besides that by noise


@dataclass(frozen=True)
class Drift:
    """Shifts of the modes of a record from its first to its last half.

    frequency_Hz (mode,). change (mode,): of ln frequency. sd (mode,): its standard deviation.
    p: probability of as large changes by chance, all modes together.
    """

    frequency_Hz: np.ndarray
    change: np.ndarray
    sd: np.ndarray
    p: float


def drift_of(bench: Workbench) -> Drift:
    """Return the Drift of a Workbench's lowest record."""
    fit, signals, lowest = bench.measured_fit, bench.signals, bench.signals.lowest
    force, responses = (bench.valid(series[lowest]) for series in (signals.force, signals.response))
    late = Measuring(np.ones(len(fit.delay)), -fit.delay)
    base = None if signals.base is None else bench.valid(signals.base[lowest])
    # the delay is one of the absolute motion
    responses = responses if base is None else responses + base
    responses = late.delayed(responses, signals.rate)
    responses = responses if base is None else responses - base
    # start from the modes of the whole record, from which those of the halves differ little
    there = at_modes(bench.bare, fit)
    middle = force.shape[-1] // 2
    start = 0.0 if signals.from_rest else 2.0 * DISCARDED
    halves = []
    for end, begin in ((middle, start), (force.shape[-1], 0.5)):
        record = LinearRecord(
            force[..., :end],
            signals.rate,
            signals.band_Hz,
            signals.from_rest,
            begin,
            None if base is None else base[:, :end],
        )
        found = fit_modes(
            record,
            responses[:, :end],
            there,
            signals.kinds,
            signals.noise_in_band,
            fit.modes,
            search=False,
        )
        assert found is not None, "the modes to fit are given"
        halves.append(found)
    count = len(fit.modes)
    covariance = sum(half.covariance[:count, :count] for half in halves)
    covariance = covariance + LEAST**2 * np.eye(count)
    change = halves[1].log_frequency - halves[0].log_frequency
    chi_square = float(change @ linalg.solve(covariance, change, assume_a="pos"))
    return Drift(
        there.frequencies[fit.modes],
        change,
        np.sqrt(np.diag(covariance)),
        float(stats.chi2.sf(chi_square, count)),
    )
