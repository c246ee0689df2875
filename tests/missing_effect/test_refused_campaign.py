"""A campaign that can not be tested still gets every file that the workflow waits for."""

import json

from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.missing_effect import engine

WRITTEN = {
    "verdict.json",
    "ranking.csv",
    "map.nc",
    "map_after.nc",
    "model_updated.yaml",
    "so_far.json",
}


def test_refused_campaign_gets_all_its_files(monkeypatch, tmp_path):
    prepared = Prepared([], refusal="Fewer than two records are left after the checks.")
    monkeypatch.setattr(engine, "prepare", lambda *_, **__: prepared)
    engine.Engine(None, "bench.nc", tmp_path, "quick").run({})
    assert {file.name for file in tmp_path.iterdir()} == WRITTEN
    verdict = json.loads((tmp_path / "verdict.json").read_text())
    assert verdict["verdict"] == "not_testable"
    assert verdict["next_measurement"] == prepared.refusal
    assert json.loads((tmp_path / "so_far.json").read_text()) == {"refused": prepared.refusal}
