"""What the lowest record told is ranked among the explanations that were run beside it."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.missing_effect.decision import decide
from vibroimpact.missing_effect.ranking import ranking_rows

FRICTION = "dry_friction@all"
LINEAR = [(("added_mass",), 0.96), (("root_stiffness",), 0.04)]
ADOPTED = {"name": "added_mass@apex", "unit": [0.5], "gain": 40.0, "interval": [[0.4, 0.6]]}
FIT = SimpleNamespace(log_evidence=7.0, left=9.0, by_law=np.array([0.0, -9.0]))


def ranked(linear, adopted, nothing, something_else, friction):
    """The rows of a ranking in which friction was run."""
    chances = {"nothing": nothing, "something else": something_else, FRICTION: friction}
    fits = {FRICTION: FIT}
    estimate = np.array([0.5]), np.array([[0.4, 0.6]])
    logs = {name: np.log(chance) for name, chance in chances.items()}
    decision = decide(logs, fits, lambda _: estimate, linear, 90.0, 9, {})
    search = SimpleNamespace(
        bench=SimpleNamespace(signals=SimpleNamespace(holdout=lambda: [4])),
        trials={FRICTION: SimpleNamespace(candidate=candidate_named(FRICTION), refined=3)},
        fits=fits,
    )
    closed = SimpleNamespace(misfit={"holdout": {"closed_fraction": 0.9}})
    return ranking_rows(search, Prepared([], adopted=adopted), decision, closed)


def test_what_the_lowest_record_told_alone_leads():
    rows = ranked(LINEAR, ADOPTED, nothing=0.97, something_else=0.02, friction=0.01)
    assert [row["ids"] for row in rows] == [
        "added_mass",
        "root_stiffness",
        "added_mass+dry_friction",
    ]
    assert [row["probability"] for row in rows] == pytest.approx([0.9312, 0.0388, 0.01])
    assert rows[0]["location"] == "apex" and rows[0]["closed_fraction"] == 0.9
    assert rows[1]["closed_fraction"] is None and not rows[1]["tested"]


def test_an_effect_beside_it_leads():
    rows = ranked(LINEAR, ADOPTED, nothing=0.01, something_else=0.02, friction=0.97)
    assert rows[0]["ids"] == "added_mass+dry_friction" and rows[0]["closed_fraction"] == 0.9
    assert rows[1]["closed_fraction"] is None  # the completed model has the friction too


def test_nothing_told_adds_no_row():
    rows = ranked([], None, nothing=0.01, something_else=0.02, friction=0.97)
    assert [row["ids"] for row in rows] == ["dry_friction"]
