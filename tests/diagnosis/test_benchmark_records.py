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
from vibroimpact.diagnosis.diagnose import run_diagnosis
from vibroimpact.diagnosis.identified.identified import identified
from vibroimpact.diagnosis.identified.levels import levels_of, naming_split
from vibroimpact.diagnosis.identified.linear_models import fit_family
from vibroimpact.diagnosis.identified.records import usable_records
from vibroimpact.diagnosis.identified.stated import own_units
from vibroimpact.diagnosis.identified.structure_file import model_of
from vibroimpact.diagnosis.verdict.content import Estimate, FoundEffect

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
    campaign = f16_campaign(tmp_path.glob("*.mat"))
    levels = levels_of(campaign)
    assert {level.name: (level.split, level.periods) for level in levels} == {
        "level 1": ("fit", 8),
        "level 2": ("holdout", 8),
        "level 3": ("fit", 8),
        "level 4": ("holdout", 2),
        "level 5": ("holdout", 1),
        "level 7": ("fit", 8),
    }
    assert campaign["channel_name"].values.tolist() == [f"acceleration {at}" for at in (1, 2, 3)]
    fitted, tried = naming_split(levels)
    assert {level.name for level in fitted} == {"level 1", "level 3", "level 7"} and len(tried) == 3


def test_a_level_given_twice_has_two_names(tmp_path):
    write_f16(tmp_path, "Level1", 3)
    write_f16(tmp_path, "Level1_Validation", 3)
    levels = levels_of(f16_campaign(tmp_path.glob("*.mat")))
    assert {(level.name, level.split) for level in levels} == {
        ("level 1", "fit"),
        ("level 1 validation", "holdout"),
    }


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
    levels = levels_of(campaign)
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
    """(campaign, MeasuredStructure) of the real records by the example's file, or a skip that says
    where to get them.
    """
    files = sorted((DATA / folder).glob("*.mat"))
    if not files:
        pytest.skip(f"no records in {DATA / folder}: download them from nonlinearbenchmark.org")
    return campaign_of(files), model_of(ROOT / "examples" / name / "structure.yaml")


def errors_of(found, channel):
    """{level: (linear, identified again, completed)} of a channel of a Diagnosis."""
    rows = found.grounds.own.prediction(found.grounds.chosen)
    names = ("error_linear", "error_refitted", "error_completed")
    return {
        row["level"]: tuple(row[name] for name in names)
        for row in rows
        if row["channel"] == channel
    }


@pytest.mark.slow
def test_f16_mounting_softens():
    own, _ = identified(*real("f16", "f16_ground_vibration", f16_campaign))
    base = own.linear.base
    assert base.frequency[~base.residual][:6] == pytest.approx(
        [3.47, 3.97, 5.19, 6.61, 7.32, 9.17], abs=0.02
    )
    levels = [level for level in own.everything.levels if level.split == "fit"]
    row = own.ranking["mounting"].row
    change = fit_family(base, row, levels, own.everything.band_Hz).k / 1.0e6
    assert change == pytest.approx([0.0, -0.52, -1.1, -1.5], rel=0.15, abs=0.01)


@pytest.mark.slow
def test_f16_friction_in_the_mounting_is_named():
    found = run_diagnosis(*real("f16", "f16_ground_vibration", f16_campaign))
    verdict = found.verdict
    assert (verdict.verdict, verdict.ambiguity_set) == ("named", [["coulomb_friction"]])
    assert verdict.effects[0].location.startswith("mounting")
    errors = errors_of(found, "acceleration 3")
    assert errors[1][2] < 1.2 * errors[1][0]
    for level, most in ((3, 1.0), (5, 0.6), (7, 0.75)):
        assert errors[level][2] < most * errors[level][1], level


@pytest.mark.slow
def test_published_silverbox_coefficients_are_recovered():
    found = run_diagnosis(*real("silverbox", "silverbox", silverbox_campaign))
    assert found.grounds.own.linear.base.frequency == pytest.approx([68.58], abs=0.02)
    values = {
        name: each.value
        for effect in found.verdict.effects
        for name, each in effect.parameters.items()
    }
    assert values["cubic_stiffness"] == pytest.approx(3.97, rel=0.01)
    assert values["quadratic_stiffness"] == pytest.approx(-0.26, rel=0.05)
    errors = errors_of(found, "output")
    assert errors[5][2] < 2.0 * errors[5][0] and errors[20][2] < 0.006 and errors[100][2] < 0.004


def test_units_of_an_electronic_law_are_powers_of_volts():
    volts = own_units(electronic("V", "V"), 0)
    assert [volts[unit] for unit in ("N", "N/m", "N/m3")] == ["V", "1", "V-2"]
    assert own_units(electronic("mV", "A"), 0)["N/m2"] == "V/(A)2"  # laws are fitted in SI


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
    modes = [{"frequency_Hz": 68.58, "damping_ratio": 0.05}]
    cubic = FoundEffect(
        id="cubic_stiffness",
        location="ground",
        parameters={"cubic_stiffness": Estimate(value=4.0, unit="V-2", low=3.9, high=4.1)},
    )
    rows = silverbox_table(SimpleNamespace(effects=[cubic]), {"structure": {"modes": modes}})
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
    usable, _, measured = usable_records(tmp_path / "f16.nc")
    assert measured.period_samples == 0 and "whole_records" not in usable.attrs
    assert sorted(level.periods for level in levels_of(usable)) == [3, 8, 8]
