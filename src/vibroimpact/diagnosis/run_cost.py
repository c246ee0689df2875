"""The cost of a run: CPU time and simulated records of its stages."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock
from time import process_time
from typing import Any

SIMULATED = {"records": 0}  # number of records that this process has simulated
COUNTING = Lock()


def count_simulated(records: int) -> None:
    """Add to the number of simulated records."""
    with COUNTING:
        SIMULATED["records"] += records


class StageCosts:
    """The cost of stages, added to by `with costs(name):`."""

    def __init__(self) -> None:
        self.stages: dict[str, dict[str, Any]] = {}

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Add the cost of a `with` block under a name."""
        start, records = process_time(), SIMULATED["records"]
        try:
            yield
        finally:
            stage = self.stages.setdefault(name, {"cpu_seconds": 0.0, "simulations": 0})
            stage["cpu_seconds"] += process_time() - start
            stage["simulations"] += SIMULATED["records"] - records

    def total(self) -> dict[str, Any]:
        """Return the `cost` of verdict.json."""
        stages = self.stages.values()
        return {
            "cpu_seconds": float(sum(stage["cpu_seconds"] for stage in stages)),
            "simulations": sum(stage["simulations"] for stage in stages),
            "by_stage": self.stages,
        }
