"""What of a campaign is compared with a model."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.comparable import sampling_rows
from vibroimpact.diagnosis.measurement.usable import Refused, checks_of_completed, usable
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


def test_a_channel_passes_that_follows_the_completed_model(study_config):
    channels = [
        Channel(name, place, Y, "m", "displacement")
        for name, place in (("apex", APEX), ("drive", DRIVE))
    ]
    drive = Channel("shaker", DRIVE, Y, "N", "generic")
    levels = [Level("low", 2.9e-4), Level("high", 2.9e-4)]
    rng = np.random.default_rng(2)
    force = np.stack([band_limited_noise(rng, 32768, RATE, (5.0, 200.0)) for _ in range(2)])
    force = force[:, None] * np.array([1e-3, 9e-3])[:, None, None]
    still = campaign_dataset(force, np.zeros((2, 2, 32768)), channels, [drive], levels, RATE)
    model = attach(study_config, still)
    s = 2j * np.pi * np.fft.rfftfreq(32768, 1.0 / RATE)
    receptance = 1.0 / (model.omega[:, None] ** 2 + s**2 + model.damping[:, None] * s)
    lines = (model.sensor_shapes * model.drive_shapes).T @ receptance * np.fft.rfft(force)
    turned = campaign_dataset(
        *(force, -np.fft.irfft(lines, 32768), channels, [drive], levels, RATE)
    )
    excitation = study_config.excitation.model_copy(update={"turn_deg": 180.0})
    completed = study_config.model_copy(update={"excitation": excitation})
    with pytest.raises(Refused) as refusal:  # both channels are reversed, and left out
        usable(turned, study_config)
    said = {row["channel"]: row["level"] for row in refusal.value.checks if row["channel"]}
    assert said == {"apex": "warn", "drive": "warn"}
    settled = checks_of_completed(refusal.value.checks, turned, completed)
    assert {row["channel"]: row["level"] for row in settled if row["channel"]} == dict.fromkeys(
        said, "pass"
    )
    assert checks_of_completed(refusal.value.checks, turned, study_config) == refusal.value.checks


@pytest.mark.parametrize("seconds", [(0.6, 4.0, 4.0), (0.6, 0.6, 4.0)])
def test_short_records_are_left_out(study_config, seconds):
    rng = np.random.default_rng(2)
    force = np.stack([[band_limited_noise(rng, 8192, RATE, (20.0, 900.0))] for _ in seconds])
    force *= np.array([1.0, 3.0, 9.0])[:, None, None]
    response = np.repeat(force, 2, axis=1) + 0.01 * rng.standard_normal((3, 2, 8192))
    campaign = campaign_dataset(
        force,
        response,
        [Channel(name, APEX, Y, "m s-2", "acceleration") for name in ("apex", "beside")],
        [Channel("shaker", DRIVE, Y, "N", "generic")],
        [Level(name, 2.9e-4) for name in ("low", "middle", "high")],
        RATE,
    )
    campaign["valid_samples"] = "record", np.round(RATE * np.array(seconds)).astype(int)
    for record, samples in enumerate(campaign["valid_samples"].values):
        for name in ("force", "response"):
            campaign[name].values[record, ..., samples:] = np.nan
    if sum(duration > 1.0 for duration in seconds) < 2:
        with pytest.raises(Refused, match="Fewer than two records"):
            usable(campaign, study_config)
        return
    found, checks = usable(campaign, study_config)
    assert list(found["record_name"].values) == ["middle", "high"]
    assert [row["record"] for row in checks if row["check"] == "short records"] == ["low"]


@pytest.mark.parametrize(("share", "levels"), [(0.9, ["refuse"]), (2.0, ["warn"]), (9.0, [])])
def test_records_sampled_too_slowly_for_the_modes_are_told(comparison, share, levels):
    model = comparison.structure.with_terms(())
    rate = 2.0 * share * model.frequencies.min() / 0.78125
    rows = sampling_rows(model, xr.Dataset(attrs={"sampling_frequency": rate}))
    assert [row["level"] for row in rows] == levels
    assert all("Sample at" in row["message"] for row in rows)


def test_a_model_without_an_elastic_mode_is_refused(comparison):
    model = comparison.structure.with_terms(())
    free = replace(model, omega=np.zeros(model.modes))
    [row] = sampling_rows(free, xr.Dataset(attrs={"sampling_frequency": 1000.0}))
    assert row["level"] == "refuse" and "hold it" in row["message"]
