"""Matrix files as programs and careless users write them: refused, or the matrix as written."""

import io as bytes_io

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import io, sparse

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.properties.recorder_files import EITHER, REFUSED, RIGHT
from vibroimpact.structure.matrix_files import MatrixFileError, read_matrix

VALUES = {
    "right": (lambda matrix: matrix, RIGHT),
    "round-off apart": (lambda matrix: matrix + 1e-13 * np.triu(matrix), RIGHT),
    "upper half": (np.triu, REFUSED),
    "lower half": (np.tril, REFUSED),
    "two rows swapped": (lambda matrix: matrix[[1, 0, 2, 3]], REFUSED),
    "a row left out": (lambda matrix: matrix[1:], REFUSED),
    "a sign lost": (lambda matrix: np.abs(np.triu(matrix)) + np.tril(matrix, -1), REFUSED),
    "antisymmetric": (lambda matrix: np.triu(matrix, 1) - np.triu(matrix, 1).T, REFUSED),
    "a value is no number": (lambda matrix: np.where(matrix == 40, np.nan, matrix), REFUSED),
    "a value is infinite": (lambda matrix: np.where(matrix == 40, np.inf, matrix), REFUSED),
    "beyond all": (lambda matrix: 1e40 * matrix, REFUSED),
    "a vector": (np.diag, REFUSED),
    "flat": (np.ravel, REFUSED),
    "twice": (lambda matrix: np.stack([matrix, matrix]), REFUSED),
    "empty": (lambda matrix: matrix[:0, :0], REFUSED),
}
TYPES = {
    "f8": RIGHT, "f4": RIGHT, ">f8": RIGHT, ">f4": RIGHT, "f2": RIGHT, "i4": RIGHT, ">i2": RIGHT,
    "i1": RIGHT, "c16": REFUSED, "U8": REFUSED, "bool": REFUSED,
}  # fmt: skip
FORMS = ("dense", "csr", "csc", "coo", "bsr", "dia", "unsorted", "entries twice")
NAMES = {
    "mass": RIGHT, "M": RIGHT, "m": RIGHT, "Mass": EITHER, "mgg": EITHER, "matrix": EITHER,
    "K": EITHER,
}  # fmt: skip


def symmetric(seed):
    """A matrix (4, 4) of small whole numbers; no row can stand for another."""
    half = np.triu(np.random.default_rng(seed).integers(-9, 10, (4, 4)).astype(float), 1)
    half[0, 1] = -5.0
    return half + half.T + np.diag([20.0, 40.0, 30.0, 50.0])


def sparse_of(form, matrix):
    """A sparse matrix in one of the forms."""
    found = sparse.coo_array(matrix)
    if form == "entries twice":  # as elements are assembled: the sum counts
        data, (rows, columns) = found.data / 2, found.coords
        places = np.concatenate([rows, rows]), np.concatenate([columns, columns])
        return sparse.coo_array((np.concatenate([data, data]), places), found.shape)
    if form == "unsorted":
        order = np.argsort(-found.coords[1], kind="stable")
        places = (found.coords[0][order], found.coords[1][order])
        return sparse.coo_array((found.data[order], places), found.shape)
    return getattr(found, f"to{form}")()


def _storable(matrix):
    """Whether a sparse matrix of SciPy can hold the array."""
    return matrix.ndim == 2 and matrix.dtype.kind in "fi" and matrix.dtype.itemsize != 2


def write_npz(draw, path, matrix, name):
    """Write a NumPy archive; return what a reader owes for its form."""
    form = draw(st.sampled_from(FORMS)) if _storable(matrix) else ""
    if form in ("", "dense"):
        arrays = {name: np.asfortranarray(matrix) if draw(st.booleans()) else matrix}
        if draw(st.booleans()):
            arrays["C"] = matrix
        (np.savez if draw(st.booleans()) else np.savez_compressed)(path, **arrays)
        return NAMES[name] if name != "K" or len(arrays) == 1 else REFUSED
    sparse.save_npz(path, sparse_of(form, matrix.astype(matrix.dtype.newbyteorder("="))))
    return RIGHT


