"""Judged campaigns of a draw: read from its folder, from tables of shards, and written."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from .calibration import statements
from .judging import judged

TEXT = {
    "draw",
    "campaign",
    "kind",
    "drawn_as",
    "source",
    "hidden",
    "verdict",
    "named",
    "first_name",
    "parameter",
}
STATED = "statements"  # "probability:1 or 0" of what a verdict states, in one cell
WHOLE = {"effects", "channels"}
Row = dict[str, Any]


def read_folder(folder: str | Path) -> list[Row]:
    """Return the judged rows of a draw's folder: <name>/verdict.json and truth/<name>.json."""
    rows = []
    for file in sorted(Path(folder).glob("campaign_*/verdict.json")):
        truth_file = Path(folder) / "truth" / f"{file.parent.name}.json"
        if truth_file.is_file():
            verdict, truth = (
                json.loads(path.read_text(encoding="utf-8")) for path in (file, truth_file)
            )
            stated = " ".join(f"{p:.6g}:{int(true)}" for p, true in statements(verdict, truth))
            rows.append(
                {"draw": Path(folder).name, "campaign": file.parent.name}
                | judged(verdict, truth)
                | {STATED: stated}
            )
    return rows


def stated_in(rows: Iterable[Row]) -> list[tuple[float, bool]]:
    """Return (probability, whether it is true) of all statements of judged rows."""
    pairs = [pair.split(":") for row in rows for pair in row[STATED].split()]
    return [(float(probability), true == "1") for probability, true in pairs]


def read_shards(folder: str | Path, added: Iterable[str | Path]) -> list[Row]:
    """Return the judged rows of a folder and of campaigns.csv files of shards judged elsewhere:
    each campaign once, as judged here where it is in both.
    """
    rows = {row["campaign"]: row for file in added for row in read_table(file)}
    rows |= {row["campaign"]: row for row in read_folder(folder)}
    return [rows[name] for name in sorted(rows)]


def read_table(file: str | Path) -> list[Row]:
    """Return the judged rows of a campaigns.csv, as `read_folder` returned them."""
    with open(file, newline="", encoding="utf-8") as table:
        return [
            {column: _cell(column, text) for column, text in row.items()}
            for row in csv.DictReader(table)
        ]


def _cell(column: str, text: str) -> Any:
    if column in TEXT or column == STATED:
        return text
    if text in ("True", "False"):
        return text == "True"
    if column in WHOLE:
        return int(text)
    return float(text or "nan")
