"""A completed model that makes any of its records worse is seen as worse."""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy.misfit import closed_fraction, repeats
from vibroimpact.missing_effect import verification


def split(before, after, floor=1.2):
    """A misfit of one split."""
    closed = closed_fraction(before, after, floor)
    return {"before_dB": before, "after_dB": after, "floor_dB": floor, "closed_fraction": closed}


@pytest.mark.parametrize(
    ("fit", "held_out", "worse"),
    [
        (split(5.6, 2.0), split(3.1, 2.0), False),
        (split(5.6, 8.1), split(3.1, 2.0), True),
        (split(5.6, 2.0), split(3.1, 4.4), True),
        (split(5.6, 8.1), None, True),
    ],
)
def test_growth_on_any_records_is_worse(fit, held_out, worse, monkeypatch):
    nothing = {"before_dB": None, "after_dB": None, "floor_dB": None, "closed_fraction": None}
    rows = {"fit": fit, "holdout": held_out or nothing}
    monkeypatch.setattr(verification, "verified", lambda *_: None)
    monkeypatch.setattr(verification, "misfits", lambda *_: rows)
    bench = SimpleNamespace(
        signals=SimpleNamespace(load=[1.0, 2.0]), model=lambda *_: None, variant=lambda *_: None
    )
    chosen = SimpleNamespace(candidate=SimpleNamespace(physical=lambda *_: {}), unit=None)
    assert verification.closing(bench, bench, bench, chosen, {}).worse is worse


def test_motion_that_is_there_by_chance_is_not_counted():
    """A channel across the force rattles in one of two runs; the others repeat to 1 dB."""
    power = np.random.default_rng(4).normal(-80.0, 1.0, (3, 8, 4, 24))
    power[:, ::2, 1] -= 40.0
    steady = repeats(power)
    assert steady[:, [0, 2, 3]].all() and not steady[:, 1].any()
    assert repeats(power[:, :, [1]]).all()  # where nothing repeats, all that there is


def closed_with(rises):
    """A Closing of three held-out records, two channels and six bands, whose measurement is `rises`
    (record,) in dB above the model with what was adopted, and 10 dB above the model as given; seeds
    scatter by 1 dB.
    """
    power = np.random.default_rng(2).normal(-60.0, 1.0, (4, 8, 2, 6))
    measured = power[:, 0] + np.array([0.0, *rises])[:, None, None]
    whole = SimpleNamespace(
        layout=SimpleNamespace(power=lambda features: features),
        measured_features=measured,
        signals=SimpleNamespace(
            holdout=lambda: np.array([1, 2, 3]), record_names=("low", "high", "higher", "other")
        ),
    )
    given, adopted = (
        verification.Verified(rows, rows.mean(axis=1), None) for rows in (power - 10.0, power)
    )
    rows = {"fit": split(1.2, 1.2), "holdout": split(3.0, 3.0)}
    return verification.Closing((whole, whole), given, adopted, rows, "holdout")


@pytest.mark.parametrize(
    ("rises", "record"),
    [((0.0, 0.3, 0.0), None), ((0.0, 5.0, 0.0), "higher"), ((4.0, 0.0, 8.0), "other")],
)
def test_held_out_record_that_disagrees_most_is_told(rises, record, monkeypatch):
    """With the model that holds what the lowest record told: as given it is wrong in all."""
    monkeypatch.setattr(verification, "counted", lambda bench: np.ones((4, 2, 6), bool))
    assert verification.telling_record(closed_with(rises)) == record
