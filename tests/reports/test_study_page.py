"""The page of a study: its numbers are those of the tables, it needs nothing else, and every figure
has its caption.
"""

import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.support.made_up_study import (
    GAPS,
    LOADS,
    MadeUpStudy,
    made_up_config,
    rows_of_two_directions,
)
from tests.support.one_mass import one_mass
from vibroimpact.config.reading import check_config, load_config
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.io.records import read_record, write_record
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.captions import CATEGORIES, CaptionError, read_caption
from vibroimpact.reports.equivalent_answer import Answer, Value
from vibroimpact.reports.figures.interactive.equivalent import equivalent_plots
from vibroimpact.reports.figures.interactive.page_plot import Control
from vibroimpact.reports.figures.interactive.response import band_of, shapes_of, spectra_of_series
from vibroimpact.reports.figures.interactive.statistics import contact_plots
from vibroimpact.reports.figures.interactive.study_plots import MOST_FRAMES, shown_loads
from vibroimpact.reports.figures.plot import Axis
from vibroimpact.reports.study_statistics import study_statistics
from vibroimpact.reports.study_tables import answer_table, reason_table
from vibroimpact.reports.study_words import (
    answer_in_words,
    contact_sentences,
    headline,
    run_sentence,
)
from vibroimpact.reports.table import Table
from vibroimpact.reports.wear_life import centred_sentence
from vibroimpact.study.cases import all_cases, case_from_id

ROOT = Path(__file__).parents[2]
CAPTIONS = ROOT / "workflow" / "report"


class Page(HTMLParser):
    """What a page holds: tables as lists of rows of cells, texts, attributes, scripts."""

    def __init__(self, text):
        super().__init__()
        self.tables, self.attributes, self.scripts, self.ids = [], [], [], []
        self._inside, self._cell = None, False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.attributes += [(tag, name, value or "") for name, value in attributes]
        self.ids += [value for name, value in attributes if name == "id"]
        self._inside = tag
        if tag == "script":
            self.scripts.append("")
        elif tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.tables[-1][-1].append("")
            self._cell = True

    def handle_endtag(self, tag):
        self._cell = self._cell and tag not in ("td", "th")
        self._inside = None

    def handle_data(self, data):
        if self._inside == "script":
            self.scripts[-1] += data
        elif self._cell:
            self.tables[-1][-1][-1] += data

    def table(self, *columns):
        """The rows of the tables that have some columns, as dicts."""
        chosen = [table for table in self.tables if set(columns) <= set(table[0])]
        return [dict(zip(table[0], row, strict=True)) for table in chosen for row in table[1:]]

    def plots(self):
        """{name: plot} of the interactive plots."""
        data = json.loads(next(script for script in self.scripts if script.startswith('{"plots"')))
        return {plot["name"]: plot for plot in data["plots"]}


def controls(**keys):
    """The Controls of a page with some keys."""
    return [Control(name, name, [*map(str, own)], own) for name, own in keys.items()]


@pytest.fixture(scope="module")
def model():
    """The reduced model of the smoke study."""
    return build_model(load_config(ROOT / "config" / "smoke.yaml"))


@pytest.fixture(scope="module")
def study(model):
    """A study with the tables of today."""
    return MadeUpStudy(model)


@pytest.fixture(scope="module")
def page(study):
    """Its page."""
    return Page(study.page())


@pytest.fixture(scope="module")
def two_directions(model):
    """The page of a study with equivalent.csv and two directions."""
    return Page(MadeUpStudy(model, rows_of_two_directions()).page())


def test_table_of_the_page_holds_the_recommended_values(page):
    rows = page.table("k (kN/m)", "c (N s/m)")
    assert len(rows) == len(GAPS) * len(LOADS)
    row = next(row for row in rows if (row["gap (mm)"], row["load (N RMS)"]) == ("0.2", "10"))
    # k = 10 x load / gap; the interval holds 0.9 and 1.1 of it with 5 % over seeds.
    assert (row["k (kN/m)"], row["interval of k"]) == ("500", "428 to 578")
    assert (row["methods on k"], row["methods on c"]) == ("agree", "over 25 % apart")
    assert row["c (N s/m)"] == "750"


