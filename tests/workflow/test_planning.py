"""A plan of a study imports the configuration, and of the library little else."""

import json
import subprocess
import sys

import pytest

from tests.support.tiny_study import ROOT

# Plans in this process, then prints the names of the modules that it has loaded.
PLAN = """
import atexit, json, sys
from snakemake import cli
atexit.register(lambda: print(json.dumps(sorted(sys.modules))))
cli.main(sys.argv[1:])
"""
# What checks of a configuration need (materials and geometry of a tube), names of cases and
# captions, and digests.
LIGHT = ("config", "geometry", "materials", "io.provenance", "io.whole_file", "reports.captions")
LIGHT += ("study.cases", "study.folder.shared_files")


@pytest.fixture(scope="module")
def loaded():
    """The modules loaded by the second of two plans: the first one checks the model."""
    command = [sys.executable, "-c", PLAN, "--dry-run", "--configfile", "config/smoke.yaml"]
    for _ in range(2):
        run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        assert run.returncode == 0, run.stdout + run.stderr
    return json.loads(run.stdout.splitlines()[-1])


def test_planning_imports_the_configuration_alone(loaded):
    top = "vibroimpact."
    library = {name.removeprefix(top) for name in loaded if name.startswith(top)}
    packages = {name.rpartition(".")[0] for name in LIGHT}
    assert {name for name in library - packages if not name.startswith(LIGHT)} == set()


def test_planning_loads_no_numerical_library(loaded):
    assert not {"scipy", "xarray", "netCDF4", "numba", "matplotlib", "h5py"} & set(loaded)
