"""What a run leaves beside its results: a configuration that runs again, and its origin."""

import json
from pathlib import Path

import numpy
import pytest
import yaml

import vibroimpact
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.config.stage_keys import STAGE_KEYS, stage_params
from vibroimpact.io.provenance import config_digest, package_digest
from vibroimpact.study.run_files import write_run_files

ROOT = Path(__file__).parents[2]
CONFIGURATIONS = sorted(
    file for file in (ROOT / "config").rglob("*.yaml") if "study:" in file.read_text()
)


@pytest.mark.parametrize("file", CONFIGURATIONS, ids=lambda file: file.stem)
def test_configuration_of_a_run_runs_again_as_it_stands(file, tmp_path):
    config = load_config(file)
    write_run_files(tmp_path, config.model_dump(mode="json"), ["snakemake"])
    again = load_config(tmp_path / "config.yaml")
    assert again == config
    for stage in STAGE_KEYS:  # every number comes back to the last bit: nothing would rerun
        assert config_digest(stage_params(again, stage)) == config_digest(
            stage_params(config, stage)
        )


def test_configuration_of_a_run_states_the_defaults(tmp_path):
    values = yaml.safe_load((ROOT / "config" / "smoke.yaml").read_text())
    assert "scheme" not in values["integration"] and "friction" not in values["supports"][0]
    config = check_config(values, "smoke")
    write_run_files(tmp_path / "smoke", config.model_dump(mode="json"), ["snakemake"])
    text = (tmp_path / "smoke" / "config.yaml").read_text()
    written = yaml.safe_load(text)
    assert written["integration"]["scheme"] == config.integration.scheme
    assert written["supports"][1]["friction"] == 0.0
    assert f"--configfile {tmp_path.as_posix()}/smoke/config.yaml" in text


def test_provenance_names_version_digests_and_command(tmp_path):
    write_run_files(tmp_path, {"seed": 1}, ["/some/where/snakemake", "-j2", "timing"])
    found = json.loads((tmp_path / "provenance.json").read_text())
    assert found["vibroimpact_version"] == vibroimpact.__version__
    assert found["package_digest"] == package_digest()
    assert found["config_digest"] == config_digest({"seed": 1})
    assert found["versions"]["numpy"] == numpy.__version__
    assert {"python", "scipy", "numba", "snakemake"} <= set(found["versions"])
    assert found["command"] == "snakemake -j2 timing"


def test_a_run_without_configuration_leaves_none(tmp_path):
    write_run_files(tmp_path, None, ["snakemake"])
    assert [file.name for file in tmp_path.iterdir()] == ["provenance.json"]
    assert json.loads((tmp_path / "provenance.json").read_text())["config_digest"] is None
