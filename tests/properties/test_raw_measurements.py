"""Folders of raw measurements, damaged: the import refuses them with a sentence, or is right."""

import h5py
import netCDF4
import numpy as np
import pytest
import pyuff
import scipy.io
import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.properties.guarded import Tried, folder_of_example, guarded
from tests.support.universal_file import UNCLOSED, dataset_58
from vibroimpact.campaign.file import (
    channel_signal,
    force_signal,
    read_campaign,
    valid_count,
    write_campaign,
)
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.io.signal_files.signals import ImportProblem

pytestmark = UNCLOSED

RATE, SAMPLES = 512.0, 128
SENSORS = ("shaker", "tip", "middle")
VALUES = {
    level: strength * np.random.default_rng(5).standard_normal((3, SAMPLES)).round(6)
    for level, strength in (("low", 1.0), ("high", 4.0))
}
UNITS = ("lbf", "mm/s²", "g")
SI = (4.4482216152605, 1e-3, 9.80665)


def described(suffix, **changes):
    """The content of a valid campaign.yaml."""
    places = [{"point_m": [0.1 * index, 0, 0], "direction": "+y"} for index in range(3)]
    sensors = [
        {"name": name, "unit": unit, **place}
        for name, unit, place in zip(SENSORS, UNITS, places, strict=True)
    ]
    return {
        "source": "bench",
        "antialias": "none",
        "sampling_frequency_Hz": RATE,
        "forces": sensors[:1],
        "channels": [{**sensor, "kind": "acceleration"} for sensor in sensors[1:]],
        "records": [
            {"name": level, "file": f"{level}.{suffix}", "gap_m": 2e-4} for level in VALUES
        ],
        **changes,
    }


def write_sidecar(folder, content):
    """Write campaign.yaml in UTF-8."""
    text = yaml.safe_dump(content, allow_unicode=True, sort_keys=False)
    (folder / "campaign.yaml").write_text(text, encoding="utf-8")


def imported(folder):
    """What the rule import_campaign does with a folder, read back from the file."""
    campaign, rows = import_folder(folder)
    write_campaign(campaign, folder / "out" / "campaign.nc")
    return read_campaign(folder / "out" / "campaign.nc"), rows


def outcome_of(folder, tried):
    """The outcome of the guarded import: a refusal names the folder or a file in it."""
    names = [file.name for file in folder.iterdir()] + ["campaign.yaml", folder.name]
    return tried.add(guarded(lambda: imported(folder), ImportProblem, [folder], names))


def differences(campaign):
    """(samples that differ from what was written, samples lost at the ends), in SI units.

    Names, order and sampling frequency must be those that were written.
    """
    assert campaign.attrs["sampling_frequency"] == RATE
    assert campaign["record_name"].values.tolist() == [*VALUES]
    assert [*campaign["force_channel_name"].values, *campaign["channel_name"].values] == [*SENSORS]
    changed = lost = 0
    for record, level in enumerate(VALUES):
        found = np.array(
            [force_signal(campaign, record)]
            + [channel_signal(campaign, record, channel) for channel in range(2)]
        )
        expected = VALUES[level] * np.array(SI)[:, None]
        lost += SAMPLES - found.shape[-1]
        same = np.isclose(found, expected[:, : found.shape[-1]], rtol=1e-5, atol=1e-7)
        changed += int(np.count_nonzero(~same))
    return changed, lost


def told(rows):
    """What the report of an import notes."""
    return " ".join(row["note"] for row in rows)


DAMAGES = st.tuples(
    st.sampled_from(["flip", "flip", "cut", "remove", "insert", "zero", "empty"]),
    st.floats(0, 1, exclude_max=True),
    st.booleans(),
    st.integers(1, 255),
)


def apply(damage, file):
    """Damage a file at one place: (kind, share of the file, only its begin, number)."""
    kind, place, early, number = damage
    raw = file.read_bytes()
    at = int(place * (min(len(raw), 1500) if early else len(raw)))
    file.write_bytes(
        {
            "flip": raw[:at] + bytes([raw[at] ^ number]) + raw[at + 1 :],
            "zero": raw[:at] + bytes(min(8, len(raw) - at)) + raw[at + 8 :],
            "insert": raw[:at] + bytes([number]) * 3 + raw[at:],
            "remove": raw[:at] + raw[at + number :],
            "cut": raw[:at],
            "empty": b"",
        }[kind]
    )


