"""What a run costs: every job leaves its CPU seconds and simulated records beside its output, and
the last one adds them up.
"""

import json
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from time import process_time

from vibroimpact.records import read_json, write_text

# {"records": records that this process has simulated so far}
SIMULATED = {"records": 0}
COUNTING = Lock()


def count_simulated(records):
    """Count records that were simulated just now."""
    with COUNTING:
        SIMULATED["records"] += records


class Meter:
    """What a job costs from here on, in a process that may do several one after the other.

    stage: of the run; begun: CPU time of the process at which the job began, 0 where the process is
    the job, now where None.
    """

    def __init__(self, stage, begun=None):
        self.stage = stage
        self.begun = process_time() if begun is None else begun
        self.known = SIMULATED["records"]

    def read(self):
        """Return {stage, cpu_seconds, simulations} so far."""
        return {
            "stage": self.stage,
            "cpu_seconds": process_time() - self.begun,
            "simulations": SIMULATED["records"] - self.known,
        }


@contextmanager
def job_cost(output, stage, begun=None):
    """Leave what the `with` block costs beside the output of a job; arguments as of Meter."""
    meter = Meter(stage, begun)
    yield
    write_text(json.dumps(meter.read()) + "\n", cost_file(output))


def cost_file(output):
    """Return the file beside the output of a job that holds its cost."""
    return Path(f"{output}.cost")


def total_cost(outputs, last):
    """Return the `cost` of verdict.json: of the jobs that made some outputs, and of the last one.

    outputs: files, of which those without a cost beside them are not counted; last: as Meter.read
    returns it.
    """
    files = [cost_file(output) for output in outputs]
    rows = [*[read_json(file) for file in files if file.is_file()], last]
    stages = {}
    for row in rows:
        known = stages.setdefault(row["stage"], {"cpu_seconds": 0.0, "simulations": 0})
        for key in known:
            known[key] += row[key]
    return {
        "cpu_seconds": sum(row["cpu_seconds"] for row in stages.values()),
        "simulations": sum(row["simulations"] for row in stages.values()),
        "by_stage": stages,
    }


def with_cost(cost):
    """Return {key: value} of verdict.json that a cost, as total_cost returns it, fills."""
    return {
        "seconds": cost["cpu_seconds"],
        "simulations": cost["simulations"],
        "cost": cost,
    }
