"""A campaign of band-limited noise, of two records of unequal length."""

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import fill_missing

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