def test_unresolved_values_have_their_reason_on_the_page(page):
    rows = page.table("why", "time in contact (%)")
    lowest = [row for row in rows if row["loads (N RMS)"] == "0.1" and row["gap (mm)"] == "0.2"]
    assert [row["value"] for row in lowest] == ["k and c: not resolved"]
    assert lowest[0]["why"] == "no method resolves k; LSCF pole: no value"
    assert lowest[0]["time in contact (%)"] == "0"
    differs = next(row for row in rows if row["value"].startswith("c: over 25 %"))
    # Left support: 2 x 0.04 x 10.
    assert differs["loads (N RMS)"] == "10" and differs["time in contact (%)"] == "80"


def test_loads_whose_reasons_differ_in_numbers_share_a_row(study):
    nothing = [math.nan] * 3
    rows = [
        Answer(
            2.0e-4,
            load,
            "plates",
            "x",
            Value(*nothing, "unresolved", f"k = {1e3 * load:g} N/m is below {2e3 * load:.1e}"),
            Value(*nothing, "unresolved", "no pole" if load < 5.0 else "two poles"),
        )
        for load in LOADS
    ]
    table = reason_table(replace(study.content, answers=rows))
    assert [row[3:5] for row in table.rows] == [
        ("0.1 to 10", "k: not resolved"),
        ("0.1 to 1", "c: not resolved"),
        ("10", "c: not resolved"),
    ]
    assert table.rows[0][5] == (
        "k = 100 N/m is below 2.0e+02 (at 0.1 N RMS, likewise at the others)"
    )
    assert [row[6] for row in table.rows] == ["0 to 80", "0 to 8", "80"]  # % of the time


def test_reasons_of_two_directions_stand_apart(two_directions):
    rows = two_directions.table("why", "direction")
    assert [row["direction"] for row in rows if row["value"].startswith("k")] == [*"xyxy"]


def test_contact_table_holds_medians_over_seeds(page):
    rows = page.table("support", "peak force (N)")
    row = next(row for row in rows if (row["load (N RMS)"], row["support"]) == ("10", "left"))
    assert row["time in contact (%)"] == "80" and row["impacts (1/s)"] == "80"
    assert row["RMS force (N)"] == "40" and row["peak force (N)"] == "405"  # 400 and 410
    assert row["wear work rate (mW)"] == "8"


def test_stress_above_the_limit_is_flagged(page):
    rows = page.table("peak stress (MPa)", "above the limit")
    assert {(row["load (N RMS)"], row["above the limit"]) for row in rows} == {
        ("0.1", "no"),
        ("1", "no"),
        ("10", "yes"),
    }
    assert {row["most stressed section"] for row in rows} == {"root start"}
    assert next(row for row in rows if row["load (N RMS)"] == "10")["peak stress (MPa)"] == "250"


def test_headline_counts_agreement_of_stiffness_and_damping(study):
    told = study.content.found
    assert told[0] == (
        "Stiffness k: 4 of 4 pairs of load and gap that the methods resolve agree on k within 10 %;"
        " in 2 k is not resolved."
    )
    assert told[1] == (
        "Damping c: 2 of 4 pairs of load and gap that both methods resolve agree on c within 0 %;"
        " in 2 they are more than 25 % apart; in 2 c is not resolved."
    )
    # ods and lscf are 0.9 and 1.0 of k, the broadband comparison 1.1.
    assert told[2].endswith(
        "The broadband PSD reads every peak from 6 to 99 Hz: its k is +16 to +16 % from the mean of"
        " pole and shape."
    )
    assert told[3] == (
        "Gap 0.2 mm: k from 50 kN/m at 1 N RMS to 500 kN/m at 10 N RMS; c from 50 N s/m at 1 N RMS"
        " to 750 N s/m at 10 N RMS."
    )


def test_k_and_c_stand_at_the_place_of_the_controls(study, page):
    data = json.loads(next(script for script in page.scripts if script.startswith('{"plots"')))
    here = {(gap, place, load): text for gap, place, load, text in data["here"]}
    assert len(here) == len(GAPS) * len(LOADS)
    assert here[0, 0, 10.0].startswith("k = 500 kN/m (428 to 578); c = 750 N s/m (")
    assert here[0, 0, 10.0].endswith(f"equivalent {study.content.name} --load 10 --gap 0.0002")
    assert here[1, 0, 0.1].startswith("No k: no method resolves k; LSCF pole: no value.")