ODD = [np.nan, np.inf, -np.inf, 1e30, -1e300, 5e-324, 0.0, -0.0, 7.25]


def write_csv(folder, encoding="utf-8", cell=None, names=None, newline="\n"):
    """Two CSV files with units in the header; cell (row, column, text) of the first is replaced."""
    names = names or ["time", "shaker [lbf]", "tip [mm/s²]", "middle [g]"]
    for level, values in VALUES.items():
        table = [[repr(float(value)) for value in row] for row in values.T]
        table = [[repr(index / RATE), *row] for index, row in enumerate(table)]
        if cell and level == "low":
            table[cell[0]][cell[1]] = cell[2]
        text = newline.join(";".join(row) for row in [names, *table]) + newline
        (folder / f"{level}.csv").write_bytes(text.encode(encoding))
    content = described("csv")
    for sensor in (*content["forces"], *content["channels"]):
        del sensor["unit"]
    write_sidecar(folder, content)


CELLS = [
    "nan",
    "inf",
    "-Infinity",
    "1e30",
    "1e400",
    "",
    "1,5",
    "1_000",
    "abc",
    "٣",
    "0x10",
    " 7.25 ",
]
HEADERS = [
    ["time", "tip [lbf]", "tip [mm/s²]", "middle [g]"],
    ["time", "shaker [lbf]", "tip [mm/s²]", "tip [g]"],
    ["time [parsec]", "shaker [lbf]", "tip [mm/s²]", "middle [g]"],
    ["time", "shaker [mm]", "tip [9**9**9]", "middle [degC]"],
    ["time", "shaker", "tip [mm/s²]", "middle [g]"],
    ["time", "shaker [lbf]", "tip [mm/s²]"],
]
ENCODINGS = ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "cp850", "iso8859-15"]


def damaged_csv_files(data, tried):
    """Any byte, cell, header, encoding and end of line."""
    with folder_of_example() as folder:
        kind = data.draw(st.sampled_from(["bytes", "cell", "header", "text"]))
        if kind == "bytes":
            write_csv(folder)
            content = described("csv")  # a digit of a unit may change: the sidecar states it
            write_sidecar(folder, content)
            apply(data.draw(DAMAGES), folder / "low.csv")
        elif kind == "cell":
            row, column = data.draw(st.integers(0, SAMPLES - 1)), data.draw(st.integers(0, 3))
            write_csv(folder, cell=(row, column, data.draw(st.sampled_from(CELLS))))
        elif kind == "header":
            write_csv(folder, names=data.draw(st.sampled_from(HEADERS)))
        else:
            newline = data.draw(st.sampled_from(["\n", "\r\n", "\r", "\n\n"]))
            write_csv(folder, data.draw(st.sampled_from(ENCODINGS)), newline=newline)
        outcome, result = outcome_of(folder, tried)
        if outcome == "right":
            changed, lost = differences(result[0])
            assert lost == 0 or kind == "bytes"
            assert changed <= {"bytes": 1, "cell": 1, "text": 0, "header": -1}[kind] or (
                "interpolated" in told(result[1])
            )
        elif kind == "cell":
            assert f"line {row + 2}" in result or column == 0 or "inf" in result


