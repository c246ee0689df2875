"""A campaign is compared at the part of its sampling rate that takes the fewest steps."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from vibroimpact.campaign.file import fill_missing
from vibroimpact.observation.decimation import slower
from vibroimpact.observation.features import feature_layout, record_features
from vibroimpact.observation.signals import signals_of
from vibroimpact.observation.simulated_records import steps_per_second

INTEGRATION = SimpleNamespace(steps_per_second=20480, scheme="exact")
SECONDS, TOP_HZ = 8.0, 200.0


def band_limited(random, samples, rate, low=20.0, high=TOP_HZ):
    """Return (sample,) noise of a band."""
    spectrum = np.fft.rfft(random.standard_normal(samples))
    frequency = np.fft.rfftfreq(samples, 1.0 / rate)
    spectrum[(frequency < low) | (frequency > high)] = 0.0
    return np.fft.irfft(spectrum, samples)


def campaign(rate, **attributes):
    """Return a campaign of two records, the second one shorter."""
    random, samples = np.random.default_rng(4), round(SECONDS * rate)
    force, response = np.full((2, 1, samples), np.nan), np.full((2, 2, samples), np.nan)
    valid = [samples, samples // 2]
    for record, count in enumerate(valid):
        force[record, 0, :count] = band_limited(random, count, rate)
        for channel in range(2):
            response[record, channel, :count] = 1.0e-3 * band_limited(random, count, rate, low=5.0)
    along = [[0.0, 1.0, 0.0]]
    return fill_missing(
        xr.Dataset(
            {
                "force": (("record", "force_channel", "time"), force),
                "response": (("record", "channel", "time"), response),
                "valid_samples": ("record", valid),
                "gap": ("record", [1.0e-4, 1.0e-4], {"units": "m"}),
                "channel_name": ("channel", ["one", "two"]),
                "channel_kind": ("channel", ["displacement", "displacement"]),
                "channel_units": ("channel", ["m", "m"]),
                "channel_point": (("channel", "xyz"), np.zeros((2, 3))),
                "channel_direction": (("channel", "xyz"), np.array(along * 2)),
                "noise_floor_rms": ("channel", [1.0e-6, 2.0e-6]),
                "force_channel_name": ("force_channel", ["shaker"]),
                "force_channel_point": (("force_channel", "xyz"), np.zeros((1, 3))),
                "force_channel_direction": (("force_channel", "xyz"), np.array(along)),
            },
            {"time": np.arange(samples) / rate},
            {"sampling_frequency": rate, "start_up": "stationary"} | attributes,
        )
    )


@pytest.mark.parametrize(
    ("rate", "kept"), [(8192.0, 2048.0), (5120.0, 2560.0), (2048.0, 2048.0), (2560.0, 2560.0)]
)
def test_fewest_steps_are_taken(rate, kept):
    found = slower(campaign(rate), INTEGRATION)
    assert found.attrs["sampling_frequency"] == kept
    assert steps_per_second(kept, INTEGRATION) <= steps_per_second(rate, INTEGRATION)
    assert found.sizes["time"] == round(SECONDS * kept)
    assert found["valid_samples"].values.tolist() == [found.sizes["time"], found.sizes["time"] // 2]


def test_what_is_compared_stays_the_same():
    whole = campaign(8192.0)
    found = slower(whole, INTEGRATION)
    rows = []
    for dataset in (whole, found):
        signals = replace(signals_of(dataset), band_Hz=(20.0, TOP_HZ))
        layout = feature_layout(signals, np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
        rows.append(record_features(layout, signals.force[0, 0], signals.response[0]))
        assert signals.noise_in_band == pytest.approx(
            np.array([1.0e-6, 2.0e-6]) * np.sqrt(180.0 / 4096.0)
        )
    assert rows[1] == pytest.approx(rows[0], abs=0.02)


def test_what_would_fold_back_is_stopped():
    whole = campaign(8192.0)
    time = whole["time"].values
    whole["response"][0, 0] = 1.0e-3 * np.sin(2.0 * np.pi * 1500.0 * time)  # 548 Hz at 2048 Hz
    whole["response"][0, 1] = 1.0e-3 * np.sin(2.0 * np.pi * 700.0 * time)
    stopped, passed = slower(whole, INTEGRATION)["response"].values[0, :, 100:-100]
    assert np.std(stopped) < 1.0e-4 * 1.0e-3
    assert np.std(passed) == pytest.approx(1.0e-3 / np.sqrt(2.0), rel=1.0e-3)


def test_period_stays_whole():
    found = slower(campaign(8192.0, period_samples=2 * 8191), INTEGRATION)
    assert (found.attrs["sampling_frequency"], found.attrs["period_samples"]) == (4096.0, 8191)


def test_wide_band_or_missing_samples_are_kept():
    wide = campaign(8192.0)
    wide["force"].values[0, 0] = band_limited(
        np.random.default_rng(1), wide.sizes["time"], 8192.0, 20.0, 1500.0
    )
    assert slower(wide, INTEGRATION) is wide
    holed = campaign(8192.0)
    holed["response"].values[0, 0, 100] = np.nan
    assert slower(holed, INTEGRATION) is holed
