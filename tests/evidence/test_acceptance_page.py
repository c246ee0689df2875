"""The acceptance table, its reliability curve, detection limit, figures and page: what they say is
what verdicts and truths hold.
"""

import inspect
import json

import numpy as np
import pytest
from scipy.special import expit, logit

from evidence.acceptance.calibration import (
    calibration_error,
    largest_gap,
    reliability,
    statements,
)
from evidence.acceptance.campaign_rows import read_folder, read_shards, read_table, stated_in
from evidence.acceptance.detection_limit import (
    detection,
    detection_curve,
    detection_limit,
    probability,
)
from evidence.acceptance.families import FAMILIES
from evidence.acceptance.intervals import wilson
from evidence.acceptance.judging import SAME_QUANTITY, judged, kind_of
from evidence.acceptance.right_names import right_names
from evidence.acceptance.table import acceptance_table, standing
from evidence.truth import hidden
from tests.support.discrepancy_results import made_up_verdict
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.io.records import write_table

MISFIT = {"before_dB": 4.0, "after_dB": 1.1, "floor_dB": 1.0, "closed_fraction": 0.9}
LIMIT = 2.0  # floors, of the campaigns drawn here


def verdict_of(said, sets=(), effects=(), **more):
    """The content of a verdict.json in the parts that are judged."""
    names = list(sets[0]) if sets else ["clearance"]
    first = {"ids": names, "heldout_score": None, "closed_fraction": None}
    return (
        made_up_verdict(
            said,
            ambiguity_set=[list(row) for row in sets],
            ranking=[first],
            checks=[],
            effects=list(effects),
            misfit={"fit": None, "holdout": MISFIT},
        ).to_values()
        | more
    )


def effect(name, parameter, value, low, high):
    """A named effect with one parameter."""
    return {
        "id": name,
        "location": "all",
        "parameters": {parameter: {"value": value, "unit": "1", "low": low, "high": high}},
    }


def truth_of(kind, *effects, floors=4.0):
    """The parts of a truth that are judged."""
    strength = {"strength": {"floors": floors}} if effects else {}
    return {"kind": kind, "effects": [list(row) for row in effects]} | strength


def row_of(kind, verdict, *effects, **more):
    """The judged row of a verdict on a kind of campaign."""
    return judged(verdict, truth_of(kind, *effects, **more))


FRICTION = ("dry_friction", {"mu": 0.2})
GAP = ("gap", {"factor": 1.2, "plates": "plate_2"})
ALL_GAPS = ("gap", {"factor": 2.0, "plates": "all"})


def pairs():
    """(verdict, truth) of a small draw: two of three strong effects named, one by a wrong name,
    nothing hidden, a stranger, a law of another family's, a pair.
    """
    named = [["dry_friction"]]
    strong = truth_of("strong", FRICTION)
    return [
        (verdict_of("named", named, [effect("dry_friction", "mu", 0.21, 0.18, 0.24)]), strong),
        (verdict_of("named", named, [effect("dry_friction", "mu", 0.3, 0.25, 0.35)]), strong),
        (verdict_of("named", [["preload"]]), strong),
        (verdict_of("none"), truth_of("nothing")),
        (
            verdict_of("partly_explained", [["gap"]]),
            truth_of("out_of_catalogue", ("drifting_gap", {})),
        ),
        (verdict_of("named", named), truth_of("other_law", ("lugre_friction", {"mu": 0.3}))),
        (verdict_of("named", [["dry_friction", "gap"]]), truth_of("two", GAP, FRICTION)),
    ]


def small_draw():
    """The judged rows of `pairs`."""
    return [
        {"draw": "development_7", "campaign": f"campaign_{number:04d}"}
        | judged(verdict, truth)
        | {"statements": ""}
        for number, (verdict, truth) in enumerate(pairs())
    ]


def numbers_of(rows, kind, quantity):
    """(campaigns, count, rate) of a row of the table."""
    (row,) = (
        row
        for row in acceptance_table(rows, [])
        if (row["kind"], row["quantity"]) == (kind, quantity)
    )
    return row["campaigns"], row["count"], row["rate"]