def write_mat(folder, version, rate, compressed, structure, force):
    """Two MAT files: F, A with two rows, Fs; force replaces the force of the first."""
    for level, values in VALUES.items():
        shaker = force if force is not None and level == "low" else values[0]
        named = {"F": shaker, "A": values[1:].T, "Fs": rate, "note": "bench"}
        if version == 5:
            content = {"run": named, "Fs": rate} if structure else named
            scipy.io.savemat(folder / f"{level}.mat", content, do_compression=compressed)
            continue
        with h5py.File(folder / f"{level}.mat", "w", userblock_size=512) as file:
            group = file.create_group("run") if structure else file
            packing = {"compression": "gzip", "chunks": True} if compressed else {}
            group.create_dataset("F", data=shaker[None], **packing)
            group.create_dataset("A", data=values[1:], **packing)
            if rate is not None:
                file["Fs"] = rate if isinstance(rate, str) else np.atleast_2d(rate)
    prefix = "run." if structure else ""
    content = described("mat")
    for sensor, name in zip(
        (*content["forces"], *content["channels"]), ("F", "A[0]", "A[1]"), strict=True
    ):
        sensor["variable"] = prefix + name
    write_sidecar(folder, content)


def refer_elsewhere(path, variable, other, kind):
    """Let a variable of an HDF5 file refer to the numbers of another file, or claim 7 TiB."""
    with h5py.File(path, "r+") as file:
        parent, name = file[variable].parent, variable.split("/")[-1]
        numbers = file[variable][()]
        shape, dtype = numbers.shape, numbers.dtype
        del parent[name]
        if kind == "link":
            with h5py.File(other, "w") as target:
                target["x"] = numbers
            parent[name] = h5py.ExternalLink(str(other), "x")
        elif kind == "storage":
            other.write_bytes(numbers.tobytes())
            parent.create_dataset(name, shape, dtype, external=[(str(other), 0, numbers.nbytes)])
        elif kind == "virtual":
            with h5py.File(other, "w") as target:
                target["x"] = numbers
            layout = h5py.VirtualLayout(shape, dtype)
            layout[...] = h5py.VirtualSource(str(other), "x", shape)
            parent.create_virtual_dataset(name, layout)
        else:
            parent.create_dataset(name, (10**6, 10**6), dtype, chunks=(100, 100))


ELSEWHERE = ["link", "storage", "virtual", "size"]
RATES = [RATE, np.nan, -1.0, 0.0, np.inf, np.arange(3.0), "fast", 1000.0]


def damaged_mat_files(data, tried):
    """Any byte of v5 and v7.3, odd values and sampling, references to other files, huge sizes."""
    with folder_of_example() as outside, folder_of_example() as folder:
        version = data.draw(st.sampled_from([5, 7]))
        compressed, structure = data.draw(st.booleans()), data.draw(st.booleans())
        kinds = [
            "bytes",
            "bytes",
            "value",
            "rate",
            "none",
            *(["elsewhere"] if version == 7 else []),
        ]
        kind = data.draw(st.sampled_from(kinds))
        rate, force = RATE, None
        if kind == "rate":
            rate = data.draw(st.sampled_from(RATES))
        if kind == "value":
            force = VALUES["low"][0].copy()
            force[data.draw(st.integers(0, SAMPLES - 1))] = data.draw(st.sampled_from(ODD))
        write_mat(folder, version, rate, compressed, structure, force)
        if kind == "bytes":
            apply(data.draw(DAMAGES), folder / "low.mat")
        if kind == "elsewhere":
            variable = "run/F" if structure else "F"
            what = data.draw(st.sampled_from(ELSEWHERE))
            refer_elsewhere(folder / "low.mat", variable, outside / "other", what)
        outcome, result = outcome_of(folder, tried)
        assert outcome == "refused" or kind != "elsewhere"
        if outcome == "right":
            changed, lost = differences(result[0])
            assert lost == 0 and changed <= {"bytes": 2, "value": 1}.get(kind, 0)


def write_netcdf(folder, form, units, extra, force):
    """Two netCDF files with time, F and A; force replaces the force of the first."""
    for level, values in VALUES.items():
        shaker = force if force is not None and level == "low" else values[0]
        with netCDF4.Dataset(folder / f"{level}.nc", "w", format=form) as file:
            file.createDimension("time", SAMPLES)
            file.createDimension("sensor", 2)
            time = file.createVariable("time", "f8", ("time",))
            time[:] = np.arange(SAMPLES) / RATE
            if units is not None:
                time.units = units
            file.createVariable("F", "f8", ("time",))[:] = shaker
            file.createVariable("A", "f8", ("sensor", "time"))[:] = values[1:]
            file["A"].setncatts(extra if level == "low" else {})
    content = described("nc")
    for sensor, name in zip(
        (*content["forces"], *content["channels"]), ("F", "A[0]", "A[1]"), strict=True
    ):
        sensor["variable"] = name
    write_sidecar(folder, content)


