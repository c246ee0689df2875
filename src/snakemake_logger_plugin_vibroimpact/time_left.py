"""How long a run will still take, from how long its jobs have taken so far."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

# The rest of the run is foretold when jobs like at least this share of it have been measured:
# the first jobs of a study are short, and say nothing of its simulations.
KNOWN_SHARE = 0.5


def kind_of(rule: str) -> str:
    """Return the name that rules of the same work share, e.g. identify of _identify_from_3.16."""
    return rule.removeprefix("_").split("_from_")[0]


@dataclass
class TimeLeft:
    """The jobs of a run by kind: how many there are, how long they took, which are running.

    waiting: {kind: number of jobs that have not ended}.
    took: {kind: [s]} of the jobs that have ended.
    running: {job: (kind, start in s)}.
    most_at_once: the largest number of jobs that were running at the same time.
    """

    waiting: dict[str, int] = field(default_factory=dict)
    took: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    running: dict[int, tuple[str, float]] = field(default_factory=dict)
    most_at_once: int = 1

    def plan(self, jobs_per_rule: dict[str, int]) -> None:
        """Take the number of jobs of each rule, as they are planned at the start."""
        self.waiting = {}
        for rule, count in jobs_per_rule.items():
            self.waiting[kind_of(rule)] = self.waiting.get(kind_of(rule), 0) + count

    def start(self, job: int, rule: str, now: float) -> None:
        """A job starts at a time in s. One that was not planned, as after a checkpoint, counts."""
        self.running[job] = (kind_of(rule), now)
        self.most_at_once = max(self.most_at_once, len(self.running))
        active = sum(kind == kind_of(rule) for kind, _ in self.running.values())
        self.waiting[kind_of(rule)] = max(self.waiting.get(kind_of(rule), 0), active)

    def end(self, job: int, now: float) -> float | None:
        """A job ends at a time in s; return how long it took in s, None for an unknown job."""
        if job not in self.running:
            return None
        kind, started = self.running.pop(job)
        self.waiting[kind] -= 1
        self.took[kind].append(now - started)
        return now - started

    def seconds(self, now: float) -> float | None:
        """Return the time left in s, None while too little has been measured to say.

        Every job is taken to need the mean of its kind; one of a kind that has no ended job, the
        mean over the kinds that have. The work of the running jobs is taken off. The rest is
        shared by as many jobs as have been running at once.
        """
        jobs = sum(self.waiting.values())
        known = sum(count for kind, count in self.waiting.items() if self.took.get(kind))
        if jobs == 0 or known < KNOWN_SHARE * jobs:
            return None
        mean = {kind: sum(took) / len(took) for kind, took in self.took.items() if took}
        typical = sum(mean.values()) / len(mean)
        work = sum(count * mean.get(kind, typical) for kind, count in self.waiting.items())
        done = sum(
            min(now - started, mean.get(kind, typical)) for kind, started in self.running.values()
        )
        return max(work - done, 0.0) / min(self.most_at_once, jobs)
