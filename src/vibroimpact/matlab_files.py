"""Arrays in MATLAB files of version 4 to 7.

Version 5 and later is read here, since the reader of SciPy 1.17 crashes on some damaged files.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from .foreign_arrays import ForeignFileError, refused_if_damaged, require_once, require_size

if TYPE_CHECKING:
    from scipy import sparse

HEADER = 128  # bytes
VERSION_73 = (b"\0\2IM", b"\2\0MI")  # how the header of an HDF5 file of MATLAB ends
BYTE_ORDER = {b"IM": "<", b"MI": ">"}  # what stands at the end of the header of a v5 file
MATRIX, COMPRESSED = 14, 15
NUMBERS = {  # by the type of a part
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
SPARSE, DENSE = 5, range(6, 16)  # classes of variables; others hold no numbers
CHUNK = 2**20


def load_matlab(path: str | Path) -> dict[str, Any]:
    """Return {name: array or sparse matrix} of the numeric variables of a file.

    Raises ForeignFileError.
    """
    with refused_if_damaged(path, "MATLAB .mat", "write it anew with save -v7"):
        with open(path, "rb") as file:
            header = file.read(HEADER)
            if header[-4:] in VERSION_73:
                raise ForeignFileError(f"{path}: is of MATLAB 7.3: save it with save -v7")
            order = BYTE_ORDER.get(header[-2:])
            if order is None:
                return _version_4(path)
            found = [
                variable
                for content in _variables(path, file, order)
                if (variable := _variable(content, order)) is not None
            ]
        require_once(path, [name for name, _ in found])
        return dict(found)


def _version_4(path: str | Path) -> dict[str, Any]:
    """Return the variables of a file of version 4, which knows no compression."""
    from scipy import io  # imported here: half a second that other formats save

    known = io.whosmat(path)
    require_once(path, [name for name, _, _ in known])
    for name, shape, kind in known:
        if kind != "sparse":
            require_size(path, 8.0 * math.prod(map(int, shape)), name)
    return {name: value for name, value in io.loadmat(path).items() if not name.startswith("__")}


def _variable(content: bytes, order: str) -> tuple[str, Any] | None:
    """Return (name, array) of a variable, None where it holds no numbers."""
    parts = _parts(content, order)
    (flags, _), (shape, _), (_, name) = next(parts), next(parts), next(parts)
    kind = int(flags[0]) & 0xFF
    if kind != SPARSE and kind not in DENSE:
        return None
    numbers = [values for values, _ in parts]
    sizes = tuple(map(int, shape))
    if kind == SPARSE:
        return name.decode("latin-1"), _sparse(sizes, numbers)
    values, *imaginary = numbers
    whole = values + 1j * imaginary[0] if imaginary else values
    return name.decode("latin-1"), whole.reshape(sizes, order="F")


def _sparse(shape: tuple[int, ...], numbers: list[np.ndarray]) -> sparse.csc_array:
    """Return the matrix of rows, starts of columns, and values (real, then imaginary if any)."""
    from scipy import sparse

    rows, starts, values, *imaginary = numbers
    whole = values + 1j * imaginary[0] if imaginary else values.astype(float)
    count = int(starts[-1])
    matrix = sparse.csc_array((whole[:count], rows[:count], starts), shape=shape)
    matrix.check_format(full_check=True)
    return matrix


def _variables(path: str | Path, file: BinaryIO, order: str) -> Iterator[bytes]:
    """Yield the content of each variable."""
    while len(tag := file.read(8)) == 8:
        kind, size = struct.unpack(f"{order}II", tag)
        end = file.tell() + size
        if end > Path(path).stat().st_size:
            raise ForeignFileError(f"{path}: ends before its last variable does: copy it again")
        if kind == COMPRESSED:
            content = _expanded(path, file.read(size))
            kind, size = struct.unpack(f"{order}II", content[:8])
            content = content[8:]
        else:
            content = file.read(size)
        if kind == MATRIX:
            yield content[:size]
        file.seek(end)


def _expanded(path: str | Path, packed: bytes) -> bytes:
    """Return compressed bytes as they were, within the memory that the file may take."""
    stream, out = zlib.decompressobj(), bytearray()
    while packed and not stream.eof:
        out += stream.decompress(packed, CHUNK)
        packed = stream.unconsumed_tail
        require_size(path, len(out), "it")
    if not stream.eof:
        raise ValueError("compressed bytes are cut")
    return bytes(out)


def _parts(content: bytes, order: str) -> Iterator[tuple[np.ndarray, bytes]]:
    """Yield (numbers, bytes) of each part of a variable: flags, shape, name, values."""
    at = 0
    while at + 8 <= len(content):
        kind, size = struct.unpack_from(f"{order}II", content, at)
        at += 8
        if kind >> 16:  # up to four bytes stand in the tag itself
            kind, size, begin = kind & 0xFFFF, kind >> 16, at - 4
        else:
            begin = at
            at += -(-size // 8) * 8
        data = content[begin : begin + size]
        if len(data) < size or kind not in NUMBERS:
            raise ValueError("a part of a variable is cut or of another kind")
        yield np.frombuffer(data, dtype=order + NUMBERS[kind]).astype(NUMBERS[kind]), data
