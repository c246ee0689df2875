"""Files of people who do this work, where they are beside the project: what each README expects."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from vibroimpact.campaign.checks.file_checks import NOT_CHECKED, check_campaign, refused
from vibroimpact.campaign.importing.assemble import import_folder
from vibroimpact.config.reading import check_config
from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.io.signal_files.csv_table import read_csv
from vibroimpact.io.signal_files.signals import ImportProblem
from vibroimpact.reduction.reduced_model import build_model

CASES = Path(__file__).parents[2].parent / "shared" / "data" / "public_cases"
pytestmark = pytest.mark.skipif(
    not CASES.is_dir(), reason=f"the public cases are not in {CASES}: put them there"
)


@pytest.mark.parametrize(
    "folder, loads",
    [
        ("01_bunv_same_dof/drive_point", (4.0, 1.0)),
        ("01_bunv_same_dof/drive_point_described", (1.0, 4.0)),
        ("04_force_offset/offset", (1.0, 3.0)),
        ("10_uff_time_start", (4.0, 1.0)),
        ("11_white_force/white_12s", (1.0, 3.0)),
    ],
)
def test_loads_are_those_of_the_force(folder, loads):
    campaign, _ = import_folder(CASES / folder)
    np.testing.assert_allclose(campaign["load_rms"].values, loads, rtol=0.02)
    assert not refused(check_campaign(campaign))


def test_the_hammer_with_noise_is_usable():
    campaign, _ = import_folder(CASES / "11_white_force" / "hammer_noise_12s")
    rows = check_campaign(campaign)
    complaints = {row["check"] for row in rows if row["level"] not in ("pass", NOT_CHECKED)}
    assert complaints == {"record length"}


def test_the_dynamic_force_of_an_analyser_is_its_load(tmp_path):
    shutil.copytree(CASES / "02_mat_analyser_export", tmp_path, dirs_exist_ok=True)
    shutil.copy(tmp_path / "case1.mat", tmp_path / "case2.mat")
    campaign, _ = import_folder(tmp_path)
    assert campaign["load_rms"].values[0] == pytest.approx(0.0028, rel=0.01)
    left = {row["check"] for row in check_campaign(campaign) if row["level"] == NOT_CHECKED}
    assert left >= {"coherence", "delay", "stationarity", "record length"}


def test_labview_is_named_and_its_table_read():
    for folder in ("as_csv", "as_lvm"):
        with pytest.raises(ImportProblem, match="LabVIEW"):
            import_folder(CASES / "03_labview_lvm" / folder)
    assert len(read_csv(CASES / "03_labview_lvm" / "header_cut" / "run.csv")) == 5


@pytest.mark.parametrize(
    "file, names",
    [
        ("raw/acc_base_a0.csv", ["acceleration"]),
        ("described/run1.csv", ["force", "acc"]),
        ("decimal_comma/lauf.csv", ["Kraft", "Beschl"]),
    ],
)
def test_names_in_comments_and_decimal_commas_are_read(file, names):
    found = read_csv(CASES / "05_savetxt_header" / file)
    assert [signal.name for signal in found] == names


def test_free_modes_of_a_superelement_are_nastrans(monkeypatch):
    pytest.importorskip("pyyeti", reason="OP4 files need pyyeti")
    monkeypatch.chdir(CASES / "06_op4_craig_bampton")
    data = read_yaml("notall6.yaml")
    data["structure"]["op4_set"] = "aa2"
    del data["basis"]
    omega = build_model(check_config(data, "notall6")).omega
    expected = [11.30124, 16.91482, 19.79400, 23.07029]  # LAMBDA of the same file, Hz
    assert omega[6:10] / (2.0 * np.pi) == pytest.approx(expected, rel=1e-6)
