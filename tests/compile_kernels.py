"""Compile the integration kernels, or find them compiled: `python -m tests.compile_kernels`.

Run once before the tests are spread over processes, each of which would compile them otherwise.
"""

import os

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}

import multiprocessing

import numpy as np


def library_kernel(cases):
    """Integrate a mass between stops for a few steps."""
    from tests.support.oscillator import oscillator
    from vibroimpact.integration.batch import Schedule, integrate_batch

    integrate_batch(
        oscillator(1.0, 400.0, contact_stiffness=1.0e5),
        Schedule(20480, 2048, 0.0, 0.02, "exact"),
        np.full(cases, 1.0e-3),
        np.zeros((1, 2, cases)),
        lambda first, count: np.zeros((count, 1, cases)),
    )


def truth_kernel():
    """Simulate a short record of the tube with the other code."""
    from evidence.truth.campaign import Plan, forces, simulate_records

    plan = Plan((1,), levels=((10.0, 1.3, "fit"),), duration=0.05)
    simulate_records(plan, forces(plan))


if __name__ == "__main__":
    jobs = [
        multiprocessing.Process(target=library_kernel, args=(2,)),
        multiprocessing.Process(target=library_kernel, args=(1,)),  # a run alone has its own
        multiprocessing.Process(target=truth_kernel),
    ]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    raise SystemExit(any(job.exitcode for job in jobs))
