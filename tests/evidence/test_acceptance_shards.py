"""Draws of campaigns: their names and seeds, which campaigns a shard judges, and one of them from
its plan to the command that a user would give.
"""

import json
from dataclasses import replace

import pytest
import yaml

from evidence.acceptance.judging import kind_of, strength_of
from evidence.acceptance.shards import (
    draw_name,
    draw_of,
    frozen_seed,
    numbers_added,
    numbers_judged,
    shard_of,
)
from evidence.truth.campaign import make_campaign
from evidence.truth.draw import POOLS, bare_plan, draw
from evidence.truth.model_file import model_of
from vibroimpact.campaign.file import read_campaign
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.diagnosis.measurement.comparable import comparison_problems
from vibroimpact.io.provenance import package_digest


def test_shards_add_up():
    parts = [*shard_of(11, "0/3"), *shard_of(11, "1/3"), *shard_of("11", "2/3")]
    assert sorted(parts) == list(range(11))


@pytest.mark.parametrize(
    ("count", "shard", "named"),
    [
        ("many", "0/1", "count = many"),
        ("0", "0/1", "count = 0"),
        ("-3", "0/1", "count = -3"),
        ("9", "3/3", "shard = 3/3"),
        ("9", "1", "shard = 1"),
        ("9", "0/0", "shard = 0/0"),
        ("9", "a/b", "shard = a/b"),
    ],
)
def test_invalid_shard_is_refused(count, shard, named):
    with pytest.raises(ValueError, match=f"^{named}: give"):
        shard_of(count, shard)


@pytest.mark.parametrize("pool", POOLS)
def test_a_draw_is_known_by_its_name(pool):
    assert draw_of(draw_name(pool, 3812913005)) == (pool, 3812913005)


def test_acceptance_seed_changes_with_the_source():
    digest = package_digest()
    assert frozen_seed(digest) == int(digest[:8], 16) != frozen_seed("0" + digest)


def test_the_table_of_another_draw_is_refused(tmp_path):
    file = tmp_path / "campaigns.csv"
    file.write_text("draw,campaign\ndevelopment_5,campaign_0002\ndevelopment_5,campaign_0003\n")
    assert numbers_added([file], "development_5") == {2, 3}
    assert numbers_added([], "development_5") == set()
    with pytest.raises(ValueError, match=r"holds campaigns of development_5: give a campaigns.csv"):
        numbers_added([file], "development_6")
    with pytest.raises(ValueError, match=r"nothing.csv is not there"):
        numbers_added([tmp_path / "nothing.csv"], "development_5")
    file.write_text("draw,campaign\n")
    with pytest.raises(ValueError, match=r"campaigns.csv holds no campaign"):
        numbers_added([file], "development_5")


def test_judged_campaigns_are_those_with_a_verdict(tmp_path):
    for number in (0, 3):
        (tmp_path / f"campaign_{number:04d}").mkdir()
        (tmp_path / f"campaign_{number:04d}" / "verdict.json").write_text(json.dumps({}))
    (tmp_path / "campaign_0001").mkdir()
    assert numbers_judged(tmp_path) == [0, 3]


@pytest.mark.parametrize("pool", POOLS)
def test_models_of_drawn_campaigns_are_configurations(pool):
    for number in range(12):
        plan, _ = bare_plan(pool, 2, number)
        text = yaml.safe_dump(model_of(plan))
        config = check_config(yaml.safe_load(text), "model.yaml")
        assert len(config.supports) == len(plan.beam.holders)


@pytest.mark.slow
@pytest.mark.parametrize(("pool", "number"), [("development", 1), ("acceptance", 4)])
def test_a_drawn_campaign_can_be_compared_with_its_model(pool, number, tmp_path):
    plan, _, names = draw(pool, 2, number)
    levels = (plan.levels[0], (*plan.levels[-1][:2], "holdout"))
    plan = replace(plan, duration=4.0, levels=levels)
    files = [tmp_path / name for name in ("x.nc", "truth.json", "x.yaml")]
    make_campaign(plan, files[0], files[1], model_path=files[2])
    campaign = read_campaign(files[0])
    assert comparison_problems(load_config(files[2]), campaign) == []
    assert list(campaign["split"].values) == ["fit", "holdout"]
    truth = json.loads(files[1].read_text())
    assert [name for name, _ in truth["effects"]] == list(names)
    assert strength_of(truth) >= 0.0 and kind_of(truth) in (plan.kind, "medium", "weak")
    lowest, highest = truth["contact_share"]
    assert max(lowest) == 0.0 < max(highest)
