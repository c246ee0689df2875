"""Table of all linear effects, and of the best two at once, fitted to the lowest record: how much
each explains, and whether it may be named.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.force_kinds import FORCE, base_channels

from . import priors
from .candidates import Candidate, candidate_named, linear_candidates
from .effect_fit import LinearChanges, LinearResult, fitted
from .effect_pairs import Begun, best_pairs
from .effect_places import placed
from .effect_readings import LinearTable, calibrate, table_of
from .workbench import Workbench

# so many of the best effects are fitted with the model itself: by interpolation in a table, a
# stinger was 8 % off
FITTED = 3


def linear_rows(
    bench: Workbench,
    sizes: dict[str, float],
    tables: dict[str, LinearTable],
    begun: Begun = (),
    pairs: bool = True,
) -> list[dict[str, Any]]:
    """Return [{name, unit, gain, interval}] of every linear candidate on the lowest record of a
    Workbench, best first, and of two of them at once where one does not suffice.

    sizes: see Candidate.physical; tables are extended; begun: see best_pairs; pairs: whether two at
    once are tried.
    """
    found: list[LinearResult[Candidate]] = []
    changes = LinearChanges(bench)
    for candidate in linear_candidates(
        bench.values, bench.signals.names, held(bench.campaign), bench.measured_fit.modes
    ):
        if candidate.effect_id == "sensor_delay":
            continue
        known = tables.get(candidate.name)
        if not candidate.effect.measured and not (known and known.serves(bench)):
            tables[candidate.name] = table_of(bench, candidate, sizes, changes)
        found.append(calibrate(bench, candidate, sizes, tables.get(candidate.name)))
    between = placed(bench, changes, found, sizes, tables)
    found += [] if between is None else [between]
    found.sort(key=lambda row: -row.gain)
    found[:FITTED] = [
        (
            row
            if row.candidate.effect.measured
            else fitted(bench, changes, row.candidate, row.unit, sizes) or row
        )
        for row in found[:FITTED]
    ]
    rows = sorted(map(plain_row, found), key=lambda row: -row["gain"])
    single = rows[0]
    if pairs and nameable(single, sizes):
        for row in map(plain_row, best_pairs(bench, changes, rows, sizes, tables, begun)):
            if nameable(row, sizes) and row["gain"] > single[
                "gain"
            ] + priors.LINEAR_SECOND + priors.PARAMETER_COST * (
                len(row["unit"]) - len(single["unit"]) - 1
            ):
                rows.append(row)
    return sorted(rows, key=lambda row: -row["gain"])


def plain_row(result: LinearResult) -> dict[str, Any]:
    """Return {name, unit, gain, interval} of a LinearResult, in plain values."""
    return {
        "name": result.candidate.name,
        "unit": result.unit.tolist(),
        "gain": result.gain,
        "interval": result.interval.tolist(),
    }


def nameable(row: dict[str, Any], sizes: dict[str, float]) -> bool:
    """Return whether a linear effect, or two (a row of linear_rows), explain enough to be named and
    lie beyond what the priors of nuisances allow.
    """
    return row["gain"] > priors.LINEAR_GAIN + priors.PARAMETER_COST * (
        len(row["unit"]) - 1
    ) and beyond_prior(row, sizes)


def beyond_prior(row: dict[str, Any], sizes: dict[str, float]) -> bool:
    """Return whether the effects of a row that are also nuisances lie, with their whole interval,
    outside what their priors allow.
    """
    candidate, interval = candidate_named(row["name"]), np.atleast_2d(row["interval"])
    sides = zip(candidate.parts(interval[:, 0]), candidate.parts(interval[:, 1]), strict=True)
    return all(_beyond(part, (low, high), sizes) for (part, low), (_, high) in sides)


def _beyond(candidate, ends, sizes):
    """Return whether a Candidate between two ends (parameter,) is no nuisance or lies outside what
    its prior allows.
    """
    sd = {
        "mode_frequency_error": priors.FREQUENCY_SD,
        "modal_damping": priors.DAMPING_SD,
        "sensor_gain": priors.GAIN_SD,
    }.get(candidate.effect_id)
    if sd is None:
        return True
    (parameter,) = candidate.effect.parameters
    logs = [np.log(candidate.physical(end, sizes)[parameter.name]) for end in ends]
    return logs[0] > priors.NAMED_BEYOND * sd or logs[1] < -priors.NAMED_BEYOND * sd


def nearest_linear(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Return the names of the best FITTED single effects of the model in rows of linear_rows, one
    of each id.
    """
    best: dict[str, str] = {}
    for row in rows:
        candidate = candidate_named(row["name"])
        if (
            isinstance(candidate, Candidate)
            and not candidate.effect.measured
            and row["gain"] > priors.LINEAR_GAIN
        ):
            best.setdefault(candidate.effect_id, row["name"])
    return list(best.values())[:FITTED]


def held(campaign: xr.Dataset) -> list[str]:
    """Return the names of what a campaign contains beyond responses: a force at a point of the
    structure, and the voltage of the shaker.
    """
    forces = [] if base_channels(campaign).any() else [FORCE]
    return [*forces, *(name for name in ("voltage",) if name in campaign)]
