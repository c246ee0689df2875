"""Matrices from Nastran OP4 files: every form of the format, the names in it, what is refused, and
the frequencies of what is built.
"""

import sys

import numpy as np
import pytest
from scipy import sparse

from vibroimpact.config.reading import check_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.matrix_files import OP4_READER, MatrixFileError, read_matrix
from vibroimpact.structure.point_structure import build_point_structure

# Two masses of 2 kg between three springs of 8000 N/m, ground to ground: omega² = k / m and 3 k /
# m.
MASS, STIFFNESS = np.diag([2.0, 2.0]), np.array([[16.0e3, -8.0e3], [-8.0e3, 16.0e3]])
OMEGA = np.sqrt([4.0e3, 12.0e3])
DAMPING = np.array([[5.0, -1.0], [-1.0, 5.0]])

# By hand, as the format is documented: columns, rows (negative: bigmat), form, type, name, number
# format; then column, first row (0: sparse), length. The stiffness is sparse, each column one
# string: 4 words and 1, first row.
BY_HAND = """\
       2       2       6       2MGG     1P,3E23.16
       1       1       1
 2.0000000000000000E+00
       2       2       1
 2.0000000000000000E+00
       3       1       1
 1.0000000000000000E+00
       2      -2       6       2KGG     1P,3E23.16
       1       0       6
       5       1
 1.6000000000000000E+04-8.0000000000000000E+03
       2       0       6
       5       1
-8.0000000000000000E+03 1.6000000000000000E+04
       3       1       1
 1.0000000000000000E+00
"""


@pytest.fixture
def op4():
    """The library that writes OP4 files for these tests, and reads them for the project."""
    pytest.importorskip(
        "pyyeti", reason=f"OP4 files need pyyeti, which is not installed: pip install {OP4_READER}"
    )
    from pyyeti.nastran import op4

    return op4


def frequencies(path):
    """Angular frequencies (2,) rad/s of the model built from an OP4 file with mass and stiffness in
    it.
    """
    structure = {
        "kind": "matrices",
        "mass": str(path),
        "stiffness": str(path),
        "points": {"a": {"x": 0}, "b": {"x": 1}},
    }
    config = check_config(
        {
            "study": "op4",
            "structure": structure,
            "damping": {"kind": "modal", "other_ratio": 0.0},
            "excitation": {"kind": "none"},
            "integration": {"steps_per_second": 20000, "start_up_s": 0.0, "imperfection": 0.0},
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0], "seeds": 1},
            "record": {"duration_s": 0.5, "every_step": True},
        },
        "op4",
    )
    built = build_point_structure(config)
    assert np.array_equal(built.mass.toarray(), MASS) and np.array_equal(
        built.stiffness.toarray(), STIFFNESS
    )
    return build_model(config).omega


@pytest.mark.parametrize("form", ["dense", "bigmat", "nonbigmat"])
@pytest.mark.parametrize(
    "file",
    [{"binary": True, "endian": "<"}, {"binary": True, "endian": ">"}, {"binary": False}],
    ids=["little", "big", "ascii"],
)
def test_every_form_of_the_format_has_the_same_frequencies(tmp_path, op4, form, file):
    op4.write(
        str(tmp_path / "plate.op4"),
        ["KGG", "V", "MGG"],
        [STIFFNESS, np.ones((2, 3)), MASS],
        sparse=form,
        **file,
    )
    assert frequencies(tmp_path / "plate.op4") == pytest.approx(OMEGA, rel=1e-12)


def test_a_file_written_by_hand_has_them_too(tmp_path, op4):
    (tmp_path / "HAND.OP4").write_text(BY_HAND)
    assert frequencies(tmp_path / "HAND.OP4") == pytest.approx(OMEGA, rel=1e-12)