FORMS = ["NETCDF4", "NETCDF4_CLASSIC", "NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET"]
TIMES = [None, "s", "ms", "seconds since 2000-01-01", "days since yesterday", "furlongs", "", 5]
EXTRAS = [
    {},
    {"scale_factor": np.nan},
    {"scale_factor": "two"},
    {"add_offset": np.inf},
    {"valid_range": np.array([-1e-3, 1e-3])},
    {"missing_value": "none"},
    {"units": 7},
    {"coordinates": "nothing here"},
]


def damaged_netcdf_files(data, tried):
    """Any byte, odd units of time, odd attributes and values, references to other files."""
    with folder_of_example() as outside, folder_of_example() as folder:
        form = data.draw(st.sampled_from(FORMS))
        units, extra, force = "s", {}, None
        kinds = ["bytes", "bytes", "value", "units", "extra"]
        kind = data.draw(st.sampled_from(kinds + ["elsewhere"] * (form == "NETCDF4")))
        if kind == "units":
            units = data.draw(st.sampled_from(TIMES))
        if kind == "extra":
            extra = data.draw(st.sampled_from(EXTRAS))
        if kind == "value":
            force = VALUES["low"][0].copy()
            force[data.draw(st.integers(0, SAMPLES - 1))] = data.draw(st.sampled_from(ODD))
        write_netcdf(folder, form, units, extra, force)
        if kind == "bytes":
            apply(data.draw(DAMAGES), folder / "low.nc")
        if kind == "elsewhere":
            what = data.draw(st.sampled_from(ELSEWHERE))
            refer_elsewhere(folder / "low.nc", "F", outside / "other", what)
        outcome, result = outcome_of(folder, tried)
        assert outcome == "refused" or kind != "elsewhere"
        if outcome == "right":
            changed, lost = differences(result[0])
            most = {"bytes": 2, "value": 1, "extra": 2 * SAMPLES}.get(kind, 0)
            assert lost == 0 and (changed <= most or "interpolated" in told(result[1]))


def uff_sets(values, binary, even, units):
    """Datasets 58 of three signals."""
    for number, (row, label) in enumerate(zip(values, units, strict=True), start=1):
        yield dataset_58(
            row,
            np.arange(SAMPLES) / RATE,
            number,
            2,
            binary=binary,
            abscissa_spacing=int(even),
            ordinate_spec_data_type=13 if number == 1 else 12,
            ordinate_axis_units_lab=label,
            id1=f"signal {number}",
        )


def write_uff(folder, binary, even, stated):
    """Two universal files; units in their labels, or stated in the sidecar."""
    for level, values in VALUES.items():
        sets = list(uff_sets(values, binary, even, UNITS))
        pyuff.UFF(str(folder / f"{level}.uff")).write_sets(sets, "add")
    content = described("uff")
    sensors = (*content["forces"], *content["channels"])
    for number, sensor in enumerate(sensors, start=1):
        sensor["variable"] = f"{number}:+y"
        if not stated:
            del sensor["unit"]
    write_sidecar(folder, content)


def in_header(raw, old, new):
    """Replace a text in the headers of a file by one of the same length."""
    assert len(old) == len(new) and old in raw
    return raw.replace(old, new)


LABELS = [
    ("mm/s²".encode() + b"  ", "mm/s²".encode("cp1252") + b"   "),
    ("mm/s²".encode() + b"  ", "mm/s²".encode("cp1252") + b" \xff "),
    (b"lbf ", b"mm  "),
    (b"s                   ", b"ms                  "),
    (b"s                   ", b"parsec              "),
    (b"         2   2", b"         1   2"),
    (b"       128", b"       127"),
    (b"       128", b"        -1"),
    (b"1.95312e-03", b"        nan"),
    (b"    58", b"    5x"),
]


