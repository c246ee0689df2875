"""A disk that is full or read-only: one sentence with file, folder and space left, and no half
file; once there is room, a rerun gives the same bits.
"""

import os
import shutil
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from tests.faults.runs import Runs, bits
from tests.support.tiny_study import ROOT, TinyStudy, tiny_values
from vibroimpact.io.records import RecordError, record_file, write_cells, write_record, write_text
from vibroimpact.io.whole_file import problem_of, whole_file
from vibroimpact_workflow.run_lock import take_folder

RECORD = "results/tiny/records/load_20_gap_0.0001_seed_0.nc"
REDIRECT = "from vibroimpact.io.job_log import redirect_output as to"
MILLION = np.random.default_rng(1).normal(size=10**6)
SERIES = xr.Dataset({"force": ("time", MILLION)})


def write_series_in_pieces(path):
    """Write a record as the simulation does, while it goes on."""
    parts = {"force": (("time",), "f8", {})}
    with record_file(path, xr.Dataset({"level": 1.0}), parts, {"time": MILLION.size}) as put:
        for first in range(0, MILLION.size, 8192):
            piece = slice(first, min(first + 8192, MILLION.size))
            put("force", piece, MILLION[piece])


def write_picture(path):
    """Write a file by another library."""
    with whole_file(path) as temporary:
        temporary.write_bytes(bytes(8 * MILLION.size))


WRITERS = {
    "record": lambda path: write_record(SERIES, path),
    "record in pieces": write_series_in_pieces,
    "table": lambda path: write_cells(("a",), [["x" * 100]] * 10**5, path),
    "text": lambda path: write_text("x" * 10**7, path),
    "picture": write_picture,
}


@pytest.mark.parametrize("kind", WRITERS)
def test_full_disk_is_named_with_file_folder_and_space(kind, small_disk, reliability):
    disk = small_disk("size=2m")
    path = disk / "records" / "file.nc"
    path.parent.mkdir()
    path.write_text("as it was")
    with pytest.raises(RecordError) as refusal:
        WRITERS[kind](path)
    expected = (
        f"{path}: cannot be written: {path.parent} is full: 0 MB left of 2 MB: free space and"
    )
    assert str(refusal.value).startswith(expected)
    assert [file.name for file in path.parent.iterdir()] == ["file.nc"]
    assert path.read_text() == "as it was"
    assert problem_of(disk) is None  # nothing keeps the space
    reliability.fault(
        "a full disk", "one sentence: file, folder, space left, remedy; no half file remains"
    )


@pytest.mark.parametrize("kind", WRITERS)
def test_no_space_for_even_a_temporary_file_is_named(kind, small_disk):
    disk = small_disk("size=1m")
    with pytest.raises(OSError, match="No space left"):
        (disk / "filling").write_bytes(bytes(2**21))
    with pytest.raises(RecordError, match=r"disk is full: 0 MB left of 1 MB: free space"):
        WRITERS[kind](disk / "file.nc")
    assert [file.name for file in disk.iterdir()] == ["filling"]


@pytest.mark.parametrize("kind", WRITERS)
def test_a_read_only_folder_is_named(kind, small_disk, reliability):
    disk = small_disk("size=16m")
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
    for path in (disk / "file.nc", disk / "new" / "file.nc"):
        with pytest.raises(RecordError, match=rf"{path}: cannot be written: .* is read-only: make"):
            WRITERS[kind](path)
    with pytest.raises(RecordError, match="run.txt: cannot be written: .* is read-only"):
        take_folder(disk / "run.txt", ["snakemake"])
    reliability.fault("a read-only result folder", "one sentence: file, folder, remedy")


def python(program, folder):
    """Run a program in a folder; returns the finished process."""
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-c", program]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.parametrize("content", ["print('word')", "raise KeyError('unforeseen')"])
def test_a_log_on_a_read_only_disk_is_named(content, small_disk):
    disk = small_disk("size=1m")
    subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
    done = python(f"{REDIRECT}; to('{disk}/a.log'); {content}", disk)
    assert done.returncode == 1 and "Traceback" not in done.stderr
    assert f"{disk}/a.log: cannot be written: {disk} is read-only" in done.stderr


def test_an_error_with_a_sentence_ends_a_log_without_traceback(tmp_path):
    read = "from vibroimpact.io.records import read_table as read; read('none.csv')"
    done = python(f"{REDIRECT}; to('a.log'); print('begun'); {read}", tmp_path)
    assert done.returncode == 1
    assert (tmp_path / "a.log").read_text().splitlines() == [
        "begun",
        "RecordError: none.csv: cannot be read (No such file or directory)",
    ]


def test_a_study_on_a_full_disk_continues_on_a_larger_one(
    finished_study, small_disk, tmp_path, reliability
):
    disk = small_disk("size=1m")
    study = TinyStudy(disk, tiny_values())
    with pytest.raises(RecordError, match="timeseries is full: 0 MB left of 1 MB"):
        study.simulate()
    assert not list(study.folder.glob("timeseries/*"))
    subprocess.run(["mount", "-o", "remount,size=64m", str(disk)], check=True)
    study.simulate()
    kinds = ("records", "timeseries", "spectra")
    assert bits(study.folder, *kinds) == bits(finished_study.folder, *kinds)
    reliability.fault("a full disk, then room", "a rerun gives the same bits")


@pytest.mark.slow
def test_a_run_on_a_full_or_read_only_disk_ends_with_a_sentence(
    small_disk, tmp_path, finished_study
):
    disk = small_disk("size=1m")
    (tmp_path / "study").mkdir()
    (tmp_path / "study" / "results").symlink_to(disk)
    runs = Runs(tmp_path / "study", tiny_values())
    code, told = runs.run(RECORD)
    assert code == 1 and "is full: 0 MB left of 1 MB: free space and run again" in told
    assert "HDF error" not in told and "Traceback" not in told
    subprocess.run(["mount", "-o", "remount,ro,size=64m", str(disk)], check=True)
    code, told = runs.run(RECORD)
    assert code == 1 and "Traceback" not in told
    assert "is read-only: make it writable" in told.strip().splitlines()[-1]
    subprocess.run(["mount", "-o", "remount,rw", str(disk)], check=True)
    code, told = runs.run(RECORD)
    assert code == 0, told
    found = bits(finished_study.folder, "records", "timeseries")
    assert bits(runs.results, "records", "timeseries") == {
        name: content for name, content in found.items() if "load_20_" in name
    }
    shutil.rmtree(runs.results)