def test_a_bounded_stiffness_is_shown_everywhere(study):
    text = "k < 2.45 kN/m: the tube hardly touches, 0.3 % of the time"
    lost = Value(*[math.nan] * 3, "unresolved", text)
    row = Answer(2.0e-4, 0.1, "all", "y", lost, lost, 2.45e3, 0.003)
    content = replace(study.content, answers=[row])
    assert answer_table(content, 2.0e-4).rows[0][2:5] == ("< 2450", "-", "upper bound")
    ((gap, loads, value, why, touching),) = reason_table(content).rows
    assert (gap, loads, value, why) == ("0.2", "0.1", "k: upper bound", text) and touching == "0.3"
    assert answer_in_words(row, ("kN/m", 1e-3)) == text + "."
    k, _ = equivalent_plots([row], [], Axis("load_rms_N", True))
    ((trace,),) = k.drawn(controls(gap=[2.0e-4], place=[("all", "y")]))["frames"].values()
    assert (trace["name"], trace["y"]) == ("upper bound", [2450.0])
    assert "in 1 the tube hardly touches" in headline(study.config, [row], "N")[0]


def test_every_load_and_gap_has_its_spectrum(page, study):
    plot = page.plots()["spectrum"]
    assert plot["controls"] == ["gap", "load"] and len(plot["frames"]) == len(GAPS) * len(LOADS)
    low, high, mean = plot["frames"]["1,2"]
    assert low["x"] == high["x"] == mean["x"]  # written once, for all frames
    frequency = np.array(plot["shared"][mean["x"].removeprefix("@")])
    assert frequency[np.argmax(mean["y"])] == pytest.approx(26.0, abs=0.3)  # 16 Hz + 10
    ratio = np.array(high["y"]) / np.array(mean["y"])
    assert np.median(ratio) == pytest.approx(4.0, rel=0.02)
    assert np.all(np.array(low["y"]) < np.array(mean["y"]))


def test_time_series_stand_in_where_there_are_no_spectra(study):
    time = np.arange(0.0, 16.0, 1.0 / 512.0)

    def read(path, names):
        # 2 mm x load at 20 Hz on the first sensor, half of it on the second.
        wave = 2e-3 * case_from_id(Path(path).stem).load_rms_N * np.sin(2.0 * np.pi * 20.0 * time)
        return xr.Dataset(
            {"displacement": (("sensor", "time"), np.array([wave, 0.5 * wave]))},
            {"sensor": ["first", "second"]},
            {"sampling_frequency": 512.0},
        )

    places = [(GAPS[0], load) for load in LOADS]
    settings = study.config.spectra  # segments of 4 s
    sensor, frequency, spectra = spectra_of_series(study.paths, read, settings, places)
    assert sensor == "first" and sorted(spectra) == sorted(places)
    mean = spectra[GAPS[0], 10.0]["mean"]
    assert frequency[np.argmax(mean)] == pytest.approx(20.0)
    # The PSD sums to the mean square of a sine of 20 mm.
    assert np.sum(mean) * (frequency[1] - frequency[0]) == pytest.approx(0.5 * 20e-3**2, rel=1e-3)
    low, high = band_of(frequency, spectra)
    assert 9.0 < low < 10.5 and 29.5 < high < 31.0
    short = {"segment_s": 20.0, "overlap": 0.5, "window": "hann"}
    assert spectra_of_series(study.paths, read, StageSettings(short), places)[2] == {}


def test_moving_shape_has_its_parts_in_phase_and_quadrature(page):
    traces = page.plots()["shape"]["frames"]["0,1"]
    moving = next(trace for trace in traces if "meta" in trace)
    re_part, im_part = (np.array(moving["meta"][name]) for name in ("re", "im"))
    assert np.hypot(re_part, im_part).max() == pytest.approx(1.0, rel=1e-3)
    middle = np.argmax(re_part)
    assert im_part[middle] / re_part[middle] == pytest.approx(0.1, rel=2e-3)


def test_curves_of_the_methods_are_those_of_the_table(page):
    traces = {trace.get("name"): trace for trace in page.plots()["equivalent_k"]["frames"]["1,0"]}
    assert traces["LSCF pole"]["x"] == [1.0, 10.0] and traces["LSCF pole"]["y"] == [2e5, 2e6]
    assert traces["recommended"]["y"] == [None, 2e5, 2e6]
    damping = {trace.get("name"): trace for trace in page.plots()["equivalent_c"]["frames"]["1,0"]}
    assert "deflection shape" not in damping  # a shape carries no damping


