"""The numbers of a MAT file of version 5.

Read here and not by scipy, which takes the memory that a damaged file claims and may crash on it.
The format: "MAT-File Format", The MathWorks, chapter 1 of its edition for version 7.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vibroimpact.records import MOST_PACKED, MOST_READ

from .signals import ImportProblem

HEADER, TAG = 128, 8  # bytes
BYTE_ORDERS = {b"IM": "<", b"MI": ">"}
MATRIX, COMPRESSED = 14, 15  # types of elements
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
STRUCTURE = 2  # class of an array
# Class of a numeric array -> types in which it may be stored: MATLAB packs whole numbers.
PACKED = (1, 2, 3, 4, 5, 6)
CLASSES = {
    6: (*PACKED, 7, 9),
    7: (*PACKED, 7),
    **dict.fromkeys(range(8, 14), PACKED),
    14: (*PACKED, 12),
    15: (*PACKED, 13),
}
COMPLEX = 0x0800  # flag of an array
DEEPEST = 20  # structures in structures


class _Damaged(Exception):
    """What is wrong with an element."""


def read_matlab_5(path: str | Path) -> dict[str, np.ndarray]:
    """Return {name: real numbers} of a file; fields of structures are named structure.field.

    Texts, cells, arrays of structures, complex and sparse arrays are left out. Raises ImportProblem
    for another or a damaged file, with the place in it.
    """
    raw = memoryview(Path(path).read_bytes())
    order = BYTE_ORDERS.get(bytes(raw[HEADER - 2 : HEADER]))
    if order is None:
        raise ImportProblem(
            f"{path}: is no MAT file of v5 or v7.3: save it again with -v7 or -v7.3"
        )
    found: dict[str, np.ndarray] = {}
    place, total = HEADER, 0
    while place < len(raw):
        try:
            kind, content, end = _element(raw, place, order)
            if kind == COMPRESSED:
                kind, content = _unpacked(content, order, MOST_READ - total)
            if kind != MATRIX:
                raise _Damaged(f"an element of type {kind} where a variable is expected")
            total += len(content)
            for name, values in _arrays(content, order, "", 0):
                if name in found:
                    raise _Damaged(f"'{name}' for the second time")
                found[name] = values
        except (_Damaged, zlib.error, struct.error, UnicodeDecodeError, ValueError) as error:
            raise ImportProblem(
                f"{path}: the variable that begins at byte {place} can not be read ({error}): the"
                " file is damaged or cut short, export it again"
            ) from error
        place = end
    return found


def _element(raw: memoryview, place: int, order: str) -> tuple[int, memoryview, int]:
    """Return (type, content, place of the next element) of the element at a place."""
    kind, size = struct.unpack_from(f"{order}II", raw, place)
    if kind >> 16:  # a small element has its content in its tag
        kind, size, start = kind & 0xFFFF, kind >> 16, place + 4
        end = place + TAG
        if size > 4:
            raise _Damaged(f"a small element of {size} bytes")
    else:
        start = place + TAG
        end = start + size + (0 if kind == COMPRESSED else -size % 8)
    if start + size > len(raw):
        raise _Damaged(f"it claims {size} bytes, {len(raw) - start} are left")
    return kind, raw[start : start + size], end


def _unpacked(packed: memoryview, order: str, most: int) -> tuple[int, memoryview]:
    """Return (type, content) of the element inside a compressed one of at most `most` bytes."""
    stream = zlib.decompressobj()
    head = stream.decompress(packed, TAG)
    kind, size = struct.unpack(f"{order}II", head)
    if size > MOST_PACKED * len(packed):
        raise _Damaged(f"it claims {size} bytes in {len(packed)}")
    if size > most:
        raise _Damaged(f"more than {MOST_READ:.0e} bytes of numbers in one file")
    content = stream.decompress(stream.unconsumed_tail, size + TAG)
    if len(content) < size or not stream.eof:
        raise _Damaged(f"it claims {size} bytes and holds {len(content)}")
    return kind, memoryview(content)[:size]


def _arrays(
    content: memoryview, order: str, name: str, depth: int
) -> Iterator[tuple[str, np.ndarray]]:
    """Yield (name, numbers) of a variable, or of the fields of one that is a structure.

    name: of the field that the variable is; a variable at the top has its own.
    """
    if not len(content):  # an empty field
        return
    parts = _parts(content, order)
    _, flags = next(parts)
    word = struct.unpack_from(f"{order}I", flags)[0]
    if word & 0xFF not in (*CLASSES, STRUCTURE):
        return  # a text, a cell, an object
    _, sizes = next(parts)
    shape = struct.unpack(f"{order}{len(sizes) // 4}i", sizes)
    _, own = next(parts)
    name = name or bytes(own).decode("utf-8")
    if min(shape, default=-1) < 0:
        raise _Damaged(f"'{name}' has the size {shape}")
    if word & 0xFF == STRUCTURE:
        if math.prod(shape) == 1:
            yield from _fields(parts, order, name, depth + 1)
    elif not word & COMPLEX:
        yield name, _numbers(*next(parts), word & 0xFF, shape, order, name)


def _parts(content: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Yield (type, content) of the elements that a variable consists of."""
    place = 0
    while place < len(content):
        kind, part, place = _element(content, place, order)
        yield kind, part
    raise _Damaged("it ends too early")


def _fields(parts, order, name, depth):
    """Yield (name, numbers) of the fields of a structure."""
    if depth > DEEPEST:
        raise _Damaged(f"more than {DEEPEST} structures in structures")
    _, length = next(parts)
    width = struct.unpack(f"{order}i", length)[0]
    _, names = next(parts)
    if width < 1 or len(names) % width:
        raise _Damaged(f"the names of the fields of '{name}' do not fit")
    for start in range(0, len(names), width):
        field = bytes(names[start : start + width]).split(b"\0")[0].decode("utf-8")
        kind, content = next(parts)
        if kind != MATRIX:
            raise _Damaged(f"'{name}.{field}' is of type {kind}")
        yield from _arrays(content, order, f"{name}.{field}", depth)


def _numbers(kind, content, array_class, shape, order, name):
    """Return the numbers of an array of a class and a shape that are stored as a type."""
    if kind not in CLASSES[array_class]:
        raise _Damaged(f"'{name}' is stored as type {kind}, which is none of its class")
    dtype = np.dtype(order + TYPES[kind])
    if math.prod(shape) * dtype.itemsize != len(content):
        raise _Damaged(f"'{name}' of size {shape} in {len(content)} bytes of type {kind}")
    return np.frombuffer(content, dtype).reshape(shape, order="F")
