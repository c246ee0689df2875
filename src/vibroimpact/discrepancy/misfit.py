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


def closed_fraction(
    before: float, after: float, floor: float, floor_before: float | None = None
) -> float | None:
    """Return 1 - excess after / excess before; None where the excess before is negligible: then the
    records tell nothing of what is added.

    before, after: distances in dB. floor, floor_before: dB, of the model after and before, the same
    where None.
    """
    given = floor if floor_before is None else floor_before
    first = excess(before, given)
    return None if first <= priors.NO_EXCESS * given else 1.0 - excess(after, floor) / first


def makes_worse(row: dict[str, Any]) -> bool:
    """Return whether the misfit with the completed model is larger than before, and than its floor,
    by more than chance.

    row: {before_dB, after_dB, floor_dB}.
    """
    if row["after_dB"] is None:
        return False
    known = max(row["before_dB"], row["floor_dB"])
    return excess(row["after_dB"], known) > priors.NO_EXCESS * row["floor_dB"]


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
) -> dict[str, float | None]:
    """Return {before_dB, after_dB, floor_dB, closed_fraction} on some records.

    chosen (record, channel, band) bool: cells of all records; before, after (record, seed,
    feature): runs of the model as given and of the completed one. floor_dB is that of the completed
    one; what the model as given is off by counts beyond its own floor.

    The mean of several seeds scatters less than one seed: the distance from measurement to mean is
    corrected to that of two single runs.
    """
    layout, inside = bench.layout, chosen[records]
    measured = layout.power(bench.measured_features)[records]
    away, floors = [], []
    for runs in (before, after):
        power, seeds = layout.power(runs)[records], runs.shape[1]
        floors.append(floor_of(power, inside))
        own = floors[-1] * np.sqrt((1.0 - 1.0 / seeds) / 2.0)
        away.append(float(np.hypot(level_distance(measured - power.mean(axis=1), inside), own)))
    return {
        "before_dB": away[0],
        "after_dB": away[1],
        "floor_dB": floors[1],
        "closed_fraction": closed_fraction(away[0], away[1], floors[1], floors[0]),
    }
