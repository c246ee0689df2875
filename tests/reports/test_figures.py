"""The figures: the data beside each picture are the data in it, axes say what they are and in what
unit, and known numbers come out.
"""

import ast
import csv
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from vibroimpact.campaign.file import read_campaign, write_campaign
from vibroimpact.config.reading import load_config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.identify.estimate import table_rows
from vibroimpact.identify.identify_case import identify_case
from vibroimpact.reduction.basis_accuracy import basis_frequency_errors
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.figures.drawing import drawn, save_plots
from vibroimpact.reports.figures.plot import Axis, Panel, Plot
from vibroimpact.reports.figures.sheet import Sheet, rounded
from vibroimpact.reports.figures.study import (
    basis,
    broadband,
    checks,
    contact,
    equivalent,
    overlay,
    poles,
    psd_table,
    response,
    shapes,
    tube,
)
from vibroimpact.reports.figures.study import (
    seed_scatter as scatter,
)
from vibroimpact.reports.figures.study.cases_of_gap import (
    shown_gap,
    spread_loads,
    transition_load,
)
from vibroimpact.reports.figures.style import COLUMNS, label_of, shown
from vibroimpact.reports.study_statistics import StudyStatistics
from vibroimpact.structure.tube import build_structure
from vibroimpact.study.case_spectra import case_spectra
from vibroimpact.study.cases import all_cases, case_from_id, nearest_loads
from vibroimpact.study.simulation import simulate_cases
from vibroimpact.study.statistics_table import statistics_rows
from vibroimpact.study.synthetic_campaign import synthetic_campaign

ROOT = Path(__file__).parents[2]
UNIT = re.compile(r"\(.+\)$")
SMALL = {
    "basis": {"free_modes_to_Hz": 1000.0, "constrained_modes_to_Hz": 500.0},
    "integration": {"steps_per_second": 20480, "start_up_s": 1.0},
    "grid": {"load_rms_N": [0.1, 4.0, 15.0], "gap_m": [2.8886e-4, 5.1106e-5], "seeds": 1},
}


@pytest.fixture(scope="module")
def config():
    """The smoke configuration, smaller."""
    whole = load_config(ROOT / "config" / "smoke.yaml", SMALL)
    return whole.model_copy(update={"record": whole.record.model_copy(update={"duration_s": 12.0})})


@pytest.fixture(scope="module")
def study(config):
    """Model, and {Case: Dataset} of records, spectra and curves, and the rows of the table, of a
    study of six short cases.
    """
    model, found = build_model(config), {"records": {}, "spectra": {}, "curves": {}}
    rows = []
    for case, record in simulate_cases(config, model, all_cases(config.grid)):
        spectra = case_spectra(config, record)
        estimates, curves = identify_case(config, model, record, spectra)
        rows += table_rows(estimates, record.attrs)
        for name, dataset in (("records", record), ("spectra", spectra), ("curves", curves)):
            found[name][case] = dataset
    return model, found, rows


@pytest.fixture(scope="module")
def sheets(config, study, tmp_path_factory):
    """Every Sheet, drawn with the configuration that its stage is given, and saved; {name: Sheet}
    and the folder.
    """
    folder = tmp_path_factory.mktemp("figures")
    model, found, rows = study
    of_gap = {
        name: {
            case: dataset for case, dataset in datasets.items() if case.gap_m == shown_gap(config)
        }
        for name, datasets in found.items()
    }
    gap_rows = [row for row in rows if row["gap_m"] == shown_gap(config)]
    parts = {
        stage: StageSettings(stage_params(config, stage))
        for stage in (
            "figures_model",
            "figures_response",
            "figures_identification",
            "figures_checks",
            "synthetic_campaign",
        )
    }
    write_campaign(
        synthetic_campaign(
            parts["synthetic_campaign"],
            model,
            nearest_loads(config.grid, config.overlay.load_rms_N),
        ),
        folder / "campaign.nc",
    )
    part, structure = parts["figures_model"], build_structure(parts["figures_model"])
    plots = [
        tube.figure_01_layout(part, structure),
        tube.figure_02_free_modes(part, structure),
        contact.figure_03_contact_law(part, structure),
        contact.figure_04_first_frequency(part),
        basis.basis_quality(part, basis_frequency_errors(config)),
    ]
    part = parts["figures_response"]
    responses = psd_table.gather(part, model, found["spectra"].values())
    campaign = read_campaign(folder / "campaign.nc")
    plots += [
        overlay.figure_05_overlay(part, model, responses, campaign),
        response.figure_06_levels(part, model, responses),
        response.figure_07_overlay_of_loads(part, model, responses),
        response.figure_08_load_and_stiffness(part, model, responses),
        response.in_plane_share(part, responses),
    ]
    part, files = parts["figures_identification"], (of_gap["curves"], of_gap["spectra"])
    plots += figures_identification(part, model, *files, gap_rows)
    part = parts["figures_checks"]
    plots += [
        equivalent.figure_13_equivalent_support(part, model, rows),
        equivalent.collapse(part, model, rows),
        checks.energy_balance(part, *statistics_of(found["records"])),
        checks.contact_statistics(part, model, statistics_of(found["records"])[0]),
    ]
    found = [*map(drawn, plots)]
    save_plots(found, folder)
    return {sheet.name: sheet for sheet in found}, folder


