"""Figures and page of a discrepancy run: what is drawn is what the files hold, and every verdict
has its sentence.
"""

import base64
import csv
import json
import re

import numpy as np
import pytest

from tests.discrepancy_results import (
    CHANNELS,
    EDGES,
    RECORDS,
    made_up_candidates,
    made_up_map,
    made_up_ranking,
    made_up_verdict,
)
from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.discrepancy.results_folder import best_places, read_results
from vibroimpact.display_units import display_unit
from vibroimpact.effects.registry import effects_in_words
from vibroimpact.figures.discrepancy.place import place_figure
from vibroimpact.figures.discrepancy.ranking import axis_label, found_of, named_of
from vibroimpact.figures.discrepancy.sheets import discrepancy_figures
from vibroimpact.figures.discrepancy.spectra import chosen_channels, chosen_records
from vibroimpact.records import write_record, write_table
from vibroimpact.reports.discrepancy_page import discrepancy_page, verdict_sentence
from vibroimpact.reports.verdict_words import next_steps
from vibroimpact.verdict.content import CONCLUSIONS, Estimate, FoundEffect
from vibroimpact.verdict.file import write_verdict


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The files of a run that named friction."""
    folder = tmp_path_factory.mktemp("named")
    (folder / "candidates").mkdir()
    write_verdict(made_up_verdict(), folder / "verdict.json")
    write_record(made_up_map(9.0), folder / "map.nc")
    write_record(made_up_map(0.8, 2), folder / "map_after.nc")
    write_table(made_up_ranking(), folder / "ranking.csv")
    for name, candidate in zip(("b", "a"), made_up_candidates(), strict=True):
        (folder / "candidates" / f"{name}.json").write_text(json.dumps(candidate))
    return folder


@pytest.fixture(scope="module")
def figures(folder):
    """{name: Sheet} of the run, saved."""
    sheets = discrepancy_figures(read_results(folder))
    for sheet in sheets:
        sheet.save(folder / "figures")
    return {sheet.name: sheet for sheet in sheets}


def rows_of(folder, name):
    """The rows of a figure's table."""
    with open(folder / "figures" / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_candidates_come_back_best_first(folder):
    assert [candidate["ids"] for candidate in read_results(folder).candidates] == [
        ["dry_friction"],
        ["gap"],
    ]


def test_axes_say_what_they_are_and_in_which_unit(figures):
    for sheet in figures.values():
        for name, axes in sheet.axes.items():
            shared = not axes.get_xticklabels() or not axes.xaxis.get_tick_params().get(
                "labelbottom", True
            )
            assert (
                axes.get_xlabel().endswith(")")
                or shared
                or sheet.name in ("discrepancy_psd", "discrepancy_map")
            ), (sheet.name, name)
        assert any(axes.get_xlabel() for axes in sheet.axes.values()) and sheet.caption.endswith(
            "."
        )


def test_the_map_holds_every_counted_cell(folder, figures):
    rows = rows_of(folder, "discrepancy_map")
    assert len(rows) == 4 * len(RECORDS) * len(CHANNELS) * 24
    before = made_up_map(9.0)
    shown = [
        row for row in rows if row["panel"] == "D before" and row["curve"] == "L10_G1.3_2, apex_y"
    ]
    np.testing.assert_allclose(
        [float(row["discrepancy_dB"]) for row in shown], before["D"].values[2, 0], rtol=1e-6
    )
    np.testing.assert_allclose(
        [float(row["frequency_Hz"]) for row in shown], np.sqrt(EDGES[:-1] * EDGES[1:]), rtol=1e-6
    )
    quiet = [
        row["discrepancy_dB"]
        for row in rows
        if row["panel"] == "D before" and row["curve"] == "L0.5_G1.3_0, apex_x"
    ]
    assert set(quiet) == {"nan"}  # not 6 dB above its noise
    meshes = [
        figures["discrepancy_map"].axes[f"z {stage}"].collections[0]
        for stage in ("before", "after")
    ]
    assert (
        meshes[0].get_clim() == meshes[1].get_clim()
        and meshes[0].get_clim()[0] == -meshes[0].get_clim()[1]
    )


def test_spectra_of_most_discrepant_records_are_shown(folder, figures):
    before = made_up_map(9.0)
    assert [RECORDS[index][0] for index in chosen_records(before)] == [
        "L0.5_G1.3_0",
        "L10_G1.3_2",
        "L10_G0.9_3",
    ]
    assert [CHANNELS[index] for index in chosen_channels(before)] == ["apex_y", "bend45_right_y"]
    rows = [
        row
        for row in rows_of(folder, "discrepancy_psd")
        if row["record"] == "L10_G1.3_2" and row["channel"] == "apex_y"
    ]
    assert {row["curve"] for row in rows} == {"measured", "before", "after"}
    assert all(
        float(row["psd_m2_per_s4_per_Hz_low"]) <= float(row["psd_m2_per_s4_per_Hz_high"])
        for row in rows
        if row["curve"] != "measured"
    )


def test_the_ranking_shows_evidence_and_probability(folder, figures):
    rows = rows_of(folder, "discrepancy_ranking")
    assert [row["curve"] for row in rows][:2] == ["dry_friction", "dry_friction+gap"]
    score = [float(row["fit_score"]) for row in rows]
    assert score == sorted(score, reverse=True)
    axes = figures["discrepancy_ranking"].axes["main"]
    bars, words = axes.patches, [text.get_text() for text in axes.texts]
    assert [bar.get_width() for bar in bars[:3]] == [212.0, 208.0, 180.0]
    named, refined, screened = (bars[place].get_facecolor() for place in (0, 1, 6))
    assert len({named, refined, screened}) == 3
    assert words[:3] == ["95 %, closes 87 %", "4 %", ""]


def test_estimates_of_the_named_law_and_of_pairs_are_shown():
    def candidate(law, value, ids=("foliate_obstacle",), name="angle"):
        return {"ids": list(ids), "name": law, "parameters": {name: {"value": value}}}

    angle, factor = (
        Estimate(value=value, unit=unit, low=value, high=value)
        for value, unit in ((0.4, "rad"), (1.2, "1"))
    )
    effects = [
        FoundEffect(id="foliate_obstacle", location="all", parameters={"angle": angle}),
        FoundEffect(id="gap", location="all", parameters={"gap_factor": factor}),
    ]
    lands, lobes = candidate("foliate_lands@all", 0.4), candidate("foliate_obstacle@all", 0.5)
    pair = candidate("pair", 0.4, ("foliate_obstacle", "gap"), "foliate_obstacle.angle")
    assert named_of([lobes, lands], effects[:1]) == [lands]
    assert named_of([lobes, lands, pair], effects) == [pair]
    assert named_of([lobes, lands], []) == [lobes]
    assert (
        found_of(effects, "gap.gap_factor") == factor
        and found_of(effects, "angle") == angle
        and found_of(effects, "gap.angle") is None
    )
    assert axis_label("foliate_obstacle.angle", "deg") == "foliate obstacle, angle (deg)"


def test_profiles_show_the_simulated_points(folder, figures):
    rows = [
        row["parameter"]
        for row in rows_of(folder, "discrepancy_profiles")
        if row["curve"] == "mu simulated"
    ]
    assert [float(value) for value in rows] == [0.1, 0.15, 0.3]


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


def test_labels_of_axes_have_the_unit_shown():
    assert axis_label("offset_x", "mm") == "offset x (mm)" and axis_label("mu", "1") == "mu (-)"


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


def test_model_of_another_structure_is_told_first():
    rows = [
        check_row(
            "linear model", "warn", "First look at the legs. Modes against the model's: 11 Hz."
        ),
        check_row("other structure", "warn", "Nothing was looked for beside this model."),
    ]
    verdict = made_up_verdict("unknown", checks=rows)
    told = verdict_sentence(verdict)
    assert "nothing was looked for beside it. First look at the legs" in told
    assert "Modes against" not in told and "no effect of the catalogue" not in told
    (step,) = next_steps(verdict, "model.yaml")
    assert step["words"].startswith("Mend the model")


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


def test_effect_is_shown_at_its_best_place():
    rows = [
        {"ids": ids, "location": place, "heldout_score": score}
        for ids, place, score in (
            ("clearance", "leg", 40.0),
            ("clearance", "apex", 20.0),
            ("clearance", "shaker", ""),
            (["gap"], "all", None),
            ("gap", "left", np.nan),
        )
    ]
    assert [row["location"] for row in best_places(rows)] == [
        "leg",
        "apex",
        "all",
    ]  # what was looked at closely stays


def test_report_states_how_much_was_compared():
    page = discrepancy_page("campaign", made_up_verdict("unknown"), [], compared_s=16.0)
    assert "first 16 s of every record" in page
    assert "effort=" not in discrepancy_page("campaign", made_up_verdict("unknown"), [])


def test_a_run_without_map_or_candidates_says_so(tmp_path):
    write_verdict(made_up_verdict("not_testable"), tmp_path / "verdict.json")
    sheets = discrepancy_figures(read_results(tmp_path))
    assert len(sheets) == 5 and all(sheet.tables == [] for sheet in sheets)
    for sheet in sheets:
        sheet.save(tmp_path)
        assert [text.get_text() for axes in sheet.axes.values() for text in axes.texts]
    page = discrepancy_page("refused", made_up_verdict("not_testable"), [])
    assert "can not be judged" in page and "a verdict needs two levels" in page


def test_run_without_completed_model_shows_only_the_map(folder, tmp_path):
    sheets = {
        sheet.name: sheet
        for sheet in discrepancy_figures(read_results_without_after(folder, tmp_path))
    }
    assert [*sheets["discrepancy_map"].axes] == ["D before", "z before"]
    assert {curve for _, curve, _ in sheets["discrepancy_psd"].tables} == {"measured", "before"}


def read_results_without_after(folder, elsewhere):
    """The Results of the run, had it named nothing."""
    for name in ("verdict.json", "map.nc", "ranking.csv"):
        (elsewhere / name).write_bytes((folder / name).read_bytes())
    return read_results(elsewhere)


def test_report_is_one_self_contained_file(folder, figures):
    verdict = made_up_verdict()
    files = [folder / "figures" / f"{name}.png" for name in figures]
    page = discrepancy_page("dev <friction>", verdict, files)
    assert not re.findall(r'(?:src|href)="(?!data:)', page) and "dev &lt;friction&gt;" in page
    images = re.findall(r"base64,([^\"]+)", page)
    shown = [base64.b64decode(image) for image in images]
    assert sorted(shown) == sorted(file.read_bytes() for file in files)
    for part in (
        "The model lacks dry friction (mu 0.149, between 0.128 and 0.171)",
        "the contact rubs",
        "0.128 to 0.171",
        "24 to 33",
        "+7.4",
        "T5, power balance",
        "87 %",
        "flat tops",
        "3120 simulations",
        "0123456789abcdef",
        "below 0.001",
    ):
        assert part in page, part


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


def test_region_names_each_nearby_mode_once():
    region = made_up_verdict().to_values()["regions"][0]
    page = discrepancy_page(
        "campaign",
        made_up_verdict(regions=[region | {"nearest_modes_Hz": [104.45, 104.68, 171.12, 171.75]}]),
        [],
    )
    assert "<td>104, 105, 171, 172</td>" in page
    assert "<td>104, 171</td>" in discrepancy_page(
        "campaign",
        made_up_verdict(regions=[region | {"nearest_modes_Hz": [104.41, 104.42, 171.1]}]),
        [],
    )
    without = {
        key: region[key] for key in region if key != "nearest_modes_Hz"
    }  # a structure that is known by its measured responses alone
    assert "nearest modes" not in discrepancy_page(
        "campaign", made_up_verdict(regions=[without]), []
    )


STORY = (
    "What is missing",
    "How sure",
    "Where it shows",
    "What adding it does",
    "What was ruled out, and why",
    "What to do next",
)


def test_page_tells_one_story_in_order():
    page = discrepancy_page("campaign", made_up_verdict(), [], model="results/a/model_updated.yaml")
    places = [page.index(f"{part}\n") if "?" in part else page.index(part) for part in STORY]
    assert places == sorted(places)
    assert "snakemake -j2 --configfile results/a/model_updated.yaml" in page
    assert "campaign=FILE model=results/a/model_updated.yaml" in page
    assert "screened" not in page and "explains less" in page


def test_closed_share_is_one_number_on_the_page():
    rows = made_up_verdict().to_values()["ranking"]
    assert rows[0]["closed_fraction"] == 0.87  # of what is named: that of its misfit
    page = discrepancy_page("campaign", made_up_verdict(ranking=rows[:1]), [])
    held_out = page.index("held out: not fitted"), page.index("<td>fitted</td>")
    assert "closes 87 % of the excess misfit on records that took no part" in page
    assert "87 %" in page[held_out[0] : held_out[1]]
    assert set(re.findall(r"\d+ %(?= ?</td>)", page)) == {"87 %"}


def test_no_region_is_shown_where_nothing_is_missing():
    page = discrepancy_page("campaign", made_up_verdict("none", regions=[]), [])
    assert "no band is singled out" in page and "<th>nearest modes" not in page
    open_page = discrepancy_page("campaign", made_up_verdict("unknown", regions=[]), [])
    assert "No band is beyond chance by itself" in open_page


def test_probabilities_are_bars_and_are_explained():
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
    bars = [int(width) for width in re.findall(r'class="bar" style="width: (\d+)px', page)]
    assert bars == [223, 12, 5, 0]  # of 240 pixels, the most probable first
    for part in (
        "93 %",
        "something that is not in the catalogue",
        "nine in ten",
        "than chance does",
    ):
        assert part in page, part
    without = discrepancy_page("campaign", made_up_verdict(), [])
    assert "nine in ten" not in without and 'class="bar"' not in without


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
    ("chance", "words"), [(0.2, "within the scatter of its seeds"), (1.0e-9, "two right models")]
)
def test_nothing_missing_is_said_with_its_chance(chance, words):
    assert words in verdict_sentence(made_up_verdict("none", p_global_before=chance))


