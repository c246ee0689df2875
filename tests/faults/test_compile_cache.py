"""A stale, damaged or read-only cache of compiled kernels costs time, and nothing else."""

import os
import shutil
import subprocess
import sys

import pytest

from vibroimpact.integration.kernels.compiled import COMPILING, SOURCES

# One filter tap of 2 applied to ones, and whether the machine code came out of the cache.
PROGRAM = """
import numpy as np
from kernels.decimation import decimate
from kernels.lanes import LANES
out = np.zeros((1, 1, 1), np.float32)
decimate(np.ones((1, 1, LANES)), np.pad([2.0], 3), out, 0, 1, np.zeros((4, LANES)))
print(out[0, 0, 0], sum(decimate.stats.cache_hits.values()))
"""
COMPILED, FROM_CACHE = "2.0 0", "2.0 1"


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A folder with a copy of the kernels, and their cache beside them."""
    folder = tmp_path_factory.mktemp("filled")
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(SOURCES, folder / "kernels", ignore=ignored)
    assert run(folder) == (COMPILED, COMPILING)
    assert run(folder) == (FROM_CACHE, "")
    return folder


@pytest.fixture
def cache(filled):
    """The files of the cache, which are put back after the test."""
    folder = filled / "cache"
    shutil.copytree(folder, filled / "as_it_was")
    yield folder
    shutil.rmtree(folder, ignore_errors=True)
    (filled / "as_it_was").rename(folder)


def run(folder, cache="cache"):
    """(what the program prints, what it says beside that) in a process of its own."""
    settings = {"PYTHONPATH": str(folder), "NUMBA_CACHE_DIR": str(folder / cache)}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip(), done.stderr.strip()


def flip_a_bit(content):
    """One wrong bit in the middle."""
    at = len(content) // 2
    return content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]


DAMAGES = {
    "empty": lambda content: b"",
    "cut": lambda content: content[: len(content) // 2],
    "zeros": lambda content: bytes(len(content)),
    "one bit": flip_a_bit,
    "without digest": lambda content: content[:-32],
    "foreign": lambda content: b"cos\nsystem\n(S'true'\ntR.",
}


QUICK = ("cut", "one bit")


@pytest.mark.parametrize(
    "damage",
    [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in DAMAGES],
)
def test_a_damaged_cache_is_built_again_by_itself(filled, cache, damage, reliability):
    files = [file for file in cache.rglob("*") if file.suffix in (".nbi", ".nbc")]
    assert {file.suffix for file in files} == {".nbi", ".nbc"}
    for file in files:
        file.write_bytes(DAMAGES[damage](file.read_bytes()))
    assert run(filled) == (COMPILED, COMPILING)
    assert run(filled) == (FROM_CACHE, "")
    reliability.fault("a damaged or stale compile cache", "compiled again by itself; same numbers")


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_a_missing_file_of_the_cache_is_made_again(filled, cache, suffix):
    for file in cache.rglob(f"*{suffix}"):
        file.unlink()
    assert run(filled) == (COMPILED, COMPILING)
    assert run(filled) == (FROM_CACHE, "")


@pytest.mark.usefixtures("cache")
def test_a_stale_cache_of_an_edited_kernel_is_not_used(filled):
    file = filled / "kernels" / "panels.py"
    text = file.read_text()
    file.write_text(text + "\n# edited\n")
    assert run(filled) == (COMPILED, COMPILING)
    file.write_text(text)


def test_a_read_only_cache_falls_back_with_a_note(filled, small_disk, reliability):
    disk = small_disk("size=8m,ro")
    told, note = run(filled, disk)
    assert told == COMPILED
    assert f"kernels can not be kept (no writing in {disk})" in note and len(note.split("\n")) == 1
    reliability.fault("a read-only compile cache", "compiles in each job, with a note")


def test_a_full_disk_under_the_cache_stops_nothing(filled, small_disk, reliability):
    disk = small_disk("size=16k")
    told, note = run(filled, disk)
    assert told == COMPILED and "kernels can not be kept" in note and COMPILING in note
    assert "Traceback" not in note
    reliability.fault("a full disk under the compile cache", "compiles in each job, with a note")
