"""Kills in the middle of a run, and a run beside another: the same command continues, and its files
have the bits of a run that was not disturbed.
"""

import os
import re
import signal

import pytest

from tests.faults.runs import Runs, bits
from tests.support.tiny_study import tiny_values

pytestmark = pytest.mark.slow
RECORD = "results/tiny/records/load_20_gap_0.0001_seed_0.nc"
IN_A_JOB = "timeseries/.load_20*"  # the temporary file of a series that is being written
KINDS = ("records", "timeseries")
CONTINUED = r"The last run was killed: process (\d+) on .* It is continued"


@pytest.fixture
def runs(tmp_path):
    """Runs in a folder whose name has a space and letters beyond ASCII."""
    runs = Runs(tmp_path / "étude n° 1", tiny_values())
    yield runs
    runs.end()


def undisturbed(finished_study):
    """The bits of the cases of the load that is run here."""
    found = bits(finished_study.folder, *KINDS)
    return {name: content for name, content in found.items() if "load_20_" in name}


def continue_and_compare(runs, finished_study):
    """Give the same command again; returns what it says."""
    code, told = runs.run(RECORD)
    assert code == 0, told
    assert bits(runs.results, *KINDS) == undisturbed(finished_study)
    return told


def test_a_killed_job_is_run_again_with_the_same_bits(runs, finished_study, reliability):
    process = runs.start(RECORD)
    runs.wait_for(process, IN_A_JOB)
    for job in runs.jobs(process):
        os.kill(job, signal.SIGKILL)
    told, _ = process.communicate()
    assert process.returncode == 1
    assert "1 job failed:" in told and "give the same command again" in told
    assert not any(list(runs.results.glob(f"{kind}/load*")) for kind in KINDS)
    told = continue_and_compare(runs, finished_study)
    assert re.search(r"\d+ temporary files of killed jobs are removed", told)
    assert "was killed" not in told  # snakemake itself could end
    reliability.fault("SIGKILL of a job", "no half file; the same command continues, same bits")


def test_killed_snakemake_continues_without_unlock(runs, finished_study, reliability):
    process = runs.start(RECORD)
    runs.wait_for(process, IN_A_JOB)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    told = continue_and_compare(runs, finished_study)
    assert re.search(CONTINUED, told)[1] == str(process.pid)
    assert re.search(r"\d+ temporary files of killed jobs are removed", told)
    reliability.fault(
        "SIGKILL of Snakemake and its jobs",
        "the same command continues and says so, without --unlock; same bits",
    )


def test_a_run_beside_an_orphaned_job_has_the_same_bits(runs, finished_study, reliability):
    process = runs.start(RECORD)
    runs.wait_for(process, IN_A_JOB)
    orphans = runs.jobs(process)
    os.kill(process.pid, signal.SIGKILL)  # its job goes on
    code, told = runs.run(RECORD)
    assert code == 0 and re.search(CONTINUED, told), told
    runs.wait_until_ended(orphans)  # it may be the slower one
    assert bits(runs.results, *KINDS) == undisturbed(finished_study)
    reliability.fault(
        "SIGKILL of Snakemake alone, its job goes on", "the same command continues; same bits"
    )


def test_an_interrupted_run_continues(runs, finished_study, reliability):
    process = runs.start(RECORD)
    runs.wait_for(process, IN_A_JOB)
    os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C on a terminal
    process.communicate()
    assert process.returncode != 0
    assert "was killed" not in continue_and_compare(runs, finished_study)
    reliability.fault("SIGINT of Snakemake (Ctrl-C)", "the same command continues; same bits")


def test_second_run_is_refused_while_the_first_goes_on(runs, finished_study):
    first = runs.start(RECORD)
    runs.wait_for(first, IN_A_JOB)
    os.killpg(first.pid, signal.SIGSTOP)
    code, told = runs.run(RECORD)
    os.killpg(first.pid, signal.SIGCONT)
    last = told.strip().splitlines()[-1]
    assert code == 1 and last.startswith("another run is at work in this folder")
    assert f"process {first.pid} on" in last and "Traceback" not in told
    told, _ = first.communicate()
    assert first.returncode == 0, told
    assert bits(runs.results, *KINDS) == undisturbed(finished_study)
