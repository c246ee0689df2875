"""The count of what a run simulates."""

from concurrent.futures import ThreadPoolExecutor

from vibroimpact.diagnosis.run_cost import SIMULATED, StageCosts, count_simulated


def test_records_of_all_threads_are_counted():
    before = SIMULATED["records"]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda number: count_simulated(2), range(50)))
    assert SIMULATED["records"] - before == 100


def test_a_stage_that_comes_again_adds_to_its_cost():
    costs = StageCosts()
    for name, records in (("search", 3), ("floor", 4), ("search", 5)):
        with costs(name):
            count_simulated(records)
    total = costs.total()
    assert {name: stage["simulations"] for name, stage in total["by_stage"].items()} == {
        "search": 8,
        "floor": 4,
    }
    assert total["simulations"] == 12 and total["cpu_seconds"] >= 0.0
