"""The records that a linear model explains: held little, they show its modes best.

A strong damper answers the noise of all sensors in every channel, and its force is as large at a
resonance as beside it. With weak dampers the residual is that of the measured motion, which shows
frequencies, damping and the direction of the force far better, once the model is near. A model that
lacks something at the lowest load needs the strong ones.
"""

from dataclasses import replace

import numpy as np

from .bench import holding_lines, mean_log_power, touches
from .comparison import Comparison
from .constants import EXPLAINED
from .explanations import Point
from .floor import played_stretches
from .gauss_newton import fit

PASSES = 3


def with_linear_records(comparison: Comparison) -> Comparison:
    """Return the Comparison that holds the records at the lowest load little, if the model as given
    touches no support there and, with fitted nuisances, leaves little but noise.
    """
    bench = comparison.lowest()
    if touches(bench).any():
        return comparison
    found = fit(bench, Point(), comparison.nuisances(), PASSES)
    stretches = played_stretches(comparison, bench, found.point, np.random.default_rng(1))
    if stretches is None:
        return comparison
    [noise] = holding_lines(replace(bench, stretches=stretches), [found.point])
    if mean_log_power(bench, found.lines) - mean_log_power(bench, noise) > EXPLAINED:
        return comparison
    return comparison.with_linear(each.record for each in bench.stretches)
