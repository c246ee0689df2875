"""The page of a study in a browser: plotly.js draws every plot, the controls change them, nothing
is requested and nothing goes wrong.
"""

import re
from pathlib import Path

import pytest

from tests.support.chromium import needs_chromium, opened, printed
from tests.support.made_up_study import LOADS, MadeUpStudy, rows_of_two_directions
from vibroimpact.config.reading import load_config
from vibroimpact.reduction.reduced_model import build_model

ROOT = Path(__file__).parents[2]
pytestmark = needs_chromium
SCRIPT = """
  const names = JSON.parse(document.getElementById("data").textContent).plots.map((p) => p.name);
  const plot = (name) => document.getElementById("plot-" + name);
  const mean = () => plot("spectrum").data[2].y;
  const peak = () => plot("spectrum").data[2].x[mean().indexOf(Math.max(...mean()))];
  const recommended = () => plot("equivalent_k").data[2].y;
  const set = (name, value) => {
    const input = document.getElementById("control-" + name);
    input.value = value;
    input.dispatchEvent(new Event("input"));
  };
  const found = {layers: {}, widths: {}, boxes: {}};
  for (const name of names) {
    found.layers[name] = plot(name).querySelectorAll("svg.main-svg").length;
    found.widths[name] = plot(name).getBoundingClientRect().width;
  }
  found.marks = plot("equivalent_k").querySelectorAll(".scatterlayer .point").length;
  found.load = document.getElementById("load-shown").textContent;
  found.highest = peak();
  set("load", 0);
  await pause(300);
  found.load_after = document.getElementById("load-shown").textContent;
  found.lowest = peak();
  found.line = plot("equivalent_k").layout.shapes.map((shape) => shape.x0);
  found.first_gap = recommended();
  set("gap", 1);
  await pause(300);
  found.second_gap = recommended();
  const moving = () => plot("shape").data.find((trace) => trace.meta).y[13];
  const before = moving();
  document.getElementById("play").click();
  await pause(1500);
  document.getElementById("play").click();
  found.moved = before - moving();
  if (document.getElementById("control-place")) {
    set("place", 1);
    await pause(300);
    found.second_place = recommended();
  }
  found.overflow = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  found.pictures = [...document.images].map((image) => image.naturalWidth);
  return found;
"""


@pytest.fixture(scope="module")
def model():
    """The reduced model of the smoke study."""
    return build_model(load_config(ROOT / "config" / "smoke.yaml"))


@pytest.fixture(scope="module")
def found(model, tmp_path_factory):
    """What was found on the page of a study with two directions, and its troubles."""
    page = MadeUpStudy(model, rows_of_two_directions()).page()
    return opened(page, SCRIPT, tmp_path_factory.mktemp("browser"))


def test_page_opens_without_an_error_or_a_request(found):
    assert found[1] == []


def test_every_plot_is_drawn(found):
    layers = found[0]["layers"]
    assert len(layers) >= 10 and set(layers.values()) == {3}  # plotly.js draws on three
    assert found[0]["marks"] > 0 and found[0]["pictures"] == [1]


def test_slider_changes_the_spectrum_and_the_marked_load(found):
    values = found[0]
    assert (values["load"], values["load_after"]) == ("10 N RMS", "0.1 N RMS")
    # The peak is at 16 Hz plus the load.
    assert values["highest"] == pytest.approx(26.0, abs=0.3)
    assert values["lowest"] == pytest.approx(16.1, abs=0.3)
    assert values["line"] == [LOADS[0]]


def test_gap_and_direction_change_the_curves(found):
    values = found[0]
    assert values["first_gap"] == [None, 5e4, 5e5]
    assert values["second_gap"] == [None, 2e5, 2e6]
    assert values["second_place"] == [None, 4e5, 4e6]


def test_shape_moves_when_it_is_played(found):
    assert abs(found[0]["moved"]) > 1e-3


def test_page_fits_a_narrow_window(model, tmp_path):
    # Chromium's window is at least 500 px wide: the page is opened in a frame of 400 px, and tells
    # its widths to the page around it.
    tell = """<script>addEventListener("load", () => setTimeout(() => {
      const root = document.documentElement;
      const plots = [...document.querySelectorAll(".plotly svg.main-svg")];
      parent.postMessage({window: root.clientWidth, needed: root.scrollWidth,
        plots: Math.max(...plots.map((plot) => plot.getBoundingClientRect().right))}, "*");
    }, 800));</script></body>"""
    page = MadeUpStudy(model).page().replace("</body>", tell)
    (tmp_path / "inner.html").write_text(page, encoding="utf-8")
    outer = (
        "<!doctype html><html><head></head><body style='margin:0'>"
        "<script>addEventListener('message', (event) => { window.told = event.data; });</script>"
        "<iframe src='inner.html' style='border:0;width:400px;height:900px'></iframe>"
        "</body></html>"
    )
    widths, troubles = opened(outer, "return window.told;", tmp_path)
    assert troubles == [] and 380 <= widths["window"] <= 400
    assert widths["needed"] <= widths["window"] and widths["plots"] <= widths["window"]


def test_page_is_printed_on_a4(model, tmp_path):
    pdf = printed(MadeUpStudy(model).page(), tmp_path)
    boxes = re.findall(rb"/MediaBox \[([\d. ]+)\]", pdf)
    assert len(boxes) > 2
    for box in boxes:
        left, bottom, right, top = map(float, box.split())
        assert (right - left, top - bottom) == pytest.approx((595.3, 841.9), abs=1.0)
