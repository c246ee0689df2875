"""Simulated records of a campaign: the response of the model to the measured force, as the sensors
record it.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from vibroimpact.diagnosis.run_cost import count_simulated
from vibroimpact.excitation.random_force import resample_measured
from vibroimpact.integration.batch import Schedule, integrate_batch, rest_state
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.decimation import RATIO, SLOTS
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.preload import seated
from vibroimpact.reduction.modal_model import ModalModel

from .sensed_motion import force_weights, of_modes, orders
from .stretches import NO_GAP_M

# Largest random offset of an obstacle, as a share of the gap, drawn for every run. No plate is
# centred better. With 1e-6, a tube driven in one plane takes most of a record to leave it: 12 dB
# too little across that plane at first contact. Results with 1e-4 to 1e-2 agree with each other and
# with a tube in its steady state.
IMPERFECTION = 1.0e-3
LOST = 0.25  # largest share of diverged runs in a batch: a measured structure did not diverge


def simulate_records(
    model: ModalModel,
    schedule: Schedule,
    force: np.ndarray,
    runs: Sequence[tuple[int, float, int]],
    kinds: Sequence[str] | np.ndarray,
) -> np.ndarray:
    """Return (run, channel, sample) float32: the responses of runs, LANES of them at a time.

    model: attached to the campaign. force (record, force_channel, sample): N as measured, NaN
    beyond the end of a record. runs: (record, gap in m, seed) of each; a gap that is not finite
    stands for none. kinds (channel,): see sensed_motion.SENSED.

    Before a record begins, the structure is at rest under its dead loads, in contact if they press
    it against a support. The seed of a run draws small offsets of the obstacles, so that two runs
    of an impacting tube differ. A diverged run is NaN. Raises ValueError for another kind and for a
    contact force at no support, IntegrationError if more than LOST of a batch diverge.
    """
    at_step = lru_cache(maxsize=None)(lambda record: _at_step(force[record], schedule))
    out = np.empty((len(runs), len(kinds), schedule.samples), np.float32)
    count_simulated(len(runs))
    moves, weights = of_modes(kinds), force_weights(model, kinds)
    schedule = replace(schedule, derivatives=tuple(map(int, orders(kinds))))
    for first in range(0, len(runs), LANES):
        batch = runs[first : first + LANES]
        gaps = np.array([gap if np.isfinite(gap) else NO_GAP_M for _, gap, _ in batch])
        offsets = _offsets(len(model.support_of_point), batch, gaps)
        offsets, seat = seated(model, schedule, gaps, offsets)
        initial = rest_state(model, schedule, gaps, offsets, seat)
        led, lead = schedule, 0
        if initial is not None:
            # a start-up as long as the memory of the output filter, which then starts on a
            # structure at rest, even if the rest position is not zero
            lead = (schedule.filter.delay + SLOTS) * RATIO
            led = replace(schedule, start_up=lead / schedule.steps_per_second)
        lost: set[int] = set()

        def drive(at, count, batch=batch, lead=lead, lost=lost):
            silent = min(max(lead - at, 0), count)
            known = slice(max(at - lead, 0), max(at - lead + count, 0))
            acting = np.stack([at_step(record)[known] for record, _, _ in batch], axis=-1)
            acting[..., list(lost)] = 0.0
            return np.pad(acting, ((silent, 0), (0, 0), (0, 0)))

        def receive(at, _, motion, contact, first=first, size=len(batch)):
            rows, columns = slice(first, first + size), slice(at, at + motion.shape[-1])
            out[rows, moves, columns] = motion[:, moves]
            if len(weights):
                out[rows, ~moves, columns] = weights @ contact[:, : weights.shape[1]]

        while True:
            try:
                integrate_batch(model, led, gaps, offsets, drive, receive, initial)
                break
            except IntegrationError as error:  # repeat, without force on the diverged runs
                if error.case is None or error.case in lost or len(lost) + 1 > LOST * len(batch):
                    raise error.of([f"run {run} of record {at}" for at, _, run in batch]) from error
                lost.add(error.case)
        out[[first + case for case in lost]] = np.nan
    return out


def _offsets(points, batch, gaps):
    """Return (point, 2, run) in m: offsets of the obstacles, drawn for each (record, gap, seed) of
    a batch, whose gaps are (run,) in m.
    """
    drawn = [
        np.random.default_rng([seed, record]).uniform(-IMPERFECTION, IMPERFECTION, (points, 2))
        for record, _, seed in batch
    ]
    return np.stack(drawn, axis=-1) * gaps


def _at_step(force, schedule):
    """Return (step, force_channel) in N, one more than the steps: the first is one step before time
    0. force (force_channel, sample).
    """
    measured = force[:, : np.flatnonzero(np.isfinite(force).all(axis=0))[-1] + 1]
    sampling, rate = schedule.sampling_frequency, schedule.steps_per_second
    fine = np.stack([resample_measured(row, sampling, rate) for row in measured], axis=-1)
    out = np.zeros((schedule.steps + 2, fine.shape[1]))
    kept = min(len(fine), len(out) - 1)
    out[1 : 1 + kept] = fine[:kept]
    return out
