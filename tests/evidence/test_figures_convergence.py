"""The figures of the convergence: drawn from a few made-up rows, their tables hold what is
drawn.
"""

import csv
import re

import numpy as np
import pytest

from evidence.validation.convergence.statistics import ENERGY
from evidence.validation.figures import (
    convergence as validation_convergence,
)
from evidence.validation.figures import (
    convergence_runs as validation_convergence_runs,
)
from evidence.validation.figures import (
    convergence_spectra as validation_convergence_spectra,
)
from vibroimpact.reports.figures import drawing
from vibroimpact.reports.figures.style import COLUMNS, shown

NAMES = (
    "validation_convergence_mesh",
    "validation_convergence_contact_points",
    "validation_convergence_step",
    "validation_convergence_statistics_step",
    "validation_convergence_statistics_modes",
    "validation_convergence_spectra",
)


def mesh_rows():
    """Return rows as mesh_rows gives them."""
    return [
        {
            "refined": part,
            "theory": theory,
            "size": 0.5**level,
            "stiffness_N_per_m": 4e6,
            "mode": mode,
            "change": 1e-3 * mode * 0.25**level,
        }
        for part in ("legs", "bend", "both")
        for theory in ("euler_bernoulli", "timoshenko")
        for mode in range(1, 8)
        for level in range(3)
    ]


def point_rows():
    """Return (rows, refinement) as contact_point_rows and refinement_rows give them."""
    sharing = [("equal", n) for n in (1, 2, 3, 5, 9)] + [("trapezoidal", 5), ("layer", 0)]
    rows = [
        {
            "weights": weights,
            "points": points,
            "stiffness_N_per_m": k,
            "first_frequency_Hz": 16.0 + points + k / 1e9,
            "from_layer": 1e-3 * (1 + points),
        }
        for weights, points in sharing
        for k in (1e3, 1e6, 1e9)
    ]
    refined = [
        {
            "weights": weights,
            "points": points,
            "stiffness_N_per_m": k,
            "size": 1 / (points - 1),
            "change": 1e-3 / points,
        }
        for weights in ("equal", "trapezoidal")
        for k in (1e6, 4e6)
        for points in (3, 5, 9)
    ]
    return rows, refined


def run_tables():
    """Return (periods, table) as period_rows and statistics_rows give them."""
    periods = [
        {
            "steps_per_second": rate,
            "mode_Hz": f,
            "omega_step": 6.28 * f / rate,
            "shift": (6.28 * f / rate) ** 2 / 12,
        }
        for rate in (25600, 51200)
        for f in (45.0, 104.0, 400.0)
    ]
    table = []
    for axis, values in (
        ("step", (25600, 51200)),
        ("modes", (2000.0, 7500.0)),
        ("modes_alone", (2000.0,)),
    ):
        for value in values:
            for load in (5.0, 20.0):
                for place, name in enumerate(
                    ("rms_force_N", "band_5_20_dB", "wear_work_rate_W", ENERGY)
                ):
                    finest = axis != "modes_alone" and value == max(values)
                    table.append(
                        {
                            "axis": axis,
                            "value": value,
                            "load_rms_N": load,
                            "statistic": name,
                            "mean": 1e-3 * (place + 1) / value,
                            "scatter": 0.9 if name.startswith("wear") else 0.05,
                            "difference": np.nan if finest else 0.01 * place + 0.01,
                            "standard_error": np.nan if finest else 0.02,
                        }
                    )
    return periods, table


def spectra_rows():
    """Return (averages, leakage, impacts) as their modules give them."""
    averages = [
        {
            "record": record,
            "segment_s": 10.0,
            "overlap": overlap,
            "duration_s": 49.0,
            "window": "hann",
            "frequency_Hz": 16.0,
            "nu_flat": 17.8 + overlap,
            "nu_resonance": 15.0,
            "nu_measured": 16.0 + overlap,
            "standard_error": 0.5,
        }
        for record in ("white noise", "linear tube")
        for overlap in (0.5, 0.65)
    ]
    leakage = [
        {
            "window": window,
            "segment_s": segment,
            "peak_Hz": peak,
            "damping_ratio": 0.002,
            "level_dB": -1.0 / segment,
            "apparent_damping_ratio": 0.002 + 0.01 / segment,
        }
        for window in ("hann", "boxcar")
        for segment in (1.0, 10.0)
        for peak in (16.0, 45.0)
    ]
    impacts = [
        {
            "load_rms_N": load,
            "contact_fraction": 0.1,
            "segment_s": 10.0,
            "width_Hz": width,
            "multiple": 1.0 + width,
            "standard_error": 0.1,
        }
        for load in (0.2, 5.0)
        for width in (0.1, 1.0, 10.0)
    ]
    return averages, leakage, impacts


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Return ({name: Sheet}, folder) of all figures, saved."""
    folder = tmp_path_factory.mktemp("figures")
    periods, table = run_tables()
    plots = [
        *validation_convergence.mesh(mesh_rows()),
        *validation_convergence.contact_points(*point_rows()),
        *validation_convergence_runs.step(periods, table),
        *validation_convergence_runs.both_axes(table),
        *validation_convergence_spectra.spectra(*spectra_rows()),
    ]
    sheets = [*map(drawing.drawn, plots)]
    drawing.save_plots(sheets, folder)
    return {sheet.name: sheet for sheet in sheets}, folder


def test_every_figure_is_there(drawn):
    assert sorted(drawn[0]) == sorted(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_line_in_the_picture_is_in_the_table(drawn, name):
    sheet, folder = drawn[0][name], drawn[1]
    with open(folder / f"{name}.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    compared = 0
    for axes in sheet.figure.axes:
        for line in axes.get_lines():
            place = re.fullmatch(r"rows (\d+):(\d+)", line.get_gid() or "")
            if place is None:
                continue
            mine = rows[int(place[1]) : int(place[2])]
            columns = [
                shown(key, [float(row[key] or "nan") for row in mine])
                for key in rows[0]
                if key in COLUMNS
            ]
            for values in line.get_data():
                assert any(
                    np.allclose(values, column, rtol=1e-6, atol=1e-12) for column in columns
                ), (name, axes.get_label())
            compared += len(mine)
    assert compared > 2 and (folder / f"{name}.txt").read_text(encoding="utf-8").strip().endswith(
        "."
    )


def test_unresolved_values_are_not_drawn(drawn):
    sheet = drawn[0]["validation_convergence_statistics_step"]
    shown_names = {str(name) for _, _, table in sheet.tables for name in table["statistic"]}
    assert shown_names == {"rms_force_N", "band_5_20_dB"}


def test_the_finest_value_has_no_difference_to_draw(drawn):
    curves = {curve for _, curve, _ in drawn[0]["validation_convergence_statistics_modes"].tables}
    assert "free modes kept: 2000 Hz" in curves and "free modes kept: 7500 Hz" not in curves
