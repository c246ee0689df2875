"""What may stand in a campaign file, what is compared with a model, and where results may go."""

from pathlib import Path

import numpy as np
import pytest

from evidence.acceptance.shards import draw_name
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.checks.file_checks import check_campaign, usable_signals
from vibroimpact.campaign.contract import contract_problems
from vibroimpact.campaign.file import fill_missing, measured_values, write_campaign
from vibroimpact.config.reading import load_config
from vibroimpact.config.reserved_names import name_problem
from vibroimpact.diagnosis.diagnose import diagnose
from vibroimpact.diagnosis.measurement.comparable import comparison_problems

ROOT = Path(__file__).parents[2]


@pytest.fixture
def campaign():
    """A sound campaign to put faults into."""
    return sound_campaign()


def test_what_can_not_be_is_told_all_at_once(campaign):
    assert [*contract_problems(campaign)] == []
    campaign["gap"].values[:] = [-1.0e-4, np.inf, 2.0]
    campaign["record_name"].values[2] = "low"
    campaign["force_channel_name"].values[0] = "tip 1"
    campaign["channel_point"].attrs["units"] = "mm"
    campaign["valid_samples"] = ("record", np.array([0, 4096, 4097]))
    campaign["load_rms"] = ("record", np.array(["1", "2", "3"], dtype=object))
    campaign.attrs |= {
        "sampling_frequency": np.inf,
        "period_samples": 7,
        "transient_periods": -1,
        "start_up": "flying",
        "antialias": 3,
    }
    told = "\n".join(contract_problems(campaign))
    for part in (
        "gap[0] = -0.0001 m is negative (and 2 more): give the radial clearance in m",
        "record_name[2] = 'low' is the name of record_name[0] too",
        "force_channel_name[0] = 'tip 1' is the name of channel_name[1] too",
        "'channel_point' has the attribute units = 'mm'",
        "valid_samples[0] = 0 is below 1 (and 1 more)",
        "'load_rms' holds texts: write numbers",
        "sampling_frequency = inf",
        "period_samples = 7 is no period",
        "transient_periods = -1",
        "start_up = 'flying' is unknown",
        "antialias = 3 is no text",
    ):
        assert part in told
    assert len(told.splitlines()) == 11


def test_a_signalling_nan_is_a_missing_sample(campaign):
    campaign["response"] = campaign["response"].astype(np.float32)
    campaign["response"].values.view(np.uint32)[0, 1, 5] = 0x7F800001
    missing = np.isnan(measured_values(campaign, "response", 0))
    assert np.argwhere(missing).tolist() == [[1, 5]]


def test_records_too_short_to_average_are_left_out(campaign):
    campaign["valid_samples"] = ("record", np.array([4096, 100, 4096]))
    campaign["load_rms"].values[1] = np.sqrt(
        np.mean(campaign["force"].values[1, 0, :100].astype(float) ** 2)
    )
    rows = check_campaign(campaign)
    assert usable_signals(campaign, rows)[0].tolist() == [True, False, True]
    assert any("middle has 100 samples" in row["message"] for row in rows)


def test_a_period_that_the_force_has_not_is_refused(campaign):
    rows = check_campaign(campaign.assign_attrs(period_samples=1000))
    assert [row["message"][:21] for row in rows if row["level"] == "refuse"] == [
        "period_samples = 1000"
    ]


def test_counts_of_a_converter_are_read_as_numbers(campaign):
    counts = np.round(1000 * campaign["response"].values).astype(np.int16)
    read = fill_missing(campaign.assign(response=(campaign["response"].dims, counts)))
    assert read["response"].dtype == float and (read["response"].values == counts).all()


def test_millimetres_are_seen_on_the_tube(campaign):
    model = load_config(ROOT / "config" / "smoke.yaml")
    assert comparison_problems(model, campaign) == []
    for name in ("gap", "channel_point", "force_channel_point"):
        campaign[name].values[:] *= 1000.0
    told = comparison_problems(model, campaign)
    assert len(told) == 5 and all("is it in millimetres?" in sentence for sentence in told)


@pytest.mark.parametrize(
    ("file", "part"),
    [
        ("turbulence.yaml", "excitation.kind = 'turbulence' has no point"),
        ("examples/mass_between_stops.yaml", "structure.kind = 'chain' does not say where"),
    ],
)
def test_models_without_tube_or_point_force_are_refused(campaign, tmp_path, file, part):
    write_campaign(campaign, tmp_path / "bench.nc")
    verdict = diagnose(tmp_path / "bench.nc", ROOT / "config" / file)
    assert verdict.verdict == "not_testable" and part in verdict.next_measurement


def test_volts_and_reserved_names_drive_no_model(campaign):
    campaign["force_channel_units"].values[0] = "V"
    campaign["channel_name"].values[2] = "responses"
    told = "\n".join(comparison_problems(load_config(ROOT / "config" / "smoke.yaml"), campaign))
    assert "force channel shaker has the unit 'V', which is no force" in told
    assert "channel_name[2] = 'responses' stands for several channels" in told


def test_results_of_draws_are_not_overwritten():
    for pool in ("acceptance", "development"):
        assert "which the target acceptance writes" in name_problem(draw_name(pool, 3))
    assert "the folder of the study 'bench'" in name_problem("bench", "bench")
    assert name_problem("bench") is None
