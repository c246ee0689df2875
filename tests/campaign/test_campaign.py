"""The campaign file: what is written is read, what breaks the contract is told, and the synthetic
one holds what it promises.
"""

from pathlib import Path

import numpy as np
import pytest

from vibroimpact.campaign.file import (
    CampaignError,
    Channel,
    Level,
    campaign_dataset,
    channel_at,
    read_campaign,
    write_campaign,
)
from vibroimpact.config.reading import load_config
from vibroimpact.io.records import RecordError, write_record
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.study.cases import nearest_loads
from vibroimpact.study.synthetic_campaign import synthetic_campaign

ROOT = Path(__file__).parents[2]
DEVELOPMENT = ROOT.parent / "shared" / "data" / "campaigns" / "dev_null.nc"


@pytest.fixture
def campaign():
    """Two levels, two accelerometers at one point and a displacement sensor elsewhere."""
    draw = np.random.default_rng(1)
    channels = [
        Channel("top x", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), "m s-2", "acceleration"),
        Channel("top y", (0.0, 0.0, 1.001), (0.0, -1.0, 0.0), "g", "acceleration"),
        Channel("leg y", (-0.3, 0.0, 0.5), (0.0, 1.0, 0.0), "mm", "displacement"),
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    force = np.stack([0.5 * draw.standard_normal((1, 400)), 3.0 * draw.standard_normal((1, 400))])
    levels = [Level("low", 2.9e-4), Level("high", 2.9e-4, split="holdout")]
    return campaign_dataset(
        force, draw.standard_normal((2, 3, 400)), channels, [drive], levels, 2048.0, source="a test"
    )


def test_campaign_file_round_trip(campaign, tmp_path):
    write_campaign(campaign, tmp_path / "campaign.nc")
    read = read_campaign(tmp_path / "campaign.nc")
    for name in campaign.variables:
        assert read[name].dims == campaign[name].dims
        assert (read[name].values == campaign[name].values).all(), name
    assert read.attrs["sampling_frequency"] == 2048.0 and read.attrs["source"] == "a test"
    rms = campaign["force"].values[:, 0].astype(float).std(axis=-1)
    np.testing.assert_allclose(read["load_rms"].values, rms, rtol=1e-6)


def test_all_format_errors_are_reported_together(campaign, tmp_path):
    broken = campaign.drop_vars("gap").assign(
        channel_kind=("channel", np.array(["acceleration", "tilt", "displacement"], dtype=object))
    )
    broken["response"] = broken["response"].transpose("channel", "record", "time")
    del broken.attrs["sampling_frequency"]
    broken = broken.drop_vars("force_channel_units")
    broken["force"].attrs["units"] = "furlong"
    with pytest.raises(CampaignError) as refusal:
        write_campaign(broken, tmp_path / "broken.nc")
    told = str(refusal.value)
    for part in (
        "no variable 'gap'",
        "'response' has dimensions ('channel', 'record', 'time')",
        "sampling_frequency",
        "furlong",
        "channel_kind 'tilt'",
    ):
        assert part in told
    assert not (tmp_path / "broken.nc").exists()
    write_record(broken, tmp_path / "broken.nc")
    with pytest.raises(CampaignError, match="broken.nc: has no variable 'gap'"):
        read_campaign(tmp_path / "broken.nc")
    with pytest.raises(RecordError, match="nowhere.nc"):
        read_campaign(tmp_path / "nowhere.nc")


def test_a_channel_is_found_by_place_direction_and_kind(campaign):
    assert (
        channel_at(campaign, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "acceleration") == 1
    )  # either sense of the direction
    assert channel_at(campaign, (0.0, 0.0, 1.0), (2.0, 0.0, 0.0), "acceleration") == 0
    with pytest.raises(CampaignError, match="no channel of kind acceleration within 5 mm.*leg y"):
        channel_at(campaign, (-0.3, 0.0, 0.5), (0.0, 1.0, 0.0), "acceleration")


def test_the_synthetic_campaign_has_its_loads_gap_and_noise():
    coarse = {
        "basis": {"free_modes_to_Hz": 800.0, "constrained_modes_to_Hz": 400.0},
        "integration": {"steps_per_second": 20480, "start_up_s": 1.0},
    }
    config = load_config(ROOT / "config" / "smoke.yaml", coarse)
    config = config.model_copy(
        update={"record": config.record.model_copy(update={"duration_s": 8.0})}
    )
    model = build_model(config)
    loads = nearest_loads(config.grid, config.overlay.load_rms_N)
    assert loads == [0.1, 4.0, 20.0]  # of 0.1, 4 and 20 N those nearest to 0.5, 2, 5 and 20 N
    campaign = synthetic_campaign(config, model, loads)
    np.testing.assert_allclose(campaign["load_rms"].values, loads, rtol=1e-3)
    np.testing.assert_allclose(campaign["gap"].values, 1.05 * 2.8886e-4)
    # The lowest load touches nothing: above the force's 200 Hz there is noise alone, white to 1024
    # Hz, alike in all records.
    lowest = campaign["response"].values[0].astype(float)
    window = np.hanning(lowest.shape[-1])
    quiet = np.fft.rfft(window * lowest, axis=-1)[:, 400 * 8 : 1000 * 8]
    noise = np.sqrt(np.mean(np.abs(quiet) ** 2, axis=-1) / np.sum(window**2))
    np.testing.assert_allclose(noise, 0.01 * np.sqrt(np.mean(lowest**2, axis=-1)).max(), rtol=0.05)
    channel = channel_at(campaign, (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "acceleration")
    assert str(campaign["channel_name"].values[channel]) == "apex.y.acceleration"
