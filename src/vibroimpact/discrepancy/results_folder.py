"""The results of a discrepancy run, read from its folder for the figures and the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from vibroimpact.records import MAKE_AGAIN, read_dataset, read_json, read_table
from vibroimpact.verdict.content import Verdict
from vibroimpact.verdict.file import read_verdict


@dataclass(frozen=True)
class Results:
    """The results of a discrepancy run.

    before, after: the maps with the model as given and as completed, None where there is none.
    ranking: rows of ranking.csv. candidates: contents of candidates/*.json, best first.
    """

    verdict: Verdict
    before: xr.Dataset | None
    after: xr.Dataset | None
    ranking: list[dict[str, Any]]
    candidates: list[dict[str, Any]]


def read_results(folder: str | Path) -> Results:
    """Return the Results of a folder.

    Where the campaign was refused, files other than verdict.json may be missing and maps empty.
    """
    folder = Path(folder)
    verdict = read_verdict(folder / "verdict.json")
    ranking = read_table(folder / "ranking.csv") if (folder / "ranking.csv").is_file() else []
    order = ["+".join(sorted(str(row["ids"]).split("+"))) for row in ranking]
    candidates = [read_json(file) for file in sorted((folder / "candidates").glob("*.json"))]
    keys = {id(candidate): "+".join(sorted(candidate["ids"])) for candidate in candidates}
    candidates.sort(
        key=lambda candidate: (
            order.index(keys[id(candidate)]) if keys[id(candidate)] in order else len(order)
        )
    )
    return Results(
        verdict, _map(folder / "map.nc"), _map(folder / "map_after.nc"), ranking, candidates
    )


NO_VALUE = ("None", "", "nan")


def best_places(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows of a ranking, best first, without those that were only screened and whose
    effects are in a row before at another place.
    """
    shown, kept = set(), []
    for row in rows:
        ids = row["ids"] if isinstance(row["ids"], str) else "+".join(row["ids"])
        tested = str(row.get("heldout_score")) not in NO_VALUE or str(row.get("tested")) == "True"
        if tested or ids not in shown:
            kept.append(row)
        shown.add(ids)
    return kept


def _map(path):
    """Return the map of a file, None where there is no file or no map in it."""
    data = read_dataset(path, MAKE_AGAIN) if path.is_file() else None
    return data if data is not None and "D" in data else None
