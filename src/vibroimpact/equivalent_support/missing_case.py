"""The answer outside the grid of a study: the nearest case, and how to add the one wanted."""

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.config.problems import ConfigError
from vibroimpact.config.yaml_file import read_yaml

from .answer import EquivalentError

MM = 1.0e-3  # m
OTHER_UNIT = 10.0  # times a known gap: no gap of the same structure


def require_metres(gap_m: float, gaps_m: Sequence[float]) -> None:
    """Raise EquivalentError for a gap that is like those of a structure in mm, and far above them
    in m.

    gaps_m: those of the study or of the configuration, m.
    """
    low, high = min(gaps_m) / OTHER_UNIT, max(gaps_m) * OTHER_UNIT
    if gap_m > high and low <= gap_m * MM <= high:
        raise EquivalentError(
            f"the gap is {gap_m:g} m, those of the grid are {min(gaps_m):g} to"
            f" {max(gaps_m):g} m: gaps are in metres, {gap_m:g} mm is {gap_m * MM:g}"
        )


def no_study_sentence(study: str | Path, tables: Sequence[Path]) -> str:
    """Return the sentence for a study that is not there: those there are, or how to make one.

    tables: the paths searched for its tables; the last one below results/.
    """
    places = " nor ".join(map(str, tables))
    sentence = f"'{study}' is no finished study: neither {places} is there. "
    table = tables[-1]
    there = sorted(path.parent.name for path in table.parents[1].glob(f"*/{table.name}"))
    if not there:
        return sentence + (
            "Run `snakemake -j2 --configfile FILE` with an identification, or name another folder"
        )
    meant = get_close_matches(str(study), there, 1)
    return sentence + (
        f"{f'Did you mean {meant[0]}? ' if meant else ''}There are: {', '.join(there)}"
    )


def outside_sentence(
    study: str,
    rows: Sequence[dict[str, Any]],
    load_rms_N: float | None,
    gap_m: float,
    fixed_gap: bool,
) -> str:
    """Return the sentence for a case outside a study: the nearest case, and how to add this one.

    rows: of the study, with gap_m and load_rms_N.
    load_rms_N: N RMS; None if the gap alone is missing.
    fixed_gap: whether the load counts at fixed gap, not load over gap.
    """
    path = configuration_of(study)
    config = path or f"the configuration of study '{study}'"
    run = f"run `snakemake -j2 --configfile {path or 'FILE'}`: only the new cases are simulated"
    if load_rms_N is None:
        return f"Add {gap_m:g} to grid.gap_m in {config} and {run}"
    loads = sorted({float(row["load_rms_N"]) for row in rows})
    if fixed_gap:
        place = (
            f"load {load_rms_N:g} N RMS is outside the loads of study '{study}' at this gap,"
            f" {loads[0]:g} to {loads[-1]:g} N"
        )
        nearest = min(rows, key=lambda row: abs(np.log(row["load_rms_N"] / load_rms_N)))
        wanted = load_rms_N
    else:
        level = load_rms_N / gap_m
        levels = [row["load_rms_N"] / row["gap_m"] for row in rows]
        place = (
            f"load over gap, {load_rms_N:g} N / {gap_m:g} m = {level:.3g} N/m, is outside study"
            f" '{study}', {min(levels):.3g} to {max(levels):.3g} N/m"
        )
        nearest = min(rows, key=lambda row: abs(np.log(row["load_rms_N"] / row["gap_m"] / level)))
        # Any case with this load over gap will do: one load more, at a gap that is there.
        wanted = level * nearest["gap_m"]
    step = 10.0 ** (np.floor(np.log10(wanted)) - 2.0)  # three digits, away from the nearest
    away = np.ceil if wanted > nearest["load_rms_N"] else np.floor
    return (
        f"{place}: nothing is extrapolated. The nearest case is {nearest['load_rms_N']:g} N RMS at"
        f" {nearest['gap_m']:g} m. Add the load {away(wanted / step) * step:g} to"
        f" grid.load_rms_N in {config} (written as a list: the loads there are, and this one) and"
        f" {run}"
    )


def configuration_of(study: str) -> str | None:
    """Return the file, here or in config/, whose `study` is this one; None if there is none."""
    for path in (*sorted(Path("config").glob("*.yaml")), *sorted(Path().glob("*.yaml"))):
        try:
            if read_yaml(path).get("study") == study:
                return str(path)
        except ConfigError:
            continue  # another file's problem
    return None
