"""Importers: one small measurement written in every format comes back as the same campaign, and
what files do not say is asked for.
"""

from pathlib import Path

import numpy as np
import pytest
import pyuff
import scipy.io
import yaml

from tests.support.universal_file import UNCLOSED, dataset_58
from vibroimpact.campaign.checks.file_checks import check_campaign, refused
from vibroimpact.campaign.file import channel_signal, force_signal, read_campaign, write_campaign
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.draft import checked_folder
from vibroimpact.campaign.importing.report import import_text
from vibroimpact.campaign.importing.uff import read_uff
from vibroimpact.io.signal_files.signals import ImportProblem, even_samples

pytestmark = UNCLOSED

DATA = Path(__file__).parents[2].parent / "shared" / "data"
RATE, SAMPLES = 512.0, 3000
LBF = 4.4482216152605
SIDECAR = {
    "source": "bench test",
    "antialias": "none",
    "forces": [
        {
            "name": "shaker",
            "variable": "F",
            "unit": "lbf",
            "point_m": [0.1, 0, 0],
            "direction": "+y",
        }
    ],
    "channels": [
        {
            "name": "tip",
            "variable": "A[0]",
            "unit": "g",
            "kind": "acceleration",
            "point_m": [0.5, 0, 0],
            "direction": "-y",
        },
        {
            "name": "middle",
            "variable": "A[1]",
            "unit": "mm/s²",
            "kind": "acceleration",
            "point_m": [0.25, 0, 0],
            "direction": [0, 3, 4],
        },
    ],
}


@pytest.fixture
def signals():
    """{level: (force, tip, middle)} of two levels, in lbf, g and mm/s²."""
    draw = np.random.default_rng(5)
    return {
        "low": draw.standard_normal((3, SAMPLES)),
        "high": 4.0 * draw.standard_normal((3, SAMPLES)),
    }


def sidecar(folder, suffix, **changes):
    """Write campaign.yaml for files low and high."""
    records = [
        {"name": "low", "file": f"low.{suffix}", "gap_m": 2e-4},
        {"name": "high", "file": f"high.{suffix}", "gap_m": 2e-4, "split": "holdout"},
    ]
    (folder / "campaign.yaml").write_text(
        yaml.safe_dump({**SIDECAR, "records": records, **changes}, allow_unicode=True),
        encoding="utf-8",
    )


def renamed(*names):
    """Sensors of the sidecar with other signal names."""
    sensors = [
        {**sensor, "variable": name}
        for sensor, name in zip([*SIDECAR["forces"], *SIDECAR["channels"]], names, strict=True)
    ]
    return {"forces": sensors[:1], "channels": sensors[1:]}


def write_mat5(folder, signals):
    for level, (force, *responses) in signals.items():
        scipy.io.savemat(
            folder / f"{level}.mat",
            {"F": force[:, None], "A": np.array(responses).T, "Fs": RATE, "note": "text"},
        )
    sidecar(folder, "mat")


def write_csv(folder, signals):
    for level, rows in signals.items():
        lines = [
            "time;F [lbf];tip [g];middle [mm/s²]",
            *(
                ";".join(repr(float(value)) for value in line)
                for line in zip(np.arange(SAMPLES) / RATE, *rows, strict=True)
            ),
        ]
        (folder / f"{level}.csv").write_text("\n".join(lines), encoding="utf-8")
    sensors = renamed("F", "tip", "middle")
    sidecar(
        folder,
        "csv",
        **{
            group: [
                {key: value for key, value in sensor.items() if key != "unit"}
                for sensor in sensors[group]
            ]
            for group in sensors
        },
    )


def uff_set(values, direction, kind, label, number=1, node=7, **stated):
    """A dataset 58 of a time record."""
    names = {"rsp_ent_name": f"S{number}", "id1": f"signal {number}"}
    units = {"ordinate_spec_data_type": kind, "ordinate_axis_units_lab": label}
    time = np.arange(values.size) / RATE
    return dataset_58(values, time, node, direction, **names, **units, **stated)


