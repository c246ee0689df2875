"""A YAML error in a configuration, whichever way snakemake is given the file."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--configfile", "{broken}"],
        ["--configfile={broken}"],
        ["--configfile", "config/smoke.yaml", "--config", "model={broken}"],
    ],
    ids=["configfile", "configfile=", "model"],
)
def test_snakemake_names_file_line_and_column(tmp_path, arguments):
    broken = tmp_path / "broken.yaml"
    broken.write_text("study: mine\nseed: [1\nspectra: {}\n")
    given = [argument.format(broken=broken) for argument in arguments]
    run = subprocess.run(
        [sys.executable, "-m", "snakemake", "--dry-run", *given],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert run.returncode == 1
    last = run.stderr.strip().splitlines()[-1]
    assert last.startswith(f"{broken}: line 3, column 8: the list that [ opens in line 2")
