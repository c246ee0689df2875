"""A campaign of strain gauges alone from file to verdict: a wider clearance is named by them. The
records are the package's own, for the independent code has no strains.
"""

import json

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.missing_effect.engine import Engine
from vibroimpact.observation.attached_model import attach
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, WIDER, NOISE, GAINS = 2048.0, 14.0, 1.4, 0.01, 0.02
X, Y, DRIVE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.2121, 0.0, 0.9121)
PLACES = (((-0.3, 0, 0.3), Y), ((-0.3, 0, 0.02), Y), ((0.3, 0, 0.55), Y), ((-0.3, 0, 0.3), X))
GAPS = (2.8886e-4, 2.8886e-4, 2.0e-4)
LOADS_N = (0.5, 10.0, 10.0)


@pytest.mark.slow
def test_wider_clearance_is_named_by_strain_gauges(study_config, tmp_path):
    samples = int(RATE * SECONDS)
    force = np.stack(
        [
            load * band_limited_noise(np.random.default_rng(number), samples, RATE, (5.0, 200.0))
            for number, load in enumerate(LOADS_N)
        ]
    )[:, None]
    gauges = [
        Channel(f"gauge {number}", place, normal, "um/m", "strain")
        for number, (place, normal) in enumerate(PLACES)
    ]
    drive = Channel("shaker", DRIVE, Y, "N", "generic")
    names = ("low", "high", "held")
    levels = [
        Level(name, gap, split="holdout" if name == "held" else "fit")
        for name, gap in zip(names, GAPS, strict=True)
    ]

    def campaign_of(strains):
        return campaign_dataset(
            force, 1.0e6 * strains, gauges, [drive], levels, RATE, start_up="rest"
        )

    blank = campaign_of(np.zeros((3, len(gauges), samples)))
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    runs = [(number, WIDER * gap, 900 + number) for number, gap in enumerate(GAPS)]
    kinds = ["strain"] * len(gauges)
    strains = simulate_records(
        attach(study_config, blank), schedule, Forces(force, schedule), runs, kinds
    ).astype(float)
    random = np.random.default_rng(5)
    noise = NOISE * strains[0].std(axis=-1).max()
    strains *= (1.0 + GAINS * random.standard_normal(len(gauges)))[:, None]
    strains += noise * random.standard_normal(strains.shape)
    write_campaign(campaign_of(strains), tmp_path / "campaign.nc")

    Engine(study_config, str(tmp_path / "campaign.nc"), tmp_path, "quick").run({})

    verdict = json.loads((tmp_path / "verdict.json").read_text())
    assert not [row for row in verdict["checks"] if row["check"] == "channels"]
    assert verdict["ambiguity_set"] == [["gap"], ["sensor_gain"]]
    factor = verdict["most_probable"][0]["parameters"]["gap_factor"]
    assert factor["low"] < WIDER < factor["high"]
    assert verdict["p_global_before"] < 1.0e-6 < 0.001 < verdict["p_global_after"]
    assert verdict["misfit"]["holdout"]["closed_fraction"] > 0.7