def damaged_universal_files(data, tried):
    """Any byte of ASCII and binary files, labels in other encodings, odd headers."""
    with folder_of_example() as folder:
        kind = data.draw(st.sampled_from(["bytes", "bytes", "header", "none"]))
        binary, even = data.draw(st.integers(0, 1)), data.draw(st.booleans())
        write_uff(folder, binary, even, stated=kind == "bytes")
        file = folder / "low.uff"
        label = 0
        if kind == "bytes":
            apply(data.draw(DAMAGES), file)
        if kind == "header":
            label = data.draw(st.integers(0, len(LABELS) - 1 - 2 * (not even)))
            old, new = LABELS[label]
            if old in file.read_bytes():
                file.write_bytes(in_header(file.read_bytes(), old, new))
        outcome, result = outcome_of(folder, tried)
        assert outcome == "right" or kind == "bytes" or label
        if outcome == "right":
            changed, lost = differences(result[0])
            assert lost == 0 and (
                changed <= 2 * (kind == "bytes") or "interpolated" in told(result[1])
            )


WORDS = [
    "",
    " ",
    "tip",
    "shaker",
    "low",
    "m/s²",
    "a\nb",
    "\ud800",
    "x" * 300,
    "../low.csv",
    "/etc/passwd",
]
ANYTHING = st.one_of(
    st.sampled_from([None, True, -1, 0, 1, 2, 0.1, 0.2, 1e30, -1e-9, np.nan, np.inf, 10**40]),
    st.sampled_from(WORDS),
    st.sampled_from([[], {}, [1e-4], [1e-4, 2e-4], [0, 0, 0], [1, 2, "3"], {"tip": "middle"}]),
)
KEYS = [
    ("sampling_frequency_Hz",),
    ("antialias",),
    ("start_up",),
    ("period_samples",),
    ("transient_periods",),
    ("source",),
    ("voltage",),
    ("surprise",),
    *[("forces", 0, key) for key in ("name", "variable", "unit", "point_m", "direction")],
    *[("channels", 1, key) for key in ("name", "variable", "unit", "kind", "direction")],
    *[("records", 1, key) for key in ("name", "file", "files", "split", "repeat", "variables")],
    *[("records", 1, key) for key in ("gap_m", "support_gap_m", "from_s", "to_s")],
    ("records", 0, "support_gap_m"),
    ("records",),
]
USUAL = {
    "from_s": [0, 0.05, 0.1, 0.3],
    "to_s": [0.1, 0.2, 0.25, 0.3],
    "gap_m": [0, 1e-4, 2e-4, 0.2],
    "name": ["low", "tip", "à b", "third"],
    "file": ["low.csv", "high.csv"],
    "variable": ["tip", "middle", "shaker"],
    "variables": [{"tip": "middle", "middle": "tip"}, {"tip": "middle"}, {"tpi": "middle"}],
    "unit": ["m s-2", "N", "g", "degC"],
    "direction": ["-x", [0, 3, 4], [0, 0, 0]],
    "point_m": [[0, 0, 1], [0, 0]],
    "split": ["holdout", "train"],
    "repeat": [0, 3],
    "period_samples": [16, 64, 128, 500],
    "transient_periods": [0, 1, 50],
    "source": ["a bench"],
    "support_gap_m": [[1e-4], [1e-4, 2e-4]],
    "sampling_frequency_Hz": [512, 500],
}
TEXTS = [
    lambda text: text.encode("cp1252"),
    lambda text: text.encode("utf-16"),
    lambda text: text.encode("utf-8-sig"),
    lambda text: text.replace("source:", "\tsource:").encode(),
    lambda text: (text + "source: again\n").encode(),
    lambda text: (text + "voltage: !!python/object/apply:os.getcwd []\n").encode(),
    lambda text: (text + "voltage: !!python/name:os.system\n").encode(),
    lambda text: (text + "voltage: &a {variable: *a, unit: V}\n").encode(),
    lambda text: b"",
]


def set_at(content, keys, value):
    """Set a value inside nested lists and mappings, where they are still there."""
    for key in keys[:-1]:
        content = content[key]
    if isinstance(content, (dict, list)):
        content[keys[-1]] = value


