"""The cache of compiled code: reused by later processes, never stale after an edit in any file."""

import os
import shutil
import subprocess
import sys

import pytest

from vibroimpact.integration.kernels.compiled import SOURCES, source_digest

FILES = sorted(file.name for file in SOURCES.glob("*.py"))
# One filter tap of 2 applied to ones, and whether the machine code came out of the cache.
PROGRAM = """
import numpy as np
from kernels.decimation import decimate
from kernels.lanes import LANES
out = np.zeros((1, 1, 1), np.float32)
decimate(np.ones((1, 1, LANES)), np.pad([2.0], 3), out, 0, 1, np.zeros((4, LANES)))
print(out[0, 0, 0], sum(decimate.stats.cache_hits.values()))
"""


@pytest.fixture
def kernels(tmp_path):
    """A copy of the kernels that stands alone."""
    shutil.copytree(SOURCES, tmp_path / "kernels", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "kernels"


def run(folder, **environment):
    """(result, cache hits) of the program in a process of its own."""
    settings = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"} | {
        "PYTHONPATH": str(folder.parent),
        **environment,
    }
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=settings, capture_output=True, text=True, check=True
    )
    result, hits = done.stdout.split()
    return float(result), int(hits)


def edit(folder):
    """Make fma add 1: an edit in a file that the entry point only imports."""
    file = folder / "lanes.py"
    text = file.read_text()
    old = 'return call_intrinsic(builder, "fma", _in_lanes(builder, sig.args, args))'
    new = old.replace("return ", "value = ") + (
        "\n        return builder.fadd(value, ir.Constant(VECTOR, [1.0] * LANES))"
    )
    assert text.count(old) == 1
    file.write_text(text.replace(old, new))


def test_machine_code_is_cached_and_an_edit_is_seen(kernels):
    assert run(kernels) == (2.0, 0)
    assert run(kernels) == (2.0, 1)
    original = (kernels / "lanes.py").read_text()
    edit(kernels)
    edited, hits = run(kernels)
    assert edited > 2.0 and hits == 0
    (kernels / "lanes.py").write_text(original)
    assert run(kernels) == (2.0, 1)


@pytest.mark.parametrize("name", FILES)
def test_an_edit_of_any_file_changes_the_cache_folder(kernels, name):
    before = source_digest(kernels)
    (kernels / name).write_text((kernels / name).read_text() + "\n")
    assert source_digest(kernels) != before


def test_read_only_sources_use_the_users_cache(kernels, tmp_path):
    (kernels / "__pycache__").write_text("")  # no folder can be made here
    assert run(kernels, XDG_CACHE_HOME=str(tmp_path / "user")) == (2.0, 0)
    assert run(kernels, XDG_CACHE_HOME=str(tmp_path / "user")) == (2.0, 1)
    assert run(kernels, XDG_CACHE_HOME=str(kernels / "lanes.py")) == (2.0, 0)  # nowhere


def test_the_cache_folder_can_be_given(kernels, tmp_path):
    assert run(kernels, NUMBA_CACHE_DIR=str(tmp_path / "given")) == (2.0, 0)
    assert [each.name for each in (tmp_path / "given").iterdir()] == [
        f"kernels-{source_digest(kernels)}"
    ]
    assert not list((kernels / "__pycache__").glob("kernels-*"))
