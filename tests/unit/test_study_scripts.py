"""The scripts of the study, run in this process: a warning in any of them is an error here."""

import pytest

from tests.tiny_study import TinyStudy, tiny_values


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A tiny study with all its files. Any warning fails here: pytest makes errors of them."""
    study = TinyStudy(tmp_path_factory.mktemp("tiny"), tiny_values())
    study.simulate()
    study.identify()
    study.draw()
    return study


def test_no_script_of_the_study_warns(study):
    logs = list((study.folder / "logs").glob("*.log"))
    assert len(logs) == 13
    assert [log.name for log in logs if "Warning" in log.read_text()] == []
