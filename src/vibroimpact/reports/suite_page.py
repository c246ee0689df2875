"""The hidden-effect suite as a single HTML file: rates, detection limits, figures, campaigns."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, StrictUndefined

from vibroimpact.acceptance.rates import TARGETS

from .discrepancy_page import embedded, in_words
from .number_text import digits, percent
from .page_style import STYLE

TEMPLATE = Path(__file__).with_suffix(".html")


def suite_page(
    seed: int, rows: list[dict], rates: list[dict], limits: list[dict], figures: list
) -> str:
    """Return the HTML page.

    seed: of the draw.
    rows: judged campaigns.
    rates, limits: rows of rates.csv and detection.csv.
    figures: PNG files in their order, each with its caption in a .txt file of the same name.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(
        style=STYLE,
        seed=seed,
        count=len(rows),
        sentence=suite_sentence(seed, rows, rates),
        failed=any(row["standing"] == "fails" for row in rates),
        rates=[_rate_row(row) for row in rates],
        unasked=unasked(rates),
        limits=[_limit_row(row) for row in limits],
        figures=embedded(figures),
        campaigns=[_campaign_row(row) for row in rows],
    )


def suite_sentence(seed: int, rows: list[dict], rates: list[dict]) -> str:
    """Return how many campaigns were judged and which rates miss their target or fail."""
    met = sum(row["standing"] == "met" for row in rates)
    missed, failing = (
        "; ".join(_with_numbers(row) for row in rates if row["standing"] == standing)
        for standing in ("missed", "fails")
    )
    head = (
        f"{len(rows)} campaigns of the draw with seed {seed}: {met} of {len(rates)} rows meet their"
        " target."
    )
    return (
        head
        + (f" Missed: {missed}." if missed else "")
        + (f" Failing: {failing}." if failing else "")
    )


def unasked(rates: list[dict]) -> str:
    """Return the rows of the acceptance table, in words, that have no campaign yet."""
    present = {(row["arm"], row["quantity"]) for row in rates}
    return "; ".join(
        f"{arm}: {quantity}" for arm, quantity in TARGETS if (arm, quantity) not in present
    )


def _with_numbers(row):
    return (
        f"{row['arm']}: {row['quantity']} ({percent(row['rate'])}, target {_bound(row)}, campaigns:"
        f" {row['campaigns']})"
    )


def _bound(row):
    """Return the target in words, with the side on which it is met."""
    limit = row["fails_beyond"]
    return (
        f"at {'most' if limit == limit and limit > row['target'] else 'least'}"
        f" {percent(row['target'])}"
    )


def _rate_row(row):
    return {
        "arm": row["arm"],
        "quantity": row["quantity"],
        "campaigns": row["campaigns"],
        "rate": percent(row["rate"]),
        "interval": f"{percent(row['low'])} to {percent(row['high'])}",
        "by_chance": percent(row["by_chance"]),
        "target": _bound(row),
        "fails_beyond": percent(row["fails_beyond"]),
        "standing": row["standing"],
    }


def _limit_row(row):
    bounds = [
        f"{word} {digits(row[key])}"
        for word, key in (("from", "limit_low"), ("to", "limit_high"))
        if row[key] == row[key]
    ]
    return {
        "effect": in_words([row["effect"]]),
        "campaigns": row["campaigns"],
        "found": row["found"],
        "limit": digits(row["limit_over_floor"]),
        "interval": " ".join(bounds) or "-",
    }


def _campaign_row(row):
    sets = [in_words(names.split("+")) for names in row["named"].split("|") if names]
    return {
        "number": row["campaign"].removeprefix("campaign_"),
        "arm": row["arm"].replace("_", " "),
        "hidden": in_words(row["hidden"].split("+")) or "nothing",
        "verdict": row["verdict"].replace("_", " "),
        "sets": ", or ".join(sets) or "-",
        "first": in_words(row["first_name"].split("+")) or "-",
        "strength": digits(row["strength"]),
        "closed": percent(row["closed"]),
    }
