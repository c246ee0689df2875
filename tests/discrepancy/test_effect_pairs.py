"""Which pairs are looked at closely: those that simulation, and not a sum, puts first; at the place
that comes nearest; beside what the lowest record tells.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from vibroimpact.discrepancy import second
from vibroimpact.discrepancy.candidates import Pair, candidate_named
from vibroimpact.discrepancy.second import Told, pairs, told

PREPARED = SimpleNamespace(
    scales={"mass": 1.0}, linear=[], nonlinear_low=False, linear_stage=True, adopted=None
)
NULL = SimpleNamespace(records=np.arange(2), mean=np.zeros((2, 3)))


def finalist(name, gain):
    """A Finalist as far as pairs look at it; its path is its gain."""
    return SimpleNamespace(
        candidate=candidate_named(name), unit=np.array([0.5]), path=gain, own=lambda null: null
    )


@pytest.fixture
def simulated(monkeypatch):
    """Set what pairs are proposed, by (first, name of the second, unit of it), and what they gain
    by simulation, {name of the pair or (name, unit): gain}; others are thrown off.
    """

    def set_up(proposals, gains):
        rows = [
            (first, Pair(first.candidate, candidate_named(name)), np.array([0.5, unit]))
            for first, name, unit in proposals
        ]
        monkeypatch.setattr(second, "proposed", lambda *_: rows)
        monkeypatch.setattr(
            second,
            "simulate_path",
            lambda bench, pair, unit, *_, **__: gains.get(
                (pair.name, float(unit[-1])), gains.get(pair.name)
            ),
        )
        monkeypatch.setattr(
            second, "gains_of", lambda bench, null, measured, path, own: np.array([path])
        )

    return set_up


def found(paths=(), *finalists):
    """[(name, unit of the second, gain)] that are looked at closely."""
    rows = pairs(
        None, NULL, None, list(finalists), {candidate_named(name): None for name in paths}, PREPARED
    )
    return [(pair.name, float(unit[-1]), gain) for pair, unit, gain in rows]


def test_pairs_are_ordered_by_simulated_gain(simulated):
    gap = finalist("gap@all", 1124.0)
    simulated(
        [
            (gap, "lateral_stinger@along_x", 0.1),
            (gap, "dry_friction@all", 1.0),
            (gap, "contact_damping@all", 0.4),
        ],
        {
            "gap@all+lateral_stinger@along_x": 1108.0,
            "gap@all+dry_friction@all": 1240.0,
            "gap@all+contact_damping@all": 1481.0,
        },
    )
    assert [name for name, _, _ in found((), gap)] == [
        "gap@all+contact_damping@all",
        "gap@all+dry_friction@all",
    ]


def test_better_point_of_a_pair_is_kept(simulated):
    gap = finalist("gap@all", 1000.0)
    simulated(
        [(gap, "hertz@all", 0.2), (gap, "hertz@all", 0.6), (gap, "preload@all", 0.5)],
        {("gap@all+hertz@all", 0.2): 1100.0, ("gap@all+hertz@all", 0.6): 1300.0},
    )
    assert found((), gap) == [("gap@all+hertz@all", 0.6, 1300.0)]


def test_second_effect_is_tried_at_its_other_places(simulated):
    gap = finalist("gap@all", 1000.0)
    simulated(
        [(gap, "clearance@shaker", 0.3)],
        {"gap@all+clearance@shaker": 1200.0, "gap@all+clearance@apex": 1900.0},
    )
    assert found(("clearance@shaker", "clearance@apex", "hertz@all"), gap) == [
        ("gap@all+clearance@apex", 0.3, 1900.0)
    ]


def test_few_pairs_without_the_best_are_simulated(simulated, monkeypatch):
    first, other = finalist("gap@all", 1000.0), finalist("hertz@all", 900.0)
    simulated(
        [
            (other, "preload@all", 0.1),
            (other, "dry_friction@all", 0.1),
            (first, "hunt_crossley@all", 0.1),
        ],
        {
            "hertz@all+preload@all": 1500.0,
            "hertz@all+dry_friction@all": 1800.0,
            "gap@all+hunt_crossley@all": 1100.0,
        },
    )
    monkeypatch.setattr(second, "WITHOUT_FIRST", 1)
    assert [name for name, _, _ in found((), first, other)] == [
        "hertz@all+preload@all",
        "gap@all+hunt_crossley@all",
    ]


def test_stiffness_and_damping_of_one_contact_are_paired(simulated, monkeypatch):
    """A soft contact with a Hunt-Crossley damping of 19 s/m was the forty-second of the sums, and
    explained most by simulation.
    """
    first, other = finalist("foliate_obstacle@all", 740.0), finalist("hunt_crossley@all", 680.0)
    simulated(
        [
            (first, "plate_flexibility@all", 0.8),
            (other, "quadratic_drag@tube", 0.4),
            (other, "contact_stiffness@all", 0.2),
        ],
        {
            "foliate_obstacle@all+plate_flexibility@all": 773.0,
            "hunt_crossley@all+contact_stiffness@all": 1258.0,
        },
    )
    monkeypatch.setattr(second, "WITHOUT_FIRST", 1)
    assert found((), first, other)[0] == ("hunt_crossley@all+contact_stiffness@all", 0.2, 1258.0)


ROWS = [
    {"name": "sensor_gain@force", "unit": [0.1]},
    {"name": "added_mass@apex+fluid_added_mass_damping@tube", "unit": [0.5, 0.1, 0.2]},
    {"name": "added_mass@apex", "unit": [0.86]},
]


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({}, ["added_mass@apex"]),
        ({"nonlinear_low": False}, []),
        ({"adopted": {"name": "added_mass@apex"}}, []),
        ({"linear": ROWS[:2]}, []),
    ],
)
def test_weakly_nonlinear_lowest_record_names_one_effect(monkeypatch, change, names):
    monkeypatch.setattr(
        second,
        "simulate_path",
        lambda bench, candidate, unit, *_, **__: SimpleNamespace(
            features=[np.full((2, 3), unit[0])], readings=[None]
        ),
    )
    monkeypatch.setattr(second, "linear_score", lambda bench, reading: 0.0)
    rows = told(
        None,
        NULL,
        SimpleNamespace(
            **{"scales": {}, "linear": ROWS, "nonlinear_low": True, "adopted": None} | change
        ),
    )
    assert [row.candidate.name for row in rows] == names
    assert all(isinstance(row, Told) and row.mean[0, 0] == row.unit[0] == 0.86 for row in rows)


ALL, BEST = [0.4, 0.2, 0.8, 1.0], [0.4]


@pytest.mark.parametrize(
    ("first", "name", "hidden", "units"),
    [
        ("support_offset@all", "modal_damping@all", True, ALL),
        ("support_offset@all", "modal_damping@all", False, BEST),
        ("support_offset@all", "gap@all", True, BEST),
        ("hunt_crossley@all", "contact_stiffness@all", False, ALL),
        ("hertz@all", "contact_damping@all", False, ALL),
        ("hertz@all", "contact_stiffness@all", False, BEST),
        ("hunt_crossley@all", "gap@all", False, BEST),
    ],
)
def test_non_additive_pairs_are_tried_at_every_value(monkeypatch, first, name, hidden, units):
    """Nine times the damping, in a tube that is pressed to its hole, was simulated at six tenths
    alone, where the sum put it, and not found; a soft contact with a heavy damping was proposed
    with a stiff one.
    """
    monkeypatch.setattr(second, "direct_scores", lambda bench, null, measured, mean: mean[:, 0])
    monkeypatch.setattr(second, "linear_score", lambda bench, reading: 0.0)
    bench = SimpleNamespace(layout=SimpleNamespace(blend=np.full(3, 1.0e6)))
    at, scores = np.array([[0.2], [0.4], [0.8], [1.0]]), np.array([30.0, 40.0, 20.0, 10.0])
    path = SimpleNamespace(
        parameters=at, features=scores[:, None, None] * np.ones((1, 2, 3)), readings=[None] * 4
    )
    first = SimpleNamespace(
        candidate=candidate_named(first),
        unit=np.full(len(candidate_named(first).effect.parameters), 0.7),
        mean=NULL.mean,
        low=0.0,
        own=lambda null: null,
    )
    rows = second.proposed(bench, NULL, None, [first], {candidate_named(name): path}, hidden)
    assert [row[2][-1] for row in rows] == units