@pytest.mark.parametrize(
    "names",
    [
        ("MASS", "Stiffnes", "damping"),
        ("m", "K", "C"),
        ("M", "K", "B"),
        ("MGG", "KGG", "BGG"),
        ("maa", "kaa", "baa"),
        ("MXX", "KXX", "BXX"),
        ("MLL", "KLL", "BLL"),
    ],
    ids=" ".join,
)
def test_matrices_are_known_by_their_names(tmp_path, op4, names):
    op4.write(
        str(tmp_path / "all.op4"),
        ["K4GG", "PHIX", *names],
        [np.eye(2), np.ones((2, 2)), MASS, STIFFNESS, sparse.csr_matrix(DAMPING)],
    )
    for name, matrix in (("mass", MASS), ("stiffness", STIFFNESS), ("damping", DAMPING)):
        assert np.array_equal(read_matrix(tmp_path / "all.op4", name).toarray(), matrix)


def test_single_matrix_needs_no_name(tmp_path, op4):
    op4.write(str(tmp_path / "one.op4"), ["whole"], [MASS])
    assert np.array_equal(read_matrix(tmp_path / "one.op4", "mass").toarray(), MASS)
    op4.write(str(tmp_path / "more.op4"), ["mgg", "maa", "mass"], [np.eye(2), np.eye(2), MASS])
    assert np.array_equal(read_matrix(tmp_path / "more.op4", "mass").toarray(), MASS)


@pytest.mark.parametrize("binary", [True, False])
def test_one_of_several_sets_is_chosen(tmp_path, op4, binary):
    path = tmp_path / "sets.op4"
    parts = [np.diag([1.0, 2.0, 3.0]), np.diag([4.0, 5.0]), np.diag([6.0, 7.0])]
    op4.write(str(path), ["MAA", "KAA", "MAA", "MGG"], [parts[0], STIFFNESS, *parts[1:]], binary)
    for chosen, matrix in (("aa1", parts[0]), ("aa2", parts[1]), ("gg", parts[2])):
        assert np.array_equal(read_matrix(path, "mass", chosen).toarray(), matrix)
    for wrong, told in (
        ("aa3", "aa3 finds no mass"),
        ("ll", "ll finds no mass"),
        ("aa", "aa1 or aa2"),
    ):
        with pytest.raises(MatrixFileError, match=told):
            read_matrix(path, "mass", wrong)


def test_unusable_op4_files_are_refused(tmp_path, op4):
    for name, matrices in (
        ("complex", [("MGG", MASS + 1j), ("KGG", STIFFNESS)]),
        ("long", [("MGG", np.ones((2, 3))), ("KGG", STIFFNESS)]),
        ("half", [("MGG", np.triu(STIFFNESS)), ("KGG", STIFFNESS)]),
        ("sets", [("MGG", MASS), ("MAA", MASS)]),
        ("twice", [("MGG", MASS), ("MGG", MASS)]),
        ("others", [("KGG", STIFFNESS), ("MHH", MASS)]),
    ):
        op4.write(
            str(tmp_path / f"{name}.op4"),
            [each for each, _ in matrices],
            [matrix for _, matrix in matrices],
        )
    (tmp_path / "cut.op4").write_text(BY_HAND[:120])
    (tmp_path / "cut_binary.op4").write_bytes((tmp_path / "sets.op4").read_bytes()[:100])
    (tmp_path / "text.op4").write_text("No matrix, but a letter about one.")
    (tmp_path / "empty.op4").write_text("")
    for name, part in (
        ("complex", "mass is complex: give its real part"),
        ("long", "a square matrix is needed"),
        ("half", "not symmetric"),
        ("sets", "mgg, maa could each be the mass matrix: choose .*op4_set: gg or aa"),
        ("twice", "mgg, mgg could each be the mass matrix: choose .*op4_set: gg1 or gg2"),
        ("others", "holds kgg, mhh: name the mass matrix M, or as Nastran does, MGG"),
        ("cut", "cannot be read as OP4"),
        ("cut_binary", "cannot be read as OP4"),
        ("text", "cannot be read as OP4"),
        ("empty", "cannot be read as OP4"),
    ):
        with pytest.raises(MatrixFileError, match=part):
            read_matrix(tmp_path / f"{name}.op4", "mass")


def test_missing_op4_reader_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "hand.op4").write_text(BY_HAND)
    monkeypatch.setitem(sys.modules, "pyyeti.nastran", None)
    with pytest.raises(
        MatrixFileError, match=f"reading OP4 needs pyyeti: pip install {OP4_READER}"
    ):
        read_matrix(tmp_path / "hand.op4", "mass")
