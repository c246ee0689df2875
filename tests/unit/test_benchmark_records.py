"""The benchmarks' files as campaigns: which levels are held out, names, records of other lengths;
and the real records where they are at hand.
"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import savemat

from examples.f16.records import f16_campaign
from examples.silverbox.published import silverbox_table
from examples.silverbox.records import silverbox_campaign
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.completion.candidate import run_candidate
from vibroimpact.completion.levels import levels_of, naming_split
from vibroimpact.completion.linear_models import linear_errors, linear_models
from vibroimpact.completion.mounting import mounting_table
from vibroimpact.completion.own_records import own_records
from vibroimpact.completion.own_study import own_study
from vibroimpact.completion.store import modes_of, trial_of
from vibroimpact.completion.structure_file import StructureFile, read_structure
from vibroimpact.verdict.content import Estimate, FoundEffect

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared" / "data"
PERIOD = 8192


def periodic(count, seed, channels=1, period=PERIOD):
    """(channel, time) that repeats count times."""
    return np.tile(np.random.default_rng(seed).standard_normal((channels, period)), (1, count))


def write_f16(folder, name, count, period=PERIOD):
    """A level file; the response is the force, so that lines can be told."""
    force = periodic(count, 1, period=period)
    savemat(
        folder / f"F16Data_FullMSine_{name}.mat",
        {
            "Force": force,
            "Voltage": force,
            "Acceleration": np.repeat(force, 3, axis=0),
            "Fs": 400.0,
        },
    )


def test_validation_levels_are_held_out(tmp_path):
    for name, count in (
        ("Level1", 9),
        ("Level3", 9),
        ("Level2_Validation", 9),
        ("Level4", 3),
        ("Level7", 9),
        ("Level5_Validation", 2),
    ):
        write_f16(tmp_path, name, count)
    levels, names, kinds = levels_of(f16_campaign(tmp_path.glob("*.mat")))
    assert {level.name: (level.split, level.periods) for level in levels} == {
        "level 1": ("fit", 8),
        "level 2": ("holdout", 8),
        "level 3": ("fit", 8),
        "level 4": ("holdout", 2),
        "level 5": ("holdout", 1),
        "level 7": ("fit", 8),
    }
    assert (
        names == ["acceleration 1", "acceleration 2", "acceleration 3"]
        and kinds == ["acceleration"] * 3
    )
    fitted, tried = naming_split(levels)
    assert {level.name for level in fitted} == {"level 1", "level 3", "level 7"} and len(tried) == 3


def test_a_level_given_twice_has_two_names(tmp_path):
    write_f16(tmp_path, "Level1", 3)
    write_f16(tmp_path, "Level1_Validation", 3)
    levels, _, _ = levels_of(f16_campaign(tmp_path.glob("*.mat")))
    assert {(level.name, level.split) for level in levels} == {
        ("level 1", "fit"),
        ("level 1 validation", "holdout"),
    }


def test_held_out_record_may_have_another_period(tmp_path):
    write_f16(tmp_path, "Level1", 9)
    write_f16(tmp_path, "Level2_Validation", 4, period=16384)
    levels, _, _ = levels_of(f16_campaign(tmp_path.glob("*.mat")))
    assert sorted((level.frequency[1], level.periods) for level in levels) == [
        (400.0 / 16384, 3),
        (400.0 / 8192, 8),
    ]
    for level in levels:
        assert level.response[2] == pytest.approx(level.force, abs=1.0e-6)


def test_silverbox_input_and_output_are_paired(tmp_path):
    for level in (5, 50, 100):
        driven = periodic(30, level).T
        savemat(tmp_path / f"SNJP_um_full_FNSI_{level}.mat", {"um": driven, "fs": 2441.40625})
        savemat(tmp_path / f"SNJP_ym_full_FNSI_{level}.mat", {"ym": 2.0 * driven})
    campaign = silverbox_campaign(tmp_path.glob("*.mat"))
    assert dict(zip(campaign["record_name"].values, campaign["split"].values, strict=True)) == {
        "5 mV": "fit",
        "50 mV": "holdout",
        "100 mV": "fit",
    }
    levels, _, _ = levels_of(campaign)
    assert all(
        level.periods == 25 and level.response[0] == pytest.approx(2.0 * level.force, abs=1.0e-6)
        for level in levels
    )


def test_foreign_files_are_named(tmp_path):
    savemat(tmp_path / "other.mat", {"Force": 1.0})
    with pytest.raises(ValueError, match="must hold the level"):
        f16_campaign([tmp_path / "other.mat"])
    savemat(tmp_path / "F16Data_FullMSine_Level1.mat", {"Force": 1.0})
    with pytest.raises(ValueError, match="has no variable Acceleration, Fs"):
        f16_campaign([tmp_path / "F16Data_FullMSine_Level1.mat"])
    savemat(tmp_path / "SNJP_um_full_FNSI_5.mat", {"um": np.ones((10, 1)), "fs": 1.0})
    with pytest.raises(ValueError, match="belong together"):
        silverbox_campaign([tmp_path / "SNJP_um_full_FNSI_5.mat"])


def real(name, folder, campaign_of):
    """(campaign, Study) of the real records by the example's file, or a skip that says where to get
    them.
    """
    files = sorted((DATA / folder).glob("*.mat"))
    if not files:
        pytest.skip(f"no records in {DATA / folder}: download them from nonlinearbenchmark.org")
    campaign = campaign_of(files)
    asked = read_structure(str(ROOT / "examples" / name / "structure.yaml"))
    return campaign, own_study(name, asked, campaign, 0, asked.band_Hz)


@pytest.mark.slow
def test_f16_mounting_softens_and_methods_agree():
    campaign, study = real("f16", "f16_ground_vibration", f16_campaign)
    linear = linear_models(campaign, study)
    base, levels = modes_of(linear["base"]), levels_of(campaign)[0]
    assert base.frequency[~base.residual][:6] == pytest.approx(
        [3.47, 3.97, 5.19, 6.61, 7.32, 9.17], abs=0.02
    )
    assert (
        np.max(linear_errors(base, levels[0], study.band_Hz)) < 0.11
        and np.min(linear_errors(base, levels[-1], study.band_Hz)) > 0.8
    )
    rows, _ = mounting_table(levels, study, linear)
    found = {
        method: [row["k_N_per_m"] for row in rows if row["method"] == method]
        for method in ("peak", "broadband")
    }
    assert np.all(np.diff(found["peak"]) < 0.0) and found["broadband"] == pytest.approx(
        found["peak"], abs=0.1 * abs(found["peak"][-1])
    )


@pytest.mark.slow
def test_published_silverbox_coefficients_are_recovered():
    campaign, study = real("silverbox", "silverbox", silverbox_campaign)
    linear = linear_models(campaign, study)
    assert modes_of(linear["base"]).frequency == pytest.approx([68.58], abs=0.02)
    cubic = run_candidate(campaign, study, linear, "cubic_stiffness.ground", told=lambda text: None)
    both = run_candidate(
        campaign, study, linear, "quadratic_stiffness.ground", cubic, told=lambda text: None
    )
    third, second = (float(term.values[0]) for term in trial_of(both["trial"]).terms)
    assert third == pytest.approx(3.97, rel=0.02) and second == pytest.approx(-0.26, rel=0.06)
    assert both["errors"]["100 mV"][0] < 0.01 and both["errors"]["20 mV"][0] < 0.03


def test_units_of_an_electronic_law_are_powers_of_volts():
    campaign = electronic("V", "V")
    found = own_study("circuit", StructureFile(), campaign, 0, (1.0, 2.0))
    assert [found.unit(unit) for unit in ("N", "N/m", "N/m3", "kg")] == ["V", "1", "V-2", "kg"]
    mixed = own_study("circuit", StructureFile(), electronic("mV", "A"), 0, (1.0, 2.0))
    assert mixed.unit("N/m2") == "V/(A)2"  # laws are fitted in SI


def electronic(force, response):
    """A campaign of one generic channel and units of its own."""
    place = (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)
    signal = np.ones((1, 1, 4))
    return campaign_dataset(
        signal,
        signal,
        [Channel("output", *place, response, "generic")],
        [Channel("input", *place, force, "generic")],
        [Level("1", np.nan)],
        1.0,
    )


def test_coefficients_stand_beside_the_published_ones():
    modes = {"frequency": [68.58], "damping_ratio": [0.05]}
    cubic = FoundEffect(
        id="cubic_stiffness",
        location="ground",
        parameters={"cubic_stiffness": Estimate(value=4.0, unit="V-2", low=3.9, high=4.1)},
    )
    rows = silverbox_table(SimpleNamespace(effects=[cubic]), {"trial": {"modes": modes}})
    found = {row["quantity"]: row for row in rows}
    assert list(found) == ["frequency_Hz", "damping_ratio", "cubic"]
    assert found["cubic"]["published"] == 3.97
    assert found["cubic"]["relative_difference"] == pytest.approx(0.03 / 3.97)
    assert found["frequency_Hz"]["relative_difference"] == 0.0


def test_records_with_periods_of_their_own_reach_the_levels(tmp_path):
    write_f16(tmp_path, "Level1", 9)
    write_f16(tmp_path, "Level3", 9)
    write_f16(tmp_path, "Level2_Validation", 4, period=16384)
    campaign = f16_campaign(tmp_path.glob("*.mat"))
    campaign["force"].values[1] *= 2.0
    campaign["response"].values[1] *= 2.0
    campaign["load_rms"].values[1] *= 2.0
    write_campaign(campaign, tmp_path / "f16.nc")
    usable, _, measured = own_records(str(tmp_path / "f16.nc"))
    assert measured.period_samples == 0 and "whole_records" not in usable.attrs
    assert sorted(level.periods for level in levels_of(usable)[0]) == [3, 8, 8]
