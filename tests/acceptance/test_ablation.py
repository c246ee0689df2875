"""Rules are left out one at a time, and only where they act."""

from types import ModuleType

import pytest

from vibroimpact.acceptance.ablation import RULES, Rule


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
