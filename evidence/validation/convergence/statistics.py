"""Response statistics against the step and the number of modes, with their scatter over seeds.

Impacting motion is chaotic, so means over seeds are compared. Each seed has the same force at every
value of an axis. The difference from the finest value is taken seed by seed, and its standard error
from the scatter of these differences. This is right whether or not the common force makes the two
records alike.
"""

import numpy as np

from evidence.validation.check import Check

from .rate import fitted_order

STUDY_VALUES = {"step": 51200, "step_exact": 20480, "modes": 7500.0}  # paper, default, both
PARENTS = {"step_exact": "step", "modes_alone": "modes"}  # axis -> axis of its reference value
STANDARD_ERRORS = 4.0  # exceeded by 1 of 800 comparisons of equal means, with 16 seeds
# Relative scatter between records above which a statistic is not compared, such as that of in-plane
# motion at its onset.
LARGEST_SCATTER = 0.5
ENERGY = "potential_energy_residual"
ENERGY_ORDER, ENERGY_ORDER_TOLERANCE = 2.0, 0.1
UNITS = {
    "step": "steps per second",
    "step_exact": "steps per second, exact modal step",
    "modes": "Hz",
}
SOURCE = {
    "step": "runs at 1/204800 s",
    "step_exact": "runs at 1/204800 s, Newmark",
    "modes": "runs with free modes to 12 kHz",
}
KEYS = ("axis", "value", "load_rms_N", "seed", "modes")


def statistics_rows(rows):
    """Return one row per axis, value, load and statistic, from the rows of `run_rows`.

    Row keys: axis, value, load_rms_N, statistic, seeds, mean, scatter (standard deviation of one
    record), difference (of the mean, from the finest value of the axis or of its PARENTS),
    standard_error (of the difference). scatter, difference and standard_error are relative to the
    mean, but for names ending in _dB in dB. NaN for the finest value.
    """
    names = [name for name in rows[0] if name not in KEYS]
    table = []
    for axis, value, load in dict.fromkeys(
        (row["axis"], row["value"], row["load_rms_N"]) for row in rows
    ):
        parent = PARENTS.get(axis, axis)
        finest = max(row["value"] for row in rows if row["axis"] == parent)
        for name in names:
            own = seeds_of(rows, axis, value, load, name)
            reference = seeds_of(rows, parent, finest, load, name)
            scale = 1.0 if name.endswith("_dB") else reference.mean()
            change = (own - reference) / scale
            same = (axis, value) == (parent, finest)
            table.append(
                {
                    "axis": axis,
                    "value": value,
                    "load_rms_N": load,
                    "statistic": name,
                    "seeds": own.size,
                    "mean": own.mean(),
                    "scatter": own.std(ddof=1) / scale,
                    "difference": np.nan if same else change.mean(),
                    "standard_error": np.nan if same else change.std(ddof=1) / np.sqrt(change.size),
                }
            )
    return table


def seeds_of(rows, axis, value, load, name):
    """Return (seed,) the values of a statistic, in the order of the seeds."""
    own = [
        row for row in rows if (row["axis"], row["value"], row["load_rms_N"]) == (axis, value, load)
    ]
    return np.array([row[name] for row in sorted(own, key=lambda row: row["seed"])], dtype=float)


def statistics_checks(table):
    """Return the Checks of the study's step and modes against the finest.

    They pass within STANDARD_ERRORS of the difference, which means that no difference is seen. The
    standard error in the table is how small a difference would have been seen.
    """
    checks = []
    for row in table:
        if (
            row["value"] != STUDY_VALUES.get(row["axis"])
            or row["statistic"] == ENERGY
            or (row["scatter"] > LARGEST_SCATTER and not _in_dB(row))
        ):
            continue
        reference = next(
            other["mean"]
            for other in table
            if other["axis"] == PARENTS.get(row["axis"], row["axis"])
            and np.isnan(other["difference"])
            and (other["load_rms_N"], other["statistic"]) == (row["load_rms_N"], row["statistic"])
        )
        unit = "dB" if _in_dB(row) else "SI"
        name = (
            f"{row['statistic']}, {row['load_rms_N']:g} N, at {row['value']:g} {UNITS[row['axis']]}"
        )
        checks.append(
            Check(
                f"convergence: {row['axis']}",
                name,
                unit,
                reference,
                SOURCE[row["axis"]],
                row["mean"],
                float(STANDARD_ERRORS * row["standard_error"]),
                1.0 if _in_dB(row) else None,
            )
        )
    return checks


def energy_checks(table):
    """Return the Checks of the order of the energy residual of impacts in the step, per load."""
    checks = []
    for load in dict.fromkeys(row["load_rms_N"] for row in table):
        own = [
            row
            for row in table
            if (row["axis"], row["statistic"], row["load_rms_N"]) == ("step", ENERGY, load)
        ]
        if own:
            order = fitted_order([1.0 / row["value"] for row in own], [row["mean"] for row in own])
            checks.append(
                Check(
                    "convergence: step",
                    f"order of the energy balance of the impacts, {load:g} N",
                    "1",
                    ENERGY_ORDER,
                    "trapezoidal contact work against the potential: error dt² at each crossing of"
                    " the gap",
                    order,
                    ENERGY_ORDER_TOLERANCE,
                    1.0,
                )
            )
    return checks


def _in_dB(row):
    """Return True when the statistic is a level."""
    return row["statistic"].endswith("_dB")
