"""The suite's rows, detection limit, figures and page: what they say is what the verdicts and
truths hold.
"""

import inspect

import numpy as np
import pytest
from scipy.special import expit, logit

from tests.discrepancy_results import made_up_verdict
from vibroimpact.acceptance.detection_limit import (
    detection,
    detection_curve,
    detection_limit,
    probability,
)
from vibroimpact.acceptance.rates import SAME_QUANTITY, confusion, judged, rates, standing
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.figures.suite.sheets import suite_figures
from vibroimpact.reports.suite_page import suite_page, suite_sentence
from vibroimpact_truth import hidden

MISFIT = {"before_dB": 4.0, "after_dB": 1.1, "floor_dB": 1.0, "closed_fraction": 0.9}
LIMIT = 2.0  # floors, of the campaigns drawn here


def verdict_of(kind, sets=(), effects=(), before_dB=4.0):
    """A Verdict in the parts that the suite reads."""
    return made_up_verdict(
        kind,
        ambiguity_set=[list(row) for row in sets],
        ranking=[
            {
                "ids": list(sets[0]) if sets else ["clearance"],
                "heldout_score": None,
                "closed_fraction": None,
            }
        ],
        checks=[],
        effects=list(effects),
        misfit={"fit": None, "holdout": MISFIT | {"before_dB": before_dB}},
    )


def effect(name, parameter, value, low, high):
    """A named effect with one parameter."""
    return {
        "id": name,
        "location": "all",
        "parameters": {parameter: {"value": value, "unit": "1", "low": low, "high": high}},
    }


def truth_of(arm, *effects):
    """The parts of a truth that the suite reads."""
    return {"arm": arm, "effects": [list(row) for row in effects]}


def made_up_rows():
    """Judged rows of a small suite: two of three strong effects named, one by a wrong name, a null,
    a stranger, an effect taken out, a pair.
    """
    friction = truth_of("strong", ("dry_friction", {"mu": 0.2}))
    pair = [["dry_friction", "gap"]]
    rows = [
        judged(
            verdict_of(
                "named", [["dry_friction"]], [effect("dry_friction", "mu", 0.21, 0.18, 0.24)]
            ),
            friction,
        ),
        judged(
            verdict_of(
                "named", [["dry_friction"]], [effect("dry_friction", "mu", 0.3, 0.25, 0.35)]
            ),
            friction,
        ),
        judged(verdict_of("named", [["preload"]]), friction),
        judged(verdict_of("none"), truth_of("null")),
        judged(
            verdict_of("partly_explained", [["gap"]]), truth_of("stranger", ("drifting_gap", {}))
        ),
        judged(verdict_of("unknown"), truth_of("left_out", ("gap", {"factor": 1.2}))),
        judged(
            verdict_of("named", pair),
            truth_of("two", ("gap", {"factor": 1.2}), ("dry_friction", {"mu": 0.2})),
        ),
    ]
    return [{"campaign": f"campaign_{number:04d}"} | row for number, row in enumerate(rows)]


def drawn(count, seed):
    """(strength, found) of campaigns whose detection is logistic in the logarithm of the strength,
    80 % at LIMIT.
    """
    rng = np.random.default_rng(seed)
    strength = np.exp(rng.uniform(np.log(0.2), np.log(20.0), count))
    return strength, rng.random(count) < expit(logit(0.8) + 2.5 * np.log(strength / LIMIT))


def test_rows_hold_strength_and_parameter_against_truth():
    row = made_up_rows()[1]
    assert row["strength"] == pytest.approx(np.sqrt(15.0))  # floors: (4 dB)² less (1 dB)²
    assert (row["parameter"], row["true"], row["value"], row["low"], row["high"]) == (
        "dry_friction.mu",
        0.2,
        0.3,
        0.25,
        0.35,
    )
    assert row["parameter_error"] == pytest.approx(0.5) and row["covered"] == 0.0
    stated = truth_of("medium", ("gap", {"factor": 1.2})) | {"strength": {"excess_over_floor": 5.0}}
    assert judged(verdict_of("none"), stated)["strength"] == 5.0


@pytest.mark.parametrize("name", SAME_QUANTITY)
def test_a_quantity_of_both_codes_is_a_parameter_of_each(name):
    true, own = SAME_QUANTITY[name]
    stated = (
        {"channel", "factor"}
        if name == "sensor_gain"
        else inspect.signature(hidden.EFFECTS[name]).parameters
    )  # a fault of the measuring chain, not of the rig
    assert true in stated and own in {row.name for row in EFFECTS[name].parameters}


def test_renamed_parameter_is_compared_with_its_truth():
    row = judged(
        verdict_of(
            "named",
            [["quadratic_drag"]],
            [effect("quadratic_drag", "coefficient", 60.3, 51.4, 66.4)],
        ),
        truth_of("strong", ("quadratic_drag", {"drag": 59.8})),
    )
    assert row["parameter"] == "quadratic_drag.coefficient" and row["covered"] == 1.0


def test_a_refused_campaign_has_no_strength_and_no_parameter():
    refused = made_up_verdict("not_testable")
    row = judged(refused, truth_of("strong", ("gap", {"factor": 1.2})))
    assert (
        row["arm"] == "strong"
        and np.isnan(row["strength"])
        and row["parameter"] == ""
        and np.isnan(row["low"])
    )


