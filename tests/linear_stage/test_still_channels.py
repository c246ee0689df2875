"""A campaign of which no channel shows what the structure does is refused, never called sound."""

import numpy as np

from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage.linear_analysis import prepare

RATE, SAMPLES, GAP = 2048.0, 24576, 2.8886e-4


def test_noise_that_is_left_of_a_campaign_is_refused(study_config, tmp_path):
    """The channel that moves clips in one record, and is left out of both."""
    random = np.random.default_rng(3)
    force = np.array(
        [load * band_limited_noise(random, SAMPLES, RATE, (5.0, 200.0)) for load in (0.1, 0.3)]
    )[:, None]
    moved = 50.0 * force
    moved[1] = np.clip(moved[1], -20.0, 20.0)
    noise = 0.01 * random.standard_normal((2, 2, SAMPLES))
    response = np.concatenate([moved, np.zeros_like(moved)], axis=1) + noise
    channels = [
        Channel(f"apex_{name}", (0.0, 0.0, 1.0), direction, "m s-2", "acceleration")
        for name, direction in (("y", (0.0, 1.0, 0.0)), ("x", (1.0, 0.0, 0.0)))
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    path = tmp_path / "campaign.nc"
    levels = [Level("low", GAP), Level("high", GAP)]
    write_campaign(campaign_dataset(force, response, channels, [drive], levels, RATE), path)
    prepared = prepare(study_config, path)
    assert "Of apex_x none shows motion above its noise" in prepared.refusal
    assert any(row["check"] == "clipping" for row in prepared.checks)
