"""Names, seeds and shards of the suite: which campaigns are judged, and which are already."""

import csv
import hashlib
import re
from pathlib import Path


def frozen_seed(path):
    """Return the seed of an acceptance draw: of the content of the file of thresholds and priors,
    so that the draw can not precede the freeze.
    """
    return int(hashlib.sha256(Path(path).read_bytes()).hexdigest()[:8], 16)


MOST_CAMPAIGNS = 9999  # their folders have numbers of four digits
SUITE_S = 20  # of every record of a suite's campaigns
SUITE_NAME = r"suite_([0-9]+)(?:_([0-9]+)s)?(?:_draw([0-9]+))?"


def suite_name(seed, seconds=SUITE_S, draw=0):
    """Return the name of the suite of a seed, of campaigns of so many seconds, judged with a draw
    of the simulations' seeds.
    """
    return f"suite_{seed}" + f"_{seconds}s" * (seconds != SUITE_S) + f"_draw{draw}" * bool(draw)


def suite_of(name):
    """Return {seed, seconds, draw} of a suite's name."""
    seed, seconds, draw = re.fullmatch(SUITE_NAME, name).groups()
    return {"seed": int(seed), "seconds": int(seconds or SUITE_S), "draw": int(draw or 0)}


def shard_of(count, shard):
    """Return the numbers of the campaigns of a shard "i/n" of the first `count`: every n-th from
    the i-th on. Raises ValueError where these are none.
    """
    if not str(count).isdecimal() or not 1 <= int(str(count)[:9]) <= MOST_CAMPAIGNS:
        raise ValueError(
            f"count = {count}: give how many campaigns, at most {MOST_CAMPAIGNS}, as in count=90,"
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
    """Return the numbers of the campaigns of a suite's folder that have a verdict."""
    return sorted(
        int(file.parent.name.removeprefix("campaign_"))
        for file in Path(folder).glob("campaign_*/verdict.json")
    )


def numbers_added(files, suite):
    """Return the numbers of the campaigns that campaigns.csv files hold of a suite of this name.
    Raises ValueError where one holds those of another, or none.
    """
    out = set()
    for file in files:
        if not Path(file).is_file():
            raise ValueError(f"add = {file} is not there: give a campaigns.csv of {suite}")
        with open(file, newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        others = sorted({str(row.get("suite")) for row in rows} - {suite})
        if others or not rows:
            raise ValueError(
                f"add = {file} holds {'campaigns of ' + others[0] if others else 'no campaign'}:"
                f" give a campaigns.csv of {suite}"
            )
        out |= {int(row["campaign"].removeprefix("campaign_")) for row in rows}
    return out
