"""What a measured tube leaves in its folder, and what is refused, each with its remedy."""

import runpy
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import vibroimpact
from tests.support.chromium import needs_chromium, opened
from tests.support.measured_campaigns import LinearCampaigns, without_force
from vibroimpact.campaign.file import (
    CampaignError,
    fill_missing,
    read_campaign,
    with_no_force,
    write_campaign,
)
from vibroimpact.campaign.importing.report import import_text
from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.config.stage_keys import answer_digest
from vibroimpact.equivalent_support.answer import EquivalentError
from vibroimpact.equivalent_support.measured.equivalent_of import cases_of_records, gaps_of_records
from vibroimpact.equivalent_support.measured.usable import identification_problems
from vibroimpact.equivalent_support.study_answer import equivalent
from vibroimpact.io.records import read_table, write_record, write_table
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.figures.drawing import drawn
from vibroimpact.reports.figures.quicklook import quicklook
from vibroimpact.reports.figures.study.measured import study_beside
from vibroimpact.study.run_files import write_run_files

ROOT = Path(__file__).parents[2]
SENSORS = ("apex.y", "bend_45.y", "apex.x")
FIGURES = ("figure_13_equivalent_support", "figure_05_overlay", "figure_06_levels")


@pytest.fixture(scope="module")
def config():
    config = load_config(ROOT / "config" / "smoke.yaml")
    return changed_config(config, {"spectra.segment_s": 8.0, "study": "mine"})


@pytest.fixture(scope="module")
def campaign(config):
    """Two records of the linear tube on a spring and damper."""
    tube = config, build_model(config), (2.0e5, 80.0)
    return LinearCampaigns(*tube, ["bend_45"], SENSORS, duration_s=64.0).campaign(2)


