"""Files deleted from a finished study are made again by the same command."""

import pytest

from tests.workflow.test_workflow import Study

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A finished study whose scripts write empty files."""
    study = Study(tmp_path_factory.mktemp("study"))
    assert study.snakemake("-j2").returncode == 0
    assert study.plan() == {}
    return study


def test_a_deleted_file_of_a_case_is_planned_again(study):
    for kind, rule in (("spectra", "spectra"), ("estimates", "identify")):
        path = next((study.results / kind).glob("load_4_*"))
        path.rename(study.folder / "aside")
        plan = study.plan()
        (study.folder / "aside").rename(path)
        assert plan[rule] == 1 and not {"basis", "simulate"} & set(plan)
    assert study.plan() == {}


def test_a_deleted_record_is_made_again(study, reliability):
    path = next((study.results / "records").glob("load_4_*"))
    content = path.read_text()
    path.unlink()
    run = study.snakemake("-j2")
    assert run.returncode == 0 and "Simulation at 4 N RMS" in run.stderr + run.stdout
    assert path.read_text() == content and study.plan() == {}
    reliability.fault(
        "a record, spectrum or estimate of a finished study is deleted",
        "the same command makes it again, from what is there",
    )


def test_a_deleted_figure_or_table_is_made_again(study):
    for name in ("consistency.csv", "figures/figure_06_levels.pdf", "index.html"):
        (study.results / name).unlink()
    plan = study.plan()
    assert {"consistency", "figures_response", "study_page", "all"} <= set(plan)
    assert not {"basis", "simulate", "spectra", "identify"} & set(plan)
    assert study.snakemake("-j2").returncode == 0
    assert study.plan() == {}
