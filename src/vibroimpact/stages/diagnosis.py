"""Write the effects that a model lacks of a measured campaign, in one job."""

from pathlib import Path
from typing import Any

from vibroimpact.diagnosis.diagnose import run_diagnosis, write_diagnosis
from vibroimpact.diagnosis.identified.structure_file import model_from
from vibroimpact.diagnosis.progress import SoFar
from vibroimpact.io.provenance import verdict_origin


def make(given: Any, made: Any, params: Any, threads: int) -> None:
    """given: campaign. made: verdict; the other files lie in its folder. params: model in plain
    values, effort, so_far: file of the progress. threads: runs at a time.
    """
    values, campaign = params.model, str(given.campaign)
    found = run_diagnosis(
        campaign,
        model_from(values),
        params.effort,
        threads,
        verdict_origin(values, campaign),
        SoFar(params.so_far),
    )
    write_diagnosis(found, Path(made.verdict).parent)
