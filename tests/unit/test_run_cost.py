"""What a run costs: CPU seconds and simulated records of all its jobs."""

from time import process_time

import pytest

from vibroimpact.run_cost import Meter, count_simulated, job_cost, total_cost
from vibroimpact.verdict.content import Cost


def burn(seconds):
    """Use CPU time."""
    begun = process_time()
    while process_time() < begun + seconds:
        sum(range(1000))


def test_cost_is_summed_over_jobs_and_stages(tmp_path):
    for name, stage, records in (("a", "null", 4), ("b", "null", 5), ("c", "additions", 7)):
        with job_cost(tmp_path / f"{name}.npz", stage):
            count_simulated(records)
            burn(0.03)
    meter = Meter("verdict")
    count_simulated(2)
    burn(0.01)
    made = [tmp_path / f"{name}.npz" for name in "abcd"]  # nothing is beside d
    cost = Cost.from_values(total_cost(made, meter.read()))
    assert {stage: row.simulations for stage, row in cost.by_stage.items()} == {
        "null": 9,
        "additions": 7,
        "verdict": 2,
    }
    assert cost.simulations == 18 and 0.1 <= cost.cpu_seconds < 1.0
    stages = cost.by_stage.values()
    assert cost.cpu_seconds == pytest.approx(sum(row.cpu_seconds for row in stages))


def test_job_that_is_the_process_counts_its_start(tmp_path):
    with job_cost(tmp_path / "a.npz", "null", begun=0.0):
        pass
    whole = total_cost([tmp_path / "a.npz"], Meter("verdict").read())
    assert whole["by_stage"]["null"]["cpu_seconds"] > 0.3  # of the imports of this test


def test_job_that_fails_leaves_no_cost(tmp_path):
    with pytest.raises(ValueError, match="broken"), job_cost(tmp_path / "a.npz", "null"):
        raise ValueError("broken")
    assert list(tmp_path.iterdir()) == []