def drawn(count, seed):
    """(strength, found) of campaigns whose detection is logistic in the logarithm of the strength,
    80 % at LIMIT.
    """
    rng = np.random.default_rng(seed)
    strength = np.exp(rng.uniform(np.log(0.2), np.log(20.0), count))
    return strength, rng.random(count) < expit(logit(0.8) + 2.5 * np.log(strength / LIMIT))


def test_rows_hold_strength_and_parameter_against_truth():
    row = small_draw()[1]
    assert row["strength"] == 4.0 and row["kind"] == "strong"
    found = (row[key] for key in ("parameter", "true", "value", "low", "high"))
    assert [*found] == ["dry_friction.mu", 0.2, 0.3, 0.25, 0.35]
    assert row["parameter_error"] == pytest.approx(0.5) and row["covered"] == 0.0


@pytest.mark.parametrize(
    ("kind", "floors", "counted"),
    [
        ("strong", 2.0, "medium"),
        ("medium", 3.5, "strong"),
        ("strong", 0.9, "weak"),
        ("two", 0.5, "faint"),
        ("two", 2.0, "two"),
        ("out_of_catalogue", 0.2, "faint"),
        ("medium", 0.2, "faint"),
        ("fault", 0.0, "fault"),
    ],
)
def test_kind_follows_the_strength_that_resulted(kind, floors, counted):
    assert kind_of(truth_of(kind, GAP, floors=floors)) == counted


@pytest.mark.parametrize("name", SAME_QUANTITY)
def test_a_quantity_of_both_codes_is_a_parameter_of_each(name):
    true, own = SAME_QUANTITY[name]
    stated = (
        {"channel", "factor"}
        if name == "sensor_gain"
        else inspect.signature(hidden.EFFECTS[name]).parameters
    )  # a fault of the measuring chain, not of the rig
    assert true in stated and own in {row.name for row in EFFECTS[name].parameters}


def test_both_codes_share_the_families_and_every_effect_has_one():
    assert {name for names in FAMILIES.values() for name in names} >= {
        name for name in EFFECTS if EFFECTS[name].reported == name and name != "shaker_interaction"
    }
    assert FAMILIES == hidden.FAMILIES


def test_a_refused_campaign_has_no_parameter_and_is_open():
    row = row_of("strong", made_up_verdict("not_testable").to_values(), GAP)
    assert row["parameter"] == "" and np.isnan(row["low"]) and row["open"]


def test_wrong_names_are_told_from_right_ones():
    table = small_draw()
    assert numbers_of(table, "one effect", "first") == (3, 2, pytest.approx(2 / 3))
    assert numbers_of(table, "two", "pair in the set") == (1, 1, 1.0)
    # of five single names, the preload is wrong; friction for LuGre friction is right
    assert numbers_of(table, "all", "right, given a single name") == (5, 4, 0.8)
    assert numbers_of(table, "other law", "family named or in the set")[2] == 1.0
    assert numbers_of(table, "weak", "first")[0] == 0


def test_a_stated_family_counts_where_no_law_is_named():
    unknown = verdict_of("partly_explained", [["coulomb_friction"]], [])
    lugre = ("lugre_friction", {"mu": 0.3})
    assert not row_of("other_law", unknown, lugre)["family"]
    stated = effect("coulomb_friction", "force", 1.0, 0.5, 2.0) | {"family": "Friction"}
    assert row_of("other_law", unknown | {"effects": [stated]}, lugre)["family"]


@pytest.mark.parametrize(
    ("kind", "sets", "right"),
    [
        ("exact_alias", [["gap"], ["sensor_gain"]], True),
        ("exact_alias", [["gap"]], False),
        ("near_alias", [["hertz"], ["contact_stiffness"]], True),
        ("near_alias", [["hertz"]], True),
        ("near_alias", [["contact_stiffness"]], False),
        ("near_alias", [["hertz"], ["preload"]], False),
    ],
)
def test_aliases_are_told_together_unless_evidence_parts_them(kind, sets, right):
    hidden_one = ALL_GAPS if kind == "exact_alias" else ("hertz", {"coefficient": 1e6})
    said = "named" if len(sets) == 1 else "ambiguous"
    assert row_of(kind, verdict_of(said, sets), hidden_one)["both"] is right


