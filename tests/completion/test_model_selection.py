"""Which candidate is named, when a set is told instead, and when nothing or no law is."""

from types import SimpleNamespace

import pytest

from vibroimpact.completion.levels import naming_split
from vibroimpact.completion.naming import believed, choose, completed_furthest, score

LINEAR, JOINT, AGAIN = {"one": [1.0, 1.2]}, {"one": [0.8, 0.9]}, {"one": [0.1, 0.1]}


def candidate(name, ids, error, cost=0.01):
    """Values of a candidate with one error on the level it is tried on."""
    return {
        "name": name,
        "ids": ids,
        "errors": {"one": [error, error]},
        "tried": ["one"],
        "cost": cost,
    }


def test_a_score_is_the_gain_in_squared_error():
    assert score([[0.1, 0.1]], [[1.0, 1.0]]) == pytest.approx(20.0)
    assert score([[None, None]], [[1.0, 1.0]]) == -float("inf")


def test_clear_winner_is_named_alone():
    choice = choose(
        [candidate("a", ["cubic_stiffness"], 0.05), candidate("b", ["clearance"], 0.3)],
        [],
        LINEAR,
        JOINT,
        AGAIN,
    )
    assert (choice.verdict, choice.chosen, choice.ambiguity) == (
        "named",
        "a",
        [["cubic_stiffness"]],
    )


def test_equally_good_effects_form_an_ambiguity_set():
    choice = choose(
        [candidate("a", ["cubic_stiffness"], 0.050), candidate("b", ["clearance"], 0.052)],
        [],
        LINEAR,
        JOINT,
        AGAIN,
    )
    assert choice.verdict == "ambiguous" and choice.ambiguity == [
        ["cubic_stiffness"],
        ["clearance"],
    ]


def test_worse_fit_does_not_join_the_ambiguity_set():
    choice = choose(
        [
            candidate("a", ["cubic_stiffness"], 0.050),
            candidate("b", ["clearance"], 0.052, cost=0.05),
        ],
        [],
        LINEAR,
        JOINT,
        AGAIN,
    )
    assert choice.verdict == "named" and choice.ambiguity == [["cubic_stiffness"]]


def test_second_effect_needs_a_clear_gain():
    first = candidate("a", ["cubic_stiffness"], 0.05)
    little, much = (
        candidate("a+b", ["cubic_stiffness", "quadratic_stiffness"], error)
        for error in (0.048, 0.02)
    )
    assert choose([first], [little], LINEAR, JOINT, AGAIN).chosen == "a"
    choice = choose([first], [much], LINEAR, JOINT, AGAIN)
    assert choice.chosen == "a+b" and choice.ambiguity == [
        ["cubic_stiffness", "quadratic_stiffness"]
    ]


def test_laws_are_added_while_each_gains():
    """A third law is tried beside the second one; what gains too little ends it."""
    first = candidate("a", ["cubic_stiffness"], 0.05)
    laws = {"a+b": 0.02, "a+c": 0.04, "a+b+c": 0.01, "a+b+c+d": 0.0099}
    more = [candidate(name, [*name.split("+")], error) for name, error in laws.items()]
    errors = {"one": LINEAR["one"]}
    assert completed_furthest([first], more, errors)["name"] == "a+b+c"
    assert completed_furthest([first], more[1:], errors)["name"] == "a+c"


def test_held_out_levels_choose_nothing():
    """The fitted level below the highest tells the name; held-out ones where two are fitted."""
    records = [("fit", 1.0), ("fit", 2.0), ("holdout", 3.0), ("fit", 4.0)]
    levels = [SimpleNamespace(split=split, load_rms=load) for split, load in records]
    assert naming_split(levels) == ([levels[0], levels[3]], [levels[1]])
    assert naming_split(levels[1:]) == ([levels[1], levels[3]], [levels[2]])


def test_useless_second_effect_does_not_join_the_set():
    choice = choose(
        [candidate("a", ["cubic_stiffness"], 0.05)],
        [candidate("a+b", ["cubic_stiffness", "quadratic_drag"], 0.0499)],
        LINEAR,
        JOINT,
        AGAIN,
    )
    assert (choice.verdict, choice.ambiguity) == ("named", [["cubic_stiffness"]])


@pytest.mark.parametrize(
    ("kind", "left", "floor", "wanted"),
    [
        ("none", 0.1, 0.01, "none"),
        ("none", 0.6, 0.01, "unknown"),
        ("none", 0.6, 0.5, "none"),
        ("named", 0.04, 0.01, "named"),
        ("named", 0.08, 0.01, "partly_explained"),
        ("named", 0.15, 0.1, "named"),
        ("named", 0.7, 0.5, "partly_explained"),
        ("ambiguous", 0.9, 0.01, "ambiguous"),
        ("unknown", 0.01, 0.01, "unknown"),
    ],
)
def test_residual_of_held_out_records_bounds_the_verdict(kind, left, floor, wanted):
    assert believed(kind, 1.5, left, left, floor) == wanted


def test_linear_structure_has_nothing_missing():
    choice = choose(
        [candidate("a", ["cubic_stiffness"], 0.09)], [], {"one": [0.1, 0.1]}, JOINT, AGAIN
    )
    assert (choice.verdict, choice.ambiguity) == ("none", [])


def test_law_hardly_better_than_linear_is_not_named():
    assert (
        choose([candidate("a", ["cubic_stiffness"], 0.6)], [], LINEAR, JOINT, AGAIN).verdict
        == "unknown"
    )
