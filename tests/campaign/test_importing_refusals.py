"""What an import refuses, and what it reads although the file does not say it plainly."""

import os
from pathlib import Path

import h5py
import numpy as np
import pytest
import scipy.io
import yaml
from scipy import sparse

from vibroimpact.campaign.file import channel_signal
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.raw_files import absence
from vibroimpact.campaign.importing.sidecar import read_sidecar
from vibroimpact.io.foreign_arrays import ForeignFileError
from vibroimpact.io.matlab_files import load_matlab
from vibroimpact.io.records import RecordError, read_hdf5_arrays
from vibroimpact.io.signal_files.array_files import read_matlab
from vibroimpact.io.signal_files.signals import ImportProblem

RATE, SAMPLES = 512, 512
HEADER = "time,F [N],tip [µm/s²]"
PLACES = {"point_m": [0, 0, 0], "direction": "+y"}
FORCE = {"name": "F", **PLACES}
TIP = {"name": "tip", "kind": "acceleration", **PLACES}


@pytest.fixture
def values():
    """(sample, (force, tip)) of one file."""
    return np.random.default_rng(3).standard_normal((SAMPLES, 2))


@pytest.fixture
def folder(tmp_path, values):
    """A folder with run.csv."""
    write(tmp_path, values)
    return tmp_path


def write(folder, values, header=HEADER, time=1.0, encoding="utf-8"):
    """Write run.csv; time: its unit in s."""
    rows = [
        f"{index / RATE / time!r},{force!r},{tip!r}"
        for index, (force, tip) in enumerate(values.tolist())
    ]
    (folder / "run.csv").write_bytes("\n".join([header, *rows]).encode(encoding))


def describe(folder, records=({"file": "run.csv"},), **changes):
    """Write campaign.yaml."""
    content = {"forces": [FORCE], "channels": [TIP], "records": list(records), **changes}
    (folder / "campaign.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")


def refusal(folder):
    """The sentences of a refused import."""
    with pytest.raises(ImportProblem) as problem:
        import_folder(folder)
    return str(problem.value)


def test_a_file_cut_into_records_numbers_their_names(folder, values):
    describe(
        folder,
        [{"file": "run.csv", "to_s": 0.5}, {"file": "run.csv", "from_s": 0.5}, {"file": "run.csv"}],
    )
    campaign, rows = import_folder(folder)
    assert campaign["record_name"].values.tolist() == ["run", "run_2", "run_3"]
    assert [row["record"] for row in rows[::2]] == ["run", "run_2", "run_3"]
    np.testing.assert_allclose(
        channel_signal(campaign, 1, 0), 1e-6 * values[256:, 1], rtol=1e-5, atol=1e-12
    )


