"""The study on a real Slurm of one node, with the profile for clusters and what befalls a cluster.

Each job of a cluster starts Snakemake twice, so that one run has all the faults.
"""

import os
import subprocess

import pytest
import xarray as xr

from tests.cluster.conftest import PROFILE, ROOT, SCRIPT, command, wait_for

TABLES = ("results/tiny/equivalent.csv", "results/tiny/consistency.csv")
OPTIONS = ("--profile", PROFILE, "--slurm-init-seconds-before-status-checks", 3)


class Run:
    """A run of the tiny study through Slurm."""

    def __init__(self, slurm, folder, *arguments):
        self.slurm, self.folder = slurm, folder
        with open(folder / "told.txt", "a") as told:
            started = command(folder, *OPTIONS, *arguments)
            self.process = subprocess.Popen(started, cwd=ROOT, stdout=told, stderr=told)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.process.kill()  # one that has ended stays so
        self.process.wait()

    def told(self):
        """What Snakemake has said."""
        return (self.folder / "told.txt").read_text()

    def job_in_the_middle(self, rule, log):
        """The id of a running job of a rule whose script has opened its log."""
        opened = self.folder / "results" / "tiny" / "logs" / log

        def running():
            assert self.process.poll() is None, self.told()
            return opened.is_file() and self.slurm.jobs(rule, "RUNNING")

        return wait_for(running, self.told)[0]

    def wait_for_pending(self, rule):
        """Wait until a job of a rule is queued and can not start."""
        wait_for(lambda: self.slurm.jobs(rule, "PENDING"), self.told)

    def wait_for_end(self, job, state):
        """Wait until a job has ended in a state, such as CANCELLED."""
        wait_for(lambda: self.slurm.state_of(job) == state, self.told)

    def complete(self):
        """Wait for the end, which must be a success."""
        assert self.process.wait() == 0, self.told()


def different(local, remote):
    """The files of local results that are missing, or differ, in those of the cluster.

    Variables and attributes of netCDF files but the time of writing, every byte of tables and
    pictures.
    """
    names = [file.relative_to(local) for file in local.rglob("*")]
    names = [name for name in names if name.suffix in (".nc", ".csv", ".png")]
    assert len(names) > 40
    return [str(name) for name in names if not same(local / name, remote / name)]


def same(ours, theirs):
    """Whether two files hold the same."""
    if not theirs.is_file() or ours.suffix != ".nc":
        return theirs.is_file() and ours.read_bytes() == theirs.read_bytes()
    with xr.open_dataset(ours) as one, xr.open_dataset(theirs) as other:
        written = {"history": ""}
        return one.assign_attrs(written).identical(other.assign_attrs(written))


@pytest.mark.parametrize(
    "words, sentence",
    [
        (["start"], "start FOLDER, or"),
        (["start", "two words"], "has a character that slurm.conf can not hold"),
        (["begin", "there"], "start FOLDER, or"),
    ],
)
def test_the_script_for_slurm_refuses_with_a_sentence(words, sentence, tmp_path):
    refused = subprocess.run([SCRIPT, *words], cwd=tmp_path, capture_output=True, text=True)
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1
    assert (sentence if os.getuid() == 0 else "need root") in refused.stderr


@pytest.mark.skipif(os.getuid() != 0, reason="changes the user")
def test_slurm_is_refused_to_a_user_who_is_not_root():
    as_nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups", "bash", "-s"]
    script = SCRIPT.read_text()
    run = [*as_nobody, "start", "/tmp/no"]
    refused = subprocess.run(run, input=script, cwd="/", capture_output=True, text=True)
    assert refused.returncode == 2 and "need root" in refused.stderr


@pytest.mark.slow
def test_a_study_survives_the_faults_of_a_cluster(slurm, local_results, tmp_path, reliability):
    too_little = "_basis:mem_mb=attempt * attempt * 150"  # MB; the second attempt has enough
    with Run(slurm, tmp_path, *TABLES, "--set-resources", too_little) as run:
        cancelled = run.job_in_the_middle("_simulate", "simulate_from_4.log")
        slurm.ask("scancel", cancelled)
        run.wait_for_end(cancelled, "CANCELLED")

        drained = run.job_in_the_middle("_spectra", "spectra_from_4.log")
        slurm.set_node("drain")
        run.wait_for_pending("_identify")
        assert slurm.state_of(drained) == "COMPLETED"
        slurm.set_node("resume")

        lost = run.job_in_the_middle("_identify", "identify_from_4.log")
        slurm.set_node("down")  # comes back by itself, without its job
        run.wait_for_end(lost, "NODE_FAIL")
        run.complete()
    with Run(slurm, tmp_path) as rest:  # figures and page
        rest.complete()
    assert different(local_results, tmp_path / "results" / "tiny") == []
    same = "runs again by itself; every file has the same bits as on one machine"
    reliability.fault(
        "a job of a cluster (Slurm) asks for too little memory", f"it asks for more and {same}"
    )
    reliability.fault("a job of a cluster (Slurm) is cancelled", f"it {same}")
    reliability.fault("a node of a cluster (Slurm) goes down under a job", f"the job {same}")
    reliability.fault(
        "a node of a cluster (Slurm) is drained and resumed",
        "the running job ends, the next one waits; every file has the same bits as on one machine",
    )
