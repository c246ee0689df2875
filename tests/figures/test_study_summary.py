"""The summary of a study on two pages: nothing is clipped or written over, its numbers are those of
the study.
"""

from itertools import combinations
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from tests.support.made_up_study import MadeUpStudy, equivalent_rows
from vibroimpact.config.reading import load_config
from vibroimpact.figures.printed_page import RIGHT_PT, height_pt, width_pt, wrapped
from vibroimpact.figures.study_summary import study_summary, summary_pages
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.study_tables import Table

ROOT = Path(__file__).parents[2]
FINE = 4.0


@pytest.fixture(scope="module")
def model():
    """The reduced model of the smoke study."""
    return build_model(load_config(ROOT / "config" / "smoke.yaml"))


def contents(model):
    """{kind: StudyContent}: one group of supports, two directions with long reasons, and a study
    without identification.
    """
    plain, long = MadeUpStudy(model).content, equivalent_rows()
    for row in long:
        row["group"] = f"anti-vibration bars {row['direction']}"
        if row["reason_k"]:
            row["reason_k"] += ": the tube is touched too rarely for any method to see" * 3
    without = type(plain)(plain.config, [], plain.statistics, plain.limits, plain.provenance)
    return {
        "plain": plain,
        "two directions": MadeUpStudy(model, long).content,
        "without identification": without,
    }


def boxes(page):
    """(text, left, bottom, right, top) of the texts of a page, in points."""
    canvas = FigureCanvasAgg(page.figure)
    page.figure.set_dpi(72.0 * FINE)  # the hinting of letters widens texts at low resolution
    canvas.draw()
    artists = [*page.figure.texts]
    for axes in page.figure.axes:
        artists += [axes.xaxis.label, axes.yaxis.label]
    for legend in page.figure.legends:
        artists += legend.get_texts()
    renderer = canvas.get_renderer()
    return [
        (artist.get_text(), *(artist.get_window_extent(renderer).extents / FINE))
        for artist in artists
        if artist.get_text()
    ]


@pytest.mark.parametrize("kind", ["plain", "two directions", "without identification"])
def test_texts_are_on_the_page_and_not_on_one_another(model, kind):
    pages = summary_pages(contents(model)[kind])
    assert len(pages) == 2
    for page in pages:
        found = boxes(page)
        assert len(found) > 20
        for text, left, bottom, right, top in found:
            assert left > 20 and bottom > 20 and right < RIGHT_PT + 4 and top < 822, text
        for (one, *a), (other, *b) in combinations(found, 2):
            across = min(a[2], b[2]) - max(a[0], b[0])
            along = min(a[3], b[3]) - max(a[1], b[1])
            assert across < 1.0 or along < 2.5, (one, other)


def test_numbers_of_the_summary_are_those_of_the_study(model):
    first, second = summary_pages(MadeUpStudy(model).content)
    told = [text for text, *_ in boxes(first)]
    for value in ("500", "428 to 578", "750", "over 25 % apart", "not resolved"):
        assert value in told
    below = [text for text, *_ in boxes(second)]
    for value in ("405", "250", "root start", "yes", "c: over 25 % apart", "0a1b"):
        assert value in below
    # All three loads fit: at 1 N the largest force on the left is 40 and 50 N, at both gaps.
    assert below.count("45") == 2


def test_pdf_has_two_pages_of_a4(model, tmp_path):
    study_summary(MadeUpStudy(model).content, tmp_path / "summary.pdf")
    data = (tmp_path / "summary.pdf").read_bytes()
    assert data.startswith(b"%PDF") and b"/Count 2" in data
    assert b"/MediaBox [ 0 0 595.3 841.9 ]" in data
    assert list(tmp_path.iterdir()) == [tmp_path / "summary.pdf"]


def test_wrapped_lines_hold_every_word_and_fit():
    words = " ".join(f"word{number}" for number in range(40))
    lines = wrapped(words, 9.0, 150.0)
    assert " ".join(lines) == words and len(lines) > 5
    assert max(width_pt(line, 9.0) for line in lines) <= 150.0


def test_height_of_a_table_grows_with_its_wrapped_cells():
    plain = Table(("a", "why"), [("1", "short")])
    long = Table(("a", "why"), [("1", "long " * 200)])
    assert height_pt(long) > height_pt(plain) + 50.0
