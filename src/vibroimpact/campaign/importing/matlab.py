"""Signals of MATLAB files: v5 through scipy, v7.3 through h5py."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np

from vibroimpact.records import MOST_PACKED, MOST_READ, RecordError, is_hdf5, read_hdf5_arrays

from .arrays import Arrays, signals_of_arrays
from .signals import ImportProblem, Signal

HEADER, TAG = 128, 8  # bytes
BYTE_ORDERS = {b"IM": "<", b"MI": ">"}
MATRIX, COMPRESSED = 14, 15  # types of the elements of a file
AGAIN = "export it again"


def read_matlab(path: str | Path) -> list[Signal]:
    """Return the Signals of a MAT file, v5 or v7.3.

    Fields of structures are named structure.field. The rate is Fs, or follows from a time vector.
    Raises ImportProblem.
    """
    if is_hdf5(path):
        try:
            columns = read_hdf5_arrays(path)
        except RecordError as error:
            raise ImportProblem(str(error)) from error
    else:
        columns = _matlab_5(path)
    return signals_of_arrays(Arrays(path, columns))


def _matlab_5(path):
    """Return {name: array} of a file of v5. Raises ImportProblem."""
    from scipy.io import loadmat  # imported here: other files do not need it

    _check_elements(path)
    try:
        content = loadmat(path, simplify_cells=True)
    except Exception as error:  # a damaged file makes scipy raise almost any exception
        raise ImportProblem(
            f"{path}: can not be read as a MAT file ({error or type(error).__name__}): it is"
            f" damaged, {AGAIN}"
        ) from error
    return dict(
        _flat({name: value for name, value in content.items() if not name.startswith("__")})
    )


def _check_elements(path):
    """Raise ImportProblem unless the elements of a v5 file lie within it, one after the other.

    scipy takes the memory that an element claims before it reads it, and skips what it can not
    name.
    """
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        head = file.read(HEADER)
        order = BYTE_ORDERS.get(head[-2:])
        if len(head) < HEADER or order is None:
            raise ImportProblem(
                f"{path}: is no MAT file of v5 or v7.3: save it again with -v7 or -v7.3"
            )
        total = 0
        for place, kind, stored, claimed in _elements(file, order, size):
            if kind != MATRIX or place + TAG + stored > size or claimed > MOST_PACKED * stored:
                raise ImportProblem(
                    f"{path}: byte {place}: no variable begins here, or it is longer than the"
                    f" file: it is damaged or cut short, {AGAIN}"
                )
            total += claimed
    if total > MOST_READ:
        raise ImportProblem(
            f"{path}: holds {total:.3g} bytes of numbers, at most {MOST_READ:.0e} are read from one"
            " file: store fewer signals or a shorter record in each"
        )


def _elements(file: BinaryIO, order: str, size: int) -> Iterator[tuple[int, int, int, int]]:
    """Yield (place, type, bytes stored, bytes claimed) of each element of a v5 file."""
    place = HEADER
    while place < size:
        file.seek(place)
        kind, stored = _tag(file.read(TAG), order)
        claimed = stored
        if kind == COMPRESSED:
            try:
                inner = zlib.decompressobj().decompress(file.read(min(stored, 4096)), TAG)
            except zlib.error:
                inner = b""
            kind, claimed = _tag(inner, order)
        yield place, kind, stored, claimed
        place += TAG + stored


def _tag(raw: bytes, order: str) -> tuple[int, int]:
    """Return (type, bytes) of a tag; type 0, which there is not, where it is cut short."""
    return struct.unpack(f"{order}II", raw) if len(raw) == TAG else (0, 0)


def _flat(content, prefix=""):
    """Yield (name, array) of the numbers in nested dicts."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        elif isinstance(value, (int, float)) or (
            isinstance(value, np.ndarray) and value.dtype.kind in "fiu"
        ):
            yield f"{prefix}{name}", np.asarray(value)