def write_mat(draw, path, matrix, name):
    """Write a MATLAB file; return what a reader owes for its form."""
    kind = draw(st.sampled_from(["5", "4", "7.3", "sparse", "structure"]))
    if kind == "7.3":
        with h5py.File(path, "w", userblock_size=512) as file:
            file[name] = np.zeros(1) if matrix.dtype.kind == "U" else matrix
        head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM"
        path.write_bytes(head + path.read_bytes()[128:])
        return REFUSED
    if kind == "sparse" and _storable(matrix) and matrix.size:
        io.savemat(path, {name: sparse.csc_array(matrix.astype(float))})
    elif kind == "structure":
        io.savemat(path, {"model": {name: matrix}})
        return REFUSED
    else:
        version = "4" if kind == "4" and matrix.ndim == 2 and matrix.dtype.kind in "fi" else "5"
        matrix = matrix.astype(matrix.dtype.newbyteorder("="))
        io.savemat(path, {name: matrix.astype(float) if version == "4" else matrix}, format=version)
    return NAMES[name]


def write_mtx(draw, path, matrix, name):
    """Write a MatrixMarket file; return what a reader owes for its form."""
    if matrix.ndim != 2 or matrix.dtype.kind not in "fi":
        path.write_text("\n".join(map(str, matrix.ravel())))
        return REFUSED
    file = bytes_io.BytesIO()
    matrix = matrix.astype(float)
    io.mmwrite(file, matrix if draw(st.booleans()) else sparse.coo_array(matrix))
    text = file.getvalue().decode()
    changes = {
        "as it is": (lambda text: text, RIGHT),
        "Windows": (lambda text: text.replace("\n", "\r\n"), RIGHT),
        "Fortran": (lambda text: text.replace("e+", "D+"), EITHER),
        "capitals": (lambda text: text.replace("matrix", "MATRIX"), EITHER),
        "a comment": (lambda text: text.replace("\n", "\n% of rig 7\n", 1), RIGHT),
        "decimal commas": (lambda text: text.replace(".", ","), EITHER),
        "no header": (lambda text: text.split("\n", 1)[1], REFUSED),
        "a line lost": (lambda text: text.rstrip().rsplit("\n", 1)[0] + "\n", REFUSED),
        "a blank line": (lambda text: text.rstrip("\n") + "\n\n", RIGHT),
        "skew": (lambda text: text.replace("symmetric", "skew-symmetric"), EITHER),
        "whole": (lambda text: text.replace("real", "integer"), EITHER),
        "complex": (lambda text: text.replace("real", "complex"), REFUSED),
        "counts from 0": (_from_zero, EITHER),
    }
    change, outcome = changes[draw(st.sampled_from([*changes]))]
    changed = change(text)
    path.write_bytes(changed.encode())
    return RIGHT if changed == text else outcome


def _from_zero(text):
    """A coordinate text whose rows and columns are counted from 0."""
    lines = text.split("\n")
    at = next(index for index, line in enumerate(lines) if line[:1] != "%") + 1
    for index, line in enumerate(lines[at:], start=at):
        cells = line.split()
        if "coordinate" in lines[0] and len(cells) == 3:
            lines[index] = f"{int(cells[0]) - 1} {int(cells[1]) - 1} {cells[2]}"
    return "\n".join(lines)


WRITERS = {".npz": write_npz, ".mat": write_mat, ".mtx": write_mtx}


@pytest.mark.parametrize("ending", WRITERS)
def test_matrices_of_programs_are_refused_or_right(ending, reliability):
    tried = Tried()

    @given(st.data())
    def check(data):
        odd = data.draw(st.sampled_from(["values", "type", "name", "none", "none"]))
        values = data.draw(st.sampled_from([*VALUES])) if odd == "values" else "right"
        kind = data.draw(st.sampled_from([*TYPES])) if odd == "type" else "f8"
        name = data.draw(st.sampled_from([*NAMES])) if odd == "name" else "M"
        change, owed = VALUES[values]
        expected = symmetric(data.draw(st.integers(0, 2**32 - 1)))
        matrix = change(expected).astype(kind)
        with folder_of_example() as folder:
            path = folder / f"mass{ending}"
            owes = [owed, TYPES[kind], WRITERS[ending](data.draw, path, matrix, name)]
            outcome, result = tried.add(
                guarded(lambda: read_matrix(path, "mass"), MatrixFileError, [folder], [path.name])
            )
        told = (values, kind, name, owes, result)
        if outcome == "refused":
            assert {*owes} != {RIGHT}, told
            return
        assert REFUSED not in owes, told
        np.testing.assert_allclose(result.toarray(), expected, rtol=1e-6, err_msg=str(told))

    check()
    reliability.inputs(f"matrices of programs, {ending}: types, forms, names, halves", tried)
