"""What several test files share: the study's configuration and its reduced model, built once."""

import os
from pathlib import Path

os.environ.setdefault(
    "OMP_NUM_THREADS", "1"
)  # as the workflow's jobs have it: threads on small matrices cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest

from vibroimpact.config.reading import load_config
from vibroimpact.reduction.reduced_model import build_model

CONFIG = Path(__file__).resolve().parents[1] / "config"


@pytest.fixture(scope="session")
def study_config():
    """The default configuration."""
    return load_config(CONFIG / "study.yaml")


@pytest.fixture(scope="session")
def study_model(study_config):
    """The reduced model of the default configuration."""
    return build_model(study_config)
