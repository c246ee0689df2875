"""`make clean STUDY=name` removes one study, and never what was imported."""

import pytest

from workflow.remove_study import remove_study


def folder_with(results, name, *files):
    """A folder of results with empty files."""
    for file in files:
        path = results / name / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    return results / name


def test_a_study_is_removed_and_its_neighbour_stays(tmp_path):
    study = folder_with(tmp_path, "mine", "model.nc", "figures/a.png")
    other = folder_with(tmp_path, "other", "model.nc")
    assert remove_study("mine", tmp_path) == "mine: removed"
    assert not study.exists() and (other / "model.nc").exists()


def test_an_imported_campaign_stays(tmp_path):
    folder = folder_with(tmp_path, "test", "import.txt", "test.nc", "verdict.json", "logs/a.log")
    assert "test.nc stays" in remove_study("test", tmp_path)
    assert sorted(file.name for file in folder.iterdir()) == ["import.txt", "test.nc"]


@pytest.mark.parametrize("name", ["", ".", "..", "../mine", "mine/figures", "absent"])
def test_only_a_folder_of_the_results_is_removed(tmp_path, name):
    study = folder_with(tmp_path, "mine", "figures/a.png")
    with pytest.raises(ValueError, match=r"is not in .*which holds mine"):
        remove_study(name, tmp_path)
    assert (study / "figures" / "a.png").exists()
