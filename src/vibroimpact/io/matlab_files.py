"""Arrays in MATLAB files of version 4 to 7.

Version 5 and later is read here, since the reader of SciPy 1.17 crashes on some damaged files and
takes the memory that they claim. The format: "MAT-File Format", The MathWorks, chapter 1 of its
edition for version 7.
"""

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .foreign_arrays import ForeignFileError, refused_if_damaged, require_once, require_size

HEADER, TAG = 128, 8  # bytes
VERSION_73 = (b"\0\2IM", b"\2\0MI")  # how the header of an HDF5 file of MATLAB ends
BYTE_ORDER = {b"IM": "<", b"MI": ">"}  # the end of the header of a v5 file
BYTES, MATRIX, COMPRESSED = 2, 14, 15  # types of elements
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
STRUCTURE, SPARSE, INT32 = 2, 5, 12  # classes of arrays
# Class of a numeric array -> types in which it may be stored: MATLAB packs whole numbers.
PACKED = (1, 2, 3, 4, 5, 6)
CLASSES = {
    SPARSE: (*PACKED, 7, 9),
    6: (*PACKED, 7, 9),
    7: (*PACKED, 7),
    **dict.fromkeys(range(8, 14), PACKED),
    14: (*PACKED, 12),
    15: (*PACKED, 13),
}
COMPLEX, LOGICAL = 0x0800, 0x0200  # flags of an array
DEEPEST = 20  # structures in structures
REMEDY = "write it anew with save -v7"


def load_matlab(path: str | Path, most: float = math.inf) -> dict[str, Any]:
    """Return {name: array or sparse matrix} of the numeric variables of a file.

    Fields of structures are named structure.field. Texts, cells, objects and arrays of structures
    are left out.

    most: bytes that all variables may take. Raises ForeignFileError.
    """
    with refused_if_damaged(path, "MATLAB .mat", REMEDY):
        raw = memoryview(Path(path).read_bytes())
        header = bytes(raw[:HEADER])
        if header[-4:] in VERSION_73:
            raise ForeignFileError(f"{path}: is of MATLAB 7.3: save it with save -v7")
        order = BYTE_ORDER.get(header[-2:])
        if order is None:
            return _version_4(path)
        found = list(_version_5(path, raw, order, most))
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


def _version_5(
    path: str | Path, raw: memoryview, order: str, most: float
) -> Iterator[tuple[str, Any]]:
    """Yield (name, numbers) of each variable and field. Raises ForeignFileError."""
    place, total = HEADER, 0
    while place < len(raw):
        try:
            kind, content, end = _element(raw, place, order)
            if kind == COMPRESSED:
                kind, content = _expanded(path, content, order, total, most)
            if kind != MATRIX:
                raise ValueError(f"an element of type {kind} where a variable is expected")
            total += len(content)
            yield from _arrays(content, order, "", 0)
        except ForeignFileError:
            raise
        except (ValueError, struct.error, zlib.error) as error:
            raise ForeignFileError(
                f"{path}: the variable that begins at byte {place} can not be read ({error}): the"
                f" file is damaged or cut short, {REMEDY}"
            ) from error
        place = end


def _element(raw: memoryview, place: int, order: str) -> tuple[int, memoryview, int]:
    """Return (type, content, place of the next element) of the element at a place."""
    kind, size = struct.unpack_from(f"{order}II", raw, place)
    if kind >> 16:  # a small element has its content in its tag
        kind, size, start = kind & 0xFFFF, kind >> 16, place + 4
        end = place + TAG
        if size > 4:
            raise ValueError(f"a small element of {size} bytes")
    else:
        start = place + TAG
        end = start + size + (0 if kind == COMPRESSED else -size % 8)
    if start + size > len(raw):
        raise ValueError(f"it claims {size} bytes, {len(raw) - start} are left")
    return kind, raw[start : start + size], end


def _expanded(
    path: str | Path, packed: memoryview, order: str, total: int, most: float
) -> tuple[int, memoryview]:
    """Return (type, content) of the element inside a compressed one.

    total, most: bytes that the variables before it take, and that all may take.
    """
    stream = zlib.decompressobj()
    kind, size = struct.unpack(f"{order}II", stream.decompress(packed, TAG))
    require_size(path, total + size, "it")
    if total + size > most:
        raise ForeignFileError(
            f"{path}: holds {total + size:.3g} bytes of numbers, at most {most:.0e} are read from"
            " one file: store fewer signals or a shorter record in each"
        )
    content = stream.decompress(stream.unconsumed_tail, size + TAG)
    if len(content) < size or not stream.eof:
        raise ValueError(f"it claims {size} bytes and holds {len(content)}")
    return kind, memoryview(content)[:size]


