"""Decimation of a campaign to the sampling rate that its comparison needs.

A simulation takes at least ten steps per sample. So a record at 8192 Hz costs four times as much as
one at 2048 Hz, with no more information up to 200 Hz.
"""

import numpy as np
import xarray as xr
from scipy import signal

from vibroimpact.campaign.file import measured_values, valid_count
from vibroimpact.campaign.signals import campaign_signals, excited_band
from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.integration.output_filter import PASS_FRACTION

from .simulated_records import steps_per_second

FEWEST = 8.0  # samples in a period at the upper end of the excited band
STOPPED_DB = 80.0  # stopband attenuation, that of the output filter of a simulation


def slower(campaign: xr.Dataset, integration: ConfigPart) -> xr.Dataset:
    """Return a campaign Dataset decimated by the whole factor with the fewest integration steps.

    It is the campaign itself where that factor is 1 or samples are missing. The decimation filter
    has the band edges of the output filter of simulations. integration: section of a configuration.
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
    """Return a campaign Dataset decimated by the factor `part`."""
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
    if "noise_floor_rms" in campaign:  # white, over the range to half the sampling rate
        out["noise_floor_rms"] = campaign["noise_floor_rms"] / np.sqrt(part)
    out.attrs["sampling_frequency"] = float(campaign.attrs["sampling_frequency"]) / part
    out.attrs["period_samples"] = int(campaign.attrs.get("period_samples", 0)) // part
    return out


def _taps(part):
    """Return (tap,) of the decimation filter: the passband of the output filter of simulations,
    and STOPPED_DB attenuation from half the new rate on.
    """
    count, beta = signal.kaiserord(STOPPED_DB, (1.0 - PASS_FRACTION) / part)
    return signal.firwin(count | 1, 0.5 * (1.0 + PASS_FRACTION) / part, window=("kaiser", beta))
