"""Command line: the plan of a draw, its campaigns, or one campaign by hand.

python -m evidence.truth plan --pool development --seed 1 --count 180 --out PLAN.json
python -m evidence.truth make --plan PLAN.json --out FOLDER [--number 7 | --shard 0/2]
python -m evidence.truth one --out x.nc --effect gap --set factor=1.25
    [--effect dry_friction --set mu=0.2] [--truth x.json] [--model x.yaml]
"""

import argparse
import json
import sys
import time
from pathlib import Path

from evidence.truth.campaign import LEVELS, Plan, make_campaign
from evidence.truth.draw import POOLS
from evidence.truth.geometry import TUBES
from evidence.truth.hidden import IN_RIG
from evidence.truth.measure import INSTRUMENTS
from evidence.truth.table import files_of, make_number, plan_table, read_plan, write_plan


class EffectOption(argparse.Action):
    """--effect starts an effect, --set key=value adds a parameter to the last one."""

    def __call__(self, parser, namespace, value, option=None):
        effects = getattr(namespace, "effects", None) or []
        if option == "--effect":
            if value not in (known := [*IN_RIG, *INSTRUMENTS]):
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
        prog="python -m evidence.truth",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    plan = commands.add_parser("plan", help="write the table of a draw")
    plan.add_argument("--pool", choices=POOLS, default="development")
    plan.add_argument("--seed", type=int, required=True)
    plan.add_argument("--count", type=int, default=180)
    plan.add_argument("--out", required=True, help="the file of the table, JSON")
    make = commands.add_parser("make", help="make campaigns of a plan that do not exist yet")
    make.add_argument("--plan", required=True, help="the file of the table")
    make.add_argument("--number", type=int, help="one campaign alone")
    make.add_argument("--shard", default="0/1", help="i/n: every n-th campaign from the i-th on")
    make.add_argument("--out", required=True, help="folder; truths go to FOLDER/truth")
    one = commands.add_parser("one", help="make a campaign by hand")
    one.add_argument("--out", required=True, help="the file")
    one.add_argument("--truth", help="file of the truth, by default the same with .truth.json")
    one.add_argument("--model", help="file of the model, none by default")
    one.add_argument("--seed", type=int, default=0)
    one.add_argument("--effect", action=EffectOption, dest="effects")
    one.add_argument("--set", action=EffectOption, dest="effects", metavar="KEY=VALUE")
    one.add_argument("--duration", type=float, default=20.0, help="s per record")
    one.add_argument("--sampling", type=float, default=2048.0, help="Hz")
    one.add_argument("--start-up", choices=("rest", "stationary"), default="rest")
    one.add_argument("--tube", default="stand_in", choices=sorted(TUBES))
    one.add_argument(
        "--change", action="append", default=[], metavar="KEY=VALUE", help="a field of the tube"
    )
    one.add_argument("--levels", type=levels, default=LEVELS, metavar="N:PERCENT:SPLIT,...")
    one.add_argument("--force", help="take the forces of this campaign file")
    one.add_argument("--contact-force", action="store_true", help="channels of the plates' forces")
    one.add_argument("--noise-floor", action="store_true", help="write noise_floor_rms")
    one.add_argument(
        "--no-twin", action="store_true", help="do not run the bare rig that gives the strength"
    )
    for name, value in (("gain", 0.02), ("frequency", 0.003), ("damping", 0.10)):
        one.add_argument(f"--{name}-scatter", type=float, default=value)
    one.add_argument("--noise", type=float, default=0.01)
    return parser


def plan_by_hand(given):
    """The Plan of the command `one`."""
    return Plan(
        (given.seed,),
        tuple(given.effects or ()),
        "one",
        tube=given.tube,
        changes=dict(key_value(text) for text in given.change),
        levels=given.levels,
        duration=given.duration,
        sampling=given.sampling,
        start_up=given.start_up,
        gain_scatter=given.gain_scatter,
        frequency_scatter=given.frequency_scatter,
        damping_scatter=given.damping_scatter,
        noise=given.noise,
        contact_force=given.contact_force,
        noise_floor=given.noise_floor,
        drive_force=given.force,
    )


def make_shard(given):
    """Make those campaigns of a plan that do not exist yet: one, or those of a shard."""
    table = read_plan(given.plan)
    first, every = (int(part) for part in given.shard.split("/"))
    numbers = range(first, len(table["campaigns"]), every)
    for number in numbers if given.number is None else [given.number]:
        if not all(path.exists() for path in files_of(given.out, number).values()):
            start = time.perf_counter()
            path = make_number(table, number, given.out)
            print(f"{path} {time.perf_counter() - start:.1f} s", flush=True)


def main(arguments=None):
    """Run the command."""
    given = options().parse_args(arguments)
    if given.command == "plan":
        write_plan(plan_table(given.pool, given.seed, given.count), given.out)
    elif given.command == "make":
        make_shard(given)
    else:
        path = Path(given.out)
        truth = given.truth or path.with_suffix(".truth.json")
        try:
            make_campaign(plan_by_hand(given), path, truth, not given.no_twin, given.model)
        except FloatingPointError as problem:
            sys.exit(f"{path}: not made: {problem}")


if __name__ == "__main__":
    main()
