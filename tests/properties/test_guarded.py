"""The guard of the property tests sees what it is there for."""

import os
import pickle
import subprocess
import sys
import time

import pytest

from tests.properties import guarded as module
from tests.properties.guarded import Tried, guarded


def test_a_sentence_is_a_refusal_and_counts(tmp_path):
    tried = Tried()

    def refuse():
        raise ValueError("file.yaml: gap_m = -1 must be positive")

    assert tried.add(guarded(refuse, ValueError, [tmp_path], ["file.yaml"]))[0] == "refused"
    assert tried.add(guarded(lambda: 3, ValueError, [tmp_path])) == ("right", 3)
    assert tried.outcomes == {"refused": 1, "right": 1}


def test_other_exceptions_and_silent_refusals_fail(tmp_path):
    with pytest.raises(AssertionError, match="KeyError"):
        guarded(lambda: {}["x"], ValueError, [tmp_path])
    with pytest.raises(AssertionError, match="file.yaml"):
        guarded(lambda: int("x"), ValueError, [tmp_path], ["file.yaml"])


def test_files_outside_the_folder_fail(tmp_path):
    inside, outside = tmp_path / "in", tmp_path / "out.txt"
    inside.mkdir()
    outside.write_text("1", encoding="utf-8")
    (inside / "link").symlink_to(outside)
    for path in (outside, inside / "link"):
        with pytest.raises(AssertionError, match="out.txt"):
            guarded(path.read_text, ValueError, [inside])


class _Code:
    def __reduce__(self):
        return os.getcwd, ()


def test_programs_and_loaded_code_fail(tmp_path):
    with pytest.raises(AssertionError, match="Popen"):
        guarded(lambda: subprocess.run([sys.executable, "-V"]), ValueError, [tmp_path])
    data = pickle.dumps(_Code())
    with pytest.raises(AssertionError, match="find_class"):
        guarded(lambda: pickle.loads(data), ValueError, [tmp_path])


def test_hangs_and_large_memory_fail(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "SECONDS", 1)
    with pytest.raises(AssertionError, match="no end"):
        guarded(lambda: time.sleep(5), ValueError, [tmp_path])
    with pytest.raises(AssertionError, match="MemoryError"):
        guarded(lambda: bytearray(3 * 10**9), ValueError, [tmp_path])
