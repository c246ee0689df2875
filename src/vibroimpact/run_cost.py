"""The cost of a run: each job writes its CPU seconds and number of simulated records to a file
beside its output, and the last job adds them up.
"""

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from time import process_time
from typing import Any

from vibroimpact.records import read_json, write_text

# {"records": number of records that this process has simulated, "steps": time steps of
# their modes, known of the records of a search alone}
SIMULATED = {"records": 0, "steps": 0}
COUNTING = Lock()


def count_simulated(records: int, steps: int = 0) -> None:
    """Add to the numbers of simulated records and of time steps of their modes."""
    with COUNTING:
        SIMULATED["records"] += records
        SIMULATED["steps"] += steps


class Meter:
    """The cost of a job from its start, in a process that may run several jobs in turn.

    stage: of the run. begun: CPU time of the process at the start of the job; 0 where the process
    runs one job only, None for now.
    """

    def __init__(self, stage: str, begun: float | None = None):
        self.stage = stage
        self.begun = process_time() if begun is None else begun
        self.known = SIMULATED["records"]

    def read(self) -> dict[str, Any]:
        """Return {stage, cpu_seconds, simulations} so far."""
        return {
            "stage": self.stage,
            "cpu_seconds": process_time() - self.begun,
            "simulations": SIMULATED["records"] - self.known,
        }


@contextmanager
def job_cost(output: str | Path, stage: str, begun: float | None = None) -> Iterator[None]:
    """Write the cost of the `with` block to the cost_file of an output; see Meter for the rest."""
    meter = Meter(stage, begun)
    yield
    write_text(json.dumps(meter.read()) + "\n", cost_file(output))


def cost_file(output: str | Path) -> Path:
    """Return the file with the cost of the job that wrote an output."""
    return Path(f"{output}.cost")


def total_cost(outputs: Iterable[str | Path], last: dict[str, Any]) -> dict[str, Any]:
    """Return the `cost` of verdict.json: of the jobs that wrote the outputs, and of the last job.

    outputs: files; one without a cost_file is not counted. last: as Meter.read returns it.
    """
    files = [cost_file(output) for output in outputs]
    rows = [*[read_json(file) for file in files if file.is_file()], last]
    stages: dict[str, dict[str, float]] = {}
    for row in rows:
        known = stages.setdefault(row["stage"], {"cpu_seconds": 0.0, "simulations": 0})
        for key in known:
            known[key] += row[key]
    return {
        "cpu_seconds": sum(row["cpu_seconds"] for row in stages.values()),
        "simulations": sum(row["simulations"] for row in stages.values()),
        "by_stage": stages,
    }


def with_cost(cost: dict[str, Any]) -> dict[str, Any]:
    """Return the entries {key: value} of verdict.json for a cost as total_cost returns it."""
    return {
        "seconds": cost["cpu_seconds"],
        "simulations": cost["simulations"],
        "cost": cost,
    }