def _arrays(content: memoryview, order: str, name: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield (name, numbers) of a variable, or of the fields of one that is a structure.

    name: of the field that the variable is; a variable at the top has its own.
    """
    if not len(content):  # an empty field
        return
    word = struct.unpack_from(f"{order}I", _element(content, 0, order)[1])[0]
    array_class = word & 0xFF
    if array_class not in (*CLASSES, STRUCTURE):
        return  # a text, a cell, an object
    _, (_, sizes), (_, own), *parts = _parts(content, order)
    shape = struct.unpack(f"{order}{len(sizes) // 4}i", sizes)
    name = name or _text(own)
    if not name:  # data of objects and functions
        return
    if min(shape, default=-1) < 0:
        raise ValueError(f"{name!r} has the size {shape}")
    if array_class != STRUCTURE:
        yield name, _array(name, word, shape, parts, order)
    elif math.prod(shape) == 1:
        yield from _fields(parts, order, name, depth + 1)


def _parts(content: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Yield (type, content) of the elements that a variable consists of."""
    place = 0
    while place < len(content):
        kind, part, place = _element(content, place, order)
        yield kind, part


def _fields(parts: list, order: str, name: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield (name, numbers) of the fields of a structure."""
    if depth > DEEPEST:
        raise ValueError(f"more than {DEEPEST} structures in structures")
    (_, length), (_, names), *values = parts
    width = struct.unpack(f"{order}i", length)[0]
    if width < 1 or len(names) != width * len(values):
        raise ValueError(f"the names of the fields of {name!r} do not fit")
    for index, (kind, content) in enumerate(values):
        field = f"{name}.{_text(names[index * width : (index + 1) * width])}"
        if kind != MATRIX:
            raise ValueError(f"{field!r} is of type {kind}")
        yield from _arrays(content, order, field, depth)


def _array(name: str, word: int, shape: tuple[int, ...], parts: list, order: str) -> Any:
    """Return the array or sparse matrix of the parts of a variable: the places of its values if it
    is sparse, the values, their imaginary parts if it is complex.
    """
    array_class, indices = word & 0xFF, [INT32] * (2 * (word & 0xFF == SPARSE))
    if indices and word & LOGICAL and len(parts) == 3 and len(parts[2][1]) == len(parts[0][1]) // 4:
        parts[2] = BYTES, parts[2][1]  # MATLAB calls them doubles
    classes = [*indices, array_class, *([array_class] if word & COMPLEX else [])]
    numbers = [
        _numbers(name, kind, content, each, order)
        for (kind, content), each in zip(parts, classes, strict=True)
    ]
    values = numbers[len(indices)]
    if word & LOGICAL:
        values = values.astype(bool)
    if word & COMPLEX:
        values = values + 1j * numbers[-1]
    if indices:
        return _sparse(name, shape, numbers[0], numbers[1], values)
    if math.prod(shape) != len(values):
        raise ValueError(f"{name!r} of size {shape} holds {len(values)} numbers")
    return values.reshape(shape, order="F")


def _text(raw: memoryview) -> str:
    """Return a name in UTF-8, or else in Latin-1, in which SciPy writes it."""
    name = bytes(raw).split(b"\0")[0]
    try:
        return name.decode("utf-8")
    except UnicodeDecodeError:
        return name.decode("latin-1")


def _numbers(name: str, kind: int, content: memoryview, array_class: int, order: str) -> np.ndarray:
    """Return the numbers of an array of a class that are stored as a type."""
    if kind not in CLASSES[array_class]:
        raise ValueError(f"{name!r} is stored as type {kind}, which is none of its class")
    return np.frombuffer(content, order + TYPES[kind]).astype(TYPES[kind])


def _sparse(
    name: str, shape: tuple[int, ...], rows: np.ndarray, starts: np.ndarray, values: np.ndarray
) -> Any:
    """Return a sparse matrix from the rows of its values and the start index of each column."""
    from scipy import sparse

    count = int(starts[-1]) if len(starts) else -1
    if not 0 <= count <= min(len(rows), len(values)):
        raise ValueError(f"{name!r} claims {count} values and holds {len(values)}")
    values = values if values.dtype.kind in "bc" else values.astype(float)
    matrix = sparse.csc_array((values[:count], rows[:count], starts), shape=shape)
    matrix.check_format(full_check=True)
    if not matrix.has_canonical_format:
        raise ValueError(f"the rows of a column of {name!r} do not rise")
    return matrix