@pytest.mark.parametrize(
    "records, changes, told",
    [
        ([{"file": "run.csv", "name": "a"}] * 2, {}, "2 records are called 'a'"),
        (
            [{"file": "run.csv"}, {"file": "run.csv"}, {"file": "run.csv", "name": "run_2"}],
            {},
            "2 records are called 'run_2'",
        ),
        ([{"file": "run.csv", "from_s": -0.1}], {}, "records[0].from_s = -0.1 must be >= 0"),
        ([{"file": "run.csv", "to_s": -0.1}], {}, "records[0].to_s = -0.1 must be >= 0"),
        ([{"file": "run.csv", "from_s": 3.0}], {}, "from_s = 3 is beyond the end of run.csv, 1 s"),
        ([{"file": "run.csv", "to_s": 3.0}], {}, "to_s = 3 is beyond the end of run.csv, 1 s"),
        ([{"file": "run.csv", "from_s": 0.5, "to_s": 0.2}], {}, "to_s = 0.2 is not after from_s"),
        ([{"file": "run.csv", "gap_m": 0.2}], {}, "gap_m = 0.2 must be <= 0.1: the radial"),
        ([{"file": "run.csv", "gap_m": -1e-4}], {}, "gap_m = -0.0001 must be >= 0"),
        (
            [{"file": "run.csv", "support_gap_m": [1e-4]}, {"file": "run.csv"}],
            {},
            "support_gap_m has another number of supports in some records",
        ),
        ([{"file": "run.csv", "variables": {"tpi": "F"}}], {}, "'tpi' is no force and no channel"),
        ([{"file": "run.csv"}], {"channels": [{**TIP, "name": "F"}]}, "the name 'F' is given to 2"),
        ([{"file": "run.csv"}], {"channels": [TIP, TIP]}, "the name 'tip' is given to 2"),
        (
            [{"file": "run.csv"}],
            {"channels": [TIP, {**TIP, "name": "b", "variable": "tip"}]},
            "tip and b are the same signal 'tip' of run.csv",
        ),
        ([{"file": "run.csv"}], {"channels": [{**TIP, "unit": "degC"}]}, "no multiple of an SI"),
        ([{"file": "run.csv"}], {"channels": [{**TIP, "unit": "9**9**9"}]}, "is not known"),
        ([{"file": "run.csv"}], {"period_samples": 300, "transient_periods": 1}, "takes 600"),
    ],
)
def test_a_contradictory_sidecar_is_refused(folder, records, changes, told):
    describe(folder, records, **changes)
    assert told in refusal(folder)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "latin-1", "utf-16"])
def test_micrometres_are_read_in_any_encoding(folder, values, encoding):
    write(folder, values, encoding=encoding)
    describe(folder)
    campaign, rows = import_folder(folder)
    np.testing.assert_allclose(channel_signal(campaign, 0, 0), 1e-6 * values[:, 1], rtol=1e-5)
    assert ("Windows-1252" in rows[0]["note"]) == (encoding in ("cp1252", "latin-1"))


def test_a_code_page_that_is_no_latin_1_is_refused(folder, values):
    write(folder, values, encoding="cp850")
    describe(folder)
    assert "tip has the unit 'æm/sý', which is not known" in refusal(folder)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16"])
def test_a_sidecar_that_is_not_utf_8_is_a_sentence(folder, encoding):
    describe(folder)
    text = "source: Meßstand\n" + (folder / "campaign.yaml").read_text(encoding="utf-8")
    (folder / "campaign.yaml").write_bytes(text.encode(encoding))
    assert "campaign.yaml: " in refusal(folder)


def test_time_in_milliseconds_gives_the_rate_in_hertz(folder, values):
    write(folder, values, header=HEADER.replace("time", "time [ms]"), time=1e-3)
    describe(folder)
    assert import_folder(folder)[0].attrs["sampling_frequency"] == RATE


def test_infinity_names_its_line_and_column(folder, values):
    values[36, 1] = np.inf
    write(folder, values)
    describe(folder)
    assert "run.csv, line 38, column tip: inf µm/s² in record run is no" in refusal(folder)


def test_nan_is_a_missing_sample_and_said(folder, values):
    values[36, 1] = np.nan
    write(folder, values)
    describe(folder)
    campaign, rows = import_folder(folder)
    assert np.isnan(campaign["response"].values[0, 0, 36])
    assert rows[1]["note"] == "1 of 512 samples are missing (nan)"


def test_two_columns_of_one_name_are_refused(folder, values):
    write(folder, values, header="time,tip [N],tip [g]")
    describe(folder)
    assert "run.csv: 2 columns are called 'tip'" in refusal(folder)


@pytest.mark.parametrize("name", ["run.csv", "campaign.yaml"])
def test_a_link_out_of_the_folder_is_refused(folder, tmp_path_factory, name):
    describe(folder)
    other = tmp_path_factory.mktemp("other") / name
    (folder / name).rename(other)
    (folder / name).symlink_to(other)
    assert f"{name}: is a link to {other}, out of the folder" in refusal(folder)


