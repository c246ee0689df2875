"""A simulated campaign that stands in for a measured one.

It is the study's tube with another force, a slightly different gap and measurement noise.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.file import SYNTHETIC, Channel, Level, campaign_dataset
from vibroimpact.excitation.random_streams import random_generator
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.modal_model import ModalModel

from .cases import Case
from .simulation import simulate_cases


def synthetic_campaign(
    config: Any, model: ModalModel, loads: Sequence[float], stopwatch: Stopwatch | None = None
) -> xr.Dataset:
    """Return the campaign Dataset: accelerations at all sensors of the model, one record per load.

    loads: N RMS, ascending.
    stopwatch: see simulate_cases.

    The gap is the largest of the grid times overlay.gap_ratio. The force is that of seed
    overlay.seed, which no case of the study has. Noise is white and Gaussian, as of a measuring
    chain the same for all channels and records: overlay.noise times the largest channel RMS of the
    lowest level.
    """
    gap = max(config.grid.gap_m) * config.overlay.gap_ratio
    cases = [Case(load, gap, config.overlay.seed) for load in loads]
    records = [record for _, record in simulate_cases(config, model, cases, stopwatch=stopwatch)]
    response = np.array([record["acceleration"].values for record in records], dtype=float)
    level = config.overlay.noise * np.sqrt(np.mean(np.square(response[0]), axis=-1)).max()
    noise = random_generator(config.seed, config.overlay.seed, "measuring noise")
    response += level * noise.standard_normal(response.shape)
    sensors = zip(model.sensor_names, model.sensor_positions, model.sensor_directions, strict=True)
    channels = [
        Channel(f"{name}.acceleration", tuple(point), tuple(direction), "m s-2", "acceleration")
        for name, point, direction in sensors
    ]
    force, drives = np.zeros(0), []  # turbulence has no force that a sensor measures
    if "point" in config.excitation:
        place, direction = config.points[config.excitation.point], config.excitation.direction
        drives = [Channel("drive", place, direction, "N", "generic")]
        force = np.array([record["force"].values for record in records])[:, None, :]
    levels = [Level(f"load_{case.load_rms_N:g}N", gap) for case in cases]
    campaign = campaign_dataset(
        force,
        response,
        channels,
        drives,
        levels,
        config.record.sampling_frequency_Hz,
        start_up="stationary",
        source=(
            f"{SYNTHETIC}: gap {config.overlay.gap_ratio:g} times the study's, noise"
            f" {config.overlay.noise:g}"
        ),
    )
    if drives:
        return campaign
    return campaign.assign(load_rms=("record", np.array(loads, float), {"units": "N"}))
