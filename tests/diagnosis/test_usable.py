"""What of a campaign is compared with a model."""

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.diagnosis.measurement.usable import usable
from vibroimpact.excitation.random_force import band_limited_noise

RATE, Y = 2048.0, (0.0, 1.0, 0.0)
PLATE, APEX, DRIVE = (-0.3, 0.0, 0.35), (0.0, 0.0, 1.0), (-0.2121, 0.0, 0.9121)


@pytest.mark.parametrize(
    ("place", "direction", "told"),
    [
        (PLATE, Y, None),
        (APEX, Y, "at no support of the model (left, right)"),
        (PLATE, (0.0, 0.0, 1.0), "along the tube"),
    ],
)
def test_contact_forces_that_a_model_has_not_are_left_out(study_config, place, direction, told):
    channels = [
        Channel("apex", APEX, Y, "m s-2", "acceleration"),
        Channel("cell", place, direction, "N", "contact_force"),
    ]
    drive = Channel("shaker", DRIVE, Y, "N", "generic")
    rng = np.random.default_rng(2)
    force = np.stack([band_limited_noise(rng, 16384, RATE, (5.0, 200.0)) for _ in range(2)])
    force = force[:, None] * np.array([1.0, 9.0])[:, None, None]
    campaign = campaign_dataset(
        force,
        force + 0.01 * rng.standard_normal((2, 2, 16384)),
        channels,
        [drive],
        [Level("low", 2.9e-4), Level("high", 2.9e-4)],
        RATE,
    )
    found, checks = usable(campaign, study_config)
    assert ("cell" in found["channel_name"].values) == (told is None)
    rows = [row["message"] for row in checks if row["check"] == "channels"]
    assert rows == [] if told is None else told in rows[0]
