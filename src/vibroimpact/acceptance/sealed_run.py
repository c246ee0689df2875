"""One sealed campaign of a draw, from its file to its verdict: as a user would run it."""

from pathlib import Path
from tempfile import TemporaryDirectory

from vibroimpact.config.reading import load_config
from vibroimpact.missing_effect.engine import Engine
from vibroimpact.provenance import package_digest


def run_sealed(campaign, model, verdict):
    """Judge a campaign file against the model file of its user; the verdict is all that is kept."""
    verdict = Path(verdict)
    with TemporaryDirectory(dir=verdict.parent) as work:
        Engine(load_config(model), str(campaign), Path(work)).run(
            {"source_digest": package_digest()}
        )
        Path(work, "verdict.json").rename(verdict)
