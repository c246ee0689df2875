"""Times measured in pairs: ours and a peer's next to each other, again and again, so that a
machine's moods fall on both.
"""

import time
from dataclasses import dataclass, field

import numpy as np

from evidence.benchmarks.ours import SAME_STEP, march_ours, schedule_of, study_step
from evidence.benchmarks.peak import PeakRate, flops_per_step
from evidence.benchmarks.problem import LONGEST_S, RATE, SEED

ONE_RUN = "one run"
BATCH = "batch of {}, per run"
STUDY = "batch of {} at the study's step, per run"
PEAK = "FMA peak of one core"
PROBE_S = 0.2


@dataclass(frozen=True)
class Clock:
    """How long and how often is measured: repeats; ours_s: CPU time of a timed run of ours, whose
    set-up takes 0.01 s; batches: runs in one call.
    """

    repeats: int = 5
    ours_s: float = 0.3
    batches: tuple = (8, 16)
    peer_scale: float = 1.0  # of the simulated seconds of the peers
    slow_s: float = (
        3.0  # a peer whose timed run takes longer is measured slow_repeats times at most
    )
    slow_repeats: int = 3


@dataclass
class Pair:
    """CPU seconds per simulated second and run, pair by pair. quantity: how ours ran; same_step:
    ours and the peer step alike; bound: the peer is arithmetic at the FMA peak.
    """

    case: str
    quantity: str
    peer: str
    same_step: bool
    bound: bool = False
    ours: list = field(default_factory=list)
    theirs: list = field(default_factory=list)


def cpu_seconds(work):
    """Return the CPU time in s of a call, all threads of this process together: unlike the wall
    clock it does not see other processes.
    """
    start = time.process_time()
    work()
    return time.process_time() - start


def our_cost(problem, batch, seconds, step=SAME_STEP):
    """Return the function () -> CPU s per simulated s and run of `batch` runs side by side, each
    with a force of its own.
    """
    forces = np.stack(
        [problem.force(seconds, SEED + case, step.rate) for case in range(batch)], axis=1
    )
    schedule = schedule_of(seconds, step)
    return lambda: cpu_seconds(lambda: march_ours(problem, forces, schedule)) / seconds / batch


def our_long_cost(problem, batch, lasting, step=SAME_STEP):
    """Return (our_cost, simulated s) of runs that take about `lasting` s of CPU time, compiled and
    warmed up.
    """
    probe = our_cost(problem, batch, PROBE_S, step)
    probe()
    seconds = round(min(max(lasting / (probe() * batch), PROBE_S), LONGEST_S), 1)
    cost = our_cost(problem, batch, seconds, step)
    cost()
    return cost, seconds


def peer_cost(peer, problem, scale=1.0):
    """Return (function () -> CPU s per simulated s and run of a peer, CPU s of its first run, which
    compiles).
    """
    marcher = peer.start(problem, True)
    force = peer_force(peer, problem, scale)
    seconds = (len(force) - 1) / RATE
    warm = cpu_seconds(lambda: marcher.march(force))
    return (lambda: cpu_seconds(lambda: marcher.march(force)) / seconds / peer.batch), warm


def peer_force(peer, problem, scale=1.0):
    """Return the force (step + 1,), or (step + 1, batch) with a record of its own for each run,
    that a peer is timed with.
    """
    first = problem.force(scale * peer.seconds)
    return (
        first
        if peer.batch == 1
        else np.stack(
            [problem.force(scale * peer.seconds, SEED + run) for run in range(peer.batch)], axis=1
        )
    )


def peak_cost(problem, touching):
    """Return the function () -> CPU s per simulated s and run, were the step's arithmetic all that
    there is, at the FMA peak.
    """
    peak = PeakRate()
    share = flops_per_step(problem.model, touching) * RATE / peak.flops
    return lambda: share * cpu_seconds(peak.run)


def measure_pairs(problem, peers, clock, touches=True, say=print):
    """Return [Pair] of one case: every peer against ours alone and in batches; a batched peer
    against our batches only.

    touches: whether the load reaches the obstacles (for the count of operations).
    """
    ours = {ONE_RUN: our_long_cost(problem, 1, clock.ours_s)[0]}
    ours |= {
        BATCH.format(batch): our_long_cost(problem, batch, clock.ours_s)[0]
        for batch in clock.batches
    }
    same = [*ours]
    ours[STUDY.format(clock.batches[0])] = our_long_cost(
        problem, clock.batches[0], clock.ours_s, study_step(problem)
    )[0]
    others = [
        (
            peer.name,
            peer.same_step,
            *peer_cost(peer, problem, clock.peer_scale),
            [*ours][peer.batch > 1 :],
        )
        for peer in peers
    ]
    others.append((PEAK, True, peak_cost(problem, touches), 0.0, same))
    pairs = []
    for name, same_step, cost, warm, quantities in others:
        found = {
            quantity: Pair(
                problem.name, quantity, name, same_step and quantity in same, name == PEAK
            )
            for quantity in quantities
        }
        for repeat in range(
            min(clock.repeats, clock.slow_repeats) if warm > clock.slow_s else clock.repeats
        ):
            # Ours before and after, in turns, so that neither has the cooler core.
            order = quantities if repeat % 2 else quantities[::-1]
            for quantity in order[:1]:
                found[quantity].ours.append(ours[quantity]())
            theirs = cost()
            for quantity in order[1:]:
                found[quantity].ours.append(ours[quantity]())
            for pair in found.values():
                pair.theirs.append(theirs)
        pairs += found.values()
        say(
            f"{problem.name}: {name} {np.median(theirs):.4g} s/s, times ours: "
            + ", ".join(
                f"{np.median(np.divide(pair.theirs, pair.ours)):.3g} ({pair.quantity})"
                for pair in found.values()
            )
        )
    return pairs
