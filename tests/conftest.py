"""What several test files share: the study's configuration and its reduced model, built once."""

from pathlib import Path

import pytest

from vibroimpact.config import load_config
from vibroimpact.reduction import build_model

CONFIG = Path(__file__).resolve().parents[1] / "config"


@pytest.fixture(scope="session")
def study_config():
    """The default configuration."""
    return load_config(CONFIG / "study.yaml")


@pytest.fixture(scope="session")
def study_model(study_config):
    """The reduced model of the default configuration."""
    return build_model(study_config)
