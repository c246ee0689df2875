"""Command line: a seeded set of sealed campaigns, one campaign, or the strength of amounts.

python -m vibroimpact_truth --out FOLDER --seed S --count N [--shard 0/1] [--duration 20]
    [--tube dev|stand_in] [--list]
python -m vibroimpact_truth one --out x.nc --effect gap --set factor=1.25
    [--effect dry_friction --set mu=0.2] [--truth x.json]
python -m vibroimpact_truth calibrate [effect ...]
"""

import argparse
import json
import sys
import time
from pathlib import Path

from vibroimpact_truth.amounts import AMOUNTS
from vibroimpact_truth.calibrate import table
from vibroimpact_truth.campaign import LEVELS, Plan, make_campaign
from vibroimpact_truth.draw import draw_plans
from vibroimpact_truth.geometry import TUBES
from vibroimpact_truth.hidden import EFFECTS, STRANGERS
from vibroimpact_truth.measure import INSTRUMENTS


class EffectOption(argparse.Action):
    """--effect starts an effect, --set key=value adds a parameter to the last one."""

    def __call__(self, parser, namespace, value, option=None):
        effects = getattr(namespace, "effects", None) or []
        if option == "--effect":
            if value not in (known := [*EFFECTS, *STRANGERS, *INSTRUMENTS]):
                parser.error(f"effect '{value}' is unknown: {', '.join(known)}")
            effects.append((value, {}))
        elif not effects:
            parser.error("--set needs an --effect before it")
        else:
            effects[-1][1].update([key_value(value)])
        namespace.effects = effects


def key_value(text):
    """(key, number or text) of key=value."""
    key, _, value = text.partition("=")
    try:
        return key, json.loads(value)
    except json.JSONDecodeError:
        return key, value


def levels(text):
    """((N RMS, gap %, split), ...) of "0.5:1.3:fit,10:0.9:holdout"."""
    rows = [row.split(":") for row in text.split(",")]
    return tuple((float(load), float(gap), split) for load, gap, split in rows)


def options():
    """The parser of all three commands."""
    parser = argparse.ArgumentParser(
        prog="python -m vibroimpact_truth",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("command", nargs="?", default="draw", choices=("draw", "one", "calibrate"))
    parser.add_argument("names", nargs="*", help="calibrate: effects, all by default")
    parser.add_argument("--out", help="draw: a folder, truths go to FOLDER/truth; one: the file")
    parser.add_argument(
        "--truth", help="one: file of the truth, by default the same name with .truth.json"
    )
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=24)
    parser.add_argument("--shard", default="0/1", help="i/n: every n-th campaign from the i-th on")
    parser.add_argument("--list", action="store_true", help="list the campaigns, and make nothing")
    parser.add_argument("--effect", action=EffectOption, dest="effects")
    parser.add_argument("--set", action=EffectOption, dest="effects", metavar="KEY=VALUE")
    parser.add_argument("--duration", type=float, default=20.0, help="s per record")
    parser.add_argument("--tube", default="stand_in", choices=sorted(TUBES))
    parser.add_argument(
        "--change", action="append", default=[], metavar="KEY=VALUE", help="a field of the tube"
    )
    parser.add_argument("--levels", type=levels, default=LEVELS, metavar="N:PERCENT:SPLIT,...")
    parser.add_argument("--force", help="take the forces of this campaign file")
    parser.add_argument(
        "--contact-force", action="store_true", help="channels of the plates' forces"
    )
    parser.add_argument("--noise-floor", action="store_true", help="write noise_floor_rms")
    parser.add_argument(
        "--no-twin", action="store_true", help="do not run the bare rig that gives the strength"
    )
    for name, value in (("gain", 0.02), ("frequency", 0.003), ("damping", 0.10)):
        parser.add_argument(f"--{name}-scatter", type=float, default=value)
    parser.add_argument("--noise", type=float, default=0.01)
    return parser


def plan_fields(given):
    """Fields of Plan that the command line gives."""
    return {
        "tube": given.tube,
        "changes": dict(key_value(text) for text in given.change),
        "levels": given.levels,
        "duration": given.duration,
        "gain_scatter": given.gain_scatter,
        "frequency_scatter": given.frequency_scatter,
        "damping_scatter": given.damping_scatter,
        "noise": given.noise,
        "contact_force": given.contact_force,
        "noise_floor": given.noise_floor,
        "drive_force": given.force,
    }


def make_set(given):
    """Make those campaigns of a shard that do not exist yet."""
    first, every = (int(part) for part in given.shard.split("/"))
    for index, plan in enumerate(draw_plans(given.seed, given.count, **plan_fields(given))):
        if given.list:
            print(index, plan.arm, *(f"{name}{parameters}" for name, parameters in plan.effects))
        elif index % every == first:
            path = Path(given.out) / f"campaign_s{given.seed}_{index:04d}.nc"
            truth = Path(given.out) / "truth" / f"{path.stem}.json"
            if not (path.exists() and truth.exists()):
                make_one(plan, path, truth, not given.no_twin)


def make_one(plan, path, truth, twin):
    """Make one campaign and print a line that does not reveal what is hidden."""
    start = time.perf_counter()
    try:
        make_campaign(plan, path, truth, twin)
    except FloatingPointError as problem:
        print(f"{path}: not made: {problem}", file=sys.stderr, flush=True)
    else:
        print(f"{path} {time.perf_counter() - start:.1f} s", flush=True)


def main(arguments=None):
    """Run the command."""
    parser = options()
    given = parser.parse_args(arguments)
    if given.command == "calibrate":
        table(given.names or list(AMOUNTS), given.seed, given.duration, given.tube)
    elif given.out is None and not given.list:
        parser.error("--out is needed")
    elif given.command == "one":
        path = Path(given.out)
        make_one(
            Plan((given.seed,), tuple(given.effects or ()), "one", **plan_fields(given)),
            path,
            given.truth or path.with_suffix(".truth.json"),
            not given.no_twin,
        )
    else:
        make_set(given)


if __name__ == "__main__":
    main()
