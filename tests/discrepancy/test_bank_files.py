"""Which simulations of candidates a run takes from a bank, and that it adds none of its own to
it.
"""

from vibroimpact.discrepancy.dag import screened_files

NAMES = ["gap@all", "cubic_stiffness@left.upper_y", "root_stiffness@roots"]


def test_without_a_bank_every_candidate_is_a_file_of_the_run(tmp_path):
    files = screened_files(NAMES, tmp_path)
    assert [file.stem for file in files] == NAMES and {file.parent for file in files} == {
        tmp_path / "paths"
    }


def test_missing_bank_candidates_are_simulated_in_the_run(tmp_path):
    bank = tmp_path / "bank"
    (bank / "paths").mkdir(parents=True)
    (bank / "paths" / f"{NAMES[1]}.npz").touch()
    files = screened_files(NAMES, tmp_path / "run", bank)
    assert [file.parents[1].name for file in files] == ["run", "bank", "run"] and [
        file.stem for file in files
    ] == NAMES
