"""A completed model that makes records worse that took no part is not offered: neither by the
verdict nor as a file.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import conclusion
from vibroimpact.discrepancy.completed_model import not_offered
from vibroimpact.discrepancy.misfit import closed_fraction, makes_worse
from vibroimpact.discrepancy.verdict import Decision

DAMPING = [
    {
        "id": "contact_damping",
        "location": "all",
        "parameters": {"damping": {"value": 1291.0, "unit": "N s/m", "low": 882.0, "high": 1502.0}},
    }
]


def split(before, after, floor=1.2):
    """A misfit of one split."""
    closed = closed_fraction(before, after, floor)
    return {"before_dB": before, "after_dB": after, "floor_dB": floor, "closed_fraction": closed}


@pytest.fixture
def offer(monkeypatch):
    """Function (misfits one after the other) -> offered() of a partly explained campaign."""

    def told(*held_out):
        left = iter(held_out)
        monkeypatch.setattr(conclusion, "completed", lambda *_: "completed")
        monkeypatch.setattr(conclusion.verdict, "effects_of", lambda *_: DAMPING)
        monkeypatch.setattr(conclusion.naming, "bare_explained", lambda *_: np.array([-9.0]))
        monkeypatch.setattr(
            conclusion,
            "misfits",
            lambda whole, before, after: (
                {"fit": split(9.0, 9.0), "holdout": split(8.9, 8.9)}
                if after is before
                else {"fit": split(9.0, 3.0), "holdout": next(left)}
            ),
        )
        bench = SimpleNamespace(bare=None, measured_features=np.zeros((1, 3)))
        run = SimpleNamespace(
            whole_bench=None, bench=bench, prepared=None, null=SimpleNamespace(records=[0])
        )
        decision = Decision(
            "partly_explained", "chosen", [["contact_damping"]], {}, np.zeros(1), 15.0
        )
        return conclusion.offered(run, decision, "before", 4)

    return told


def test_model_that_makes_others_worse_is_withdrawn(offer):
    decision, after, misfit, withdrawn = offer(split(8.9, 10.5), split(8.9, 8.0))
    assert (decision.verdict, decision.chosen, decision.ambiguity) == ("unknown", None, [])
    assert (after, misfit["holdout"]["after_dB"]) == ("completed", 8.0)  # the linear effect alone
    assert withdrawn["effects"] == DAMPING and withdrawn["misfit"]["holdout"]["after_dB"] == 10.5


def test_linear_effect_that_makes_others_worse_is_withdrawn_too(offer):
    decision, after, misfit, withdrawn = offer(split(8.9, 10.5), split(8.9, 11.0))
    assert after == "before" and misfit["holdout"]["after_dB"] == 8.9
    text = not_offered(withdrawn)
    assert "contact damping" in text and "8.90 dB before and 10.50 dB after" in text
    assert all(line.startswith("#") for line in text.splitlines())


def test_model_that_makes_others_better_is_offered(offer):
    decision, after, misfit, withdrawn = offer(split(8.9, 3.0))
    assert decision.verdict == "partly_explained" and after == "completed" and withdrawn is None


def test_what_is_left_within_chance_is_no_growth():
    assert makes_worse(split(8.9, 10.5)) and not makes_worse(split(8.9, 8.8))
    assert not makes_worse(split(1.25, 1.3)) and makes_worse(split(1.25, 2.0))
    assert not makes_worse({"before_dB": None, "after_dB": None, "floor_dB": None})
