"""The acceptance of verdicts as a single HTML file: table, reliability, detection limits, figures,
campaigns.
"""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, StrictUndefined

from vibroimpact.effects.registry import effects_in_words
from vibroimpact.reports.discrepancy_page import embedded
from vibroimpact.reports.number_text import digits, percent
from vibroimpact.reports.page_style import STYLE

TEMPLATE = Path(__file__).with_suffix(".html")


def acceptance_page(draw: str, rows: list[dict], tables: dict, figures: list) -> str:
    """Return the HTML page.

    draw: its name.
    rows: judged campaigns.
    tables: rows of table.csv, reliability.csv and detection.csv by name.
    figures: PNG files in their order, each with its caption in a .txt file of the same name.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    table = tables["table"]
    return template.render(
        style=STYLE,
        draw=draw,
        count=len(rows),
        sentence=acceptance_sentence(draw, rows, table),
        failed=any(row["standing"] == "missed" for row in table),
        table=[_table_row(row) for row in table],
        curve=[_bin_row(row) for row in tables["reliability"]],
        limits=[_limit_row(row) for row in tables["detection"]],
        figures=embedded(figures),
        campaigns=[_campaign_row(row) for row in rows],
    )


def acceptance_sentence(draw: str, rows: list[dict], table: list[dict]) -> str:
    """Return how many campaigns were judged, by which sources where they are several, and which
    rows miss their target or have none.
    """
    of = {
        standing: [row for row in table if row["standing"] == standing]
        for standing in ("met", "missed", "no campaigns")
    }
    head = (
        f"{len(rows)} campaigns of the draw {draw}: {len(of['met'])} of {len(table)} rows meet"
        " their target."
    )
    missed = "; ".join(_with_numbers(row) for row in of["missed"])
    sources = sorted({row["source"] for row in rows})
    several = f" Judged by several sources: {', '.join(sources)}." if len(sources) > 1 else ""
    absent = "; ".join(f"{row['kind']}: {row['quantity']}" for row in of["no campaigns"])
    return (
        head
        + several
        + (f" Missed: {missed}." if missed else "")
        + (f" No campaign answers yet: {absent}." if absent else "")
    )


def _with_numbers(row):
    return (
        f"{row['kind']}: {row['quantity']} ({_shown(row, 'rate')}, target {_target(row)},"
        f" campaigns: {row['campaigns']})"
    )


def _is_share(row):
    return row["count"] is not None or "error" in row["quantity"]


def _shown(row, key):
    """Return a number of a row: shares and relative errors as percentages."""
    return percent(row[key]) if _is_share(row) else digits(row[key])


def _target(row):
    """Return the target in words."""
    bounds = [f"at {key} {_shown(row, key)}" for key in ("least", "most") if row[key] == row[key]]
    return " and ".join(bounds)


def _table_row(row):
    known = row["rate"] == row["rate"]
    return {
        "kind": row["kind"],
        "quantity": row["quantity"],
        "campaigns": row["campaigns"],
        "count": "-" if row["count"] is None else row["count"],
        "rate": _shown(row, "rate") if known else "-",
        "interval": f"{_shown(row, 'low')} to {_shown(row, 'high')}" if known else "-",
        "target": _target(row),
        "standing": row["standing"],
    }


def _bin_row(row):
    return {
        "bin": f"{percent(row['stated_low'])} to {percent(row['stated_high'])}",
        "statements": row["statements"],
        "stated": percent(row["stated"]),
        "true": percent(row["true"]),
        "interval": f"{percent(row['low'])} to {percent(row['high'])}",
    }


def _limit_row(row):
    bounds = [
        f"{word} {digits(row[key])}"
        for word, key in (("from", "limit_low"), ("to", "limit_high"))
        if row[key] == row[key]
    ]
    return {
        "effect": effects_in_words([row["effect"]]),
        "campaigns": row["campaigns"],
        "found": row["found"],
        "limit": digits(row["limit_over_floor"]),
        "interval": " ".join(bounds) or "-",
    }


def _campaign_row(row):
    sets = [effects_in_words(names.split("+")) for names in row["named"].split("|") if names]
    return {
        "number": row["campaign"].removeprefix("campaign_"),
        "kind": row["kind"].replace("_", " "),
        "hidden": effects_in_words(row["hidden"].split("+")) or "nothing",
        "verdict": row["verdict"].replace("_", " "),
        "sets": ", or ".join(sets) or "-",
        "first": effects_in_words(row["first_name"].split("+")) or "-",
        "strength": digits(row["strength"]),
        "closed": percent(row["closed"]),
    }