def test_directions_have_curves_of_their_own(two_directions):
    frames = two_directions.plots()["equivalent_k"]["frames"]
    assert sorted(frames) == ["0,0", "0,1", "1,0", "1,1"]
    x, y = (
        next(trace for trace in frames[key] if trace.get("name") == "recommended")["y"]
        for key in ("0,0", "0,1")
    )
    assert x == [None, 5e4, 5e5] and y == [None, 1e5, 1e6]
    assert "control-place" in two_directions.ids


def test_energy_residuals_stand_beside_their_limits(page):
    rows = page.table("accepted (-)", "within")
    work = next(row for row in rows if row["energy balance"].startswith("with the work"))
    # 1e-5 x 10 N; the exact scheme is accepted up to 3e-4.
    assert work["worst residual / input work (-)"] == "0.0001" and work["within"] == "yes"
    assert work["accepted (-)"] == "0.0003"


def test_page_refers_to_nothing_outside(study, page):
    addresses = [
        (tag, value)
        for tag, name, value in page.attributes
        if name in ("src", "href", "action", "data", "poster", "srcset")
    ]
    assert addresses
    assert [item for item in addresses if not item[1].startswith(("#", "data:image/png"))] == []
    assert {tag for tag, _, _ in page.attributes} & {"link", "iframe", "object", "embed"} == set()
    policy = next(
        value for _, name, value in page.attributes if name == "content" and "-src" in value
    )
    assert "default-src 'none'" in policy and "http" not in policy
    styles = re.findall(r"<style>(.*?)</style>", study.page(), flags=re.S)
    assert styles and "url(" not in "".join(styles) and "@import" not in "".join(styles)


def test_ids_of_the_page_are_unique(page, two_directions):
    for found in (page, two_directions):
        assert sorted(found.ids) == sorted(set(found.ids))


def test_every_axis_of_the_page_has_a_title_with_its_unit(page, two_directions):
    for plots in (page.plots(), two_directions.plots()):
        for plot in plots.values():
            for axis in ("xaxis", "yaxis"):
                title = plot["layout"][axis]["title"]["text"]
                names = plot["layout"][axis].get("type") == "category" and "Section" in title
                assert names or re.search(r"\(.+\)$", title), (plot["name"], title)


def test_without_identification_contact_and_stress_are_shown(model):
    study = MadeUpStudy(model)
    study.content = replace(study.content, answers=[])
    study.paths = []
    found = Page(study.page())
    assert {"contact_fraction", "stress", "stress_sections", "energy"} <= set(found.plots())
    assert "equivalent_k" not in found.plots() and "spectrum" not in found.plots()
    assert "answer" not in found.ids and "contact" in found.ids


def test_configuration_on_the_page_is_the_one_that_ran(study):
    assert "study: made_up\ngrid:\n  seeds: 2\n" in study.page()
    assert "<code>figures/layout</code>" in study.page()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "a random force from 5 to 200 Hz at shaker: 3 loads from 0.1 to 10 N RMS"),
        (
            {
                "identification": None,
                "excitation": {
                    "kind": "base_motion",
                    "direction": [0.0, 1.0, 0.0],
                    "signal": {"kind": "harmonic", "frequency_Hz": 12.5},
                },
            },
            "a motion of its base (sinusoidal, 12.5 Hz): 3 loads from 0.1 to 10 m/s² RMS",
        ),
    ],
)
def test_what_was_run_is_said_with_its_units(study, changes, words):
    told = run_sentence(made_up_config(**changes), study.content.statistics)
    assert words in told and "2 gaps (radial, 0.2 and 0.05 mm)" in told
    assert told.startswith("A U-tube with 2 gap supports") and "12 records of 16 s" in told


def test_wear_of_a_centred_tube_has_its_caveat():
    told = centred_sentence(1e-6, np.zeros((10, 2)), 1e-4)
    assert "centred to 1e-06 of the gap" in told and "supports.centre_offset_m" in told
    assert centred_sentence(0.1, np.zeros((10, 2)), 1e-4) == ""
    assert centred_sentence(1e-6, np.full((10, 2), 1e-5), 1e-4) == ""
    assert centred_sentence(1e-6, np.zeros((0, 2)), 1e-4) == told


