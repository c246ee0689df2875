"""The plan of a draw as one table, and the files of its campaigns."""

import json
from dataclasses import replace
from pathlib import Path

from evidence.truth.campaign import make_campaign, write_whole
from evidence.truth.draw import draw
from evidence.truth.hidden import family_of
from evidence.truth.tune import tuned

NO_STRENGTH = ("nothing", "fault")  # kinds that no twins are run for


def plan_table(pool, seed, count):
    """{pool, seed, campaigns: rows of what each is} of the first `count` campaigns of a seed."""
    rows = []
    for number in range(count):
        plan, _, names = draw(pool, seed, number)
        rows.append(
            {
                "number": number,
                "kind": plan.kind,
                "hidden": list(names),
                "families": [family_of(name) for name in names],
                "beam": type(plan.beam).__name__,
                "channels": len(plan.channels),
                "records": len(plan.levels),
                "duration_s": plan.duration,
                "sampling_Hz": plan.sampling,
            }
        )
    return {"pool": pool, "seed": seed, "campaigns": rows}


def write_plan(table, path):
    """Write a plan table."""
    write_whole(path, json.dumps(table, indent=1) + "\n")


def read_plan(path):
    """The plan table in a file."""
    return json.loads(Path(path).read_text(encoding="utf-8"))


def files_of(folder, number):
    """{campaign, model, truth} paths of a campaign in a folder."""
    name = f"campaign_{number:04d}"
    return {
        "campaign": Path(folder) / f"{name}.nc",
        "model": Path(folder) / f"{name}.yaml",
        "truth": Path(folder) / "truth" / f"{name}.json",
    }


def make_number(table, number, folder):
    """Make a campaign of a plan table, its model and its truth; return the campaign's path.

    It depends on the table's pool and seed and on the number alone.
    """
    files = files_of(folder, number)
    plan = tuned(table["pool"], table["seed"], number)
    for finer in (1, 2, 4):
        steps = finer * plan.steps_per_second
        try:
            make_campaign(
                replace(plan, steps_per_second=steps),
                files["campaign"],
                files["truth"],
                plan.kind not in NO_STRENGTH,
                files["model"],
            )
            break
        except FloatingPointError:
            if finer == 4:
                raise
    return files["campaign"]