def test_cost_of_all_stages_is_on_the_page():
    stages = {"null": {"cpu_seconds": 10.0, "simulations": 72}}
    cost = {"cpu_seconds": 10.0, "simulations": 72, "by_stage": stages}
    page = discrepancy_page("campaign", made_up_verdict(cost=cost), [])
    assert '<td>null</td><td class="number">10</td>' in page


def with_points(data):
    """A map with the places of channels and of the force on the tube of the study."""
    apex = np.tile([0.0, 0.0, 1.0], (len(CHANNELS), 1))
    across = np.tile([0.0, 1.0, 0.0], (len(CHANNELS), 1))
    force = [[-0.2121, 0.0, 0.9121]]
    return data.assign(
        channel_point=(("channel", "xyz"), apex),
        channel_direction=(("channel", "xyz"), across),
        force_channel_point=(("force_channel", "xyz"), force),
        force_channel_direction=(("force_channel", "xyz"), across[:1]),
    )


@pytest.mark.parametrize(
    ("effect", "location", "marked"),
    [
        ("dry_friction", "all", [(-0.3, 0.35), (0.3, 0.35)]),
        ("gap", "left", [(-0.3, 0.35)]),
        ("added_mass", "apex", [(0.0, 1.0)]),
        ("sensor_gain", "apex_y", [(0.0, 1.0)]),
        ("sensor_gain", "force", [(-0.2121, 0.9121)]),
        ("cubic_stiffness", "leg: at apex, to the ground", [(0.0, 1.0)]),
        ("modal_damping", "all", None),
    ],
)
def test_place_of_an_effect_is_marked(study_config, effect, location, marked):
    found = FoundEffect(id=effect, location=location, parameters={})
    (sheet,) = place_figure(study_config, with_points(made_up_map(1.0)), [found])
    (table,) = [table for _, curve, table in sheet.tables if curve == f"{effect} at {location}"]
    spots = np.transpose([table["x_m"], table["z_m"]])
    if marked is None:  # all of the tube
        assert len(spots) > 100
    else:
        np.testing.assert_allclose(spots, marked, atol=2.0e-4)
    assert effects_in_words([effect]) in [text.get_text() for text in sheet.axes["main"].texts]