def test_flags_are_right_where_there_is_a_fault():
    late = {"checks": [{"check": "delay", "level": "warn", "record": "", "channel": "s1"}]}
    fault = row_of("fault", verdict_of("none") | late, ("sensor_delay", {"delay": 0.01}))
    none = row_of("nothing", verdict_of("none") | late)
    assert fault["flagged"] and not fault["flag_not_due"] and none["flag_not_due"]


def test_wilson_interval_has_its_printed_value():
    # R. Newcombe, Statist. Med. 17 (1998) 857-872, table I, method 3
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=5e-5)


@pytest.mark.parametrize(
    ("rate", "least", "most", "expected"),
    [
        (0.97, 0.97, None, "met"),
        (0.96, 0.97, None, "missed"),
        (0.03, None, 0.03, "met"),
        (0.04, None, 0.03, "missed"),
        (0.96, 0.85, 0.95, "missed"),
        (np.nan, 0.85, None, "no campaigns"),
    ],
)
def test_targets_are_met_from_their_side(rate, least, most, expected):
    assert standing(rate, least, most) == expected


def stated(**more):
    """A verdict that states probabilities, of friction first."""
    ranked = verdict_of("named", [["dry_friction"]])
    ranked["ranking"] = [
        row | {"probability": p, "ids": ids}
        for p, ids, row in zip(
            (0.8, 0.1), (["dry_friction"], ["gap"]), 2 * ranked["ranking"], strict=True
        )
    ]
    return ranked | {"probability_none": 0.02, "probability_something_else": 0.08} | more


def test_every_stated_probability_is_counted_once():
    assert statements(stated(), truth_of("strong", FRICTION)) == [
        (0.02, False),
        (0.08, False),
        (0.8, True),
        (0.1, False),
    ]
    stranger = statements(stated(), truth_of("out_of_catalogue", ("loose_mass", {})))
    assert [true for _, true in stranger] == [False, True, False, False]
    assert statements(verdict_of("none"), truth_of("nothing")) == []


def test_calibrated_statements_lie_on_the_diagonal():
    rng = np.random.default_rng(2)
    said = rng.uniform(0.0, 1.0, 20000)
    curve = reliability(zip(said, rng.random(said.size) < said, strict=True))
    assert len(curve) == 10 and largest_gap(curve) < 0.03
    too_sure = reliability(zip(said, rng.random(said.size) < said**2, strict=True))
    assert largest_gap(too_sure) == pytest.approx(0.25, abs=0.03)  # p - p² at one half


def test_bins_of_the_curve_hold_ten_statements_or_more():
    rng = np.random.default_rng(3)
    for count in (0, 9, 10, 37, 200):
        said = rng.beta(0.3, 0.3, count)
        curve = reliability(zip(said, said > 0.5, strict=True))
        assert sum(row["statements"] for row in curve) == (count if count >= 10 else 0)
        assert all(row["statements"] >= 10 for row in curve)


def test_the_detection_limit_is_that_of_the_draw():
    limit = detection_limit(*drawn(2000, 1))
    assert limit["limit"] == pytest.approx(LIMIT, rel=0.12)
    assert limit["low"] < LIMIT < limit["high"] and limit["note"] == ""
    assert limit["high"] / limit["low"] < 1.6


def test_detection_limit_intervals_have_nominal_coverage():
    found = [detection_limit(*drawn(60, seed)) for seed in range(30)]
    held = [not row["low"] > LIMIT and not row["high"] < LIMIT for row in found]
    assert np.mean(held) >= 0.83
    assert np.nanmedian([row["limit"] for row in found]) == pytest.approx(LIMIT, rel=0.2)


def test_separated_campaigns_keep_a_finite_slope():
    strength = np.geomspace(0.2, 20.0, 24)
    intercept, slope = detection_curve(strength, strength > LIMIT)
    assert 1.0 < slope < 50.0 and probability((intercept, slope), LIMIT) == pytest.approx(
        0.5, abs=0.15
    )
    assert detection_limit(strength, strength > LIMIT)["limit"] == pytest.approx(LIMIT, rel=0.6)


