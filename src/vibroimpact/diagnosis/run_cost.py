"""The cost of a run: the simulated records and time steps of this process, counted."""

from threading import Lock

# {"records": number of records that this process has simulated, "steps": time steps of
# their modes, known of the records of a search alone}
SIMULATED = {"records": 0, "steps": 0}
COUNTING = Lock()


def count_simulated(records: int, steps: int = 0) -> None:
    """Add to the numbers of simulated records and of time steps of their modes."""
    with COUNTING:
        SIMULATED["records"] += records
        SIMULATED["steps"] += steps
