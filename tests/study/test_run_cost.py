"""What a run costs: records and time steps, counted over all threads."""

from concurrent.futures import ThreadPoolExecutor

from vibroimpact.diagnosis.run_cost import SIMULATED, count_simulated


def test_records_of_all_threads_are_counted():
    before = dict(SIMULATED)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda number: count_simulated(2, 10), range(50)))
    assert SIMULATED["records"] - before["records"] == 100
    assert SIMULATED["steps"] - before["steps"] == 500
