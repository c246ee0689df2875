"""The page of a verdict: every kind has its sentence, and nothing on it speaks against it."""

import re

import numpy as np
import pytest

from tests.support.discrepancy_results import made_up_verdict
from vibroimpact.diagnosis.diagnose_command import summary
from vibroimpact.diagnosis.verdict.content import CONCLUSIONS
from vibroimpact.io.display_units import display_unit
from vibroimpact.reports.discrepancy_page import discrepancy_page
from vibroimpact.reports.figures.diagnosis.sheets import ranking_figure
from vibroimpact.reports.verdict_words import explanations_of, verdict_sentence


def test_closest_effect_is_shown_if_nothing_is_named():
    told = verdict_sentence(
        made_up_verdict(
            "unknown",
            most_probable=[
                {"id": name, "location": "all", "parameters": {}}
                for name in ("clearance", "support_offset")
            ],
        )
    )
    near = "stop behind a clearance and support offset"
    assert told.endswith(f"The best candidate, {near}, does not explain it.")
    assert "best candidate" not in verdict_sentence(made_up_verdict("unknown"))


def test_spectra_that_come_no_nearer_are_told_as_such():
    given = made_up_verdict().to_values()["misfit"]["holdout"]
    no_nearer = given | {"closed_fraction": -0.2}
    told = verdict_sentence(made_up_verdict(misfit={"fit": None, "holdout": no_nearer}))
    assert "are no nearer with it" in told and "closes" not in told


def test_most_probable_of_several_is_shown():
    named = made_up_verdict().to_values()["effects"]
    page = discrepancy_page("campaign", made_up_verdict("ambiguous", most_probable=named), [])
    assert (
        "The most probable of them" in page
        and "0.149" in page
        and "Adding the most probable of them closes" in page
    )
    assert "The most probable of them" not in discrepancy_page(
        "campaign", made_up_verdict("ambiguous"), []
    )
    assert "0.149" not in discrepancy_page(
        "campaign", made_up_verdict("unknown", most_probable=named), []
    )


@pytest.mark.parametrize("kind", CONCLUSIONS)
def test_every_verdict_has_its_sentence_and_page(kind):
    verdict = made_up_verdict(kind)
    sentence = verdict_sentence(verdict)
    assert (
        sentence.endswith(".")
        and {
            "none": "No effect",
            "named": "lacks dry friction",
            "ambiguous": "dry friction, or lobed hole",
            "unknown": "no effect of the catalogue",
            "partly_explained": "something else",
            "not_testable": "can not be judged",
        }[kind]
        in sentence
    )
    page = discrepancy_page(kind, verdict, [])
    assert sentence.split(" (")[0] in page and ("Measure next" in page) == (kind == "ambiguous")


STORY = (
    "The model lacks",
    "Probability",
    "Differences of model and measurement",
    "The missing effect",
    "Gain of the completed model",
    "Explanations compared",
    "A measurement that separates the rest",
    "Checks of the campaign",
)


def test_page_tells_one_story_in_order():
    page = discrepancy_page(
        "campaign",
        made_up_verdict(next_measurement="Measure at 3 N.", probability_none=0.01),
        [],
        model="results/a/model_updated.yaml",
    )
    places = [page.index(f"{part}\n") if "?" in part else page.index(part) for part in STORY]
    assert places == sorted(places)
    assert "snakemake -j2 --configfile results/a/model_updated.yaml" in page
    assert "campaign=FILE model=results/a/model_updated.yaml" in page
    assert "less probable, by the records that were fitted" in page


def test_closed_share_is_one_number_on_the_page():
    rows = made_up_verdict().to_values()["ranking"]
    assert rows[0]["closed_fraction"] == 0.87  # of what is named: that of its misfit
    page = discrepancy_page("campaign", made_up_verdict(ranking=rows[:1]), [])
    held_out = page.index("held out: not fitted"), page.index("<td>fitted</td>")
    assert "closes 87 % of the excess misfit on records that took no part" in page
    assert "87 %" in page[held_out[0] : held_out[1]]
    assert set(re.findall(r"\d+ %(?= ?</td>)", page)) == {"87 %"}


def test_no_region_is_shown_where_nothing_is_missing():
    untested = made_up_verdict("none", regions=[], broken_invariances=[])
    assert "Differences of model and measurement" not in discrepancy_page("campaign", untested, [])


def test_probabilities_are_explained():
    values = made_up_verdict().to_values()
    values["ranking"][0]["probability"] = 0.93
    values["ranking"][2]["probability"] = 0.02
    friction = values["effects"][0] | {"family": "friction", "law_fits": "no"}
    verdict = made_up_verdict(
        ranking=values["ranking"],
        effects=[friction],
        probability_none=0.0,
        probability_something_else=0.05,
        ambiguity_probability=[0.93],
    )
    page = discrepancy_page("campaign", verdict, [])
    for part in ("93 %", "nine in ten", "than chance does"):
        assert part in page, part
    without = discrepancy_page("campaign", made_up_verdict(), [])
    assert "nine in ten" not in without