def cut_as_described(content, record):
    """What a record of a valid campaign.yaml holds (3, time), as stored, and its units."""
    stated = content["records"][record]
    rate = content["sampling_frequency_Hz"] or RATE
    first = round((stated.get("from_s") or 0) * rate)
    last = round(stated["to_s"] * rate) if stated.get("to_s") else SAMPLES
    level = (stated.get("file") or stated["files"][0]).removesuffix(".csv")
    rows = {"shaker": 0, "tip": 1, "middle": 2}
    sensors = [*content["forces"], *content["channels"]]
    chosen = [
        rows[
            (stated.get("variables") or {}).get(sensor["name"], sensor.get("variable"))
            or sensor["name"]
        ]
        for sensor in sensors
    ]
    units = [sensor["unit"] or UNITS[row] for sensor, row in zip(sensors, chosen, strict=True)]
    return VALUES[level][chosen, first:last], units


def damaged_campaign_yaml(data, tried):
    """Any value of any key, encodings, tags that would run code, links out of the folder."""
    with folder_of_example() as outside, folder_of_example() as folder:
        write_csv(folder)
        content = described("csv")
        kind = data.draw(st.sampled_from(["keys", "keys", "keys", "text", "bytes", "link"]))
        write_sidecar(folder, content)
        file = folder / "campaign.yaml"
        if kind == "keys":
            for keys in data.draw(st.lists(st.sampled_from(KEYS), min_size=1, max_size=3)):
                if len(keys) == 1 or isinstance(content.get(keys[0]), list):
                    usual = st.sampled_from(USUAL.get(keys[-1], [None]))
                    value = data.draw(st.one_of(usual, usual, ANYTHING))
                    if len(keys) == 1 or len(content[keys[0]]) > keys[1]:
                        set_at(content, keys, value)
            file.write_text(yaml.safe_dump(content, allow_unicode=False), encoding="utf-8")
        elif kind == "text":
            change = data.draw(st.sampled_from(TEXTS))
            file.write_bytes(change(file.read_text(encoding="utf-8")))
        elif kind == "bytes":
            apply(data.draw(DAMAGES), file)
        else:
            moved = folder / data.draw(st.sampled_from(["low.csv", "campaign.yaml"]))
            moved.rename(outside / moved.name)
            moved.symlink_to(outside / moved.name)
        outcome, result = outcome_of(folder, tried)
        assert outcome == "refused" or kind != "link"
        if outcome == "right" and kind == "keys":
            campaign = result[0]
            names = campaign["record_name"].values.tolist()
            assert len({*names}) == len(names) == len(content["records"])
            gaps = [record.get("gap_m") for record in content["records"]]
            assert all(
                np.isnan(found) if stated is None else found == stated
                for found, stated in zip(campaign["gap"].values, gaps, strict=True)
            )
            for record in range(len(names)):
                expected, units = cut_as_described(content, record)
                stored = [*campaign["force"].values[record], *campaign["response"].values[record]]
                count = valid_count(campaign, record)
                assert units == [
                    *campaign["force_channel_units"].values,
                    *campaign["channel_units"].values,
                ]
                np.testing.assert_allclose(
                    np.array(stored)[:, :count], expected.astype(np.float32), rtol=1e-6
                )


FORMATS = {
    "CSV files of raw measurements": damaged_csv_files,
    "MATLAB files of raw measurements": damaged_mat_files,
    "netCDF files of raw measurements": damaged_netcdf_files,
    "universal files of raw measurements": damaged_universal_files,
    "campaign.yaml of raw measurements": damaged_campaign_yaml,
}


@pytest.mark.parametrize("what", FORMATS)
def test_damaged_raw_measurements_are_refused_or_right(what, reliability):
    """Each starts from a valid folder and damages it at one place."""
    tried = Tried()

    @given(st.data())
    def example(data):
        FORMATS[what](data, tried)

    example()
    assert min(tried.outcomes["refused"], tried.outcomes["right"]) > 1
    reliability.inputs(what, tried)
