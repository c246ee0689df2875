"""Mass, stiffness and damping matrices from NumPy, MATLAB, MatrixMarket and Nastran OP4 files."""

import struct
from pathlib import Path
from typing import Any

import numpy as np
from scipy import io, sparse

LETTERS = {"mass": ("M", "m"), "stiffness": ("K", "k"), "damping": ("C", "c")}
OP4_READER = "pyyeti==1.4.7"
OP4_NAME_LENGTH = 8  # characters of a name in the format: stiffnes
OP4_LETTERS = {"mass": ("m",), "stiffness": ("k",), "damping": ("c", "b")}
# Displacement sets whose matrices Nastran writes (KGG, KAA, ...). Left out: hh, whose dofs are
# modes, and K4GG, which is structural damping and no C.
OP4_SETS = ("gg", "nn", "ff", "aa", "ll", "xx")


# What pyyeti raises on a truncated file or one of another format.
OP4_ERRORS = (ValueError, RuntimeError, IndexError, OverflowError, OSError, struct.error)


class MatrixFileError(ValueError):
    """A matrix file that cannot be used; the message names it, what it holds and the remedy."""


def read_matrix(path: str | Path, name: str) -> sparse.csr_array:
    """Return the symmetric real matrix (dof, dof) of a .npz, .mat, .mtx or .op4 file.

    name: mass, stiffness or damping; it chooses among several arrays. A MatrixMarket file or a
        scipy.sparse .npz holds one matrix.

    Raises MatrixFileError.
    """
    path = Path(path)
    if not path.is_file():
        raise MatrixFileError(
            f"{path}: no such file: give its path from the folder where the study is run"
        )
    if path.suffix.lower() not in READERS:
        raise MatrixFileError(f"{path}: ends in none of {', '.join(READERS)}")
    matrix = READERS[path.suffix.lower()](path, name)
    if matrix.dtype.kind == "c":
        raise MatrixFileError(
            f"{path}: {name} is complex: give its real part, and what damps as a damping matrix or"
            " as damping ratios"
        )
    matrix = sparse.csr_array(matrix, dtype=float)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise MatrixFileError(f"{path}: {name} is {matrix.shape}, a square matrix is needed")
    largest = abs(matrix).max()
    if abs(matrix - matrix.T).max() > 1e-8 * largest:
        raise MatrixFileError(f"{path}: {name} is not symmetric: give both halves, in SI units")
    return (0.5 * (matrix + matrix.T)).tocsr()


def _npz(path, name):
    with np.load(path, allow_pickle=False) as arrays:
        if "format" in arrays.files:
            return sparse.load_npz(path)
        return arrays[_choose_letter(path, arrays.files, name)]


def _mat(path, name):
    arrays = {key: value for key, value in io.loadmat(path).items() if not key.startswith("__")}
    return arrays[_choose_letter(path, list(arrays), name)]


def _choose_letter(path, names, name):
    """Return the name of the wanted matrix: mass, M or m. Raises MatrixFileError."""
    return _choose(path, names, [name, *LETTERS[name]], f"name the {name} matrix '{name}'")


def _op4(path: Path, name: str) -> Any:
    """Return a matrix of an OP4 file, ASCII or binary. Raises MatrixFileError."""
    try:
        from pyyeti.nastran import op4  # imported here: it takes seconds, only OP4 needs it
    except ImportError as error:
        raise MatrixFileError(
            f"{path}: reading OP4 needs pyyeti: pip install {OP4_READER}"
        ) from error
    try:
        names = op4.dir(str(path), verbose=False)[0]
        chosen = _choose_op4(path, names, name)
        return op4.read(str(path), chosen, sparse=None)[chosen]
    except MatrixFileError:
        raise
    except OP4_ERRORS as error:
        raise MatrixFileError(
            f"{path}: cannot be read as OP4 ({error}): write it anew with OUTPUT4"
        ) from error


def _choose_op4(path: Path, names: list[str], name: str) -> str:
    """Return the name of the wanted matrix in an OP4 file; names there are in lower case.

    In order: mass (or stiffness, damping), its letter, one of Nastran's names (mgg, maa, ...), the
    only matrix of the file. Raises MatrixFileError where two names fit equally.
    """
    letters = OP4_LETTERS[name]
    plain = [wanted for wanted in (name[:OP4_NAME_LENGTH], *letters) if wanted in names]
    wanted = plain[:1] or [letters[-1] + of_set for of_set in OP4_SETS]
    fitting = [each for each in names if each in wanted]
    if len(fitting) > 1:
        raise MatrixFileError(
            f"{path}: {', '.join(fitting)} could each be the {name} matrix: leave one of them in"
            " the file"
        )
    return _choose(
        path,
        names,
        fitting,
        f"name the {name} matrix {letters[-1].upper()}, or as Nastran does,"
        f" {letters[-1].upper()}GG",
    )


def _choose(path: Path, names: list[str], fitting: list[str], remedy: str) -> str:
    """Return the first fitting name that a file holds, or its only one. Raises MatrixFileError."""
    for wanted in fitting:
        if wanted in names:
            return wanted
    if len(names) == 1:
        return names[0]
    raise MatrixFileError(f"{path}: holds {', '.join(names) or 'no matrix'}: {remedy}")


READERS = {".npz": _npz, ".mat": _mat, ".mtx": lambda path, name: io.mmread(path), ".op4": _op4}
