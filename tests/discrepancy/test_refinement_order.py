"""Who comes first of what was looked at closely."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import jobs
from vibroimpact.discrepancy.candidates import candidate_named

ENOUGH, LEFT = np.array([0.3, -1.0]), np.array([0.3, -4.9])


@pytest.fixture
def ordered(monkeypatch):
    """Return the function ({name: (gain, explained)}) -> [name], best first."""

    def run(rows):
        monkeypatch.setattr(
            jobs.naming,
            "totals",
            lambda *_: {name: (gain, gain, 0.0) for name, (gain, _) in rows.items()},
        )
        monkeypatch.setattr(jobs.naming, "explained", lambda bench, null, mean, *_: rows[mean][1])
        found = [
            SimpleNamespace(candidate=candidate_named(name), mean=name, own=lambda null: null)
            for name in rows
        ]
        bench = SimpleNamespace(measured_features={"records": None})
        return [
            row.candidate.name
            for row in jobs.ordered(bench, SimpleNamespace(records="records"), found)[0]
        ]

    return run


def test_larger_score_gain_ranks_first(ordered):
    assert ordered({"gap@all": (300.0, LEFT), "hertz@all": (500.0, LEFT)}) == [
        "hertz@all",
        "gap@all",
    ]


def test_sufficient_effect_ranks_first_among_ambiguous(ordered):
    rows = {
        "hertz@all": (663.0, LEFT),
        "contact_stiffness@all": (641.0, ENOUGH),
        "plate_flexibility@all": (170.0, ENOUGH),
    }
    assert ordered(rows)[:2] == ["contact_stiffness@all", "hertz@all"]
    assert ordered(rows | {"hertz@all": (663.0, ENOUGH)})[0] == "hertz@all"
    assert ordered(rows | {"contact_stiffness@all": (400.0, ENOUGH)})[0] == "hertz@all"


def test_empty_list_has_no_order(ordered):
    assert ordered({}) == []


def test_alias_of_the_best_needs_less_gain():
    ranked = {
        "ranked": [
            {"name": name, "score": score}
            for name, score in (
                ("support_offset@all", 500.0),
                ("support_offset@left", 480.0),
                ("gap@all", 300.0),
                ("preload@all", 200.0),
            )
        ]
    }
    alias, other = (jobs.least_gain(name, ranked) for name in ("preload@all", "gap@all"))
    assert 0.0 < alias < other < 500.0  # gains count as shares of the best one's
    second = jobs.least_gain("support_offset@left", ranked)
    assert second == pytest.approx(other * 300.0 / 500.0)  # of the best of another effect, the gap
    assert jobs.least_gain("gap@all", {"ranked": ranked["ranked"][2:3]}) == -np.inf
    behind = {
        "ranked": [
            {"name": "hertz@all", "score": -77.0},
            {"name": "contact_damping@all", "score": -64.0},
        ]
    }
    assert jobs.least_gain("contact_damping@all", behind) > 0.0  # a loss of others is no measure


def test_pair_needs_the_gain_that_a_name_asks():
    pairs = {"pairs": {}, "least": 70.0, "threshold": 15.0}
    assert jobs.least_gain("gap@left", pairs) == 70.0
    assert jobs.least_gain("gap@all+hertz@all", pairs) == 70.0 + 15.0
    assert jobs.least_gain("gap@all+hertz@all", pairs | {"least": 700.0}) > 700.0 + 15.0


def test_leading_effects_are_tried_at_every_place():
    ranked = {
        "ranked": [
            {"name": "clearance@shaker", "score": 900.0},
            {"name": "coulomb_friction@shaker", "score": 800.0},
            {"name": "cubic_stiffness@apex", "score": 700.0},
        ]
    }
    names = (
        "clearance@shaker",
        "clearance@apex",
        "coulomb_friction@shaker",
        "cubic_stiffness@apex",
    )
    assert [jobs.leading(candidate_named(name), ranked) for name in names] == [
        True,
        False,
        False,
        True,
    ]
    assert not jobs.leading(candidate_named("clearance@shaker"), {"pairs": {}})
