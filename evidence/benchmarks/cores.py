"""Two processes on two cores against one: the same batch in one process alone, then in both at
once.
"""

import multiprocessing
import os
import time

from evidence.benchmarks.growth import growth_of
from evidence.benchmarks.ours import march_ours, schedule_of
from evidence.benchmarks.problem import SEED, SMALL_BASIS, tube_problem

BATCH, SECONDS = 8, 4.0


def two_cores(clock, cores, say=print):
    """Return [Growth] of one and for two processes, wall-clock s per simulated s and run; [] where
    there is one core only.
    """
    if len(cores) < 2:
        say("two cores against one: left out, this process may use one core only")
        return []
    problem = tube_problem(SMALL_BASIS)
    context = multiprocessing.get_context("spawn")
    workers = []
    try:
        for core in cores[:2]:
            here, there = context.Pipe()
            process = context.Process(target=_serve, args=(there, core), daemon=True)
            process.start()
            workers.append((process, here))
        for _, pipe in workers:
            pipe.recv()  # ready: compiled and warm
        found = {1: [], 2: []}
        for _ in range(clock.repeats):
            for count, costs in found.items():
                start = time.perf_counter()
                for _, pipe in workers[:count]:
                    pipe.send("run")
                for _, pipe in workers[:count]:
                    pipe.recv()
                costs.append((time.perf_counter() - start) / SECONDS / BATCH / count)
    finally:
        for process, pipe in workers:
            pipe.close()
            process.join(10.0)
    points = [
        growth_of("processes", count, problem, BATCH, SECONDS, costs, "wall")
        for count, costs in found.items()
    ]
    say(
        "two processes: "
        + ", ".join(f"{point.value:g}: {min(point.ns_per_step):.0f} ns" for point in points)
    )
    return points


def _serve(pipe, core):
    """Run the batch once for every message, on one core."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    import numpy as np

    problem, schedule = tube_problem(SMALL_BASIS), schedule_of(SECONDS)
    forces = np.stack([problem.force(SECONDS, SEED + case) for case in range(BATCH)], axis=1)
    march_ours(problem, forces, schedule)
    pipe.send("ready")
    try:
        while pipe.recv():
            march_ours(problem, forces, schedule)
            pipe.send("done")
    except EOFError:
        return
