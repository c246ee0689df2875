"""A call on generated input: it must refuse with a sentence or be right.

It may not end in another exception, hang, take much memory, open a file outside the folder that it
was given, start a program or load code from data.
"""

import os
import platform
import re
import resource
import signal
import sys
import sysconfig
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SECONDS = 20
MEMORY = 10**9  # bytes beyond what the process has
STARTS = {"os.exec", "os.fork", "os.posix_spawn", "os.system", "subprocess.Popen"}
# What unpickling may name: the compiled kernels come from numba's cache.
PICKLED = ("llvmlite", "numba", "numpy", "vibroimpact")
# Python's own modules, and what numpy, netCDF and matplotlib look up of the system.
KNOWN = tuple(
    os.path.realpath(folder)
    for folder in (*sysconfig.get_paths().values(), sys.base_prefix, sys.prefix)
) + tuple(map(os.path.realpath, ("/dev", "/proc", "/sys", "/usr", "/lib")))
SOURCE = os.path.realpath(Path(__file__).parents[2])
platform.processor()  # libraries ask for it as they are imported, and it starts `uname` once

_watch: dict[str, Any] = {}


class Hang(BaseException):
    """A call that takes too long."""


def _harmless(module: str) -> bool:
    return module.split(".")[0] in PICKLED


def _hook(event: str, arguments: tuple) -> None:
    if not _watch:
        return
    if event in STARTS or (event == "pickle.find_class" and not _harmless(arguments[0])):
        _watch["broken"].append(f"{event} {arguments}"[:200])
    if event == "open" and isinstance(arguments[0], (str, bytes, os.PathLike)):
        path = os.path.realpath(os.fsdecode(arguments[0]))
        inside = any(Path(path).is_relative_to(folder) for folder in _watch["folders"])
        code = path.startswith(SOURCE) and Path(path).suffix in (".py", ".pyc", ".json", ".csv")
        if not (inside or code or path.startswith(KNOWN)):
            _watch["broken"].append(f"opened {path}")


sys.addaudithook(_hook)


@contextmanager
def _limits():
    """Set the limit of memory and the alarm; take both back at the end."""

    def ring(_signal, _frame):
        raise Hang(f"no end after {SECONDS} s")

    old_limits = resource.getrlimit(resource.RLIMIT_DATA)
    text = Path("/proc/self/status").read_text(encoding="ascii")
    used = 1024 * int(re.search(r"VmData:\s+(\d+)", text)[1])
    old_alarm = signal.signal(signal.SIGALRM, ring)
    resource.setrlimit(resource.RLIMIT_DATA, (used + MEMORY, old_limits[1]))
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old_alarm)
        resource.setrlimit(resource.RLIMIT_DATA, old_limits)


def guarded(
    call: Callable[[], Any],
    refusals: type[Exception] | tuple[type[Exception], ...],
    folders: Iterable[str | Path],
    names: Iterable[str] = (),
) -> tuple[str, Any]:
    """Return ("right", what the call returns) or ("refused", the sentence).

    refusals: the exceptions that carry a sentence for the user.
    folders: where the call may open files.
    names: texts of which a refusal must hold at least one, as the file's name; none by default.

    Raises AssertionError for anything else. The temporary folder is not allowed as such.
    """
    _watch.update(folders=[os.path.realpath(folder) for folder in folders], broken=[])
    try:
        with _limits():
            outcome = ("right", call())
    except refusals as error:
        outcome = ("refused", str(error))
    except (Exception, Hang) as error:
        raise AssertionError(f"{type(error).__name__}: {error}") from error
    finally:
        broken = list(_watch.get("broken", ()))
        _watch.clear()
    assert not broken, broken
    if outcome[0] == "refused":
        text = outcome[1]
        assert text.strip() and "Traceback" not in text, repr(text)
        expected = list(names)
        assert not expected or any(name in text for name in expected), (expected, text)
    return outcome


class Tried:
    """Counts of the outcomes of one property test, for the page of reliability."""

    def __init__(self) -> None:
        self.outcomes: Counter[str] = Counter()

    def add(self, outcome: tuple[str, Any]) -> tuple[str, Any]:
        """Count an outcome of `guarded` and return it."""
        self.outcomes[outcome[0]] += 1
        return outcome


@contextmanager
def folder_of_example():
    """A new folder for one generated example; `tmp_path` is one for all examples of a test."""
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)
