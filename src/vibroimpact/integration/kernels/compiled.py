"""Decorators for compiled functions, and the cache of their machine code.

numba keys its cache on the file that holds the entry point. It does not see an edit in another file
and would then return the old physics. The cache folder is therefore named by a digest of all files
of this folder: an edit in any of them starts from an empty cache. A file of the cache that is
damaged counts as none: it is compiled and written again. Nothing in this folder may import from the
rest of the library.
"""

import hashlib
import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from numba import njit
from numba.core import config as numba_config
from numba.core.caching import IndexDataCacheFile

config: Any = numba_config  # its settings are made at run time
Function = TypeVar("Function", bound=Callable[..., Any])

SOURCES = Path(__file__).parent
PACKAGE = __name__.split(".")[-2]  # see lanes.LANES
# Without numba's reference counts: counting each array of a table at each use costs five times the
# arithmetic. No compiled function allocates; work space is handed in.
WITHOUT_REFERENCE_COUNTS: dict[str, Any] = {"_nrt": False}
# A function that only other compiled functions call needs no door for Python or C, whose code to
# unpack the tables takes longer to compile than the function.
ENTRY: dict[str, Any] = {**WITHOUT_REFERENCE_COUNTS, "nogil": True, "no_cfunc_wrapper": True}
INLINED: dict[str, Any] = {
    **WITHOUT_REFERENCE_COUNTS,
    "forceinline": True,
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
DIGEST_BYTES = hashlib.sha256().digest_size
# Said once, if every process has to compile.
NO_CACHE = (
    "vibroimpact: the compiled kernels can not be kept ({reason}): every job compiles them again;"
    " set NUMBA_CACHE_DIR to a folder that can be written"
)
COMPILING = (
    "vibroimpact: the kernels are compiled, once for this machine: 15 s, or a minute on a slow one"
)
SAID: set[str] = set()  # sentences, by all copies of this module


def source_digest(folder: Path = SOURCES) -> str:
    """Digest of the names and contents of all Python files in a folder; "" if there are none."""
    files = sorted(folder.glob("*.py"))
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.name.encode() + b"\0" + file.read_bytes() + b"\0")
    return digest.hexdigest()[:16] if files else ""


IMPORTED_SOURCES = source_digest()


def inlined(function: Function) -> Function:
    """The function compiled into every compiled function that calls it."""
    return njit(**INLINED)(function)


def entry_point(function: Function) -> Function:
    """The compiled function, for calls from Python, its machine code cached on disk. Other threads
    of Python go on while it runs.

    There is no cache if no folder can be written, if the sources are not plain files, or if they
    have changed since this process imported them.
    """
    if IMPORTED_SOURCES and source_digest() == IMPORTED_SOURCES:
        for place in cache_places():
            compiled = _compiled_with_cache(function, place / f"{PACKAGE}-{IMPORTED_SOURCES}")
            if compiled is not None:
                return compiled
        _say_once(NO_CACHE, ", ".join(f"no writing in {place}" for place in cache_places()))
    return njit(**ENTRY)(function)


def _say_once(sentence: str, reason: str = "") -> None:
    if sentence not in SAID:
        SAID.add(sentence)
        # to the terminal, even if the output of a job goes to its log
        print(sentence.format(reason=reason), file=sys.__stderr__ or sys.stderr, flush=True)


def cache_places() -> list[Path]:
    """Parent folders for the cache, the first choice first: NUMBA_CACHE_DIR if it is set, else
    __pycache__ of the sources, then the user's cache folder.
    """
    if config.CACHE_DIR:
        return [Path(config.CACHE_DIR)]
    user = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    return [SOURCES / "__pycache__", user / "vibroimpact"]


def _compiled_with_cache(function, folder):
    """The compiled function with its cache in a folder; None if numba cannot write there."""
    setting, config.CACHE_DIR = config.CACHE_DIR, str(folder)
    try:
        compiled = njit(cache=True, **ENTRY)(function)
    except RuntimeError:  # numba found no folder at all that it can write to
        return None
    finally:
        config.CACHE_DIR = setting
    # numba falls back on a folder of its own choice, which sees edits of one file only.
    if not Path(compiled.stats.cache_path).is_relative_to(folder):
        return None
    cache: Any = compiled._cache
    cache._cache_file = CheckedCacheFile(
        cache.cache_path, cache._impl.filename_base, cache._impl.locator.get_source_stamp()
    )
    return compiled


class CheckedCacheFile(IndexDataCacheFile):
    """The files of numba's cache, each with a digest of its content behind it.

    Without one, numba fails on a damaged file until someone deletes it, or runs damaged code.
    """

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        with super()._open_for_write(filepath) as file:
            content = io.BytesIO()
            yield content
            file.write(content.getvalue() + hashlib.sha256(content.getvalue()).digest())

    def _load_index(self) -> dict:
        # unpickling ends before the digest
        return super()._load_index() if _is_whole(self._index_path) else {}

    def _load_data(self, name: str) -> Any:
        if not _is_whole(self._data_path(name)):
            raise OSError("damaged")  # which numba takes for a file that is not there
        return super()._load_data(name)

    def load(self, key: Any) -> Any:
        """Return machine code; None, with an announcement, if it has to be compiled."""
        data = super().load(key)
        if data is None:
            _say_once(COMPILING)
        return data

    def save(self, key: Any, data: Any) -> None:
        """Save machine code; a disk that is full or read-only is no reason to stop."""
        try:
            super().save(key, data)
        except OSError as error:
            _say_once(NO_CACHE, str(error))


def _is_whole(path: str) -> bool:
    """Return whether a file of the cache is there and ends with the digest of its content."""
    try:
        content = Path(path).read_bytes()
    except OSError:
        return False
    return hashlib.sha256(content[:-DIGEST_BYTES]).digest() == content[-DIGEST_BYTES:]
