"""A plot as data: matplotlib and plotly draw the same numbers of it, in the units of its axes."""

import numpy as np
import pytest

from vibroimpact.reports.figures.drawing import drawn
from vibroimpact.reports.figures.interactive.page_plot import Control, PagePlot, numbers
from vibroimpact.reports.figures.plot import Axis, Bars, Mark, Panel, Plot, Series, Span, extent

LOADS, STRESS = [0.5, 1.0, 4.0], [1.0e6, 0.0, 9.0e6]


def stress_panel(log=False):
    """A Panel of a stress with its range, a limit and a shaded range of loads."""
    ends = {"low": [0.5e6, 0.0, 8.0e6], "high": [2.0e6, 0.0, 9.5e6]}
    items = [
        Series("peak", LOADS, STRESS, {"gap_m": 1e-4}, label="peak", marker="o", **ends),
        Mark("limit", "y", 5.0e6, line="--"),
        Span("x", 1.0, 2.0, "#D9D9D9"),
    ]
    return Panel(Axis("load_rms_N", True, 0.1, 10.0), Axis("stress_Pa", log), items)


def traces(panel):
    """The traces and the layout that plotly.js gets of a panel."""
    page = PagePlot("stress", "Stress", "A caption.", {(): panel}).drawn()
    return page["frames"][""], page["layout"]


def test_both_draw_the_same_numbers():
    panel = stress_panel()
    sheet = drawn(Plot("stress", "Stress", "A caption.", {"main": panel}))
    (curve, limit), layout = traces(panel)
    line, *_ = sheet.axes["main"].containers[0]
    assert line.get_xdata().tolist() == curve["x"] == LOADS
    assert line.get_ydata().tolist() == curve["y"] == [1.0, 0.0, 9.0]  # MPa
    assert (curve["error_y"]["array"], curve["error_y"]["arrayminus"]) == (
        [1.0, 0.0, 0.5],
        [0.5, 0.0, 1.0],
    )
    assert limit["y"] == [5.0, 5.0] and limit["x"] == [0.1, 10.0]
    assert sheet.axes["main"].get_xlim() == pytest.approx((0.1, 10.0))
    assert layout["xaxis"]["range"] == [-1.0, 1.0]  # decades
    assert [(shape["x0"], shape["x1"]) for shape in layout["shapes"]] == [(1.0, 2.0)]
    label = sheet.axes["main"].get_ylabel()
    assert label == layout["yaxis"]["title"]["text"] == "Bending stress (MPa)"


def test_table_has_si_units_and_leaves_out_spans():
    rows = drawn(Plot("stress", "Stress", "A caption.", {"main": stress_panel()})).rows()
    assert [row["curve"] for row in rows] == ["peak"] * 3 + ["limit"]
    assert [row["stress_Pa"] for row in rows] == [*STRESS, 5.0e6]
    assert [row["gap_m"] for row in rows] == [1e-4] * 3 + [""]


def test_a_logarithmic_axis_leaves_out_zero():
    (curve, _), layout = traces(stress_panel(log=True))
    assert curve["y"] == [1.0, None, 9.0] and layout["yaxis"]["type"] == "log"


def test_bars_stand_at_their_names():
    bars = Bars("rms", [0, 1], [2.0e6, 3.0e6], label="RMS")
    upright = Panel(Axis("section", names=["root", "apex"]), Axis("stress_Pa"), [bars])
    (trace,), layout = traces(upright)
    assert trace["x"] == ["root", "apex"] and trace["y"] == [2.0, 3.0]
    assert layout["xaxis"]["type"] == "category"
    across = Panel(Axis("stress_Pa"), Axis("section", names=["root", "apex"]), [bars])
    axes = drawn(Plot("bars", "Bars", "A caption.", {"main": across})).axes["main"]
    assert [bar.get_width() for bar in axes.patches] == [2.0, 3.0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["root", "apex"]


def test_a_panel_without_curves_says_why():
    empty = Panel(Axis("load_rms_N"), Axis("stress_Pa"), [], note="no contact")
    sheet = drawn(Plot("empty", "Empty", "A caption.", {"main": empty}))
    assert [text.get_text() for text in sheet.axes["main"].texts] == ["no contact"]
    assert sheet.tables == [] and not PagePlot("a", "A", "B.", {(): empty}).has_traces()


def test_long_x_values_are_written_once_for_all_frames():
    frequency = np.linspace(1.0, 2.0, 50)
    axes = Axis("frequency_Hz"), Axis("psd_m2_per_Hz", True)
    frames = {
        (scale,): Panel(*axes, [Series("psd", frequency, scale * frequency)])
        for scale in (1.0, 2.0)
    }
    control = Control("load", "Load", ["1", "2"], [1.0, 2.0])
    page = PagePlot("psd", "PSD", "A caption.", frames, ("load",)).drawn([control])
    (name,) = page["shared"]
    assert page["shared"][name] == numbers(frequency)
    assert {trace["x"] for found in page["frames"].values() for trace in found} == {f"@{name}"}


def test_extent_holds_the_values_with_a_margin():
    assert extent([1.0, np.nan, 3.0]) == pytest.approx((0.9, 3.1))
    assert extent([0.0, 1.0, 100.0], log=True) == pytest.approx((10**-0.1, 10**2.1))
    low, high = extent([5.0], log=True)
    assert low < 5.0 < high and extent([]) == (-1.0, 1.0)
