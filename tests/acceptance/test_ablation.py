"""Rules are left out one at a time, and only where they act."""

import json
from types import ModuleType

import pytest

from vibroimpact.acceptance.ablation import RULES, Rule, rows_of


@pytest.fixture
def module():
    made = ModuleType("made")
    made.looks = lambda near: near
    made.does = lambda: None
    made.LIMIT = 3.0
    return made


def test_a_rule_acts_where_it_finds_something_to_do(module):
    acted = set()
    looks, does, limit = (
        Rule("looks", module, "looks", False),
        Rule("does", module, "does", step=True),
        Rule("limit", module, "LIMIT", 1.0e9),
    )
    with looks.watched(acted), does.watched(acted), limit.watched(acted):
        assert module.looks(near=False) is False
        assert acted == {"limit"}
        module.looks(near=True)
        module.does()
    assert acted == {"limit", "looks", "does"}


def test_what_is_left_out_comes_back(module):
    with Rule("looks", module, "looks", False).left_out():
        assert module.looks(near=True) is False
    with Rule("limit", module, "LIMIT", 1.0e9).left_out():
        assert module.LIMIT == 1.0e9
    assert module.looks(near=True) is True and module.LIMIT == 3.0


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_every_rule_is_there(rule):
    assert rule.own is not None


def test_a_campaign_is_judged_without_each_rule_that_acts(module, tmp_path):
    """With the rule the effect is named, without it nothing is."""
    truth = {"kind": "strong", "effects": [["gap", {"factor": 1.5}]], "strength": {"floors": 4.0}}
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "campaign_0003.json").write_text(json.dumps(truth))
    rules = [Rule("looks", module, "looks", False), Rule("idle", module, "idle", False)]
    module.idle = lambda: False

    def judge(campaign, model, verdict):
        assert (campaign.name, model.name) == ("campaign_0003.nc", "campaign_0003.yaml")
        named = [["gap"]] if module.looks(near=True) or module.idle() else []
        said = {"verdict": "named" if named else "none", "ambiguity_set": named, "ranking": []}
        empty = {"checks": [], "misfit": {}, "effects": []}
        verdict.write_text(json.dumps(said | empty))

    rows = list(rows_of(tmp_path, 3, rules, judge))
    assert [(row["without"], row["in_set"]) for row in rows] == [("", True), ("looks", False)]