def write_uff(folder, signals):
    for level, rows in signals.items():
        file = pyuff.UFF(str(folder / f"{level}.uff"))
        file.write_sets(
            [
                uff_set(values, direction, kind, label, number, node, binary=1)
                for number, (values, direction, kind, label, node) in enumerate(
                    zip(
                        rows,
                        (2, -2, 3),
                        (13, 12, 12),
                        ("lbf", "g", "mm/s^2"),
                        (1, 2, 3),
                        strict=True,
                    )
                )
            ],
            "add",
        )
    points = [
        {"point_m": sensor["point_m"]} for sensor in (*SIDECAR["forces"], *SIDECAR["channels"])
    ]
    sensors = [
        {"name": name, "variable": variable, **point}
        for name, variable, point in zip(
            ("shaker", "tip", "middle"), ("1:+y", "S1", "signal 2"), points, strict=True
        )
    ]
    sidecar(folder, "uff", forces=sensors[:1], channels=sensors[1:])


# Other forms of these files, and netCDF, are read in tests/properties/test_raw_measurements.
WRITERS = {"MATLAB v5": write_mat5, "CSV": write_csv, "UFF 58 binary": write_uff}


@pytest.mark.parametrize("kind", WRITERS)
def test_every_format_gives_the_same_campaign(kind, signals, tmp_path):
    WRITERS[kind](tmp_path, signals)
    campaign, rows = import_folder(tmp_path)
    write_campaign(campaign, tmp_path / "campaign.nc")
    campaign = read_campaign(tmp_path / "campaign.nc")
    assert campaign.attrs["sampling_frequency"] == RATE and campaign.sizes == {
        "record": 2,
        "force_channel": 1,
        "time": SAMPLES,
        "channel": 2,
        "xyz": 3,
    }
    for record, level in enumerate(("low", "high")):
        force, tip, middle = signals[level]
        np.testing.assert_allclose(
            force_signal(campaign, record), LBF * force, atol=1e-5 * np.abs(force).max() * LBF
        )
        np.testing.assert_allclose(
            channel_signal(campaign, record, 0), 9.80665 * tip, atol=1e-5 * np.abs(tip).max() * 9.8
        )
        np.testing.assert_allclose(
            channel_signal(campaign, record, 1),
            1e-3 * middle,
            atol=1e-5 * np.abs(middle).max() * 1e-3,
        )
    np.testing.assert_allclose(
        campaign["load_rms"].values,
        [LBF * signals[level][0].std() for level in ("low", "high")],
        rtol=1e-6,
    )
    assert campaign["split"].values.tolist() == ["fit", "holdout"] and campaign[
        "record_name"
    ].values.tolist() == ["low", "high"]
    assert campaign["channel_direction"].values[0].tolist() == [0.0, -1.0, 0.0]
    np.testing.assert_allclose(
        campaign["channel_direction"].values[1], [0, 0.6, 0.8] if "UFF" not in kind else [0, 0, 1]
    )
    assert [(row["unit_read"], row["unit_SI"]) for row in rows[:2]] == [
        ("lbf", "N"),
        ("g", "m s-2"),
    ]
    assert rows[0]["unit_from"] == {"CSV": "header of the file", "MATLAB v5": "campaign.yaml"}.get(
        kind, "label of dataset 58"
    )
    text = import_text(tmp_path, campaign, rows, check_campaign(campaign))
    assert "lbf" in text and "4.448" in text and "Record high: 3000 samples" in text


def test_sidecar_overrides_a_label_and_is_reported(signals, tmp_path):
    write_csv(tmp_path, signals)
    sidecar(
        tmp_path,
        "csv",
        **renamed("F", "tip", "middle")
        | {"channels": [{**SIDECAR["channels"][0], "variable": "tip", "unit": "m s-2"}]},
    )
    campaign, rows = import_folder(tmp_path)
    assert campaign["channel_units"].values.tolist() == ["m s-2"]
    assert rows[1]["unit_from"] == "campaign.yaml; header of the file says g"


