"""The ranking: first what the verdict says, then what gains most."""

from types import SimpleNamespace

import pytest

from vibroimpact.discrepancy import conclusion
from vibroimpact.discrepancy.candidates import candidate_named

SPRING = SimpleNamespace(candidate=candidate_named("quadratic_stiffness@left_leg"), features=None)
PREPARED = SimpleNamespace(
    adopted={"name": "added_mass@apex", "unit": [0.5], "gain": 100.0}, linear=[]
)
SCREENING = {"threshold": 15.0, "ranked": []}


@pytest.fixture
def ranked(monkeypatch):
    """Return the function (gain of a spring beside an adopted mass, verdict, what it chose) ->
    [ids], best first.
    """
    monkeypatch.setattr(conclusion, "closed_by", lambda *_: 0.0)
    nothing = SimpleNamespace(features=None)
    signals = SimpleNamespace(holdout=list)
    judged = SimpleNamespace(
        bench=SimpleNamespace(signals=signals), null=nothing, prepared=PREPARED
    )

    def run(gain, verdict, chosen):
        totals = {SPRING.candidate.name: (gain, gain, 0.0)}
        rows = conclusion.ranking_rows(
            judged,
            [SPRING],
            totals,
            SCREENING,
            SimpleNamespace(verdict=verdict, chosen=chosen),
            (None, {"fit": {"closed_fraction": 0.0}}),
        )
        return [row["ids"] for row in rows]

    return run


def test_named_effect_ranks_before_a_rejected_addition(ranked):
    """28 units beyond the threshold, but held-out records contradict it: the mass alone is the
    answer, and the first of the list.
    """
    assert ranked(28.0, "named", None) == ["added_mass", "added_mass+quadratic_stiffness"]


def test_added_effect_ranks_first(ranked):
    assert ranked(28.0, "named", SPRING) == ["added_mass+quadratic_stiffness", "added_mass"]


@pytest.mark.parametrize(
    ("gain", "first"), [(28.0, "added_mass+quadratic_stiffness"), (10.0, "added_mass")]
)
def test_ranking_without_a_name_follows_the_gain(ranked, gain, first):
    assert ranked(gain, "unknown", None)[0] == first
