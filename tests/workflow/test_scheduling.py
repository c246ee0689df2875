"""Scheduling: what Snakemake holds and does per job stays the same as a study grows."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from evidence.benchmarks.scheduling import study_of
from tests.workflow.test_workflow import Study

ROOT = Path(__file__).parents[2]
# Runs Snakemake in this process; prints {rule: [inputs, outputs]} of the jobs of its plan, and the
# largest number of timers (threads that wait) at any time.
WATCHED = """
import json, sys, threading
from snakemake import cli, dag

plans, timers, ended = [], [0], threading.Event()
made = dag.DAG.__init__

def keep(plan, *arguments, **options):
    plans.append(plan)
    made(plan, *arguments, **options)

def watch():
    while not ended.wait(0.02):
        waiting = [thread for thread in threading.enumerate() if type(thread) is threading.Timer]
        timers[0] = max(timers[0], len(waiting))

dag.DAG.__init__ = keep
threading.Thread(target=watch, daemon=True).start()
try:
    cli.main(sys.argv[1:])
except SystemExit as end:
    assert not end.code, end.code
ended.set()
jobs = {job.rule.name: [len(job.input), len(job.output)] for job in plans[0].jobs}
print(json.dumps([jobs, timers[0]]))
"""


def watched(folder, *arguments):
    """What WATCHED prints of a run of Snakemake in a folder."""
    clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run = subprocess.run(
        [sys.executable, "-c", WATCHED, *arguments],
        cwd=folder,
        env=clean,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return json.loads(run.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def jobs(tmp_path_factory):
    """{number of loads: {rule: [inputs, outputs]}} of plans of the small study, one case a load."""
    folder = tmp_path_factory.mktemp("plans")
    found = {}
    for loads in (24, 240):
        (folder / "study.yaml").write_text(yaml.safe_dump(study_of(loads, 0.5)))
        files = ["--snakefile", str(ROOT / "Snakefile"), "--configfile", "study.yaml"]
        found[loads], _ = watched(folder, "--dry-run", *files)
    return found


def of_kind(rules, kind):
    """The inputs and outputs of the jobs of a kind."""
    return [counts for rule, counts in rules.items() if rule.startswith(f"_{kind}_from_")]


def test_a_simulation_has_one_input_whatever_the_loads(jobs, reliability):
    for rules in jobs.values():
        assert {inputs for inputs, _ in of_kind(rules, "simulate_to_spectra")} == {1}
    reliability.scale("inputs of a simulation job at 24 and 240 loads", "1")


def test_inputs_of_a_study_grow_with_its_cases_alone(jobs, reliability):
    # A case's files are inputs of identification, tables, figures and page: 10 in all. What does
    # not belong to a case is the model, tables, figures, captions and one input per simulation.
    for loads, rules in jobs.items():
        assert sum(inputs for inputs, _ in rules.values()) - 10 * loads < 230
        for inputs, outputs in of_kind(rules, "identify"):
            assert inputs == 1 + outputs  # the model; a record and a spectrum per pair of estimates
    reliability.scale("inputs of all jobs of a study", "10 per case and less than 230 beside")


def test_ten_times_the_loads_add_few_jobs(jobs, reliability):
    counts = [len(jobs[loads]) for loads in (24, 240)]
    assert counts[1] <= counts[0] + 5
    reliability.scale("jobs of a study of 24 and of 240 loads", " and ".join(map(str, counts)))


def test_no_timer_waits_for_each_job_that_is_done(tmp_path, reliability):
    Study(tmp_path)  # its scripts write empty files
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(study_of(24, 0.5)))
    rules, timers = watched(tmp_path, "-j2", "--configfile", "mine.yaml")
    assert len(of_kind(rules, "simulate_to_spectra")) == 24
    assert timers == 0
    reliability.scale("threads that wait for the next round of scheduling after 24 jobs", "none")