@pytest.mark.parametrize(
    ("row", "rate", "expected"),
    [
        (("null", "false name"), 0.05, "met"),
        (("null", "false name"), 0.08, "missed"),
        (("null", "false name"), 0.11, "fails"),
        (("strong", "first"), 0.85, "met"),
        (("strong", "first"), 0.8, "missed"),
        (("strong", "first"), 0.6, "fails"),
        (("alias", "both in the set"), 0.1, "missed"),
    ],
)
def test_targets_are_met_from_their_side(row, rate, expected):
    assert standing(*row, rate) == expected


def test_coverage_is_a_share_with_its_interval():
    row = next(row for row in rates(made_up_rows()) if row["quantity"] == "covered")
    assert (row["campaigns"], row["rate"]) == (2, 0.5)
    assert (row["low"], row["high"]) == pytest.approx(
        (0.0126, 0.9874), abs=1e-4
    )  # Clopper-Pearson, 1 of 2


def test_the_detection_limit_is_that_of_the_draw():
    limit = detection_limit(*drawn(2000, 1))
    assert (
        limit["limit"] == pytest.approx(LIMIT, rel=0.12)
        and limit["low"] < LIMIT < limit["high"]
        and limit["note"] == ""
    )
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
    (alone,) = detection(made_up_rows())
    assert (alone["effect"], alone["campaigns"], alone["found"]) == ("all", 3, 2) and np.isnan(
        alone["limit_over_floor"]
    )
    many = [
        {"arm": arm, "hidden": name, "strength": float(value), "in_set": value > LIMIT}
        for name, arm in (("gap", "alias"), ("hertz", "weak"))
        for value in np.geomspace(0.5, 8.0, 9)
    ]
    table = detection(many + [{**row, "hidden": "preload"} for row in many[:7]])
    assert [(row["effect"], row["campaigns"]) for row in table] == [
        ("all", 25),
        ("gap", 9),
        ("hertz", 9),
    ]


@pytest.fixture(scope="module")
def figures(tmp_path_factory):
    """(folder, {name: Sheet}) of the small suite, saved."""
    folder, rows = tmp_path_factory.mktemp("suite"), made_up_rows()
    sheets = suite_figures(rows, rates(rows), confusion(rows))
    for sheet in sheets:
        sheet.save(folder)
    return folder, {sheet.name: sheet for sheet in sheets}


def test_suite_figures_show_every_row(figures):
    _, sheets = figures
    assert [*sheets] == ["suite_rates", "suite_confusion", "suite_strength", "suite_parameters"]
    rows = made_up_rows()
    assert len(sheets["suite_rates"].rows()) == len(rates(rows)) and sum(
        row["campaigns"] for row in sheets["suite_confusion"].rows()
    ) == len(rows)
    assert sorted(
        row["estimate_over_truth"] for row in sheets["suite_parameters"].rows()
    ) == pytest.approx([1.05, 1.5])
    labels = [label.get_text() for label in sheets["suite_rates"].axes["main"].get_yticklabels()]
    assert "strong: in the set (n = 3)" in labels
    assert "fewer than 8" in sheets["suite_strength"].axes["curve"].get_title(loc="left")


def test_confusion_matrix_shows_each_count(figures):
    axes = figures[1]["suite_confusion"].axes["main"]
    rows, columns = (
        [label.get_text() for label in labels]
        for labels in (axes.get_yticklabels(), axes.get_xticklabels())
    )
    cells = {
        (rows[round(at[1])], columns[round(at[0])]): text.get_text()
        for text in axes.texts
        if text.get_text().isdigit()
        for at in [text.get_position()]
    }
    assert cells == {
        ("dry friction", "dry friction"): "2",
        ("dry friction", "preload"): "1",
        ("nothing", "none"): "1",
        ("drifting gap", "gap"): "1",
        ("an effect taken out", "unknown"): "1",
        ("two effects", "the right pair"): "1",
    }


def test_empty_suite_page_says_so(tmp_path):
    for sheet in suite_figures([], [], []):
        assert any("no " in text.get_text() for axes in sheet.axes.values() for text in axes.texts)
        sheet.save(tmp_path)


def test_suite_page_names_seed_count_and_missed_rows(figures):
    folder, sheets = figures
    rows = made_up_rows()
    sentence = suite_sentence(77, rows, rates(rows))
    assert sentence.startswith(
        "7 campaigns of the draw with seed 77: 6 of 10 rows meet their target. Failing: strong: in"
        " the set (67 %, target at least 95 %, campaigns: 3);"
    )
    assert (
        "parameters: median error (27 %, target at most 10 %, campaigns: 2)" in sentence
        and "null: false name" not in sentence
    )
    missed = suite_sentence(
        77,
        rows,
        [
            row | {"standing": {"fails": "missed"}.get(row["standing"], "met")}
            for row in rates(rows)
        ],
    )
    assert "Missed: strong: in the set" in missed and "Failing" not in missed
    page = suite_page(
        77, rows, rates(rows), detection(rows), [folder / f"{name}.png" for name in sheets]
    )
    assert (
        page.count("data:image/png;base64,") == 4
        and "alias: both in the set" in page.split("<h2>Rates</h2>")[0]
    )
    assert (
        page.count('<td class="fails">fails</td>')
        == sum(row["standing"] == "fails" for row in rates(rows))
        > 0
    )
    assert [row in page for row in ("0005", "drifting gap", "partly explained")] == [True] * 3
