"""Runs of the workflow in a folder of their own, with the library and the kernels of this checkout,
that can be stopped in the middle.
"""

import hashlib
import os
import signal
import subprocess
import time
from pathlib import Path

import netCDF4
import yaml

from tests.support.snakemake_runs import RULES, command

PATIENCE_S = 120.0


class Runs:
    """Runs of one configuration in a folder."""

    def __init__(self, folder, values):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / "mine.yaml").write_text(yaml.safe_dump(values), encoding="utf-8")
        self.results = self.folder / "results" / values["study"]
        self._started = []

    def start(self, *arguments, **environment):
        """Start snakemake in a process group of its own; returns the process."""
        clean = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        process = subprocess.Popen(
            command(*RULES, "-j1", *arguments, "--configfile", "mine.yaml"),
            cwd=self.folder,
            env=clean | environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self._started.append(process)
        return process

    def run(self, *arguments, **environment):
        """Run snakemake; returns (exit code, what it printed)."""
        process = self.start(*arguments, **environment)
        told, _ = process.communicate(timeout=10 * PATIENCE_S)
        return process.returncode, told

    def wait_for(self, process, pattern):
        """Wait until a file of the results is there."""
        end = time.monotonic() + PATIENCE_S
        while not list(self.results.glob(pattern)):
            assert process.poll() is None, process.communicate()[0]
            assert time.monotonic() < end, f"no {pattern}"
            time.sleep(0.01)

    def wait_until_ended(self, jobs):
        """Wait until none of the processes of these numbers is at work."""
        end = time.monotonic() + PATIENCE_S
        while any(Path(f"/proc/{job}/exe").exists() for job in jobs):  # that of a zombie is gone
            assert time.monotonic() < end, f"still at work: {jobs}"
            time.sleep(0.01)

    def jobs(self, process):
        """The processes that a running snakemake has started, and theirs."""
        parents = {}
        for entry in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = entry.read_text().rpartition(")")[2].split()
            except OSError:  # it has just ended
                continue
            parents.setdefault(int(fields[1]), []).append(int(entry.parent.name))
        found, waiting = [], [process.pid]
        while waiting:
            children = parents.get(waiting.pop(), [])
            found += children
            waiting += children
        return found

    def end(self):
        """Kill what is left of the process groups that were started."""
        for process in self._started:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
            process.stdout.close()


def bits(results, *kinds):
    """{file: digest of its variables, or of the whole table} of the result files of some kinds."""
    return {
        path.relative_to(results).as_posix(): content_of(path)
        for kind in kinds
        for path in sorted(Path(results).glob(f"{kind}/*"))
    }


def content_of(path):
    """{variable: digest} of a record, the digest of another file."""
    if path.suffix != ".nc":
        return digest(path.read_bytes())
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        return {name: digest(bytes_of(variable)) for name, variable in file.variables.items()}


def bytes_of(variable):
    """The bytes of a netCDF variable."""
    values = variable[...]
    return "\0".join(values).encode() if variable.dtype is str else values.tobytes()


def digest(content):
    """The digest of bytes: what differs is told in a line."""
    return hashlib.sha256(content).hexdigest()
