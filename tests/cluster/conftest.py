"""A study of seconds, run on this machine and through Slurm."""

import fcntl
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import pytest
import yaml

from tests.support import snakemake_runs
from tests.support.tiny_study import ROOT, tiny_values

SCRIPT = Path(__file__).with_name("slurm_on_loopback.sh")
LINK = Path("/etc/slurm/slurm.conf")
PROFILE = ROOT / "workflow" / "profiles" / "slurm"
PATIENCE_S = 300  # until a job of a loaded machine has got as far as a test waits for


def command(folder, *arguments):
    """The command that runs the tiny study, with one load, in a folder."""
    configuration = folder / "tiny.yaml"
    values = tiny_values(grid={"load_rms_N": [4.0], "gap_m": [1e-4], "seeds": 2})
    configuration.write_text(yaml.safe_dump(values))
    places = ["--configfile", configuration, "--directory", folder]
    return snakemake_runs.command(*snakemake_runs.RULES, *places, *arguments)


def wait_for(what, told):
    """What a function returns as soon as it is true; a failure with a sentence if it never is."""
    end = time.monotonic() + PATIENCE_S
    while not (found := what()):
        assert time.monotonic() < end, told()
        time.sleep(0.2)
    return found


@pytest.fixture(scope="session")
def local_results(tmp_path_factory):
    """The folder of the tiny study's results, run on this machine."""
    folder = tmp_path_factory.mktemp("local")
    run = subprocess.run(command(folder, "-j2"), cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return folder / "results" / "tiny"


def missing_for_slurm():
    """Why Slurm can not be started here, or ""."""
    if os.getuid() != 0:
        return "Slurm's daemons need root"
    path = os.pathsep.join([os.environ["PATH"], "/usr/sbin", "/sbin"])
    absent = [
        name for name in ("slurmctld", "slurmd", "munged") if not shutil.which(name, path=path)
    ]
    if absent:
        return f"not installed: {', '.join(absent)}"
    return f"{LINK} exists: this machine has a Slurm" if LINK.exists() else ""


class Slurm:
    """A Slurm of one node on this machine, and what its administrator can do."""

    def __init__(self, folder):
        self.folder = folder

    def daemons(self, verb):
        """Start or stop the cluster."""
        done = subprocess.run([SCRIPT, verb, self.folder], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr

    def ask(self, *words):
        """The lines that a program of Slurm prints."""
        return subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()

    def jobs(self, rule, state):
        """The ids of the jobs of a rule in a state, such as RUNNING."""
        rows = [line.split("|") for line in self.ask("squeue", "--all", "-ho", "%i|%T|%k")]
        return [
            job for job, now, about in rows if now == state and about.startswith(f"rule_{rule}")
        ]

    def state_of(self, job):
        """The state of a job, such as COMPLETED."""
        (line,) = self.ask("scontrol", "--oneliner", "show", "job", job)
        return line.split("JobState=")[1].split()[0]

    def set_node(self, state):
        """Set the state of the node: drain, down or resume."""
        self.ask("scontrol", "update", "nodename=localhost", f"state={state}", "reason=test")


@pytest.fixture(scope="session")
def slurm(tmp_path_factory):
    """A Slurm of one node; skips where there can be none. One test process has it at a time."""
    with open(Path(tempfile.gettempdir(), "vibroimpact_slurm.lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if why := missing_for_slurm():
            pytest.skip(why)
        cluster = Slurm(tmp_path_factory.mktemp("slurm"))
        cluster.daemons("start")
        yield cluster
        cluster.daemons("stop")