def test_a_model_that_makes_others_worse_is_told_not_offered():
    values = made_up_verdict().to_values()
    worse = values["misfit"]["holdout"] | {"before_dB": 8.9, "after_dB": 10.5}
    withdrawn = {"effects": values["effects"], "misfit": {"fit": None, "holdout": worse}}
    verdict = made_up_verdict("unknown", withdrawn=withdrawn, most_probable=values["effects"])
    page = discrepancy_page("campaign", verdict, [])
    assert "Tried and not offered: dry friction" in page
    assert "8.9 dB before, 10.5 dB after" in page and "configfile" not in page
    assert "makes records worse" in page  # its row among those ruled out


@pytest.mark.parametrize(
    ("unit", "values", "shown", "number"),
    [
        ("m", [2.5e-4, 4e-4], "mm", 0.4),
        ("m", [3.0e-5], "µm", 30.0),
        ("m", [1.2], "m", 1.2),
        ("N/m", [8.0e3], "kN/m", 8.0),
        ("N/m", [8.0e5, np.nan], "kN/m", 800.0),
        ("N/m", [4.0e6, None], "MN/m", 4.0),
        ("N/m", [820.0], "N/m", 820.0),
        ("N/m^1.5", [1.0e9], "GN/m^1.5", 1.0),
        ("N/m^2", [np.nan, 1.03e6], "MN/m²", 1.03),
        ("N/m3", [7.0e5], "kN/m³", 700.0),
        ("N/m^3", [-7e11, None], "GN/m³", 700.0),
        ("N s/m", [1291.0], "kN s/m", 1.291),
        ("kg", [0.298], "g", 298.0),
        ("rad", [np.pi], "deg", 180.0),
        ("1", [0.15], "1", 0.15),
        ("N", [0.0, None], "N", 0.0),
    ],
)
def test_prefix_of_a_unit_follows_from_the_value(unit, values, shown, number):
    name, factor = display_unit(unit, values)
    largest = max(abs(value) for value in values if value is not None and value == value)
    assert name == shown and factor * largest == pytest.approx(number)


def with_probabilities(kind, effect, nothing, other):
    """A verdict of a kind with the probabilities of friction, of nothing and of something else."""
    ranking = [
        {
            "ids": ["dry_friction"],
            "heldout_score": 2.0,
            "closed_fraction": 0.8,
            "probability": effect,
        }
    ]
    return made_up_verdict(
        kind,
        ranking=ranking,
        probability_none=nothing,
        probability_something_else=other,
    )


@pytest.mark.parametrize(
    ("kind", "chances", "told"),
    [
        ("named", (0.95, 0.0, 0.05), True),
        ("named", (0.05, 0.0, 0.95), False),
        ("none", (0.01, 0.98, 0.01), True),
        ("none", (0.99, 0.0, 0.01), False),
        ("unknown", (0.1, 0.0, 0.9), True),
        ("unknown", (1.0, 0.0, 0.0), False),
        ("ambiguous", (0.6, 0.0, 0.1), True),
        ("partly_explained", (0.2, 0.0, 0.8), True),
    ],
)
def test_probabilities_never_speak_against_the_verdict(kind, chances, told):
    verdict = with_probabilities(kind, *chances)
    assert bool(explanations_of(verdict)) == told
    page = discrepancy_page("campaign", verdict, [])
    assert ("nine in ten" in page) == told
    assert told or not re.search(r"(?:100|99|95) %", page)


def test_headline_says_how_sure_it_is():
    assert "probability of this is 95 %" in verdict_sentence(
        with_probabilities("named", 0.95, 0.0, 0.05)
    )
    none = with_probabilities("none", 0.001, 0.995, 0.002)
    assert "No effect" in verdict_sentence(none) and "over 99 %" in verdict_sentence(none)


def test_nothing_is_said_of_after_where_nothing_was_added():
    page = discrepancy_page("campaign", made_up_verdict("unknown"), [])
    assert "Misfit of the model" in page and "after (dB)" not in page
    assert "after (dB)" in discrepancy_page("campaign", made_up_verdict("named"), [])


@pytest.mark.parametrize("kind", [kind for kind in CONCLUSIONS if kind != "not_testable"])
def test_effects_that_could_not_be_run_are_told(kind):
    verdict = made_up_verdict(
        kind,
        not_run=["hertz", "preload"],
        probability_none=float(kind == "none"),
        probability_something_else=float(kind == "unknown"),
    )
    told = "Nothing is known of Hertz contact and preload: no trial of them could be integrated"
    page = " ".join(discrepancy_page("campaign", verdict, []).split())
    figure = ranking_figure(verdict)
    for text in (page, figure.caption, "\n".join(summary(verdict))):
        assert told in text
        assert not re.search(
            "something (else )?that is not|No effect is missing|effect of the", text
        )
