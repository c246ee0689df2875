"""What several test files share: the study's configuration and its reduced model, built once."""

import os
import subprocess
import sys
from pathlib import Path

# Threads on small matrices cost more than they bring, and the tests run one process per core.
os.environ |= {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMBA")}

import pytest
from hypothesis import HealthCheck, settings

from vibroimpact.config.reading import load_config
from vibroimpact.reduction.reduced_model import build_model

ROOT = Path(__file__).resolve().parents[1]
pytest_plugins = ["tests.reliability_page"]

# Examples of a property test: the same in every run. `--hypothesis-profile thorough` takes more,
# `thousand` 1,000 of each.
FIXED = {
    "derandomize": True,
    "database": None,
    "deadline": None,
    "suppress_health_check": list(HealthCheck),
}
settings.register_profile("fast", max_examples=25, **FIXED)
settings.register_profile("thorough", max_examples=250, **FIXED)
settings.register_profile("thousand", max_examples=1000, **FIXED)
settings.load_profile("fast")


@pytest.hookimpl(tryfirst=True)
def pytest_sessionstart(session):
    """Compile the kernels once, before parallel workers start and each compiles its own."""
    if session.config.getoption("numprocesses", None) and not hasattr(
        session.config, "workerinput"
    ):
        path = os.pathsep.join([str(ROOT / "src"), str(ROOT)])
        command = [sys.executable, "-m", "tests.compile_kernels"]
        subprocess.run(command, cwd=ROOT, env=os.environ | {"PYTHONPATH": path}, check=True)


@pytest.fixture(scope="session")
def study_config():
    """The default configuration."""
    return load_config(ROOT / "config" / "study.yaml")


@pytest.fixture(scope="session")
def study_model(study_config):
    """The reduced model of the default configuration."""
    return build_model(study_config)