def statistics_of(records):
    """The StudyStatistics of {Case: Dataset}, and the record whose energies are drawn."""
    rows = [row for record in records.values() for row in statistics_rows(record)]
    file = checks.file_of_energies([f"{case.id}.nc" for case in records])
    return StudyStatistics([*records], rows), records[case_from_id(Path(file).stem)]


def figures_identification(config, model, curves, spectra, rows):
    """The Plots of the identifications."""
    return [
        poles.figure_09_poles(config, model, curves, spectra, rows),
        poles.figure_09_stabilisation(config, curves, spectra, rows),
        shapes.figure_10_shapes(config, model, curves, rows),
        shapes.figure_11_singular_values(config, curves),
        broadband.figure_12_broadband(config, model, curves, spectra, rows),
    ]


def declared():
    """The names of FIGURES in workflow/rules/study_files.smk."""
    text = (ROOT / "workflow" / "rules" / "study_files.smk").read_text()
    groups = ast.literal_eval(re.search(r"^FIGURES = (\{.*?^\})", text, flags=re.M | re.S)[1])
    return [name for names in groups.values() for name in names]


def table(folder, name):
    """The rows of the CSV of a figure, texts."""
    with open(folder / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def column(rows, name):
    """The values (row,) of a column; NaN where the cell is empty."""
    return np.array([float(row[name]) if row[name] else np.nan for row in rows])


def test_every_declared_figure_is_drawn(sheets):
    assert sorted(sheets[0]) == sorted(declared())
    assert {int(name[7:9]) for name in declared() if name.startswith("figure_")} == set(
        range(1, 14)
    )


@pytest.mark.parametrize("name", declared())
def test_a_figure_is_a_picture_a_page_a_table_and_a_caption(sheets, name):
    _, folder = sheets
    assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG") and (
        folder / f"{name}.png"
    ).stat().st_size > 20_000
    assert (folder / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert len(table(folder, name)) > 2
    assert (folder / f"{name}.txt").read_text(encoding="utf-8").strip().endswith(".")
    assert not [file for file in folder.iterdir() if file.name.startswith(".")]


@pytest.mark.parametrize("name", declared())
def test_axes_name_their_quantities_and_units(sheets, name):
    sheet = sheets[0][name]
    assert sheet.figure.get_suptitle()
    for axes in sheet.figure.axes:
        inner = axes.get_subplotspec() is not None and sheet.axes.get(axes.get_label()) is axes
        labels = [axes.get_xlabel(), axes.get_ylabel()]
        if not inner:  # a colour bar, or a second scale: its y axis
            labels = labels[1:]
        for text in labels:  # an inner panel may leave an axis to its neighbour
            assert UNIT.search(text) or (inner and not text), (
                f"{name}, {axes.get_label()}: '{text}'"
            )
    for side in ("get_xlabel", "get_ylabel"):
        assert any(UNIT.search(getattr(axes, side)()) for axes in sheet.axes.values())


@pytest.mark.parametrize("name", declared())
def test_the_table_holds_what_is_plotted(sheets, name):
    """Every line and map in the picture has its rows in the CSV, with the same values in the unit
    of the axes after the declared factor.
    """
    sheet, folder = sheets[0][name], sheets[1]
    rows = table(folder, name)
    compared = 0
    for axes in sheet.figure.axes:
        for artist in [*axes.get_lines(), *axes.collections]:
            place = re.fullmatch(r"rows (\d+):(\d+)", artist.get_gid() or "")
            if place is None:
                continue
            mine = rows[int(place[1]) : int(place[2])]
            assert {row["panel"] for row in mine} <= {axes.get_label()}
            drawn = (
                artist.get_data() if hasattr(artist, "get_data") else [np.ravel(artist.get_array())]
            )
            for values in drawn:
                assert holds(mine, np.asarray(values, dtype=float)), (
                    f"{name}, panel {axes.get_label()}: {artist} is not in the table"
                )
            compared += len(mine)
    assert compared > 2


def holds(rows, values):
    """Whether some declared column of the rows, in the unit of its axis, holds these values
    (row,).
    """
    if not rows:
        return values.size == 0
    columns = [shown(name, column(rows, name)) for name in rows[0] if name in COLUMNS]
    return any(np.allclose(found, values, rtol=1e-6, atol=0.0, equal_nan=True) for found in columns)


def test_table_rounds_numbers_and_keeps_text():
    assert rounded([1.23456789, -9.87654321e-13, 0.0, 4.0e6]) == [
        1.234568,
        -9.876543e-13,
        0.0,
        4.0e6,
    ]
    assert (
        np.isnan(rounded([np.nan, 1.0])[0])
        and rounded(np.array([3, 4])) == [3, 4]
        and rounded(["a"]) == ["a"]
    )


def test_columns_of_different_lengths_are_refused():
    sheet = Sheet("wrong", "wrong", "wrong.")
    with pytest.raises(ValueError, match="wrong, curve: columns of different lengths"):
        sheet.record(
            sheet.axes["main"], "curve", load_rms_N=[1.0, 2.0], frequency_Hz=[1.0, 2.0, 3.0]
        )
    with pytest.raises(KeyError):
        sheet.line(sheet.axes["main"], ("no_such_column", [1.0]), ("frequency_Hz", [1.0]), "curve")


def test_every_column_has_a_label_with_its_unit():
    assert [label_of(name) for name in COLUMNS if not UNIT.search(label_of(name))] == []


def test_free_modes_are_those_of_the_testbed(study_config):
    # Two independent codes agreeing: k = 1 N/m, Timoshenko, 80 elements in the bend.
    frequency, shapes_found = tube.free_modes(build_structure(study_config), 7500.0)
    np.testing.assert_allclose(frequency, [15.97, 28.96, 45.03, 104.45, 104.68, 171.12], rtol=1e-3)
    across = np.sum(shapes_found[:, :, 1] ** 2, axis=1) > np.sum(
        shapes_found[:, :, 0] ** 2 + shapes_found[:, :, 2] ** 2, axis=1
    )
    assert across.tolist() == [True, False, True, False, True, True]


def test_the_secant_stiffness_is_force_over_displacement(sheets):
    rows = [
        row for row in table(sheets[1], "figure_03_contact_law") if row["curve"] == "contact force"
    ]
    displacement, force = column(rows, "radial_displacement_m"), column(rows, "contact_force_N")
    gap = 2.8886e-4
    np.testing.assert_allclose(
        force,
        np.sign(displacement) * 4.0e6 * np.maximum(np.abs(displacement) - gap, 0.0),
        rtol=1e-5,
        atol=1e-3,
    )
    moved = displacement != 0.0
    np.testing.assert_allclose(
        column(rows, "secant_stiffness_N_per_m")[moved],
        force[moved] / displacement[moved],
        rtol=1e-5,
        atol=1.0,
    )


def test_below_contact_the_response_is_the_linear_one(sheets):
    """Figure 7: at 0.1 N nothing touches, and the PSD over load² scatters about the dashed line of
    the free tube.
    """
    rows = table(sheets[1], "figure_07_overlay_of_loads")
    psd = "psd_per_load2_m2_per_N2_per_Hz"
    measured = [
        row for row in rows if row["curve"] == "non-linear" and float(row["load_rms_N"]) == 0.1
    ]
    linear = [row for row in rows if row["curve"] == "linear" and float(row["k_N_per_m"]) == 1.0]
    frequency = column(measured, "frequency_Hz")
    np.testing.assert_array_equal(frequency, column(linear, "frequency_Hz"))
    flat = (frequency > 50.0) & (frequency < 95.0)  # no peak: the window leaks nothing
    ratio = column(measured, psd)[flat] / column(linear, psd)[flat]
    assert np.mean(ratio) == pytest.approx(1.0, abs=4.0 * np.std(ratio) / np.sqrt(0.5 * ratio.size))


def test_the_in_plane_share_is_a_ratio_of_mean_squares():
    frequency = np.arange(11.0)
    psd = np.zeros((4, 11))
    psd[:, 3] = [0.02, 2.0, 5.0, 5.0]
    dataset = xr.Dataset(
        {"psd_displacement_mean": (("sensor", "frequency"), psd)},
        {"sensor": ["apex.x", "apex.y", "leg.x", "leg.y"], "frequency": frequency},
        {"gap_m": 1e-4, "load_rms_N": 2.0, "seed": 3},
    )
    share = psd_table._in_plane_share(dataset, "y")
    assert [(row["point"], row["seed"]) for row in share] == [("apex", 3), ("leg", 3)]
    np.testing.assert_allclose(
        [row["in_plane_share_dB"] for row in share], [-20.0, 0.0], atol=1e-12
    )


def test_bars_span_the_resolved_seeds():
    rows = [{"load_rms_N": 1.0, "k_N_per_m": k} for k in (3.0, 1.0, 2.0, np.nan)] + [
        {"load_rms_N": 2.0, "k_N_per_m": np.nan}
    ]
    items = scatter.over_seeds(rows, "load_rms_N", "k_N_per_m", "lscf")
    panel = Panel(Axis("load_rms_N"), Axis("k_N_per_m"), items)
    (row,) = drawn(Plot("bars", "bars", "bars.", {"main": panel})).rows()
    assert (
        row["load_rms_N"],
        row["k_N_per_m"],
        row["k_N_per_m_low"],
        row["k_N_per_m_high"],
        row["values"],
    ) == (1.0, 2.0, 1.0, 3.0, 3)
    assert scatter.over_seeds(rows[-1:], "load_rms_N", "k_N_per_m", "ods") == []


def test_shown_loads_are_spread_along_the_peak_shift():
    rows = [
        {"method": "lscf", "load_rms_N": load, "frequency_Hz": frequency, "damping_ratio": ratio}
        for load, frequency, ratio in (
            (0.1, 16.0, 0.015),
            (0.2, 16.0, 0.015),
            (1.0, 16.1, 0.02),
            (2.0, 19.0, 0.06),
            (5.0, 23.0, 0.03),
        )
    ]
    assert spread_loads(rows, 3) == [0.1, 2.0, 5.0]
    assert transition_load(rows) == 2.0
    assert (
        transition_load([{**row, "frequency_Hz": np.nan, "damping_ratio": np.nan} for row in rows])
        == 5.0
    )


def test_overlay_uses_the_nearest_gap_in_order_of_load():
    campaign = xr.Dataset(
        {
            "load_rms": ("record", [10.0, 0.5, 3.0, 10.0, 1.0]),
            "gap": ("record", [3e-4, 3e-4, 3e-4, 2e-4, np.nan]),
        }
    )
    assert overlay._shown_records(campaign.isel(record=slice(0, 4)), 2.9e-4) == [1, 2, 0]
    assert overlay._shown_records(campaign.isel(record=slice(0, 4)), 1.0e-4) == [3]


def test_unresolved_study_still_has_its_figures(config, study):
    model, found, rows = study
    unresolved = [
        {
            **row,
            **dict.fromkeys(("k_N_per_m", "c_N_s_per_m", "frequency_Hz", "damping_ratio"), np.nan),
            "quality": "unresolved",
        }
        for row in rows
    ]
    bare = {
        case: dataset.drop_vars(
            [name for name in dataset.data_vars if not name.startswith(("peak", "map"))]
        )
        for case, dataset in found["curves"].items()
    }
    empty = {
        case: dataset.assign(peak_curve=dataset["peak_curve"] * np.nan)
        for case, dataset in bare.items()
    }
    plots = [
        equivalent.figure_13_equivalent_support(config, model, unresolved),
        equivalent.collapse(config, model, unresolved),
        *figures_identification(config, model, empty, found["spectra"], unresolved),
    ]
    for plot in plots:
        assert drawn(plot).figure.axes


def test_a_missed_peak_is_told_by_its_factor():
    frequency = np.linspace(5.0, 99.0, 800)

    def spectrum(second):
        peaks = [
            1.0 / ((1.0 - (frequency / f) ** 2) ** 2 + (0.1 * frequency / f) ** 2)
            for f in (21.0, 55.0)
        ]
        return peaks[0] + second * peaks[1]

    assert broadband.peak_factor(spectrum(0.1), spectrum(0.1)) == 1.0
    assert broadband.peak_factor(spectrum(0.2), spectrum(0.1)) == pytest.approx(2.0, rel=0.03)
    assert broadband.peak_factor(spectrum(0.1), spectrum(0.3)) == pytest.approx(3.0, rel=0.03)
    assert broadband.peak_factor(np.ones(800), np.ones(800)) == 1.0


def test_the_chart_shows_the_main_peak_and_its_pole(sheets, config):
    axes = next(iter(sheets[0]["figure_09_stabilisation"].axes.values()))
    found = re.search(r"([\d.]+) Hz, stable in (\d+) of (\d+) orders", axes.get_title(loc="left"))
    low, high = config.identification.peak_search_Hz
    assert low <= axes.get_xlim()[0] < float(found[1]) < axes.get_xlim()[1] <= high
    assert axes.get_xlim()[1] < 45.0  # of the free tube's second mode
    assert 0 < int(found[2]) <= int(found[3])
