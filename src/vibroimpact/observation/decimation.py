"""A campaign at no higher a sampling rate than its comparison needs.

A simulation takes ten steps per sample at least. So a record at 8192 Hz costs four times as much as
one at 2048 Hz, which tells as much of what is compared up to 200 Hz.
"""

import numpy as np
from scipy import signal

from vibroimpact.campaign.file import measured_values, valid_count
from vibroimpact.campaign.signals import campaign_signals, excited_band
from vibroimpact.integration.output_filter import PASS_FRACTION

from .simulated_records import steps_per_second

FEWEST = 8.0  # samples in a period at the upper end of the excited band
STOPPED_DB = 80.0  # what would fold back, as the output filter of a simulation stops it


def slower(campaign, integration):
    """Return a campaign Dataset at the part of its sampling rate that takes the fewest steps of a
    configuration's integration, itself where that is the whole, or where samples are missing. Its
    signals pass the filter that simulated ones do.
    """
    measured = campaign_signals(campaign)
    if not all(np.isfinite(row).all() for row in (*measured.force, *measured.response)):
        return campaign
    force, _ = measured.padded(campaign.sizes["time"])
    most = measured.rate / (FEWEST * excited_band(force, measured.rate)[1])
    period = measured.period_samples
    parts = [part for part in range(1, int(most) + 1) if period % part == 0] or [1]
    part = min(parts, key=lambda part: (steps_per_second(measured.rate / part, integration), part))
    return campaign if part == 1 else _decimated(campaign, part)


def _decimated(campaign, part):
    """Return a campaign Dataset at a part of its sampling rate."""
    out = campaign.isel(time=slice(None, None, part)).copy()
    taps = _taps(part)
    for name in ("force", "response"):
        fewer = np.full_like(out[name].values, np.nan)
        for record, kept in enumerate(fewer):
            values = measured_values(campaign, name, record)
            found = signal.resample_poly(values, 1, part, axis=-1, window=taps, padtype="line")
            kept[:, : found.shape[-1]] = found
        out[name] = (campaign[name].dims, fewer, campaign[name].attrs)
    if "valid_samples" in campaign:
        valid = [
            -(-valid_count(campaign, record) // part) for record in range(campaign.sizes["record"])
        ]
        out["valid_samples"] = ("record", np.array(valid), campaign["valid_samples"].attrs)
    if "noise_floor_rms" in campaign:  # over the whole range to half the sampling rate
        out["noise_floor_rms"] = campaign["noise_floor_rms"] / np.sqrt(part)
    out.attrs["sampling_frequency"] = float(campaign.attrs["sampling_frequency"]) / part
    out.attrs["period_samples"] = int(campaign.attrs.get("period_samples", 0)) // part
    return out


def _taps(part):
    """Return (tap,): flat where the output filter of a simulation is, STOPPED_DB down from half the
    new rate on.
    """
    count, beta = signal.kaiserord(STOPPED_DB, (1.0 - PASS_FRACTION) / part)
    return signal.firwin(count | 1, 0.5 * (1.0 + PASS_FRACTION) / part, window=("kaiser", beta))
