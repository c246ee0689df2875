"""Compile both integration kernels, or find them compiled: `python -m tests.compile_kernels`.

Run once before the tests are spread over processes, each of which would compile them otherwise.
"""

import os

os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}

import multiprocessing

import numpy as np


def library_kernel():
    """Integrate a mass between stops for a few steps."""
    from tests.support.oscillator import oscillator
    from vibroimpact.integration.batch import Schedule, integrate_batch
    from vibroimpact.integration.kernels.lanes import LANES

    integrate_batch(
        oscillator(1.0, 400.0, contact_stiffness=1.0e5),
        Schedule(20480, 2048, 0.0, 0.02, "exact"),
        np.full(LANES, 1.0e-3),
        np.zeros((1, 2, LANES)),
        lambda first, count: np.zeros((count, 1, LANES)),
    )


def truth_kernel():
    """Simulate a short record of the tube with the other code."""
    from evidence.truth.campaign import Plan, forces, simulate_records

    plan = Plan((1,), levels=((10.0, 1.3, "fit"),), duration=0.05)
    simulate_records(plan, forces(plan))


if __name__ == "__main__":
    jobs = [multiprocessing.Process(target=job) for job in (library_kernel, truth_kernel)]
    for job in jobs:
        job.start()
    for job in jobs:
        job.join()
    raise SystemExit(any(job.exitcode for job in jobs))
