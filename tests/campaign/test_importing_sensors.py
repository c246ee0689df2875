"""Importing what is no motion under a force: a shaker table, and strain gauges."""

import numpy as np
import pytest
import yaml

from vibroimpact.campaign.checks.file_checks import check_campaign
from vibroimpact.campaign.file import channel_signal, force_signal
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.campaign.importing.report import import_text
from vibroimpact.io.signal_files.signals import ImportProblem

RATE, SAMPLES, G = 512, 3000, 9.80665
TABLE = {
    "name": "table",
    "variable": "T",
    "unit": "g",
    "kind": "base_acceleration",
    "direction": "+y",
}
TIP = {
    "name": "tip",
    "variable": "A",
    "unit": "g",
    "kind": "acceleration",
    "point_m": [0.5, 0, 0],
    "direction": "+y",
}
GAUGE = {
    "name": "gauge",
    "variable": "S",
    "unit": "microstrain",
    "kind": "strain",
    "point_m": [0.0, 0, 0],
    "direction": "+y",
}


@pytest.fixture
def folder(tmp_path):
    """Two CSV files with the acceleration of a table, one on the structure, and a strain."""
    draw = np.random.default_rng(5)
    for name, level in (("low", 1.0), ("high", 4.0)):
        table = level * draw.standard_normal(SAMPLES)
        rows = np.stack([np.arange(SAMPLES) / RATE, table, 3.0 * table, 20.0 * table], axis=1)
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header="time,T,A,S", comments="")
    return tmp_path


def imported(folder, table=None, channels=(TIP, GAUGE)):
    described = {
        "source": "a shaker table",
        "forces": [TABLE if table is None else table],
        "channels": list(channels),
        "records": [{"file": "low.csv", "gap_m": 2e-4}, {"file": "high.csv", "gap_m": 2e-4}],
    }
    (folder / "campaign.yaml").write_text(yaml.safe_dump(described))
    return import_folder(folder)


def test_shaker_table_is_stated_by_its_kind(folder):
    campaign, rows = imported(folder)
    assert campaign["force_channel_kind"].values.tolist() == ["base_acceleration"]
    assert np.isnan(campaign["force_channel_point"].values).all()
    table = np.loadtxt(folder / "low.csv", delimiter=",", skiprows=1)[:, 1]
    np.testing.assert_allclose(force_signal(campaign, 0), G * table, rtol=1e-6)
    assert campaign["load_rms"].values[0] == pytest.approx(G * table.std(), rel=1e-5)
    assert campaign["load_rms"].attrs["units"] == "m s-2"
    checks = check_campaign(campaign)
    text = import_text(folder, campaign, rows, checks)
    assert "m s-2 RMS, gap 0.2 mm" in text and "The motion of the base by table" in text


def test_strain_is_stored_with_its_unit(folder):
    campaign, rows = imported(folder)
    (row,) = [row for row in rows if row["sensor"] == "gauge" and row["record"] == "low"]
    assert (row["kind"], row["unit_SI"], row["factor"]) == ("strain", "1", pytest.approx(1e-6))
    table = np.loadtxt(folder / "low.csv", delimiter=",", skiprows=1)[:, 1]
    np.testing.assert_allclose(channel_signal(campaign, 0, 1), 2e-5 * table, rtol=1e-5)


def test_acceleration_among_forces_asks_what_moves(folder):
    with pytest.raises(ImportProblem, match="kind: base_acceleration if all that holds"):
        imported(folder, TABLE | {"kind": "acceleration"})


def test_table_in_newtons_is_refused(folder):
    with pytest.raises(ImportProblem, match="table has the unit 'N', which is no base_acc"):
        imported(folder, TABLE | {"unit": "N"})


def test_base_is_no_kind_of_a_response(folder):
    with pytest.raises(ImportProblem, match="kind = 'base_acceleration'"):
        imported(folder, channels=[TIP | {"kind": "base_acceleration"}])
