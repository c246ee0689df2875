"""The last lines of the terminal during a run: a bar, the time left, and the running jobs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from .time_left import TimeLeft

SHOWN = 6  # running jobs that are listed


def duration(seconds: float) -> str:
    """Return a duration as one reads it: 8 s, 3 min 20 s, 2 h 5 min."""
    whole = math.ceil(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


class Display:
    """Shows the progress of a run below the printed lines.

    console: of the terminal.
    now: clock in s.
    """

    def __init__(self, console: Console, now: Callable[[], float] = time.monotonic):
        self.console, self.now = console, now
        self.time_left = TimeLeft()
        self.titles: dict[int, str] = {}
        self.done = self.total = 0
        self._live = Live(
            get_renderable=self.lines, console=console, refresh_per_second=4, transient=True
        )

    def plan(self, jobs_per_rule: dict[str, int], total: int) -> None:
        """Take the plan of the run and show the bar from now on."""
        self.time_left.plan(jobs_per_rule)
        self.total = total
        self._live.start()

    def start(self, job: int, rule: str, title: str) -> None:
        """A job of a rule starts."""
        self.titles[job] = title
        self.time_left.start(job, rule, self.now())

    def end(self, job: int) -> None:
        """A job is complete: print its title and how long it took."""
        took = self.time_left.end(job, self.now())
        if took is not None:
            self.console.print(Text(f"✓ {self.titles.pop(job)}, {duration(took)}"))

    def fail(self, job: int, rule: str) -> None:
        """A job failed: print its title."""
        self.time_left.end(job, self.now())
        self.console.print(Text(f"✗ {self.titles.pop(job, rule)}", style="red"))

    def progress(self, done: int, total: int) -> None:
        """Take the numbers of jobs that are done and in all."""
        self.done, self.total = done, total
        self._live.refresh()

    def close(self) -> None:
        """Take the bar away."""
        self._live.stop()

    def lines(self) -> RenderableType:
        """Return the lines shown at this moment."""
        left = self.time_left.seconds(self.now())
        head = Table.grid(padding=(0, 1))
        head.add_row(
            ProgressBar(total=max(self.total, 1), completed=self.done, width=30),
            Text(f"{self.done} of {self.total} jobs"),
            Text("" if left is None else f"about {duration(left)} left"),
        )
        running = list(self.titles.items())
        rows = [
            Text(f"  {title}, {duration(self._since(job))}", overflow="ellipsis", no_wrap=True)
            for job, title in running[:SHOWN]
        ]
        more = len(running) - SHOWN
        return Group(head, *rows, *([Text(f"  and {more} more")] if more > 0 else []))

    def _since(self, job: int) -> float:
        """Return for how many seconds a job has been running."""
        return self.now() - self.time_left.running[job][1] if job in self.titles else 0.0
