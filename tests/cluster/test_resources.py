"""What a job asks a cluster for, beside what jobs were measured to take."""

import csv
import re
import subprocess
import sys

import pytest
import yaml

from tests.cluster.conftest import ROOT, command
from vibroimpact_workflow.resources import memory, minutes

# A job of a cluster has two Snakemake processes beside its script; each was measured to hold
# 160 MB (proportional set size, Snakemake 9.27.1).
SNAKEMAKE_MB = 2 * 160
MARGIN = 1.5
PROFILES = sorted((ROOT / "workflow" / "profiles").glob("*/config.yaml"))


def asked():
    """{rule without its underscore: (MB, minutes)} of the first attempt."""
    found = {}
    for file in [*ROOT.glob("*/rules/*.smk"), *ROOT.glob("examples/*/*.smk")]:
        parts = re.split(r"^ *(?:rule|checkpoint) (\w+):\n", file.read_text(), flags=re.M)
        for name, body in zip(parts[1::2], parts[2::2], strict=True):
            if "resources:" in body:
                numbers = re.findall(r"^ +(?:mem_mb=memory|runtime=minutes)\((\d+)\),", body, re.M)
                found[name.removeprefix("_")] = tuple(map(int, numbers))
    return found


def test_every_job_states_memory_and_time_by_its_attempt():
    assert {name: numbers for name, numbers in asked().items() if len(numbers) != 2} == {}


def test_each_attempt_asks_for_as_much_again():
    assert [memory(1500)({}, attempt) for attempt in (1, 2, 3)] == [1500, 3000, 4500]
    assert [minutes(20)({}, attempt) for attempt in (1, 2, 3)] == [20, 40, 60]


@pytest.mark.slow
def test_jobs_take_less_memory_than_they_ask_for(local_results):
    stated, short = asked(), {}
    benchmarks = sorted((local_results / "benchmarks").glob("*.tsv"))
    for file in benchmarks:
        with open(file, newline="") as lines:
            (row,) = csv.DictReader(lines, delimiter="\t")
        megabytes, _ = stated[re.split("_load_|_from_", file.stem)[0]]
        needed = MARGIN * float(row["max_rss"]) + SNAKEMAKE_MB
        if megabytes < needed:
            short[file.stem] = (megabytes, needed)
    assert len(benchmarks) > 10 and short == {}


@pytest.mark.parametrize("profile", PROFILES, ids=lambda file: file.parent.name)
def test_options_of_a_profile_exist_in_snakemake(profile):
    parser = "from snakemake.cli import get_argument_parser; get_argument_parser().print_help()"
    told = subprocess.run([sys.executable, "-c", parser], capture_output=True, text=True)
    options = re.findall(r"--([a-z-]+)", told.stdout)
    keys = [key.lstrip("?") for key in yaml.safe_load(profile.read_text())]
    assert set(keys) - {"__use_yte__", "__definitions__", "if progress"} - set(options) == set()


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["slurm", "shared_folder"])
def test_a_profile_plans_the_same_study(profile, tmp_path):
    plans = []
    for options in ([], ["--profile", ROOT / "workflow" / "profiles" / profile]):
        planned = command(tmp_path, "--dry-run", *options)
        run = subprocess.run(planned, cwd=ROOT, capture_output=True, text=True)
        assert run.returncode == 0, run.stdout + run.stderr
        plans.append(re.findall(r"^(\w+) +(\d+)$", run.stdout, flags=re.M))
    assert plans[0] == plans[1] and ("_basis", "1") in plans[0]
