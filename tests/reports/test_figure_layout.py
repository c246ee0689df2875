"""No text of a figure is cut or covers another one, whatever the study; holes are drawn as they
were run.
"""

import numpy as np
import pytest
from matplotlib.figure import Figure

from tests.support import odd_studies
from tests.support.figure_layout import layout_faults
from tests.support.tiny_study import TinyStudy, tiny_values
from vibroimpact.config.reading import check_config
from vibroimpact.config.stage_keys import stage_params
from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reports.figures import drawing
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.study import contact, support_views, tube
from vibroimpact.reports.figures.view import View
from vibroimpact.structure.contact.outline import radial_gap
from vibroimpact.structure.tube import build_structure

STUDIES = {
    "smoke": tiny_values,
    "holes": odd_studies.in_holes,
    "twelve supports": odd_studies.many_supports,
    "y-z plane": odd_studies.in_the_y_z_plane,
    "straight": odd_studies.straight,
    "space": odd_studies.in_space,
}

FAST = ("smoke", "holes")


def settings(values):
    """What the stage of the model's figures gets of a configuration."""
    return StageSettings(stage_params(check_config(values, "odd"), "figures_model"))


def drawn(values):
    """The Sheets {name: Sheet} of the layout, the modes and the contact law."""
    config = settings(values)
    structure = build_structure(config)
    plots = [
        tube.figure_01_layout(config, structure),
        tube.figure_02_free_modes(config, structure),
        contact.figure_03_contact_law(config, structure),
    ]
    return {plot.name: drawing.drawn(plot) for plot in plots}


def curve(sheet, panel, name, *columns):
    """The columns (row,) of a curve of a Sheet, as its CSV has them."""
    rows = [row for row in sheet.rows() if row["panel"] == panel and row["curve"] == name]
    return [np.array([row[column] for row in rows], dtype=float) for column in columns]


def test_checker_sees_texts_that_are_cut_or_covered():
    figure = Figure()
    axes = figure.add_subplot()
    axes.text(0.5, 0.5, "one text")
    assert layout_faults(figure) == []
    axes.text(0.52, 0.5, "another")
    axes.text(0.97, 0.9, "a text that is cut")
    first, second = layout_faults(figure)
    assert first.startswith("'a text that is cut' is cut")
    assert second == "'one text' covers 'another'"


@pytest.mark.parametrize(
    "name",
    [name if name in FAST else pytest.param(name, marks=pytest.mark.slow) for name in STUDIES],
)
def test_figures_of_the_model_have_no_cut_or_covered_text(name):
    faults = {sheet.name: layout_faults(sheet.figure) for sheet in drawn(STUDIES[name]()).values()}
    assert {name: found for name, found in faults.items() if found} == {}


@pytest.mark.slow
@pytest.mark.parametrize(
    "grid",
    [
        {"load_rms_N": [4.0], "gap_m": [1.0e-4], "seeds": 1},
        {
            "load_rms_N": [4.0, 20.0],
            "gap_m": [1e-5, 2e-5, 4e-5, 8e-5, 1.5e-4, 3e-4, 6e-4, 1e-3],
            "seeds": 1,
        },
        {"load_rms_N": {"first": 0.01, "last": 40.0, "count": 40}, "gap_m": [1e-4], "seeds": 1},
    ],
    ids=["one load", "eight gaps", "forty loads"],
)
def test_figures_of_any_grid_have_no_cut_or_covered_text(grid, tmp_path, monkeypatch):
    faults, save = {}, Sheet.save

    def save_and_look(sheet, folder):
        save(sheet, folder)
        faults[sheet.name] = layout_faults(sheet.figure)

    monkeypatch.setattr(Sheet, "save", save_and_look)
    study = TinyStudy(tmp_path, tiny_values(grid=grid))
    study.simulate()
    study.identify()
    study.draw(("response", "identification", "checks"))
    assert len(faults) == 14
    assert {name: found for name, found in faults.items() if found} == {}


def test_holes_are_drawn_with_the_profile_that_was_run():
    values = odd_studies.in_holes()
    config, sheet = settings(values), drawn(values)["figure_01_layout"]
    radius = 0.5 * config.structure.section.outer_diameter_m
    scale = support_views.drawn_scale(config, 1.0e-4)
    for number, support in enumerate(config.supports[:3], start=1):
        x, y = curve(sheet, f"section {number}", "obstacle", "section_e1_m", "section_e2_m")
        gap = radial_gap(support.profile, 1.0e-4, np.arctan2(y, x))
        assert np.hypot(x, y) == pytest.approx(radius + scale * gap, rel=1e-6)
    x, y = curve(sheet, "section 4", "obstacle", "section_e1_m", "section_e2_m")
    assert np.maximum(abs(x), abs(y)) == pytest.approx(radius + scale * 1.0e-4)  # a square


def test_one_sided_stop_is_drawn_on_its_side_only():
    stop = odd_studies.support("stop", [-0.3, 0.0, 0.35], profile=odd_studies.HOLES[5], gap_m=2e-4)
    sheets = drawn(tiny_values(supports=[stop]))
    (walls,) = curve(sheets["figure_01_layout"], "side", "wall", "across_m")
    assert walls == pytest.approx([0.01111 + 10.0 * 2e-4])
    place, force = curve(
        sheets["figure_03_contact_law"],
        "law",
        "contact force",
        "radial_displacement_m",
        "contact_force_N",
    )
    assert force == pytest.approx(4e6 * np.maximum(place - 2e-4, 0.0), abs=1e-3)


@pytest.mark.parametrize(
    ("plane", "towards"),
    [((0, 1, 2), 1), ((0, 2, 1), -1), ((1, 2, 0), 1)],
)
def test_side_of_the_reader_follows_the_right_hand(plane, towards):
    right, up, _ = np.eye(3)[list(plane)]
    assert np.cross(right, up)[plane[2]] == View(*plane).towards == towards


def test_tube_in_the_y_z_plane_is_seen_along_x():
    sheet = drawn(odd_studies.in_the_y_z_plane())["figure_01_layout"]
    across, up = curve(sheet, "front", "centreline", "y_m", "z_m")
    assert np.ptp(across) == pytest.approx(0.6) and up.max() == pytest.approx(1.0, abs=1e-3)
    (front,) = [axes for axes in sheet.figure.axes if axes.get_label() == "front"]
    assert front.get_title("left") == "front view, to scale (x towards the reader)"


def test_free_end_of_a_tube_is_not_drawn_as_held():
    sheet = drawn(odd_studies.straight())["figure_01_layout"]
    (height,) = curve(sheet, "front", "held ends", "z_m")
    assert height.tolist() == [0.0]


def test_mode_that_only_twists_is_not_drawn():
    config = settings(odd_studies.straight())
    frequency, shapes = tube.free_modes(build_structure(config), 2000.0, count=12)
    assert np.all(np.isfinite(shapes)) and len(frequency) < 24
    assert np.abs(shapes).max(axis=(1, 2)) == pytest.approx(1.0)
