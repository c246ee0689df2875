"""Mass, stiffness and damping matrices from NumPy, MATLAB, MatrixMarket and Nastran OP4 files."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from vibroimpact.io.foreign_arrays import (
    ForeignFileError,
    load_npz,
    refused_if_damaged,
    require_size,
)
from vibroimpact.io.matlab_files import load_matlab

from .matrix_market import read_matrix_market

MOST_ROWS = 10**7
LARGEST = 1e30  # beyond any mass, stiffness or damping in SI units
LETTERS = {"mass": ("M", "m"), "stiffness": ("K", "k"), "damping": ("C", "c")}
OP4_READER = "pyyeti==1.4.7"
OP4_NAME_LENGTH = 8  # characters of a name in the format: stiffnes
OP4_LETTERS = {"mass": ("m",), "stiffness": ("k",), "damping": ("c", "b")}
# Displacement sets whose matrices Nastran writes (KGG, KAA, ...). Left out: hh, whose dofs are
# modes, and K4GG, which is structural damping and no C.
OP4_SETS = ("gg", "nn", "ff", "aa", "ll", "xx")


class MatrixFileError(ForeignFileError):
    """A matrix file that cannot be used; the message names it, its content and the remedy."""


def read_matrix(path: str | Path, name: str, op4_set: str | None = None) -> sparse.csr_array:
    """Return the symmetric real matrix (dof, dof) of a .npz, .mat, .mtx or .op4 file.

    name: mass, stiffness or damping; it chooses among several arrays. A MatrixMarket file or a
        scipy.sparse .npz holds one matrix.
    op4_set: the set of Nastran in an OP4 file, such as aa, and its number if there are several:
        aa2.

    Raises MatrixFileError.
    """
    path = Path(path)
    if not path.is_file():
        raise MatrixFileError(
            f"{path}: no such file: give its path from the folder in which the study is run"
        )
    if path.suffix.lower() not in READERS:
        raise MatrixFileError(f"{path}: ends in none of {', '.join(READERS)}")
    try:
        with refused_if_damaged(path, f"a matrix file {path.suffix.lower()}", "write it anew"):
            matrix = READERS[path.suffix.lower()](path, name, op4_set)
            return _symmetric(path, name, _real(path, name, matrix))
    except MatrixFileError:
        raise
    except ForeignFileError as error:
        raise MatrixFileError(str(error)) from error


def _real(path: Path, name: str, matrix: Any) -> sparse.csr_array:
    """Return a matrix as real numbers, sparse. Raises MatrixFileError if it is not square, holds
    anything but finite real numbers, or refers to rows that it does not have.
    """
    if sparse.issparse(matrix):
        _require_shape(path, name, matrix.shape)
        if matrix.format in ("csr", "csc", "bsr"):
            matrix.check_format(full_check=True)
        matrix = sparse.csr_array(matrix)
    if matrix.dtype.kind == "c":
        raise MatrixFileError(
            f"{path}: {name} is complex: give its real part, and the damping as a damping matrix or"
            " as damping ratios"
        )
    if matrix.dtype.kind not in "fiu":
        raise MatrixFileError(f"{path}: {name} holds no numbers: give a matrix of numbers")
    _require_shape(path, name, matrix.shape)
    values = matrix.data if sparse.issparse(matrix) else np.asarray(matrix, float)
    if not np.all(np.abs(values) <= LARGEST):  # false for NaN, too
        raise MatrixFileError(
            f"{path}: {name} holds values that are not finite or beyond {LARGEST:g}: correct them"
        )
    return sparse.csr_array(matrix, dtype=float)


def _require_shape(path: Path, name: str, shape: tuple[int, ...]) -> None:
    """Raise MatrixFileError unless a matrix is square, and not beyond any structure."""
    if len(shape) != 2 or shape[0] != shape[1] or not 1 <= shape[0] <= MOST_ROWS:
        raise MatrixFileError(
            f"{path}: {name} is {tuple(map(int, shape))}, a square matrix is needed, of 1 to"
            f" {MOST_ROWS} rows"
        )


def _symmetric(path: Path, name: str, matrix: sparse.csr_array) -> sparse.csr_array:
    """Return a matrix with exactly equal halves. Raises MatrixFileError if they differ."""
    largest = abs(matrix).max()
    if abs(matrix - matrix.T).max() > 1e-8 * largest:
        raise MatrixFileError(f"{path}: {name} is not symmetric: give both halves, in SI units")
    return (0.5 * (matrix + matrix.T)).tocsr()


def _npz(path: Path, name: str, op4_set: str | None) -> Any:
    """Return a matrix of a .npz file. Raises ForeignFileError."""
    arrays = load_npz(path)
    if "format" not in arrays:
        return arrays[_choose_letter(path, list(arrays), name)]
    _require_shape(path, name, tuple(arrays["shape"]))
    with open(path, "rb") as file:
        return sparse.load_npz(file)


def _mat(path: Path, name: str, op4_set: str | None) -> Any:
    """Return a matrix of a .mat file. Raises ForeignFileError."""
    arrays = load_matlab(path)
    variables = [each for each in arrays if "." not in each]  # the others are fields of structures
    return arrays[_choose_letter(path, variables, name)]


def _choose_letter(path, names, name):
    """Return the name of the wanted matrix: mass, M or m. Raises MatrixFileError."""
    return _choose(path, names, [name, *LETTERS[name]], f"name the {name} matrix '{name}'")


def _op4(path: Path, name: str, op4_set: str | None) -> Any:
    """Return a matrix of an OP4 file, ASCII or binary. Raises MatrixFileError."""
    try:
        from pyyeti.nastran import op4  # imported here: it takes seconds, only OP4 needs it
    except ImportError as error:
        raise MatrixFileError(
            f"{path}: reading OP4 needs pyyeti: pip install {OP4_READER}"
        ) from error
    with refused_if_damaged(path, "OP4", "write it anew with OUTPUT4"):
        names, sizes = op4.dir(str(path), verbose=False)[:2]
        chosen = _choose_op4(path, names, name, op4_set)
        rows, columns = (abs(int(size)) for size in sizes[chosen])
        _require_shape(path, name, (rows, columns))
        require_size(path, 8.0 * rows * columns, names[chosen])
        earlier = names[:chosen].count(names[chosen])  # of the same name
        return op4.load(str(path), [names[chosen]], into="list", sparse=None)[1][earlier]


def _choose_op4(path: Path, names: list[str], name: str, op4_set: str | None) -> int:
    """Return the place of the wanted matrix in an OP4 file; names there are in lower case.

    In order: of the wanted set, mass (or stiffness, damping), its letter, one of Nastran's names
    (mgg, maa, ...), the only matrix of the file. Raises MatrixFileError if two fit equally.
    """
    letters = OP4_LETTERS[name]
    plain = [wanted for wanted in (name[:OP4_NAME_LENGTH], *letters) if wanted in names]
    wanted = plain[:1] or [letters[-1] + of_set for of_set in OP4_SETS]
    if op4_set is not None:
        wanted = [letters[-1] + op4_set[:2]]
    fitting = [place for place, each in enumerate(names) if each in wanted]
    if op4_set is not None and op4_set[2:]:
        fitting = fitting[int(op4_set[2:]) - 1 :][:1]
    if len(fitting) > 1:
        found = [names[place] for place in fitting]
        raise MatrixFileError(
            f"{path}: {', '.join(found)} could each be the {name} matrix: choose with"
            f" structure.op4_set: {' or '.join(_sets_of(found))}"
        )
    letter = letters[-1].upper()
    remedy = f"name the {name} matrix {letter}, or as Nastran does, {letter}GG"
    if op4_set is not None and not fitting:
        raise MatrixFileError(
            f"{path}: holds {', '.join(names)}: op4_set = {op4_set} finds no {name} matrix there"
        )
    return fitting[0] if fitting else names.index(_choose(path, names, [], remedy))


def _sets_of(names: list[str]) -> list[str]:
    """Return the set of each matrix, with its number among those of one name."""
    return [
        name[1:] + (str(names[: index + 1].count(name)) if names.count(name) > 1 else "")
        for index, name in enumerate(names)
    ]


def _choose(path: Path, names: list[str], fitting: list[str], remedy: str) -> str:
    """Return the first fitting name that a file holds, or its only one. Raises MatrixFileError."""
    for wanted in fitting:
        if wanted in names:
            return wanted
    if len(names) == 1:
        return names[0]
    raise MatrixFileError(f"{path}: holds {', '.join(names) or 'no matrix'}: {remedy}")


READERS = {
    ".npz": _npz,
    ".mat": _mat,
    ".mtx": lambda path, *_: read_matrix_market(path, MOST_ROWS),
    ".op4": _op4,
}
