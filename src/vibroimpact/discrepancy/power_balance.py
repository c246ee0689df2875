"""The power balance: measured and simulated input power of the force, where a channel measures at
the drive point along the force.
"""

import numpy as np
import xarray as xr

from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.workbench import Workbench
from vibroimpact.observation.sensed_motion import moving
from vibroimpact.units import TIME_DERIVATIVES

DRIVE_M = 5.0e-3  # largest distance of a channel at the drive point
ALONG = 0.999  # least |cosine| between the channel and the force
POWER_Z = 4.0


def drive_channel(campaign: xr.Dataset) -> tuple[int, float] | None:
    """Return (channel, sense 1.0 or -1.0) of a motion at the first force and along it.

    None where there is no such channel, and with a moving base, which acts at no point.
    """
    if base_channels(campaign).any():
        return None
    away = np.linalg.norm(
        campaign["channel_point"].values - campaign["force_channel_point"].values[0], axis=1
    )
    directions = campaign["channel_direction"].values.astype(float)
    force = campaign["force_channel_direction"].values[0].astype(float)
    cosine = (
        directions
        @ force
        / np.maximum(np.linalg.norm(directions, axis=1) * np.linalg.norm(force), 1.0e-300)
    )
    found = np.flatnonzero(
        (away < DRIVE_M) & (np.abs(cosine) > ALONG) & moving(campaign["channel_kind"].values)
    )
    return (int(found[0]), float(np.sign(cosine[found[0]]))) if found.size else None


def input_power(
    force: np.ndarray, response: np.ndarray, kind: str, rate: float, band_Hz: tuple[float, float]
) -> float:
    """Return the mean of force times velocity in a band, in W.

    force (sample,): N. response (sample,): SI, of a kind of motion. rate, band_Hz: Hz.
    """
    window = np.hanning(len(force))
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(force), 1.0 / rate)
    inside = (omega >= 2.0 * np.pi * band_Hz[0]) & (omega <= 2.0 * np.pi * band_Hz[1])
    spectra = [np.fft.rfft(window * series)[inside] for series in (force, response)]
    velocity = spectra[1] * (1j * omega[inside]) ** (1.0 - TIME_DERIVATIVES[kind])
    return float(
        2.0 * np.sum((spectra[0].conj() * velocity).real) / (len(force) * np.sum(window**2))
    )


def broken(bench: Workbench, simulated: np.ndarray) -> bool:
    """Return whether the measured input power of any record differs from the simulated one by more
    than the scatter of the seeds and the gains of two channels allow.

    simulated: (record, seed, channel, sample).
    """
    found = drive_channel(bench.campaign)
    if found is None:
        return False
    (channel, sense), signals = found, bench.signals
    for record, seeds in enumerate(simulated):
        keep = np.isfinite(signals.force[record][0])
        force = signals.force[record][0, keep]
        measured, *own = (
            sense
            * input_power(
                force, row[channel, keep], signals.kinds[channel], signals.rate, signals.band_Hz
            )
            for row in (signals.response[record], *seeds)
        )
        sd = np.hypot(
            np.std(own, ddof=1) * np.sqrt(1.0 + 1.0 / len(own)),
            np.sqrt(2.0) * priors.GAIN_SD * np.mean(own),
        )
        if abs(measured - np.mean(own)) > POWER_Z * sd:
            return True
    return False
