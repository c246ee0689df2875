"""A pair of which one effect explains as much alone becomes that effect, looked at closely where
the pair led.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import jobs
from vibroimpact.discrepancy.candidates import candidate_named
from vibroimpact.discrepancy.finalists import Finalist

PAIR = candidate_named("hertz@all+plate_flexibility@all")
UNIT = np.array([0.9, 0.5, 0.8])
START = -400.0  # log likelihood of the bare model


@pytest.fixture
def looked_at(monkeypatch):
    """Return the function (total of the pair, of its parts) -> [(name, unit) of every close look],
    the file's name last.
    """

    def run(total, parts, least=100.0, elsewhere=None):
        looks, saved = [], []

        def refine(bench, null, measured, candidate, known, *_, **__):
            looks.append((candidate.name, known))
            return Finalist(
                candidate, UNIT, None, np.array([total]), 0.0, None, None, [], np.zeros((0, 1, 1))
            )

        monkeypatch.setattr(jobs, "refine", refine)
        monkeypatch.setattr(jobs, "looked_for_elsewhere", lambda *_: elsewhere is not None)
        monkeypatch.setattr(
            jobs,
            "at_another_place",
            lambda bench, null, measured, found, *_: replace(
                found, candidate=candidate_named(elsewhere)
            ),
        )
        monkeypatch.setattr(
            jobs,
            "started",
            lambda bench, null, candidate, unit, *_, **__: np.asarray(unit).tolist(),
        )
        monkeypatch.setattr(
            jobs,
            "with_parts_beside",
            lambda bench, null, measured, found, _: Finalist(
                found.candidate,
                found.unit,
                None,
                found.scores,
                0.0,
                None,
                None,
                [],
                np.zeros((0, 1, 1)),
                np.array(parts),
            ),
        )
        monkeypatch.setattr(
            jobs, "gain_of_part", lambda bench, null, measured, found: found.parts.max() - START
        )
        monkeypatch.setattr(jobs.naming, "fit_mask", lambda *_: None)
        monkeypatch.setattr(
            jobs.store, "finalist_arrays", lambda found: {"name": found.candidate.name}
        )
        monkeypatch.setattr(jobs.store, "save", lambda path, name: saved.append(name))
        bench = SimpleNamespace(measured_features={"r": None}, nonlinear_low=False)
        bench.corrected_by = lambda nuisance: bench
        run = SimpleNamespace(
            bench=bench,
            null=SimpleNamespace(records="r"),
            paths={},
            prepared=SimpleNamespace(scales={}),
        )
        jobs.finalist(
            run,
            PAIR.name,
            {"pairs": {PAIR.name: UNIT.tolist()}, "least": least, "threshold": 15.0},
            None,
        )
        return [*looks, *saved]

    return run


def test_the_effect_that_explains_as_much_alone_takes_the_pairs_place(looked_at):
    assert looked_at(550.0, [-330.0, 570.0]) == [
        (PAIR.name, UNIT.tolist()),
        ("plate_flexibility@all", [0.5, 0.8]),
        "plate_flexibility@all",
    ]


def test_a_pair_of_two_remains_one(looked_at):
    assert looked_at(550.0, [-330.0, 500.0]) == [(PAIR.name, UNIT.tolist()), PAIR.name]


def test_an_effect_that_is_known_to_explain_more_is_not_looked_at_again(looked_at):
    assert looked_at(550.0, [-330.0, 570.0], least=980.0) == [(PAIR.name, UNIT.tolist()), PAIR.name]


def test_a_pair_may_end_at_another_place(looked_at):
    assert (
        looked_at(550.0, [-330.0, 500.0], elsewhere="hertz@all+clearance@apex")[-1]
        == "hertz@all+clearance@apex"
    )


@pytest.mark.parametrize(
    ("name", "gain", "left", "leads", "expected"),
    [
        (PAIR.name, 120.0, -9.0, False, True),
        (PAIR.name, 90.0, -9.0, False, False),
        (PAIR.name, 120.0, -2.0, False, False),
        ("clearance@apex", 120.0, -9.0, False, False),
        ("clearance@apex", 90.0, -9.0, True, True),
        ("clearance@apex", 90.0, -2.0, True, False),
    ],
)
def test_other_places_are_for_what_leads_or_adds_enough_and_leaves_something(
    monkeypatch, name, gain, left, leads, expected
):
    monkeypatch.setattr(jobs, "gains_of", lambda *_: np.array([0.0, gain]))
    monkeypatch.setattr(jobs.naming, "explained", lambda *_: np.array([1.0, left]))
    found = SimpleNamespace(
        candidate=candidate_named(name), path=None, mean=None, own=lambda null: null
    )
    assert bool(jobs.looked_for_elsewhere(None, None, None, found, leads, 100.0)) is expected
