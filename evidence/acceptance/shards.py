"""Names, seeds and shards of draws: which campaigns are judged, and which are already."""

import csv
import re
from pathlib import Path

from vibroimpact.config.reserved_names import DRAW_NAME
from vibroimpact.io.provenance import source_digest

MOST_CAMPAIGNS = 9999  # their folders have numbers of four digits
WHOLE_DRAW = 180  # campaigns


def source_digest_of(*folders):
    """Return the digest of all Python files below folders: of the library and of its evidence."""
    return source_digest(file for folder in folders for file in Path(folder).rglob("*.py"))


def frozen_seed(digest):
    """Return the seed of an acceptance draw, of the digest of the whole source: no change
    can be made between choosing the campaigns and judging them.
    """
    return int(digest[:8], 16)


def draw_name(pool, seed):
    """Return the name of the draw of a seed from a pool, "development" or "acceptance"."""
    return f"{pool}_{seed}"


def draw_of(name):
    """Return (pool, seed) of a draw's name."""
    pool, seed = re.fullmatch(DRAW_NAME, name).groups()
    return pool, int(seed)


def shard_of(count, shard):
    """Return the numbers of the campaigns of a shard "i/n" of the first `count`: every n-th from
    the i-th on. Raises ValueError where these are none.
    """
    if not str(count).isdecimal() or not 1 <= int(str(count)[:9]) <= MOST_CAMPAIGNS:
        raise ValueError(
            f"count = {count}: give how many campaigns, at most {MOST_CAMPAIGNS}, as in count=120,"
            " or count=judged for those with a verdict"
        )
    parts = shard.split("/")
    if (
        len(parts) != 2
        or not all(part.isdecimal() for part in parts)
        or not int(parts[0]) < int(parts[1])
    ):
        raise ValueError(f"shard = {shard}: give i/n with i from 0 to n - 1, as in shard=0/3")
    return range(int(parts[0]), int(count), int(parts[1]))


def numbers_judged(folder):
    """Return the numbers of the campaigns of a draw's folder that have a verdict."""
    return sorted(
        int(file.parent.name.removeprefix("campaign_"))
        for file in Path(folder).glob("campaign_*/verdict.json")
    )


def numbers_added(files, draw):
    """Return the numbers of the campaigns that campaigns.csv files hold of a draw of this name.
    Raises ValueError where one holds those of another, or none.
    """
    out = set()
    for file in files:
        if not Path(file).is_file():
            raise ValueError(f"add = {file} is not there: give a campaigns.csv of {draw}")
        with open(file, newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        others = sorted({str(row.get("draw")) for row in rows} - {draw})
        if others or not rows:
            raise ValueError(
                f"add = {file} holds {'campaigns of ' + others[0] if others else 'no campaign'}:"
                f" give a campaigns.csv of {draw}"
            )
        out |= {int(row["campaign"].removeprefix("campaign_")) for row in rows}
    return out
