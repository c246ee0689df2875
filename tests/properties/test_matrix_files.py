"""Damaged matrix files of every format: refused with the file, or a matrix that can be used."""

import io as bytes_io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import io, sparse

from tests.properties.damage import damaged_bytes
from tests.properties.guarded import Tried, folder_of_example, guarded
from vibroimpact.structure.matrix_files import MatrixFileError, read_matrix

MASS = np.array([[2.0, 1.0, 0.0], [1.0, 4.0, -1.0], [0.0, -1.0, 3.0]])
OP4 = """\
       3       3       6       2MGG     1P,3E23.16
       1       1       2
 2.0000000000000000E+00 1.0000000000000000E+00
       2       1       3
 1.0000000000000000E+00 4.0000000000000000E+00-1.0000000000000000E+00
       3       2       2
-1.0000000000000000E+00 3.0000000000000000E+00
       4       1       1
 1.0000000000000000E+00
"""


def written(write, *arguments, **options):
    """The bytes that a function writes to a file."""
    file = bytes_io.BytesIO()
    write(file, *arguments, **options)
    return file.getvalue()


# Ending, bytes, whether the format has a checksum: damaged numbers are then seen.
FILES = (
    (".npz", written(np.savez, M=MASS), True),
    (".npz", written(np.savez_compressed, M=MASS, K=2 * MASS), True),
    (".npz", written(sparse.save_npz, sparse.csr_array(MASS)), True),
    (".npz", written(sparse.save_npz, sparse.coo_array(MASS)), True),
    (".npz", written(sparse.save_npz, sparse.dia_array(MASS)), True),
    (".mat", written(io.savemat, {"M": MASS, "x": "text", "s": {"a": 1}}), False),
    (".mat", written(io.savemat, {"M": MASS}, do_compression=True), True),
    (".mat", written(io.savemat, {"M": sparse.csc_array(MASS)}), False),
    (".mat", written(io.savemat, {"M": sparse.csc_array(MASS)}, do_compression=True), True),
    (".mat", written(io.savemat, {"M": MASS}, format="4"), False),
    (".mtx", written(io.mmwrite, sparse.coo_array(MASS)), False),
    (".mtx", written(io.mmwrite, sparse.coo_array(MASS), symmetry="general"), False),
    (".mtx", written(io.mmwrite, MASS), False),
    (".op4", OP4.encode(), False),
)
NUMBERS = (b"nan", b"inf", b"1e30", b"1e999", b"-1", b"0", b"4", b"1.5", b"999999999999", b"x", b"")


@st.composite
def damaged_words(draw, content):
    """A text with one or two words replaced, a line left out or given twice."""
    lines = content.split(b"\n")
    for _ in range(draw(st.integers(1, 2))):
        at = draw(st.integers(0, len(lines) - 1))
        what = draw(st.sampled_from(["word", "word", "twice", "out"]))
        words = lines[at].split(b" ")
        if what == "word":
            words[draw(st.integers(0, len(words) - 1))] = draw(st.sampled_from(NUMBERS))
            lines[at] = b" ".join(words)
        else:
            lines[at : at + 1] = [lines[at]] * (2 if what == "twice" else 0)
        lines = lines or [b""]
    return b"\n".join(lines)


@pytest.mark.parametrize("ending", [".npz", ".mat", ".mtx", ".op4"])
def test_damaged_matrix_files_are_refused_or_right(ending, reliability):
    if ending == ".op4":
        pytest.importorskip("pyyeti", reason="OP4 files need pyyeti, which is not installed")
    tried = Tried()
    files = [file for file in FILES if file[0] == ending]

    @given(st.data())
    def check(data):
        _, content, has_checksum = data.draw(st.sampled_from(files))
        damage = damaged_words if ending in (".mtx", ".op4") and data.draw(st.booleans()) else None
        content = data.draw((damage or damaged_bytes)(content))
        with folder_of_example() as folder:
            path = folder / f"mass{ending}"
            path.write_bytes(content)
            outcome = tried.add(
                guarded(lambda: read_matrix(path, "mass"), MatrixFileError, [folder], [path.name])
            )
        if outcome[0] == "right":
            matrix = outcome[1].toarray()
            assert np.array_equal(matrix, matrix.T) and np.all(np.isfinite(matrix))
            assert not has_checksum or np.array_equal(matrix, MASS)

    check()
    reliability.inputs(f"matrix files of the kind {ending}, bytes or words damaged", tried)
