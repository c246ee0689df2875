"""Figures and page of a discrepancy run: what is drawn is what the files hold, and every verdict
has its sentence.
"""

import csv
import json

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
from vibroimpact.discrepancy.results_folder import read_results
from vibroimpact.effects.registry import effects_in_words
from vibroimpact.figures.discrepancy.place import place_figure
from vibroimpact.figures.discrepancy.ranking import axis_label, found_of, named_of
from vibroimpact.figures.discrepancy.sheets import discrepancy_figures
from vibroimpact.figures.discrepancy.spectra import chosen_channels, chosen_records
from vibroimpact.records import write_record, write_table
from vibroimpact.reports.discrepancy_page import discrepancy_page
from vibroimpact.verdict.content import Estimate, FoundEffect
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


def test_labels_of_axes_have_the_unit_shown():
    assert axis_label("offset_x", "mm") == "offset x (mm)" and axis_label("mu", "1") == "mu (-)"


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