def test_missing_information_is_requested_at_once(signals, tmp_path):
    write_mat5(tmp_path, signals)
    bare = [
        {"name": "tip", "variable": "A[0]", "kind": "acceleration", "point_m": [0, 0, 0]},
        {"name": "middle", "variable": "A[1]", "unit": "g", "direction": "+x"},
        {"name": "lost", "variable": "A[7]", "unit": "g"},
    ]
    sidecar(
        tmp_path,
        "mat",
        channels=bare,
        forces=[
            {
                "name": "shaker",
                "variable": "F",
                "unit": "m",
                "point_m": [0, 0, 0],
                "direction": [0, 0, 0],
            }
        ],
    )
    with pytest.raises(ImportProblem) as refusal:
        import_folder(tmp_path)
    told = str(refusal.value)
    for part in (
        "tip: its direction is not known: add direction",
        "tip has no unit",
        "middle: the kind is not known",
        "middle: its place is not known",
        "lost: the signal 'A[7]' is not in low.mat: they have F, A[0], A[1]",
        "shaker: direction is zero",
        "shaker has the unit 'm', which is no excitation",
    ):
        assert part in told, told


def test_conflicting_sampling_rates_are_reported(signals, tmp_path):
    write_mat5(tmp_path, signals)
    sidecar(tmp_path, "mat", sampling_frequency_Hz=500)
    with pytest.raises(
        ImportProblem, match="sampled at 512 Hz, but sampling_frequency_Hz of campaign.yaml = 500"
    ):
        import_folder(tmp_path)
    sidecar(tmp_path, "mat")
    scipy.io.savemat(
        tmp_path / "high.mat", {"F": signals["high"][0], "A": signals["high"][1:], "Fs": 1024.0}
    )
    with pytest.raises(ImportProblem, match=r"512 Hz \(low.mat\), 1024 Hz \(high.mat\)"):
        import_folder(tmp_path)
    for level in signals:
        scipy.io.savemat(
            tmp_path / f"{level}.mat", {"F": signals[level][0], "A": signals[level][1:]}
        )
    with pytest.raises(ImportProblem, match="add sampling_frequency_Hz"):
        import_folder(tmp_path)


def test_records_of_other_lengths_end_with_nan(signals, tmp_path):
    write_mat5(tmp_path, signals)
    sidecar(
        tmp_path,
        "mat",
        records=[
            {"file": "low.mat", "to_s": 4.0, "support_gap_m": [1e-4, 2e-4]},
            {"file": "high.mat", "from_s": 1.0, "support_gap_m": [1e-4, 2e-4]},
        ],
    )
    campaign, _ = import_folder(tmp_path)
    assert (
        campaign["valid_samples"].values.tolist() == [2048, SAMPLES - 512]
        and np.isnan(campaign["response"].values[0, :, 2048:]).all()
    )
    np.testing.assert_allclose(force_signal(campaign, 1), LBF * signals["high"][0, 512:], rtol=1e-6)
    assert not refused([row for row in check_campaign(campaign) if row["check"] == "contract"])


