"""A model that can not run ends a dry run with its sentence; a coarse mesh warns."""

from pathlib import Path

import pytest

from tests.support.snakemake_runs import RULES, snakemake
from tests.support.sound_campaign import sound_campaign
from vibroimpact.campaign.file import write_campaign

ROOT = Path(__file__).parents[2]
SMOKE = (ROOT / "config" / "smoke.yaml").read_text()


def dry_run(folder, text, *arguments):
    """The finished dry run of a configuration."""
    (folder / "mine.yaml").write_text(text)
    return snakemake(folder, *RULES, "--dry-run", *arguments, "--configfile", "mine.yaml")


def test_a_too_stiff_contact_ends_the_dry_run(tmp_path):
    run = dry_run(tmp_path, SMOKE.replace("4.0e+6", "1.0e+12"))
    assert run.returncode == 1
    assert "mine.yaml: contact stiffness 2e+11 N/m is too stiff" in run.stderr
    assert "Traceback" not in run.stderr and "Job stats" not in run.stderr + run.stdout


@pytest.mark.slow
def test_a_coarse_mesh_warns_in_the_dry_run(tmp_path):
    run = dry_run(tmp_path, SMOKE.replace("elements_per_span: 8", "elements_per_span: 1"))
    assert run.returncode == 0
    assert (run.stderr + run.stdout).count("mine.yaml: structure.mesh is coarse") == 1


@pytest.mark.slow
def test_what_needs_no_model_of_the_study_checks_none(tmp_path):
    """A campaign is compared with the model that is given for it."""
    model = ROOT / "config" / "smoke.yaml"
    write_campaign(sound_campaign(), tmp_path / "bench.nc")
    values = ("--config", f"model={model}", f"campaign={tmp_path}/bench.nc")
    run = dry_run(tmp_path, SMOKE.replace("4.0e+6", "1.0e+12"), "_diagnosis", *values)
    assert run.returncode == 0, run.stderr
    assert "too stiff" not in run.stderr + run.stdout
