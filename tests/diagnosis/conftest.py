"""A tube between two plates, and a campaign of its forces at three loads."""

import numpy as np
import pytest

from tests.support.contact_truth import contact_campaign
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.diagnosis.comparison import Comparison
from vibroimpact.diagnosis.explanations import Point, Structure
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.excitation.random_force import band_limited_noise

RATE, SECONDS, GAP = 2048.0, 8.0, 2.8886e-4
LOADS = (0.8, 6.0, 20.0)


@pytest.fixture(scope="session")
def measured(tmp_path_factory):
    """(campaign file, model file, TrueForces): a record below contact and one with impacts, with
    gains 2 %, frequencies 0.3 % and damping 10 % off.
    """
    levels = ((0.5, 1.3, "fit"), (12.0, 1.3, "fit"))
    folder = tmp_path_factory.mktemp("contact")
    return contact_campaign(folder, seed=(3,), levels=levels, duration=5.0)


@pytest.fixture(scope="session")
def comparison(study_config):
    """The study's tube beside records of its own motion under band-limited forces, and noise."""
    rng, samples = np.random.default_rng(5), int(RATE * SECONDS)
    points = {"apex": (0, 0, 1.0), "left": (-0.3, 0, 0.5), "right": (0.3, 0, 0.5)}
    channels = [
        Channel(f"{name}_{axis}", place, direction, "m s-2", "acceleration")
        for name, place in points.items()
        for axis, direction in (("x", (1, 0, 0)), ("y", (0, 1, 0)))
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    force = np.stack(
        [load * band_limited_noise(rng, samples, RATE, (5.0, 200.0))[None] for load in LOADS]
    )
    levels = [Level(f"load {load}", GAP) for load in LOADS]

    def compared(response):
        parts = channels, [drive], levels, RATE
        campaign = campaign_dataset(force, response, *parts, start_up="rest")
        return Comparison(signals_of(campaign), Structure(study_config, campaign))

    noise = 1.0e-3 * rng.standard_normal((len(LOADS), len(channels), samples))
    still = compared(noise)
    schedule = still.rates.schedule(SECONDS, study_config.integration.scheme)
    runs = [(record, GAP, 1) for record in range(len(LOADS))]
    model = still.structure.model(Point())
    motion = simulate_records(model, schedule, force, runs, still.signals.kinds)
    return compared(noise + motion / still.structure.scale[:, None])
