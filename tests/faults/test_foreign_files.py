"""Matrix files that claim more than they hold, pack more than fits, or bring code: one sentence
each, in little memory, and nothing is executed.
"""

import os
import pickle
import struct
import zipfile
import zlib

import numpy as np
import pytest
from scipy import io

from tests.properties.guarded import guarded
from vibroimpact.structure.matrix_files import MatrixFileError, read_matrix

PACKED = 400 * 10**6  # bytes of zeros, which compress to 0.4 MB
IDENTITY = "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 1\n2 2 1\n"
SYMMETRIC = "%%MatrixMarket matrix array real symmetric\n2 2\n2\n1\n2\n"


class Order:
    """What runs a command where it is unpickled."""

    def __reduce__(self):
        return os.system, ("touch executed",)


def npy(shape, data=b""):
    """The bytes of a NumPy array of float64 that claims a shape."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + data


def archive(path, content, blocks=1):
    """Write a .npz file with the matrix M of repeated content."""
    with (
        zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file,
        file.open("M.npy", "w", force_zip64=True) as member,
    ):
        for block in (content, *[bytes(10**7)] * (blocks - 1)):
            member.write(block)


def packed_matlab(path):
    """Write a MATLAB file whose variable expands to 400 MB of zeros."""
    io.savemat(path, {"M": np.eye(2)})
    stream = zlib.compressobj()
    blocks = [struct.pack("<II", 14, PACKED), *[bytes(10**7)] * (PACKED // 10**7)]
    packed = b"".join(map(stream.compress, blocks)) + stream.flush()
    header = path.read_bytes()[:128]
    path.write_bytes(header + struct.pack("<II", 15, len(packed)) + packed)


def pickled(path):
    """Write a .npz file whose matrix is a pickled command."""
    np.savez(path, M=np.array([Order(), 1], dtype=object))


def version_73(path):
    """Write the header of a MATLAB 7.3 file."""
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM" + bytes(1000))


def text(content):
    """The function that writes a text."""
    return lambda path: path.write_text(content)


HOSTILE = {
    "a NumPy archive that expands to 400 MB": (
        "x.npz",
        lambda path: archive(path, npy((7071, 7071)), PACKED // 10**7),
        "far more than",
    ),
    "a NumPy array that claims 1e12 rows": (
        "x.npz",
        lambda path: archive(path, npy((10**12, 1))),
        "claims the shape",
    ),
    "a NumPy array with a pickled command": (
        "x.npz",
        pickled,
        "Python objects, which are not read",
    ),
    "a bare pickle named .npz": (
        "x.npz",
        lambda path: path.write_bytes(pickle.dumps(Order())),
        "cannot be read as NumPy .npz",
    ),
    "a MATLAB file that expands to 400 MB": ("x.mat", packed_matlab, "far more than the file"),
    "a MATLAB 7.3 file": ("x.mat", version_73, "is of MATLAB 7.3: save it with save -v7"),
    "a MatrixMarket file that claims 1e12 rows": (
        "x.mtx",
        text(IDENTITY.replace("2 2 2", f"{10**12} {10**12} 2")),
        "a square matrix of at most",
    ),
    "a MatrixMarket file that claims 1e12 entries": (
        "x.mtx",
        text(IDENTITY.replace("2 2 2", f"2 2 {10**12}")),
        "its header says 1000000000000",
    ),
    "a MatrixMarket file with a row that is not there": (
        "x.mtx",
        text(IDENTITY.replace("2 2 1", "3 2 1")),
        "row 3 and column 2, of 2: count from 1",
    ),
    "a MatrixMarket file with an entry twice": (
        "x.mtx",
        text(IDENTITY.replace("2 2 1", "1 1 1")),
        "row 1 and column 1 more than once",
    ),
    "a MatrixMarket file that ends early": ("x.mtx", text(SYMMETRIC[:-2]), "holds 2 values"),
    "a matrix with a value that is not a number": (
        "x.mtx",
        text(IDENTITY.replace("1 1 1", "1 1 nan")),
        "not finite or beyond 1e+30",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_matrix_file_that_deceives_is_refused(name, tmp_path, monkeypatch, reliability):
    file, write, part = HOSTILE[name]
    monkeypatch.chdir(tmp_path)
    write(tmp_path / file)
    outcome, sentence = guarded(
        lambda: read_matrix(tmp_path / file, "mass"), MatrixFileError, [tmp_path], [file]
    )
    assert outcome == "refused" and part in sentence and "allow_pickle" not in sentence
    assert "\n" not in sentence and not (tmp_path / "executed").exists()
    reliability.fault(name, "refused with a sentence, in little memory")


def test_the_same_files_undamaged_are_read(tmp_path):
    (tmp_path / "a.mtx").write_text(IDENTITY)
    (tmp_path / "b.mtx").write_text(SYMMETRIC)
    archive(tmp_path / "c.npz", npy((2, 2), np.eye(2).tobytes()))
    assert np.array_equal(read_matrix(tmp_path / "a.mtx", "mass").toarray(), np.eye(2))
    assert np.array_equal(read_matrix(tmp_path / "b.mtx", "mass").toarray(), [[2, 1], [1, 2]])
    assert np.array_equal(read_matrix(tmp_path / "c.npz", "mass").toarray(), np.eye(2))
