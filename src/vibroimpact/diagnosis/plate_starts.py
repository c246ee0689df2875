"""Start values of a support that gives way: the plate's mass, stiffness and damping by the records.

No sensor sees the motion of a plate, so a model with a wrong one is not held: its basin is a few
percent of its frequency wide. The demanded force f and motion r at a support (see law) give the
plate without a run. In contact,

    sign r = gap + |f| / contact stiffness + sign p,      p = H f / mass,

with H of a plate of unit mass. At each frequency and damping ratio of the plate that is linear.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from scipy import optimize

from .bench import Bench
from .comparison import Comparison
from .explanations import Point, Term
from .law import SEEN, Demand, demand_of, places_of

FREQUENCIES, DAMPING_RATIOS = 100, (0.02, 0.06, 0.15)  # tried
RANGE = (0.3, 30.0)  # of the first frequency of the structure
TOUCHING = 2.0  # of the RMS of a force, from which it is one of contact
LEAST_FORCE = 0.1  # of the largest: its law can be fitted
TOLD = 0.85  # of the residual of a rigid support: a plate must leave less
MOST_MASS = 3.0  # of the modal mass of the structure
AROUND = tuple(product((0.98, 1.0, 1.02), (1.0, 0.5)))  # frequency and damping that were found


def plate_terms(comparison: Comparison, bench: Bench, point: Point) -> list[Term]:
    """Return plate_flexibility of each support whose motion a plate explains better than a rigid
    support, and of all supports with that plate.

    bench: of stretches in contact. Raises ConfigError or ValueError if the Point makes no model.
    """
    model = comparison.structure.model(point)
    if not model.support_names:
        return []
    owners = places_of(model).owners[: 2 * len(model.support_names)]
    demands = [demand_of(comparison, bench, stretch, point) for stretch in bench.stretches]
    first = float(model.frequencies[model.omega > 0.0].min())
    out, alone = [], len(model.support_names) == 1
    for support in model.support_names:
        rows = _told(demands, [at for at, owner in enumerate(owners) if owner == support])
        plate = plate_of(rows, bench.schedule.sampling_frequency, first)
        if plate is None or plate[0] > MOST_MASS * comparison.sizes["mass"]:
            continue
        mass, frequency, ratio = plate
        for moved, damped in AROUND:
            values = (mass * (2.0 * np.pi * moved * frequency) ** 2, mass, damped * ratio)
            places = ["all"] if alone else [support, "all"]
            out += [Term("plate_flexibility", place, values) for place in places]
    return out


def _told(demands: Sequence[Demand], places: Sequence[int]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return [(force (sample,), motion (sample,))] of the places and stretches that are known."""
    largest = max(each.force[place].std() for each in demands for place in places)
    return [
        (each.force[place], each.motion[place])
        for each in demands
        for place in places
        if each.resolution[place] > SEEN and each.force[place].std() > LEAST_FORCE * largest
    ]


def plate_of(
    rows: Sequence[tuple[np.ndarray, np.ndarray]], rate: float, first: float
) -> tuple[float, float, float] | None:
    """Return (mass in kg, frequency in Hz, damping ratio) of a plate under the forces of rows, None
    if a rigid support explains them as well. first: frequency of the structure, Hz.
    """
    if not rows:
        return None

    def left(at):
        return _left(rows, rate, *np.exp(at))[0]

    grid = np.log(first * np.geomspace(*RANGE, FREQUENCIES))
    starts = [(own, np.log(ratio)) for own in grid for ratio in DAMPING_RATIOS]
    found = optimize.minimize(
        left, min(starts, key=left), method="Nelder-Mead", options={"xatol": 1.0e-3}
    )
    frequency, ratio = np.exp(found.x)
    if found.fun > TOLD * _left(rows, rate, np.inf, 0.0)[0]:
        return None
    return (
        1.0 / _left(rows, rate, frequency, ratio)[1],
        frequency,
        float(np.clip(ratio, 0.01, 0.29)),
    )


def _left(rows, rate, frequency, ratio):
    """Return (RMS in m of the residual motion in contact with a plate, one over its mass)."""
    matrix, motion = [], []
    for number, (force, moved) in enumerate(rows):
        touching = np.abs(force) > TOUCHING * force.std()
        sign, column = -np.sign(force[touching]), np.zeros((touching.sum(), len(rows) + 2))
        column[:, number] = 1.0
        column[:, -2] = np.abs(force[touching])
        if np.isfinite(frequency):
            column[:, -1] = sign * _displacement(force, rate, frequency, ratio)[touching]
        matrix.append(column)
        motion.append(sign * moved[touching])
    matrix, motion = np.vstack(matrix), np.concatenate(motion)
    fitted = np.linalg.lstsq(matrix, motion, rcond=None)[0]
    if np.isfinite(frequency) and fitted[-1] <= 0.0:
        return np.inf, 0.0
    return float(np.std(motion - matrix @ fitted)), float(fitted[-1])


def _displacement(force, rate, frequency, ratio):
    """Return (sample,) m: of a plate of 1 kg under the reaction of a force (sample,)."""
    own = 2.0 * np.pi * frequency
    omega = 2.0 * np.pi * np.fft.rfftfreq(2 * len(force), 1.0 / rate)
    receptance = 1.0 / (own**2 - omega**2 + 2j * ratio * own * omega)
    lines = np.fft.rfft(-force, 2 * len(force)) * receptance
    return np.fft.irfft(lines, 2 * len(force))[: len(force)]