def run_script(folder, file, config, study):
    """Run the script of the rule; return the folder of its results."""
    for name in ("figures", "logs"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    captions = [ROOT / "workflow" / "report" / f"measured_{name}.rst" for name in FIGURES]
    job = SimpleNamespace(
        input=SimpleNamespace(campaign=str(file), captions=[str(path) for path in captions]),
        output=SimpleNamespace(page=str(folder / "equivalent.html")),
        params=SimpleNamespace(
            library="0a1b2c3d4e5f6789",
            model=config.model_dump(mode="json"),
            name=folder.name,
            study=str(study),
        ),
        log=[str(folder / "logs" / "equivalent.log")],
    )
    streams = sys.stdout, sys.stderr
    try:
        runpy.run_path(str(ROOT / "workflow" / "scripts" / "equivalent.py"), {"snakemake": job})
    finally:
        if sys.stdout is not streams[0]:
            sys.stdout.close()
        sys.stdout, sys.stderr = streams
    return folder


@pytest.fixture(scope="module")
def results(tmp_path_factory, campaign, config):
    """The folder of a campaign beside that of a study of the same tube."""
    base = tmp_path_factory.mktemp("results")
    write_campaign(campaign, base / "bench.nc")
    study = base / "mine"
    (study / "spectra").mkdir(parents=True)
    found = vibroimpact.equivalent_of(campaign, config)
    rows = [{**row, "load_rms_N": 3.0} for row in found.rows]
    write_table(rows, study / "consistency.csv")
    return run_script(base / "bench", base / "bench.nc", config, study)


@pytest.fixture(scope="module")
def file_without_force(tmp_path_factory, campaign):
    path = tmp_path_factory.mktemp("results") / "plant.nc"
    write_record(without_force(campaign), path, names_kept=True)
    return path


@pytest.fixture(scope="module")
def results_without_force(file_without_force, config):
    base = file_without_force.parent
    return run_script(base / "plant", file_without_force, config, base / "mine")


def test_the_folder_is_read_as_that_of_a_study(results):
    answer = equivalent(results, load_rms_N=1.0, gap_m=2.8886e-4)
    (along,) = [group for group in answer.groups if group.direction == "y"]
    assert along.supports == ("left", "right")
    assert along.k.value == pytest.approx(2.0e5, rel=0.05)
    assert along.c.value == pytest.approx(80.0, rel=0.35)


def test_tables_of_another_model_are_refused(results, config, tmp_path):
    copy = Path(shutil.copytree(results, tmp_path / "bench"))
    values = config.model_dump(mode="json")
    write_run_files(copy, values, ["snakemake"])
    assert equivalent(copy, 1.0, 2.8886e-4).groups
    values["damping"]["other_ratio"] *= 2.0
    write_run_files(copy, values, ["snakemake"])
    with pytest.raises(EquivalentError, match="summary.csv: is of another configuration than"):
        equivalent(copy, 1.0, 2.8886e-4)


def test_each_estimate_names_its_record(results):
    rows = read_table(results / "consistency.csv")
    assert {(row["seed"], row["record"]) for row in rows} == {(0, "run 0"), (1, "run 1")}
    assert {row["method"] for row in rows}.isdisjoint({"secant", "statistical_linearisation"})


def test_figure_13_has_the_studys_curve_behind_the_points(results):
    rows = read_table(results / "figures" / "figure_13_equivalent_support.csv")
    study = [row for row in rows if row["curve"] == "study"]
    assert study and {row["load_rms_N"] for row in study} == {3.0}
    assert {row["load_rms_N"] for row in rows if row["curve"] == "lscf"} == {1.0}


def test_figure_5_has_the_equivalent_linear_tube(results):
    rows = read_table(results / "figures" / "figure_05_overlay.csv")
    peaks = set()
    for name in ("measured, mean", "linear tube on the equivalent support"):
        curve = [row for row in rows if row["curve"] == name and row["frequency_Hz"] < 40.0]
        highest = max(curve, key=lambda row: row["psd_m2_per_s4_per_Hz"])
        peaks.add(round(highest["frequency_Hz"]))
    assert len(peaks) == 1


def test_a_study_of_another_configuration_is_not_drawn_behind(results, config, tmp_path):
    rows = read_table(results.parent / "mine" / "consistency.csv")
    own_digest = answer_digest(config.model_dump(mode="json"))
    for digest, is_drawn in ((own_digest, True), ("0123", False)):
        own = [row | {"config_digest": digest} for row in rows]
        write_table(own, tmp_path / "consistency.csv")
        assert (study_beside(config, tmp_path) is not None) == is_drawn


@needs_chromium
@pytest.mark.parametrize("width", [1400, 500])
def test_the_page_draws_the_stabilisation_chart(results, tmp_path, width):
    page = (results / "equivalent.html").read_text(encoding="utf-8")
    found, troubles = opened(
        page,
        """
        const chart = document.getElementById("plot-stabilisation");
        return {kinds: chart.data.map((trace) => trace.name),
                poles: chart.data[3].x.length,
                too_wide: document.documentElement.scrollWidth > innerWidth};
        """,
        tmp_path,
        width,
    )
    assert troubles == [] and not found["too_wide"]
    assert found["poles"] > 1 and found["kinds"][-1].startswith("taken")


def test_the_page_says_that_no_contact_was_simulated(results):
    page = (results / "equivalent.html").read_text(encoding="utf-8")
    assert "No contact was simulated" in page and "Time in contact" not in page


def test_levels_without_a_force_are_those_of_the_response(results_without_force):
    rows = read_table(results_without_force / "equivalent.csv")
    assert all(np.isnan(row["load_rms_N"]) and row["response_rms_m"] > 0.0 for row in rows)
    curves = read_table(results_without_force / "figures" / "figure_13_equivalent_support.csv")
    assert all("load_rms_N" not in row for row in curves)
    page = (results_without_force / "equivalent.html").read_text(encoding="utf-8")
    assert "No force was measured" in page and "mm RMS" in page


def test_a_load_is_not_asked_of_records_without_a_force(results_without_force):
    with pytest.raises(EquivalentError, match="measured without a force.*equivalent.csv"):
        equivalent(results_without_force, load_rms_N=1.0, gap_m=2.8886e-4)


def test_a_file_without_a_force_is_read_where_none_is_needed(file_without_force):
    with pytest.raises(CampaignError, match="holds no force"):
        read_campaign(file_without_force)
    found = read_campaign(file_without_force, force_needed=False)
    assert found.sizes["force_channel"] == 0 and np.isnan(found["load_rms"].values).all()


FOLDER = """
source: a plant in service
forces: []
channels:
  - {name: apex, variable: apex, unit: m/s^2, kind: acceleration, point_m: [0, 0, 1.0],
     direction: +y}
  - {name: bend, variable: bend, unit: m/s^2, kind: acceleration,
     point_m: [-0.2121, 0, 0.9121], direction: +y}
sampling_frequency_Hz: 512
records:
  - {name: calm, file: calm.csv, gap_m: 2.8886e-4}
  - {name: rough, file: rough.csv, gap_m: 2.8886e-4}
"""


@pytest.fixture(scope="module")
def plant(tmp_path_factory, campaign):
    """A folder of two records of accelerations alone, at two levels."""
    folder = tmp_path_factory.mktemp("plant")
    (folder / "campaign.yaml").write_text(FOLDER)
    for name, record, level in (("calm", 0, 1.0), ("rough", 1, 4.0)):
        columns = level * campaign["response"].values[record, :2].T
        np.savetxt(folder / f"{name}.csv", columns, delimiter=",", header="apex,bend", comments="")
    return folder


def test_a_folder_without_a_force_is_imported(plant, config, tmp_path):
    imported, rows = vibroimpact.import_folder(plant)
    assert {row["role"] for row in rows} == {"response"}
    write_campaign(imported, tmp_path / "plant.nc")
    found = vibroimpact.equivalent_of(tmp_path / "plant.nc", config)
    assert sorted(found.records.values()) == ["calm", "rough"]
    low, high = sorted({row["load_rms_N"] for row in found.rows})
    assert high / low == pytest.approx(4.0, rel=0.2)
    k = [row["k_median"] for row in found.summary if row["method"] == "lscf"]
    assert k == pytest.approx([2.0e5, 2.0e5], rel=0.06)


def test_its_report_says_that_no_force_was_measured(plant):
    imported, rows = vibroimpact.import_folder(plant)
    checks = vibroimpact.check_campaign(imported)
    assert [row["check"] for row in checks] == ["content"]
    text = import_text(plant, imported, rows, checks)
    assert "no force, gap 0.2889 mm" in text and "The campaign holds no force" in text
    sheet = drawn(quicklook(imported))
    assert {curve for _, curve, _ in sheet.tables} == {"calm", "rough"}


def test_a_channel_across_the_force_is_left_out(campaign, config):
    found = vibroimpact.equivalent_of(campaign, config)
    assert found.model.sensor_names == ("bend_45.y", "apex.y")  # along the tube
    assert any("apex.x" in note for note in found.notes)


def test_bands_follow_the_records_where_the_model_has_none(campaign, config):
    plain = config.model_copy(update={"identification": None})
    found = vibroimpact.equivalent_of(campaign, plain)
    low, high = found.config.identification.peak_search_Hz
    poles = [row["frequency_Hz"] for row in found.rows if row["method"] == "lscf"]
    assert low < min(poles) and max(poles) < high < 2.0 * max(poles)
    k = [row["k_N_per_m"] for row in found.equivalent if row["direction"] == "y"]
    assert k == pytest.approx([2.0e5], rel=0.05)


def test_one_sensor_gives_a_pole_and_no_shape(campaign, config):
    found = vibroimpact.equivalent_of(campaign.isel(channel=[0]), config)
    reasons = {row["method"]: row["reason"] for row in found.summary}
    assert reasons["ods"] == "one sensor tells no shape"
    k = [row["k_median"] for row in found.summary if row["method"] in ("lscf", "broadband")]
    assert k == pytest.approx([2.0e5, 2.0e5], rel=0.05)


def test_records_of_one_gap_and_about_one_level_are_a_case():
    levels = np.array([5.0, 20.0, 5.1, 4.95, 20.4])
    cases = cases_of_records(levels, np.full(5, 1.0e-4))
    assert [case.seed for case in cases] == [0, 0, 1, 2, 1]
    assert sorted({case.load_rms_N for case in cases}) == [5.017, 20.2]
    cases = cases_of_records(np.full(2, 5.0), np.array([1.0e-4, 2.0e-4]))
    assert [(case.gap_m, case.seed) for case in cases] == [(1.0e-4, 0), (2.0e-4, 0)]


def test_a_gap_that_is_not_stated_is_that_of_the_model():
    gaps = gaps_of_records(np.array([np.nan, 1.0e-4]), (2.0e-4, 3.0e-4))
    assert gaps.tolist() == [3.0e-4, 1.0e-4]


def test_what_can_be_no_measured_tube_is_refused_before_any_job(campaign, config):
    def problems(config, campaign):
        return "\n".join(identification_problems(config, fill_missing(with_no_force(campaign))))

    assert problems(config, campaign) == ""
    chain = load_config(ROOT / "config" / "examples" / "mass_between_stops.yaml")
    assert "give a model of kind u_tube or path" in problems(chain, campaign)
    bare = config.model_copy(update={"supports": ()})
    assert "the model has no supports" in problems(bare, campaign)
    off = campaign.assign(channel_point=campaign["channel_point"] + 1.0)
    assert "off the tube" in problems(config, off)
    kinds = ("force_channel", np.array(["base_acceleration"], dtype=object))
    units = ("force_channel", np.array(["m s-2"], dtype=object))
    shaken = campaign.assign(force_channel_kind=kinds, force_channel_units=units)
    assert "the base moved" in problems(config, shaken)


def with_response(campaign, place, value):
    """A campaign with another value at a place (record, channel, time)."""
    changed = campaign.copy(deep=True)
    changed["response"][place] = value
    return changed


@pytest.mark.parametrize(
    ("change", "keys", "words"),
    [
        (
            lambda campaign: with_response(campaign, (1, 0, 100), np.nan),
            {},
            "apex.y in record run 1: cut the records",
        ),
        (
            lambda campaign: with_response(campaign, np.s_[:, 1], 0.0),
            {},
            "bend_45.y measured nothing but zeros: leave",
        ),
        (
            lambda campaign: campaign.isel(time=slice(0, 2048)),
            {},
            "lasts 4 s, less than a segment of 8 s.*below 1 s",
        ),
        (lambda campaign: campaign, {"identification.lscf.band_Hz": [8.0, 150.0]}, "needs 600 Hz"),
    ],
    ids=["missing samples", "a dead channel", "a short record", "a low rate"],
)
def test_records_of_no_use_are_refused(campaign, config, change, keys, words):
    with pytest.raises(CampaignError, match=words):
        vibroimpact.equivalent_of(change(campaign), changed_config(config, keys))