def test_a_file_that_claims_terabytes_is_refused_at_once(tmp_path):
    with h5py.File(tmp_path / "run.mat", "w") as file:
        file.create_dataset("F", (10**6, 10**6), "f8", chunks=(100, 100))
    with pytest.raises(RecordError, match="'F' claims 8e\\+12 bytes, more than the file can hold"):
        read_hdf5_arrays(tmp_path / "run.mat")


def test_damaged_number_types_of_hdf5_are_refused(tmp_path):
    """One bit of the exponent's bias doubles every value; HDF5 converts them without a word."""
    path = tmp_path / "run.mat"
    with h5py.File(path, "w") as file:
        file["F"] = np.arange(1.0, 9.0)
    raw, bias = path.read_bytes(), b"\x34\xff\x03\x00\x00"
    assert raw.count(bias) == 1
    path.write_bytes(raw.replace(bias, b"\x34\xfe\x03\x00\x00"))
    with h5py.File(path) as file:
        assert file["F"][0] == 2.0
    with pytest.raises(RecordError, match="'F' holds numbers of an unknown type"):
        read_hdf5_arrays(path)


def test_version_5_of_matlab_is_read_as_scipy_reads_it(tmp_path):
    matrix = sparse.csc_array([[0.0, 2.0], [1.0, 0.0], [0.0, 3.0]])
    content = {
        "F": np.arange(6.0).reshape(2, 3),
        "run": {"acc": np.arange(5, dtype=np.int16), "deep": {"x": np.float32(1.5)}},
        "flags": np.array([True, False]),
        "text": "bench",
        "complex": np.array([1j, 2]),
        "sparse": matrix,
        "both": matrix * (1 + 2j),
        "cell": np.array([1, "a"], dtype=object),
        "empty": np.zeros((0, 0)),
    }
    for compressed in (False, True):
        scipy.io.savemat(tmp_path / "a.mat", content, do_compression=compressed)
        found = load_matlab(tmp_path / "a.mat")
        assert sorted(found) == sorted(
            {*content} - {"run", "text", "cell"} | {"run.acc", "run.deep.x"}
        )
        for name in ("F", "flags", "empty"):
            np.testing.assert_array_equal(found[name], np.atleast_2d(content[name]))
        np.testing.assert_array_equal(found["complex"], [[1j, 2]])
        np.testing.assert_array_equal(found["run.acc"], [np.arange(5)])
        assert found["run.deep.x"] == 1.5
        for name in ("sparse", "both"):
            np.testing.assert_array_equal(found[name].toarray(), content[name].toarray())
    scipy.io.savemat(tmp_path / "b.mat", {**content, "F": np.arange(50.0)})
    assert {signal.name for signal in read_matlab(tmp_path / "b.mat")} == {"F"}


def flipped(path, place, bits):
    """Write a file of MATLAB with the variable F, and change bits of one byte."""
    scipy.io.savemat(path, {"F": np.arange(50.0)}, do_compression=False)
    raw = bytearray(path.read_bytes())
    raw[place] ^= bits
    path.write_bytes(raw)
    return path


# Type of the variable, flag of complex numbers, number of rows, type of the values.
@pytest.mark.parametrize("place, bits", [(128, 0xFF), (145, 0x08), (160, 2), (176, 1)])
def test_a_flipped_tag_of_matlab_names_its_place(tmp_path, place, bits):
    path = flipped(tmp_path / "a.mat", place, bits)
    with pytest.raises(ForeignFileError, match="variable that begins at byte 128 can not be read"):
        load_matlab(path)
    with pytest.raises(ImportProblem, match="variable that begins at byte 128 can not be read"):
        read_matlab(path)


def test_a_row_twice_in_a_sparse_matrix_of_matlab_is_refused(tmp_path):
    twice = sparse.csc_array(([1.0, 2.0], [0, 0], [0, 2]), shape=(2, 1))
    scipy.io.savemat(tmp_path / "a.mat", {"K": twice})
    with pytest.raises(ForeignFileError, match="the rows of a column of 'K' do not rise"):
        load_matlab(tmp_path / "a.mat")


