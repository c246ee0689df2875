"""The power balance: what the force puts into the structure, measured and simulated, where a
channel sits at the drive and looks along the force.
"""

import numpy as np

from vibroimpact.campaign.force_kinds import base_channels
from vibroimpact.observation.sensed_motion import moving
from vibroimpact.units import TIME_DERIVATIVES

from . import priors

DRIVE_M = 5.0e-3  # a channel nearer to the drive than this is at it
ALONG = 0.999  # cosine between the channel and the force
POWER_Z = 4.0


def drive_channel(campaign):
    """Return (channel, sense 1 or -1) of a motion at the first force and along it, None where there
    is none; a moving base acts at no point.
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


def input_power(force, response, kind, rate, band_Hz):
    """Return W, the mean of force times velocity in a band (Hz): force (sample,) N, response
    (sample,) of a kind of motion in SI.
    """
    window = np.hanning(len(force))
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(force), 1.0 / rate)
    inside = (omega >= 2.0 * np.pi * band_Hz[0]) & (omega <= 2.0 * np.pi * band_Hz[1])
    spectra = [np.fft.rfft(window * series)[inside] for series in (force, response)]
    velocity = spectra[1] * (1j * omega[inside]) ** (1.0 - TIME_DERIVATIVES[kind])
    return float(
        2.0 * np.sum((spectra[0].conj() * velocity).real) / (len(force) * np.sum(window**2))
    )


def broken(bench, simulated):
    """Return whether the measured input power of any record is beyond what seeds and two gains
    allow; simulated (record, seed, channel, sample).
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
