"""One sealed campaign of a draw, from its file to its verdict: as a user would run it."""

from pathlib import Path
from tempfile import TemporaryDirectory

from vibroimpact.config.yaml_file import read_yaml
from vibroimpact.discrepancy.whole import run_campaign
from vibroimpact.provenance import package_digest


def run_sealed(campaign, model, verdict):
    """Judge a campaign file against the model file of its user; the verdict is all that is kept.

    No simulations of other campaigns are at hand, as a user has none.
    """
    verdict = Path(verdict)
    with TemporaryDirectory(dir=verdict.parent) as work:
        run_campaign(read_yaml(model), campaign, work, {"source_digest": package_digest()})
        Path(work, "verdict.json").rename(verdict)