def test_small_compressed_variables_count_together(tmp_path):
    content = {name: np.zeros(1000) for name in "ab"}
    scipy.io.savemat(tmp_path / "a.mat", content, do_compression=True)
    assert len(load_matlab(tmp_path / "a.mat", most=20_000)) == 2
    with pytest.raises(ForeignFileError, match="of numbers, at most 1e\\+04 are read"):
        load_matlab(tmp_path / "a.mat", most=10_000)


# Of MATLAB itself: a name in UTF-8, logical values called doubles, big-endian, function handles
# (whose data have no name), version 4.
@pytest.mark.parametrize(
    "file, names",
    [
        ("miutf8_array_name", ["array_name"]),
        ("logical_sparse", ["sp_log_5_4"]),
        ("testsparsecomplex_6.5.1_GLNX86", ["testsparsecomplex"]),
        ("big_endian", ["floats"]),
        ("sqr", []),
        ("testmulti_4.2c_SOL2", ["a", "theta"]),
    ],
)
def test_files_of_matlab_are_read_as_scipy_reads_them(file, names):
    path = Path(scipy.io.__file__).parent / f"matlab/tests/data/{file}.mat"
    if not path.is_file():
        pytest.skip("the files of SciPy's tests are not installed")
    found, expected = load_matlab(path), scipy.io.loadmat(path)
    assert sorted(found) == names
    for name in names:
        pair = [
            values.toarray() if sparse.issparse(values) else values
            for values in (found[name], expected[name])
        ]
        np.testing.assert_array_equal(*pair)


def test_the_reason_why_a_signal_is_not_read_is_told(tmp_path):
    content = {"Fs": 400.0, "F": np.ones(100) * 1j, "short": np.ones(50), "tip": np.ones(100)}
    scipy.io.savemat(tmp_path / "low.mat", content)
    [signal] = read_matlab(tmp_path / "low.mat")
    assert signal.left_out == {
        "F": "holds no real numbers",
        "short": "has 50 samples, the longest signal 100",
    }


def test_a_wanted_file_that_is_no_file_is_called_so(tmp_path):
    (tmp_path / "folder.csv").mkdir()
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "notes.doc").write_text("notes")
    said = {
        "folder.csv": "is a folder, not a file",
        "pipe.csv": "is no ordinary file (a pipe or a device)",
        "notes.doc": "ends in '.doc', a kind of file that is not read",
        "gone.csv": "is not in the folder",
        "../x.csv": "is outside the folder: put a copy into it, only its own files are read",
    }
    assert {name: absence(tmp_path / name) for name in said} == said


def test_problems_of_every_kind_are_told_at_once(tmp_path):
    """Wrong values hide neither contradictions nor names that are given twice."""
    sensor = {"name": "F", "point_m": [0, 0, 0], "direction": "+y"}
    content = {
        "surprise": 1,
        "forces": [sensor],
        "channels": [{**sensor, "point_m": [0, 0]}],
        "records": [
            {"name": "low", "file": "a.csv", "gap_m": 2},
            {"name": "low", "file": "b.csv", "from_s": 3, "to_s": 1, "variables": {"x": "y"}},
        ],
    }
    (tmp_path / "campaign.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    with pytest.raises(ImportProblem) as refusal:
        read_sidecar(tmp_path / "campaign.yaml")
    told = str(refusal.value).splitlines()
    starts = (
        *("channels[0].point_m = [0, 0] has 2 values", "records[0].gap_m = 2 must be"),
        *("unknown key surprise", "the name 'F' is given to 2", "records[1].to_s = 1 is not after"),
        *("records[1].variables: 'x' is no force", "2 records are called 'low'"),
    )
    assert len(told) == len(starts)
    for start in starts:
        assert any(line.startswith(f"{tmp_path / 'campaign.yaml'}: {start}") for line in told), told
