"""The misfit between measurement and simulation, its floor, and the fraction an effect closes.

closed_fraction is the only definition of that fraction.
"""

from typing import Any

import numpy as np

from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.workbench import Workbench

# between seeds of a model, one standard deviation, mean over bands: impacts scatter by 1 to 3 dB
UNSTEADY_DB = 6.0


def repeats(power: np.ndarray) -> np.ndarray:
    """Return (record, channel, 1) bool: whether seeds of a model agree on a channel of a record, of
    power (record, seed, channel, band) in dB; all where none does.

    Motion across the force breaks out in one run of a straight tube and not in another: a channel
    that moves or not by chance tells nothing of how near a model is.
    """
    steady = power.std(axis=1).mean(axis=-1, keepdims=True) < UNSTEADY_DB
    return steady if steady.any() else np.ones_like(steady)


def level_distance(difference: np.ndarray, chosen: np.ndarray) -> float:
    """Return the RMS in dB of differences (record, channel, band) over chosen cells, 0 for none."""
    return float(np.sqrt(np.mean(difference[chosen] ** 2))) if chosen.any() else 0.0


def excess(distance: float, floor: float) -> float:
    """Return the root of the squared distance less the squared floor in dB; 0 below the floor."""
    return float(np.sqrt(max(0.0, distance**2 - floor**2)))


def closed_fraction(before: float, after: float, floor: float) -> float | None:
    """Return 1 - excess after / excess before; None where the excess before is negligible.

    before, after: distances in dB. floor: dB.
    """
    least = priors.NO_EXCESS * floor
    first = excess(before, floor)
    return None if first <= least else 1.0 - excess(after, floor) / first


def makes_worse(row: dict[str, Any]) -> bool:
    """Return whether the misfit with the completed model is larger than before and beyond chance.

    row: {before_dB, after_dB, floor_dB}.
    """
    if row["after_dB"] is None:
        return False
    remaining = excess(row["after_dB"], row["floor_dB"])
    return row["after_dB"] > row["before_dB"] and remaining > priors.NO_EXCESS * row["floor_dB"]


def floor_of(power: np.ndarray, chosen: np.ndarray) -> float:
    """Return the distance in dB between two seeds of a model, RMS over all pairs.

    power (record, seed, channel, band): dB. chosen (record, channel, band) bool.
    """
    total, count = 0.0, 0
    for one in range(power.shape[1]):
        for other in range(one + 1, power.shape[1]):
            total += level_distance(power[:, one] - power[:, other], chosen) ** 2
            count += 1
    return float(np.sqrt(total / max(count, 1)))


def misfit_of(
    bench: Workbench,
    records: np.ndarray,
    chosen: np.ndarray,
    before: np.ndarray,
    after: np.ndarray,
    completed: np.ndarray,
) -> dict[str, float | None]:
    """Return {before_dB, after_dB, floor_dB, closed_fraction} on some records.

    chosen (record, channel, band) bool, before, after (record, feature): cells and means over seeds
    of all records. completed (record, seed, feature): of the completed model. The mean of several
    seeds scatters less than one seed: the distance from measurement to mean is corrected to that of
    two single runs.
    """
    layout = bench.layout
    measured = layout.power(bench.measured_features)[records]
    inside = chosen[records]
    seeds = completed.shape[1]
    floor = floor_of(layout.power(completed)[records], inside)
    own = floor**2 / 2.0 * (1.0 - 1.0 / seeds)
    before_dB, after_dB = (
        float(
            np.hypot(level_distance(measured - layout.power(mean)[records], inside), np.sqrt(own))
        )
        for mean in (before, after)
    )
    return {
        "before_dB": before_dB,
        "after_dB": after_dB,
        "floor_dB": floor,
        "closed_fraction": closed_fraction(before_dB, after_dB, floor),
    }
