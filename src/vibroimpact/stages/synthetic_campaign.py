"""Simulate the stand-in for a measured campaign and write it as a campaign file."""

from typing import Any

from vibroimpact.campaign.file import write_campaign
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.provenance import file_attributes
from vibroimpact.io.stopwatch import Stopwatch
from vibroimpact.reduction.model_file import read_model
from vibroimpact.study.synthetic_campaign import synthetic_campaign


def make(given: Any, made: Any, params: Any) -> Stopwatch:
    """given: model. made: campaign. params: config, library, loads in N RMS."""
    config, stopwatch = StageSettings(params.config), Stopwatch()
    campaign = synthetic_campaign(config, read_model(given.model), params.loads, stopwatch)
    write_campaign(
        campaign.assign_attrs(file_attributes(params.config, params.library)), made.campaign
    )
    print(f"{made.campaign} written, loads {params.loads} N RMS")
    return stopwatch
