"""Arrays in files of other programs: sizes are checked before they are read, nothing is unpickled,
and a damaged file is one sentence.
"""

import math
import zipfile
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

# Largest size of a file after decompression: FREE_BYTES, or MOST_RATIO times a large one.
FREE_BYTES = 256 * 10**6
MOST_RATIO = 20


class ForeignFileError(ValueError):
    """A file that cannot be read; the message names it, the fault and the remedy."""


@contextmanager
def refused_if_damaged(path: str | Path, kind: str, remedy: str) -> Iterator[None]:
    """Turn whatever a reader raises into a ForeignFileError.

    Readers of damaged bytes raise anything, and their messages may hold the bytes.
    """
    try:
        yield
    except ForeignFileError:
        raise
    except MemoryError as error:
        raise ForeignFileError(
            f"{path}: claims more values than fit into the memory: {remedy}"
        ) from error
    except Exception as error:
        raise ForeignFileError(
            f"{path}: cannot be read as {kind}: it is damaged or of another kind: {remedy}"
        ) from error


def require_size(path: str | Path, size: float, what: str) -> None:
    """Raise ForeignFileError if the content of a file would take far more memory than the file.

    size: bytes.
    """
    if size > max(FREE_BYTES, MOST_RATIO * Path(path).stat().st_size):
        raise ForeignFileError(
            f"{path}: {what} would take {size / 1e6:.4g} MB, far more than the file: write it anew,"
            " a large matrix as a sparse one"
        )


def load_npz(path: str | Path) -> dict[str, np.ndarray]:
    """Return {name: array} of a NumPy .npz file. Raises ForeignFileError."""
    remedy = "write it anew with numpy.savez or scipy.sparse.save_npz"
    with refused_if_damaged(path, "NumPy .npz", remedy), zipfile.ZipFile(path) as archive:
        members = archive.infolist()
        require_size(path, sum(member.file_size for member in members), "it")
        for member in members:
            with archive.open(member) as file:
                _require_array(path, member, file)
        require_once(path, [member.filename for member in members])
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}


def _require_array(path: str | Path, member: zipfile.ZipInfo, file: Any) -> None:
    """Raise unless a member of a .npz file is an array of numbers or text that it holds in full."""
    read_header = {
        1: np.lib.format.read_array_header_1_0,
        2: np.lib.format.read_array_header_2_0,
    }[np.lib.format.read_magic(file)[0]]
    shape, _, dtype = read_header(file)
    if dtype.hasobject:
        raise ForeignFileError(
            f"{path}: {member.filename} holds Python objects, which are not read: save arrays of"
            " numbers"
        )
    if math.prod(shape) * dtype.itemsize > member.file_size:
        raise ForeignFileError(
            f"{path}: {member.filename} claims the shape {shape}, which it does not hold: write it"
            " anew"
        )


def require_once(path: str | Path, names: list[str]) -> None:
    """Raise ForeignFileError if a name stands twice."""
    twice = [name for name, times in Counter(names).items() if times > 1]
    if twice:
        raise ForeignFileError(f"{path}: holds {twice[0]} twice: keep one of the two")