@pytest.mark.parametrize(
    ("found", "words"),
    [
        (lambda s: s > 0.0, "all of 20 found"),
        (lambda s: s < 0.0, "none of 20 found"),
        (lambda s: s < LIMIT, "does not grow"),
        (lambda s: s > 13.0, "above what was tried"),
    ],
)
def test_undefined_detection_limit_says_why(found, words):
    strength = np.geomspace(0.2, 20.0, 20)
    limit = detection_limit(strength, found(strength))
    assert np.isnan(limit["limit"]) and words in limit["note"]
    assert "fewer than 8" in detection_limit(strength[:7], strength[:7] > 0.5)["note"]


def test_detection_counts_single_effects_of_the_catalogue_only():
    (alone,) = detection(small_draw())
    assert (alone["effect"], alone["campaigns"], alone["found"]) == ("all", 3, 2)
    assert np.isnan(alone["limit_over_floor"])
    many = [
        {"drawn_as": kind, "hidden": name, "strength": float(value), "in_set": value > LIMIT}
        for name, kind in (("gap", "exact_alias"), ("hertz", "medium"))
        for value in np.geomspace(0.5, 8.0, 9)
    ]
    table = detection(many + [{**row, "hidden": "preload"} for row in many[:7]])
    assert [(row["effect"], row["campaigns"]) for row in table] == [
        ("all", 25),
        ("gap", 9),
        ("hertz", 9),
    ]


@pytest.fixture
def folder(tmp_path):
    """The folder of the small draw."""
    for number, (verdict, truth) in enumerate(pairs()):
        name = f"campaign_{number:04d}"
        (tmp_path / "development_7" / name).mkdir(parents=True)
        (tmp_path / "development_7" / "truth").mkdir(exist_ok=True)
        place = tmp_path / "development_7"
        (place / name / "verdict.json").write_text(json.dumps(verdict))
        (place / "truth" / f"{name}.json").write_text(json.dumps(truth))
    return tmp_path / "development_7"


def test_rows_are_read_as_they_were_written(folder, tmp_path):
    rows = read_folder(folder)
    write_table(rows, tmp_path / "campaigns.csv")
    assert repr(read_table(tmp_path / "campaigns.csv")) == repr(rows)  # NaN is not equal to itself
    assert repr(read_shards(folder, [tmp_path / "campaigns.csv"])) == repr(rows)
    for number in (2, 3):
        (folder / f"campaign_{number:04d}" / "verdict.json").unlink()
    assert repr(read_shards(folder, [tmp_path / "campaigns.csv"])) == repr(rows)
    assert stated_in([row | {"statements": "0.7:1 0.2:0"} for row in rows[:1]]) == [
        (0.7, True),
        (0.2, False),
    ]


def test_a_stray_gain_may_be_named_and_an_exact_alias_counts():
    truth = truth_of("strong", GAP) | {"gains": [1.01, 0.85]}
    gap, gain = ["gap"], ["sensor_gain"]
    assert right_names(truth) == [gap, sorted([*gap, *gain])]
    assert right_names(truth_of("exact_alias", ALL_GAPS)) == [gap, gain]
    assert right_names(truth_of("nothing") | {"gains": [0.98, 1.2]}) == [gain]
    assert right_names(truth_of("fault", ("swap", {}))) == []


def test_the_gap_of_one_support_is_no_alias_of_a_gain():
    """A gain common to force and responses scales the gaps of all supports."""
    assert kind_of(truth_of("exact_alias", ALL_GAPS)) == "exact_alias"
    assert kind_of(truth_of("exact_alias", GAP)) == "strong"
    assert row_of("exact_alias", verdict_of("named", [["gap"]]), GAP)["first"]


def test_a_pair_of_which_one_hides_the_other_is_masked():
    truth = truth_of("two", GAP, FRICTION)
    for beside, kind in (([5.0, 0.4], "masked"), ([5.0, 1.4], "two")):
        assert kind_of(truth | {"strength": truth["strength"] | {"beside": beside}}) == kind


def test_calibration_error_is_the_mean_gap():
    stated = [(0.95, True)] * 50 + [(0.95, False)] * 50 + [(0.05, False)] * 100
    assert calibration_error(stated) == pytest.approx(0.5 * 0.45 + 0.5 * 0.05)
    assert np.isnan(calibration_error([]))