def test_uneven_samples_are_interpolated_holes_refused():
    draw = np.random.default_rng(2)
    time = np.arange(2000) / 1000.0
    uneven = time + 2e-4 * draw.uniform(-1.0, 1.0, time.size)
    values, rate, note = even_samples(uneven, np.sin(2.0 * np.pi * 20.0 * uneven), "a file")
    assert rate == pytest.approx(1000.0, rel=1e-3) and "interpolated to" in note
    grid = uneven[0] + np.arange(time.size) / rate
    np.testing.assert_allclose(values, np.sin(2.0 * np.pi * 20.0 * grid), atol=2e-5)
    rounded = np.array(
        [float(f"{value:.5e}") for value in np.arange(49 * 2048) / 2048]
    )  # as E13.5 prints them
    _, rate, note = even_samples(rounded, np.zeros(rounded.size), "a file")
    assert (rate, note) == (2048.0, "")
    with pytest.raises(ImportProblem, match="samples are lost"):
        even_samples(np.delete(time, slice(500, 510)), np.zeros(1990), "a file")
    with pytest.raises(ImportProblem, match="does not rise"):
        even_samples(np.zeros(10), np.zeros(10), "a file")


def test_universal_file_gives_units_and_places(signals, tmp_path):
    file = pyuff.UFF(str(tmp_path / "low.uff"))
    file.write_sets(
        [
            pyuff.prepare_164(
                units_code=2,
                units_description="foot, pound force",
                temp_mode=1,
                length=3.280839895,
                force=0.2248089431,
                temp=1.8,
                temp_offset=459.67,
                return_full_dict=True,
            ),
            pyuff.prepare_15(
                node_nums=[1, 2],
                def_cs=[0, 0],
                disp_cs=[0, 0],
                color=[1, 1],
                x=[0.0, 3.280839895],
                y=[0.0, 0.0],
                z=[1.640419948, 0.0],
                return_full_dict=True,
            ),
            uff_set(signals["low"][0], 2, 13, "NONE", 0, 1),
            uff_set(signals["low"][1], -1, 12, "NONE", 1, 2),
        ],
        "overwrite",
    )
    force, response = read_uff(tmp_path / "low.uff")
    assert force.force and not response.force and response.kind == "acceleration"
    assert (
        response.direction == (-1.0, 0.0, 0.0)
        and response.point == pytest.approx((1.0, 0.0, 0.0))
        and force.point == pytest.approx((0.0, 0.0, 0.5))
    )
    campaign, rows = import_folder(tmp_path)  # nothing is left to say: no sidecar is needed
    assert rows[1]["factor"] == pytest.approx(0.3048) and rows[0]["factor"] == pytest.approx(
        LBF, rel=1e-8
    )
    np.testing.assert_allclose(
        channel_signal(campaign, 0, 0), 0.3048 * signals["low"][1], atol=1e-5
    )


def test_incomplete_files_get_a_draft_sidecar(signals, tmp_path):
    write_mat5(tmp_path, signals)
    (tmp_path / "campaign.yaml").unlink()
    written = tmp_path / "drafts" / "campaign.yaml"
    with pytest.raises(ImportProblem, match=f"{written} is a draft"):
        checked_folder(tmp_path, written)
    draft = yaml.safe_load(written.read_text(encoding="utf-8").replace("FILL_IN", "0"))
    assert [sensor["variable"] for sensor in draft["channels"]] == ["F", "A[0]", "A[1]"] and len(
        draft["records"]
    ) == 2
    with pytest.raises(ImportProblem, match="holds no measurement"):
        import_folder(Path(__file__).parents[1] / "workflow" / "..")


def test_the_instrument_exports_are_read():
    folder = DATA / "uff58"
    if not folder.is_dir():
        pytest.skip(
            f"the universal files are not in {folder}: put the samples of shared/data/uff58 there"
        )
    ascii_, binary = (
        read_uff(folder / name)[0] for name in ("Sample_UFF58_ascii.uff", "Sample_UFF58b_bin.uff")
    )
    assert (
        ascii_.rate == binary.rate == 65536.0
        and ascii_.unit == "Pa"
        and ascii_.direction == (1.0, 0.0, 0.0)
    )
    np.testing.assert_allclose(ascii_.values, binary.values, atol=1e-6)
    assert ascii_.values.size == 79292
    with pytest.raises(ImportProblem, match="no time record.*function types 9"):
        read_uff(folder / "sample_dataset58_psd.uff")
