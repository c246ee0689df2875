"""What a discrepancy run leaves in its folder, read back for the figures and the page."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from vibroimpact.records import MAKE_AGAIN, read_dataset, read_json, read_table
from vibroimpact.verdict.content import Verdict
from vibroimpact.verdict.file import read_verdict


@dataclass(frozen=True)
class Results:
    """Verdict, maps before and after (None where there is none), rows of
    ranking.csv, contents of candidates/*.json, best first.
    """

    verdict: Verdict
    before: xr.Dataset | None
    after: xr.Dataset | None
    ranking: list
    candidates: list


def read_results(folder):
    """Return the Results of a folder. Files other than verdict.json may be missing, and maps empty,
    where the campaign was refused.
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


def best_places(rows):
    """Return the rows of a ranking without those that were screened only, of effects that a row
    before them shows at another place.
    """
    shown, kept = set(), []
    for row in rows:
        ids = row["ids"] if isinstance(row["ids"], str) else "+".join(row["ids"])
        closely = str(row.get("heldout_score")) not in NO_VALUE or str(row.get("tested")) == "True"
        if closely or ids not in shown:
            kept.append(row)
        shown.add(ids)
    return kept


def _map(path):
    """Return the map of a file, None where there is no file or nothing in it."""
    data = read_dataset(path, MAKE_AGAIN) if path.is_file() else None
    return data if data is not None and "D" in data else None
