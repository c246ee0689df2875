"""`snakemake --report`: every figure and table is in it, with the caption and category that the
page of the study has.
"""

import json
import re

import pytest

from tests.support.chromium import needs_chromium, opened
from tests.workflow.test_workflow import ROOT, Study
from vibroimpact.reports.captions import CATEGORIES, read_caption

pytestmark = pytest.mark.slow
SCRIPT = """
  const texts = (selector) => [...document.querySelectorAll(selector)].map((e) => e.textContent);
  const find = (text) => [...document.querySelectorAll("#app a")].find(
    (link) => link.textContent.trim() === text);
  const found = {categories: texts("#app a").map((text) => text.trim())};
  find("Equivalent support").click();
  await pause(800);
  found.shown = texts("#app td, #app th").map((text) => text.trim());
  return found;
"""


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """The report of a complete study whose scripts wrote their names, as HTML text."""
    study = Study(tmp_path_factory.mktemp("report"))
    for arguments in (("-j2",), ("--report", "report.html")):
        run = study.snakemake(*arguments)
        assert run.returncode == 0, run.stdout + run.stderr
    return (study.folder / "report.html").read_text(encoding="utf-8")


def results_of(report):
    """{path: what is said of it} of the results of a report."""
    start = re.search(r"\bresults = (?=\{\")", report)
    assert start, "the report holds its results as a script variable"
    return json.JSONDecoder().raw_decode(report, start.end())[0]


def test_report_has_every_figure_and_table_with_its_caption(report):
    results = results_of(report)
    names = {path.rsplit("/", 1)[-1] for path in results}
    assert {"consistency.csv", "consistency_summary.csv", "basis_quality.csv"} <= names
    assert len([name for name in names if name.endswith(".png")]) == 19
    for path, result in results.items():
        stem, suffix = path.rsplit("/", 1)[-1].rsplit(".", 1)
        table = (ROOT / "workflow" / "report" / f"{stem}_table.rst").is_file() and suffix == "csv"
        caption = read_caption(ROOT / "workflow/report" / f"{stem}{'_table' * table}.rst")
        said = " ".join(re.sub(r"<!--.*?-->|<[^>]+>", "", result["caption"]).split())
        assert said == caption.text and result["labels"]["shows"] == caption.title


@needs_chromium
def test_report_opens_with_its_categories_in_a_browser(report, tmp_path):
    found, troubles = opened(report, SCRIPT, tmp_path)
    assert set(CATEGORIES) <= set(found["categories"])
    assert "Equivalent stiffness and damping by every method" in found["shown"]
    assert [trouble for trouble in troubles if trouble.startswith(("error", "promise"))] == []
