"""Mass, stiffness and damping matrices from files: NumPy, MATLAB, MatrixMarket and Nastran OP4."""

import struct
from pathlib import Path

import numpy as np
from scipy import io, sparse

LETTERS = {"mass": ("M", "m"), "stiffness": ("K", "k"), "damping": ("C", "c")}
OP4_READER = "pyyeti==1.4.7"
OP4_NAME_LENGTH = 8  # characters that the format keeps of a name: stiffnes
OP4_LETTERS = {"mass": ("m",), "stiffness": ("k",), "damping": ("c", "b")}
# Sets of displacements whose matrices Nastran writes (KGG, KAA, ...). Not hh: its dofs are modes.
# Not K4GG: structural damping is no C.
OP4_SETS = ("gg", "nn", "ff", "aa", "ll", "xx")


class MatrixFileError(ValueError):
    """A matrix file that can not be used; the message names it, what it holds and the remedy."""


def read_matrix(path, name):
    """Return the square, symmetric, real matrix (dof, dof) of a .npz, .mat, .mtx or .op4 file as
    sparse; `name` chooses among several arrays.

    A MatrixMarket file or a scipy.sparse .npz holds one matrix. Raises MatrixFileError.
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
        return arrays[
            _choose(path, arrays.files, [name, *LETTERS[name]], f"name the {name} matrix '{name}'")
        ]


def _mat(path, name):
    arrays = {key: value for key, value in io.loadmat(path).items() if not key.startswith("__")}
    return arrays[
        _choose(path, list(arrays), [name, *LETTERS[name]], f"name the {name} matrix '{name}'")
    ]


def _op4(path, name):
    """The matrix of an OP4 file, ASCII or binary, dense or sparse; its names come in lower case.
    Raises MatrixFileError.
    """
    try:
        from pyyeti.nastran import op4  # here: it takes seconds, and the other formats do without
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
    except (
        ValueError,
        RuntimeError,
        IndexError,
        OverflowError,
        OSError,
        struct.error,
    ) as error:  # what pyyeti raises on a cut or foreign file
        raise MatrixFileError(
            f"{path}: can not be read as OP4 ({error}): write it anew with OUTPUT4"
        ) from error


def _choose_op4(path, names, name):
    """The matrix called mass, then m, then by one of Nastran's names (mgg, maa, ...), or the only
    one; never one of two that would do.
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


def _choose(path, names, fitting, remedy):
    """The first of the fitting names that a file holds, or its only one. Raises MatrixFileError,
    with the remedy.
    """
    for wanted in fitting:
        if wanted in names:
            return wanted
    if len(names) == 1:
        return names[0]
    raise MatrixFileError(f"{path}: holds {', '.join(names) or 'no matrix'}: {remedy}")


READERS = {".npz": _npz, ".mat": _mat, ".mtx": lambda path, name: io.mmread(path), ".op4": _op4}
