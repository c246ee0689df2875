"""The tables of a study as the answer needs them: by method, and recommended."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.records import RecordError, read_table
from vibroimpact.study.method_agreement import AGREEMENT, COMPARED

from .answer import EquivalentError

SUMMARY, RECOMMENDED = "consistency_summary.csv", "equivalent.csv"
NO_DAMPING = ("ods",)  # compared methods that say nothing about c
FEWEST_METHODS = {"k": 2, "c": 1}  # that must resolve a value


def summary_rows_of(folder: Path, direction: str) -> list[dict[str, Any]]:
    """Return the rows of consistency_summary.csv: per gap, load, group, direction and method.

    direction: that of the force, for a table without the column. A table without `group` holds one
    group, "all"; its one verdict is that on k.

    Raises EquivalentError where the folder holds no such table, or it has no rows.
    """
    path = folder / SUMMARY
    try:
        rows = read_table(path)
    except RecordError as error:
        raise EquivalentError(
            f"{path}: is not there: name a finished study with identification, as in"
            " `vibroimpact equivalent gv_local`, or its folder"
        ) from error
    if not rows:
        raise EquivalentError(f"{path}: has no rows: the study identified nothing")
    return [_one_schema(row, direction) for row in rows]


def _one_schema(row: dict[str, Any], direction: str) -> dict[str, Any]:
    """Return a row with group, direction, verdict_k, verdict_c and reason."""
    reason = row.get("reason", "")
    return {
        **row,
        "group": str(row.get("group", "all")),
        "direction": str(row.get("direction", direction)),
        "verdict_k": str(row.get("verdict_k", row.get("verdict", ""))),
        "verdict_c": str(row.get("verdict_c", "")),
        "reason": reason if isinstance(reason, str) else "",
    }


def recommended_rows_of(
    folder: Path, summary: Sequence[dict[str, Any]], direction: str
) -> list[dict[str, Any]]:
    """Return the recommended rows: per gap, load, group and direction.

    Columns: gap_m, load_rms_N, group, direction, and of k and of c: value (k, c), low and high
    (k_low, ...), secant (secant_k, secant_c), agreement and reason (agreement_k, reason_k, ...).
    They are those of equivalent.csv where the study has it. Otherwise the value is the median of
    the medians of the compared methods and the interval their hull, where enough of them resolve
    it: two for k, one for c.
    """
    path = folder / RECOMMENDED
    if path.is_file():
        return [_from_table(row, direction) for row in read_table(path)]
    points: dict[tuple, dict[str, dict[str, Any]]] = {}
    for row in summary:
        key = (row["gap_m"], row["load_rms_N"], row["group"], row["direction"])
        points.setdefault(key, {})[row["method"]] = row
    return [_recommended(key, methods) for key, methods in points.items()]


def _from_table(row: dict[str, Any], direction: str) -> dict[str, Any]:
    """Return a row of equivalent.csv under the names of recommended_rows_of."""
    place = _one_schema(row, direction)
    values: dict[str, Any] = {
        name: place[name] for name in ("gap_m", "load_rms_N", "group", "direction")
    }
    for name, unit in (("k", "N_per_m"), ("c", "N_s_per_m")):
        reason = row.get(f"reason_{name}", "")
        values |= {
            name: float(row[f"{name}_{unit}"]),
            f"{name}_low": float(row[f"{name}_low"]),
            f"{name}_high": float(row[f"{name}_high"]),
            f"secant_{name}": _float(row.get(f"secant_{name}_{unit}", np.nan)),
            f"agreement_{name}": str(row.get(f"agreement_{name}", "")),
            f"reason_{name}": reason if isinstance(reason, str) else "",
        }
    return values


def _float(value: Any) -> float:
    """Return a cell as a number, NaN for an empty one."""
    return float(value) if value != "" else np.nan


def _recommended(key: tuple, methods: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """Return the recommended row of one gap, load, group and direction from its methods."""
    values: dict[str, Any] = dict(
        zip(("gap_m", "load_rms_N", "group", "direction"), key, strict=True)
    )
    for name, fewest in FEWEST_METHODS.items():
        wanted = [method for method in COMPARED if not (name == "c" and method in NO_DAMPING)]
        found = [
            method
            for method in wanted
            if method in methods and np.isfinite(methods[method][f"{name}_median"])
        ]
        lacking = [method for method in wanted if method not in found]
        spans = np.array(
            [
                [methods[method][f"{name}_{part}"] for part in ("median", "low", "high")]
                for method in found
            ]
        )
        enough = len(found) >= fewest
        span = (
            (float(np.median(spans[:, 0])), float(spans[:, 1].min()), float(spans[:, 2].max()))
            if enough
            else (np.nan, np.nan, np.nan)
        )
        stated = [methods[method][f"verdict_{name}"] for method in wanted if method in methods]
        values |= dict(zip((name, f"{name}_low", f"{name}_high"), span, strict=True))
        values[f"secant_{name}"] = (
            float(methods["secant"][f"{name}_median"]) if "secant" in methods else np.nan
        )
        values[f"agreement_{name}"] = next(
            filter(None, stated), _agreement(spans[:, 0] if enough else (), bool(lacking))
        )
        values[f"reason_{name}"] = "" if enough else _reason(name, lacking, methods)
    return values


def _agreement(medians: Sequence[float] | np.ndarray, lacking: bool) -> str:
    """Return the verdict on the methods' medians, as the study has it on k."""
    if lacking or not len(medians):
        return "unresolved"
    centre = float(np.median(medians))
    near = np.all(np.abs(np.asarray(medians) - centre) <= AGREEMENT * abs(centre))
    return "agree" if near else "spread"


def _reason(name: str, lacking: Iterable[str], methods: dict[str, dict[str, Any]]) -> str:
    """Return why a recommended value is missing: the methods that do not resolve it, and why."""
    named = [
        f"{method} ({methods[method]['reason']})"
        if method in methods and methods[method]["reason"]
        else method
        for method in lacking
    ]
    return f"{', '.join(named)} {'does' if len(named) == 1 else 'do'} not resolve {name}"
