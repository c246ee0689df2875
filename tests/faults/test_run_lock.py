"""One run at a time in a folder: the lock of a dead run is nobody's."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.support.tiny_study import ROOT
from vibroimpact.io.whole_file import HOST, RecordError, process_lives, remove_left_over, whole_file
from vibroimpact_workflow.run_lock import FolderTaken, require_past, start_text, take_folder

PROGRAM = """
import sys
import time
from pathlib import Path
from vibroimpact_workflow.run_lock import take_folder
killed = take_folder(sys.argv[1], ["/bin/snakemake", "-j1", "all"])
print(f"after {killed}" if killed else "taken", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def start():
    """Start a process that takes a folder and keeps it until its input ends."""
    started = []

    def begin(mark):
        process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, str(mark)],
            env=os.environ | {"PYTHONPATH": f"{ROOT / 'src'}:{ROOT / 'workflow'}"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process, process.stdout.readline().strip()

    yield begin
    for process in started:
        process.kill()
        process.communicate()


def lock_of(tmp_path, host=HOST):
    """The lock of a run that was killed."""
    lock = tmp_path / "run.txt"
    lock.write_text(f"process 12 on {host}, begun 2026-01-01 10:00:00 UTC (snakemake -j2)")
    return lock


def test_second_run_in_a_folder_is_refused_and_names_first(start, tmp_path, reliability):
    first, told = start(tmp_path / "run.txt")
    assert told == "taken"
    with pytest.raises(FolderTaken, match=rf"process {first.pid} on .*\(snakemake -j1 all\): wait"):
        take_folder(tmp_path / "run.txt", ["snakemake"])
    first.communicate(timeout=20)
    assert start(tmp_path / "run.txt")[1] == "taken"  # it ended itself
    reliability.fault(
        "two runs started at once in one folder", "the second is refused, names the first"
    )


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_killed_run_leaves_a_folder_that_can_be_taken(start, tmp_path, number):
    first, _ = start(tmp_path / "run.txt")
    first.send_signal(number)
    first.wait(timeout=20)
    second, told = start(tmp_path / "run.txt")
    assert f"after process {first.pid} on {HOST}" in told
    second.communicate(timeout=20)
    assert start(tmp_path / "run.txt")[1] == "taken"


def test_a_run_on_another_machine_is_never_overruled(tmp_path):
    lock = lock_of(tmp_path, host="node-7")
    with pytest.raises(FolderTaken, match="on node-7, begun .*no longer lives, delete .*run.txt"):
        take_folder(lock, ["snakemake"])
    assert "on node-7, begun" in lock.read_text()


def test_a_file_system_without_locks_goes_by_the_text(tmp_path, monkeypatch):
    def unknown(*arguments):
        raise OSError("no locks available")

    monkeypatch.setattr("fcntl.flock", unknown)
    with pytest.raises(FolderTaken, match="process 12 .*no longer lives, delete .*run.txt"):
        take_folder(lock_of(tmp_path), ["snakemake"])
    assert take_folder(tmp_path / "other.txt", ["snakemake"]) == ""


@pytest.mark.parametrize("content", ["", "no run", "{}", "process 1"])
def test_a_damaged_text_names_no_run(tmp_path, content):
    (tmp_path / "run.txt").write_text(content)
    assert take_folder(tmp_path / "run.txt", ["snakemake"]) == ""


def test_temporary_files_of_dead_processes_alone_are_removed(start, tmp_path, reliability):
    process, _ = start(tmp_path / "run.txt")
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    names = [
        f".a.nc.{host}.{number}" for host in (HOST, "node-7") for number in (dead.pid, process.pid)
    ]
    kept = [".a.nc", "a.nc.1", ".hidden.txt", f"a.nc.{HOST}.{dead.pid}"]
    for name in (*names, *kept):
        (tmp_path / name).touch()
    with whole_file(tmp_path / "mine.csv") as temporary:
        temporary.touch()
        assert remove_left_over([tmp_path, tmp_path / "none"]) == [tmp_path / names[0]]
    there = {path.name for path in tmp_path.iterdir()}
    assert there == {*names[1:], *kept, "mine.csv", "run.txt"}
    reliability.fault(
        "temporary files of a killed job", "the next run removes those of dead processes"
    )


def test_a_run_says_that_it_continues_a_killed_one(tmp_path):
    assert start_text("", []) == []
    killed, removed = start_text(take_folder(lock_of(tmp_path), ["snakemake"]), [tmp_path])
    assert killed.startswith(f"The last run was killed: process 12 on {HOST}, begun 2026-01-01 10:")
    assert removed == "1 temporary files of killed jobs are removed."


@pytest.mark.skipif(not Path("/proc/self/stat").is_file(), reason="Linux tells states of processes")
def test_a_process_that_has_ended_unasked_is_not_alive():
    """A killed job stays in the table of processes until its parent asks for its exit status."""
    child = subprocess.Popen([sys.executable, "-c", "pass"])
    os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
    assert not process_lives(child.pid)
    child.wait()
    assert process_lives(os.getpid())


def test_a_file_dated_in_the_future_is_named_with_the_remedy(tmp_path, reliability):
    now, ahead = tmp_path / "now.nc", tmp_path / "ahead file.nc"
    now.write_text("")
    ahead.write_text("")
    require_past([now, ahead, tmp_path / "not there yet"])
    os.utime(ahead, (time.time() + 7200.0,) * 2)
    with pytest.raises(RecordError, match="ahead file.nc is dated 2 hours in the future.*touch '"):
        require_past([now, ahead])
    assert now.exists() and ahead.exists()
    reliability.fault(
        "a file dated in the future, as by another clock",
        "refused before any job, with the remedy; nothing is deleted",
    )
