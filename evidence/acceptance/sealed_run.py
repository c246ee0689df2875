"""One sealed campaign of a draw, from its file to its verdict: as a user would run it."""

from pathlib import Path

from vibroimpact.config.reading import load_config
from vibroimpact.diagnosis.diagnose import run_diagnosis
from vibroimpact.diagnosis.verdict.content import write_verdict
from vibroimpact.io.provenance import package_digest


def run_sealed(campaign: str | Path, model: str | Path, verdict: str | Path) -> None:
    """Judge a campaign file against the model file of its user, and write the verdict."""
    found = run_diagnosis(
        campaign, load_config(model), provenance={"source_digest": package_digest()}
    )
    write_verdict(found.verdict, verdict)
