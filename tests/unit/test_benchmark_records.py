"""The benchmarks' files as campaigns: which levels are held out, names, records of other lengths;
and the real records where they are at hand.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from vibroimpact.completion.benchmark_records import (
    benchmark_campaign,
    f16_campaign,
    silverbox_campaign,
)
from vibroimpact.completion.candidate import run_candidate
from vibroimpact.completion.levels import levels_of, naming_split
from vibroimpact.completion.linear_models import linear_errors, linear_models
from vibroimpact.completion.mounting import mounting_table
from vibroimpact.completion.store import modes_of, trial_of
from vibroimpact.completion.study import F16, SILVERBOX

ROOT = Path(__file__).resolve().parents[2]
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
        benchmark_campaign("f16", [tmp_path / "other.mat"])
    savemat(tmp_path / "F16Data_FullMSine_Level1.mat", {"Force": 1.0})
    with pytest.raises(ValueError, match="has no variable Acceleration, Fs"):
        benchmark_campaign("f16", [tmp_path / "F16Data_FullMSine_Level1.mat"])
    savemat(tmp_path / "SNJP_um_full_FNSI_5.mat", {"um": np.ones((10, 1)), "fs": 1.0})
    with pytest.raises(ValueError, match="belong together"):
        benchmark_campaign("silverbox", [tmp_path / "SNJP_um_full_FNSI_5.mat"])


def real(config, key, pattern, name):
    """The campaign of the real records, or a skip that says where to get them."""
    files = sorted((ROOT / getattr(config, key)).glob(pattern))
    if not files:
        pytest.skip(
            f"no records in {getattr(config, key)}: download the {name} from nonlinearbenchmark.org"
        )
    return benchmark_campaign(name, files)


@pytest.mark.slow
def test_f16_mounting_softens_and_methods_agree(study_config):
    campaign = real(study_config, "f16_data", "F16Data_FullMSine_Level*.mat", "f16")
    linear = linear_models(campaign, F16)
    base, levels = modes_of(linear["base"]), levels_of(campaign)[0]
    assert base.frequency[~base.residual][:6] == pytest.approx(
        [3.47, 3.97, 5.19, 6.61, 7.32, 9.17], abs=0.02
    )
    assert (
        np.max(linear_errors(base, levels[0], F16.band_Hz)) < 0.11
        and np.min(linear_errors(base, levels[-1], F16.band_Hz)) > 0.8
    )
    rows, _ = mounting_table(levels, F16, linear)
    found = {
        method: [row["k_N_per_m"] for row in rows if row["method"] == method]
        for method in ("peak", "broadband")
    }
    assert np.all(np.diff(found["peak"]) < 0.0) and found["broadband"] == pytest.approx(
        found["peak"], abs=0.1 * abs(found["peak"][-1])
    )


@pytest.mark.slow
def test_published_silverbox_coefficients_are_recovered(study_config):
    campaign = real(study_config, "silverbox_data", "SNJP_?m_full_FNSI_*.mat", "silverbox")
    linear = linear_models(campaign, SILVERBOX)
    assert modes_of(linear["base"]).frequency == pytest.approx([68.58], abs=0.02)
    cubic = run_candidate(
        campaign, SILVERBOX, linear, "cubic_stiffness.ground", told=lambda text: None
    )
    both = run_candidate(
        campaign, SILVERBOX, linear, "quadratic_stiffness.ground", cubic, told=lambda text: None
    )
    third, second = (float(term.values[0]) for term in trial_of(both["trial"]).terms)
    assert third == pytest.approx(3.97, rel=0.02) and second == pytest.approx(-0.26, rel=0.06)
    assert both["errors"]["100 mV"][0] < 0.01 and both["errors"]["20 mV"][0] < 0.03
