"""A stand-in for a measured campaign: the study's own tube with another force, a slightly different
gap and measuring noise.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.random_streams import random_generator

from .cases import Case
from .simulation import simulate_cases


def synthetic_campaign(config, model, loads, stopwatch=None):
    """Return the campaign Dataset: accelerations at all sensors of `model`, one record per load (N
    RMS, ascending), at the largest gap times overlay.gap_ratio.

    The force is that of seed overlay.seed, which no case of the study has. stopwatch: see
    simulate_cases. Noise: white, Gaussian, overlay.noise times the largest channel RMS of the
    lowest level, the same for all channels and records, as a measuring chain has it.
    """
    gap = max(config.grid.gap_m) * config.overlay.gap_ratio
    cases = [Case(load, gap, config.overlay.seed) for load in loads]
    records = [record for _, record in simulate_cases(config, model, cases, stopwatch=stopwatch)]
    response = np.array([record["acceleration"].values for record in records], dtype=float)
    level = config.overlay.noise * np.sqrt(np.mean(np.square(response[0]), axis=-1)).max()
    response += level * random_generator(
        config.seed, config.overlay.seed, "measuring noise"
    ).standard_normal(response.shape)
    sensors = zip(model.sensor_names, model.sensor_positions, model.sensor_directions, strict=True)
    channels = [
        Channel(f"{name}.acceleration", tuple(point), tuple(direction), "m s-2", "acceleration")
        for name, point, direction in sensors
    ]
    drive = Channel(
        "drive", config.points[config.excitation.point], config.excitation.direction, "N", "generic"
    )
    force = np.array([record["force"].values for record in records])[:, None, :]
    levels = [Level(f"load_{case.load_rms_N:g}N", gap) for case in cases]
    return campaign_dataset(
        force,
        response,
        channels,
        [drive],
        levels,
        config.record.sampling_frequency_Hz,
        start_up="stationary",
        source=(
            f"simulated: gap {config.overlay.gap_ratio:g} times the study's, noise"
            f" {config.overlay.noise:g}"
        ),
    )