def test_what_is_to_be_known_of_contact_is_said_with_its_case(study):
    assert study.content.found[5:] == [
        "Most contact: 80 % of the time, at 10 N RMS and a gap of 0.2 mm.",
        "Largest wear work rate: 0.008 W, at 10 N RMS and a gap of 0.2 mm.",
        "Largest stress: 250 MPa. Above the limit of 240 MPa: at 10 N RMS and a gap of 0.2 mm; at"
        " 10 N RMS and a gap of 0.05 mm.",
    ]
    supports = [
        {**support, "gap_m": gap}
        for support, gap in zip(study.config.supports, (1e-4, 3e-4), strict=True)
    ]
    own = StageSettings({**study.config, "supports": supports})
    assert "gaps of their own (from 0.1 to 0.3 mm)" in run_sentence(own, study.content.statistics)
    assert contact_sentences(own, study.content.statistics)[0] == (
        "Most contact: 80 % of the time, at 10 N RMS."
    )


def test_supports_of_a_chain_have_curves_by_name():
    flat = {"kind": "planes", "normals_deg": [0.0]}
    stop = {"name": "stop", "point": "mass", "stiffness_N_per_m": 1.0e6, "profile": flat}
    grid = {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1}
    config = check_config(one_mass(2.0e4, 2.0, supports=[stop], grid=grid), "chain")
    case = all_cases(config.grid)[0]
    touched = xr.Dataset(
        {"contact_fraction": ("support", [0.25], {"units": "1"})},
        {"support": ["stop"]},
        {"load_rms_N": case.load_rms_N, "gap_m": case.gap_m, "seed": 0},
    )
    statistics = study_statistics([f"{case.id}.nc"], lambda path, names=None: touched)
    (plot,) = contact_plots(statistics, Axis("load_rms_N", True), "")
    (curve,) = plot.drawn(controls(gap=[1.0e-3]))["frames"]["0"]
    assert (curve["name"], curve["x"], curve["y"]) == ("stop", [1.0], [25.0])
    assert plot.name == "contact_fraction" and statistics.sections == []


def test_slider_of_a_large_study_keeps_both_ends():
    loads = list(np.geomspace(0.01, 100.0, 500))
    chosen = shown_loads(GAPS, loads)
    assert len(chosen) == MOST_FRAMES // 2 and (chosen[0], chosen[-1]) == (loads[0], loads[-1])
    assert shown_loads(GAPS, LOADS) == list(LOADS)


def test_numbers_are_told_from_words_by_column():
    table = Table(
        ("a", "b", "c", "d"), [("1.5e-06", "-", "72cee9", "2 to 3"), ("2", "4", "7", "-")]
    )
    assert table.numeric() == [True, True, False, True]


def test_every_figure_and_table_of_the_workflow_has_a_caption():
    rules = "".join(path.read_text() for path in sorted((ROOT / "workflow/rules").glob("*.smk")))
    block = re.search(r"^FIGURES = \{.*?^\}", rules, flags=re.M | re.S).group()
    figures = re.findall(r'"(\w+)"', block)
    tables = re.findall(r'"(\w+)"', re.search(r"^TABLES = \((.*)\)", rules, flags=re.M).group(1))
    assert len(figures) >= 19 + 4 and len(tables) >= 3  # with the names of four groups
    for name in [*figures, *tables, "statistics", "timing", "basis_quality_table"]:
        if name in ("model", "response", "identification", "checks"):
            continue
        caption = read_caption(CAPTIONS / f"{name}.rst")
        assert caption.category in CATEGORIES and len(re.findall(r"[.](?: |$)", caption.text)) == 2


def test_caption_without_category_or_text_is_refused(tmp_path):
    file = tmp_path / "made_up.rst"
    for text, words in (
        ("A sentence.", "category '' is none of Equivalent support"),
        (".. category: Checks\n\nA sentence.", "give a line '.. title: WORDS'"),
        (".. category: Checks\n.. title: Made up\n", "a sentence below it"),
    ):
        file.write_text(text)
        with pytest.raises(CaptionError, match=re.escape(words)):
            read_caption(file)


def test_a_case_without_a_shape_is_left_out_of_the_page(tmp_path):
    paths = [tmp_path / f"load_4_gap_0.0001_seed_{seed}.nc" for seed in (0, 1)]
    shape = {"ods_re": ("line_point", [1.0, 2.0]), "ods_im": ("line_point", [0.0, 0.0])}
    write_record(xr.Dataset({"frequency": ("line", [1.0])}), paths[0])  # no main peak
    place = (1e-4, 4.0)
    assert shapes_of(paths[:1], read_record, [place]) == {}
    write_record(xr.Dataset(shape), paths[1])
    assert shapes_of(paths, read_record, [place])[place].tolist() == [0.5, 1.0]
