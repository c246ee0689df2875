"""A structure given by matrices: an edit of a matrix reruns what was computed from it."""

import re

import numpy as np
import pytest
import yaml

from tests.support.snakemake_runs import RULES, told_by

BENCH = {
    "study": "bench",
    "structure": {
        "kind": "matrices",
        "mass": "bench/mass.npz",
        "stiffness": "bench/stiffness.npz",
        "points": {"tip": {"x": 0}},
    },
    "excitation": {"kind": "none"},
    "initial": {"displacement_m": {"tip": {"x": 1.0e-3}}},
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    "record": {"duration_s": 2.0, "sensors": {"points": ["tip"], "directions": ["x"]}},
}


def snakemake(folder, *arguments):
    """The output of snakemake with the configuration of a folder."""
    return told_by(folder, *RULES, *arguments, "--configfile", "bench.yaml")


def planned(output):
    """The rules of the table that a dry run prints; rules of batches count as one."""
    rules = re.findall(r"^(_?[a-z][\w.]+) +\d+$", output, flags=re.M)
    return {rule.split("_from_")[0] for rule in rules} - {"total"}


@pytest.mark.slow
def test_an_edited_matrix_reruns_the_model_and_what_follows(tmp_path):
    (tmp_path / "bench").mkdir()
    np.savez(tmp_path / "bench" / "mass.npz", mass=np.eye(1))
    np.savez(tmp_path / "bench" / "stiffness.npz", stiffness=np.array([[1.0e4]]))
    (tmp_path / "bench.yaml").write_text(yaml.safe_dump(BENCH))
    snakemake(tmp_path, "-j1")
    assert planned(snakemake(tmp_path, "--dry-run")) == set()
    np.savez(tmp_path / "bench" / "stiffness.npz", stiffness=np.array([[2.0e4]]))
    assert planned(snakemake(tmp_path, "--dry-run")) == {
        "_basis",
        "_simulate",
        "_statistics",
        "_study_page",
        "all",
    }
