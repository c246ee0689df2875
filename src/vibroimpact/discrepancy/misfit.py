"""The misfit between measurement and simulation, its floor, and how much of it an effect closes.

There is one definition of the closed share, and one place where it is worked out: closed_fraction.
"""

import numpy as np

from vibroimpact.observation.strain import STRAIN
from vibroimpact.units import TIME_DERIVATIVES

from . import priors

ABOVE_NOISE_DB = 6.0
# A channel answers to motion across its direction too, by 1 % at best (transverse sensitivity, ISO
# 16063-31): what is farther below the strongest channel is not known to be what it should measure.
BELOW_STRONGEST_DB = 40.0


def counted(bench):
    """Return (record, channel, band) bool: where the measurement is 6 dB above the noise, and no
    farther than 40 dB below the strongest channel of its record and band, all as displacements;
    strains beside strains.
    """
    layout, signals = bench.layout, bench.signals
    power = layout.power(bench.measured_features)
    width = np.diff(layout.edges)
    noise = 10.0 * np.log10(
        np.maximum(signals.noise[:, None] ** 2 * width / (0.5 * layout.rate), 1.0e-300)
    )
    middle = np.pi * (layout.edges[1:] + layout.edges[:-1])  # rad/s
    derivatives = np.array([TIME_DERIVATIVES.get(kind, 0) for kind in signals.kinds])
    moved = power - 20.0 * derivatives[:, None] * np.log10(middle)
    strong = np.ones(power.shape, bool)
    for family in (list(TIME_DERIVATIVES), [STRAIN]):
        own = np.isin(signals.kinds, family)[:, None]
        strongest = np.max(moved, axis=1, keepdims=True, where=own, initial=-np.inf)
        strong &= ~own | (moved > strongest - BELOW_STRONGEST_DB)
    return (power > noise + ABOVE_NOISE_DB) & strong


def level_distance(difference, chosen):
    """Return the RMS in dB of (record, channel, band) over the chosen; 0 where none is."""
    return float(np.sqrt(np.mean(difference[chosen] ** 2))) if chosen.any() else 0.0


def excess(distance, floor):
    """Return what a distance in dB has beyond its floor."""
    return float(np.sqrt(max(0.0, distance**2 - floor**2)))


def closed_fraction(before, after, floor):
    """Return 1 - excess after / excess before; None where there was next to nothing before."""
    least = priors.NO_EXCESS * floor
    first = excess(before, floor)
    return None if first <= least else 1.0 - excess(after, floor) / first


def makes_worse(row):
    """Return whether a completed model makes a misfit grow, {before_dB, after_dB, floor_dB}: what
    is left is more than before and beyond chance.
    """
    if row["after_dB"] is None:
        return False
    left = excess(row["after_dB"], row["floor_dB"])
    return row["after_dB"] > row["before_dB"] and left > priors.NO_EXCESS * row["floor_dB"]


def floor_of(power, chosen):
    """Return the distance in dB between two seeds of a model, RMS over all pairs: power (record,
    seed, channel, band).
    """
    total, count = 0.0, 0
    for one in range(power.shape[1]):
        for other in range(one + 1, power.shape[1]):
            total += level_distance(power[:, one] - power[:, other], chosen) ** 2
            count += 1
    return float(np.sqrt(total / max(count, 1)))


def misfit_of(bench, records, chosen, before, after, completed):
    """Return {before_dB, after_dB, floor_dB, closed_fraction} on some records.

    before, after: (record, feature) means of all records; completed: (record, seed, feature) of the
    completed model. As the mean of several seeds scatters less than one seed, the distance of
    measurement to mean is brought to that of two single runs.
    """
    layout = bench.layout
    measured = layout.power(bench.measured_features)[records]
    inside = chosen[records]
    seeds = completed.shape[1]
    floor = floor_of(layout.power(completed)[records], inside)
    own = floor**2 / 2.0 * (1.0 - 1.0 / seeds)
    distances = [
        float(
            np.hypot(level_distance(measured - layout.power(mean)[records], inside), np.sqrt(own))
        )
        for mean in (before, after)
    ]
    return {
        "before_dB": distances[0],
        "after_dB": distances[1],
        "floor_dB": floor,
        "closed_fraction": closed_fraction(*distances, floor),
    }
