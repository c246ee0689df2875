"""Matrices in MatrixMarket text files.

Read here, since the reader of SciPy 1.17 takes missing values for 0 and crashes on some damaged
files.
"""

from itertools import chain
from pathlib import Path
from typing import TextIO

import numpy as np
from scipy import sparse

from vibroimpact.io.foreign_arrays import ForeignFileError

FIELDS = ("real", "double", "integer")
SYMMETRIES = ("general", "symmetric")
REMEDY = "write a real matrix with scipy.io.mmwrite"


def read_matrix_market(path: str | Path, most_rows: int) -> sparse.coo_array:
    """Return the matrix (row, column) of a MatrixMarket file.

    most_rows: of a matrix that may be asked for. Raises ForeignFileError, and ValueError for text
    in the place of numbers.
    """
    with open(path, encoding="latin-1") as file:  # every byte is a character: comments hold any
        layout, symmetric = _header(path, file.readline(200))
        rows, columns, entries = _sizes(path, file, layout, symmetric)
        if rows != columns or rows > most_rows:
            raise ForeignFileError(
                f"{path}: is ({rows}, {columns}), a square matrix of at most {most_rows} rows is"
                " needed"
            )
        first = _first_line(file)
        lines = chain([first], file)
        values = np.loadtxt(lines, comments="%", ndmin=2) if first else np.zeros((0, 1))
    if len(values) != entries:
        raise ForeignFileError(
            f"{path}: holds {len(values)} values, its header says {entries}: write it anew"
        )
    if layout == "array":
        column, row = np.indices((rows, rows)).reshape(2, -1)  # column after column
        kept = row >= column if symmetric else slice(None)
        row, column = row[kept], column[kept]
    else:
        row, column = _places(path, values, rows)
        _require_each_once(path, row, column, symmetric)
    value = values[:, -1]
    if symmetric:
        off = row != column
        row, column = np.r_[row, column[off]], np.r_[column, row[off]]
        value = np.r_[value, value[off]]
    return sparse.coo_array((value, (row, column)), shape=(rows, columns))


def _header(path: str | Path, line: str) -> tuple[str, bool]:
    """Return (array or coordinate, whether one half is left out) of the first line."""
    words = line.lower().split()
    if len(words) != 5 or words[:2] != ["%%matrixmarket", "matrix"]:
        raise ForeignFileError(f"{path}: does not begin as a MatrixMarket file: {REMEDY}")
    layout, field, symmetry = words[2:]
    if field == "complex":
        raise ForeignFileError(
            f"{path}: is complex: give its real part, and the damping as a damping matrix or as"
            " damping ratios"
        )
    if layout not in ("array", "coordinate") or field not in FIELDS or symmetry not in SYMMETRIES:
        raise ForeignFileError(
            f"{path}: holds a matrix that is '{' '.join(words[2:])[:60]}': {REMEDY}"
        )
    return layout, symmetry == "symmetric"


def _sizes(path: str | Path, file: TextIO, layout: str, symmetric: bool) -> tuple[int, int, int]:
    """Return (rows, columns, lines of values) from the line of sizes."""
    line = _first_line(file)
    words = line.split()
    if len(words) != (2 if layout == "array" else 3) or not all(
        word.isascii() and word.isdecimal() and len(word) < 19 for word in words
    ):
        raise ForeignFileError(f"{path}: the line of sizes is '{line.strip()[:40]}': {REMEDY}")
    rows, columns, *entries = map(int, words)
    if entries:
        return rows, columns, entries[0]
    return rows, columns, rows * (rows + 1) // 2 if symmetric else rows * columns


def _first_line(file: TextIO) -> str:
    """Return the next line that is not empty and no comment, "" at the end."""
    return next((line for line in file if line.strip() and not line.startswith("%")), "")


def _places(path: str | Path, values: np.ndarray, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows and columns of the entries of a sparse matrix, counted from 0."""
    if values.shape[1] != 3 and len(values):
        raise ForeignFileError(f"{path}: a line of it is not row, column and value: {REMEDY}")
    places = values[:, :2] if len(values) else np.zeros((0, 2))
    off = ~((places >= 1) & (places <= rows) & (places == np.floor(places))).all(axis=1)
    if off.any():
        row, column = places[np.argmax(off)]
        raise ForeignFileError(
            f"{path}: has an entry at row {row:g} and column {column:g}, of {rows}: count from 1"
        )
    row, column = places.T.astype(np.int64) - 1
    return row, column


def _require_each_once(
    path: str | Path, row: np.ndarray, column: np.ndarray, symmetric: bool
) -> None:
    """Raise if a place is given twice; in a symmetric matrix, also in the other half."""
    low, high = (np.minimum(row, column), np.maximum(row, column)) if symmetric else (row, column)
    order = np.lexsort((high, low))
    low, high = low[order], high[order]
    twice = (np.diff(low) == 0) & (np.diff(high) == 0)
    if twice.any():
        first, second = low[np.argmax(twice)] + 1, high[np.argmax(twice)] + 1
        raise ForeignFileError(
            f"{path}: gives row {first} and column {second} more than once: give each entry once"
        )
