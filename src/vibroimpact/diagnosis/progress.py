"""The progress of a diagnosis."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

from vibroimpact.diagnosis.run_cost import SIMULATED
from vibroimpact.io.records import write_text

# Runs for each effect that is sought at once, over those before the first line of progress:
# 4.0 to 5.8 on campaigns of the default tube.
PER_EFFECT = 5.0
WIDTH = 24  # characters of the bar
BLANK = "\r\x1b[K"  # to the beginning of the line, and empty it


class SoFar:
    """Prints each line of progress, and keeps all of them in a file so_far.json."""

    def __init__(self, path: str | Path):
        self.path, self.lines = Path(path), []  # type: tuple[Path, list[str]]

    def __call__(self, line: str) -> None:
        """Add a line."""
        print(line, flush=True)
        self.lines.append(line)
        write_text(json.dumps({"so_far": self.lines}, indent=1), self.path)


class ProgressBar:
    """A bar with the time left in the last line of a terminal, and lines of progress above it.

    stream: a terminal; otherwise only the lines are printed. effects: number sought at once. now:
    clock in s.
    """

    def __init__(self, stream: TextIO, effects: int, now: Callable[[], float] = time.monotonic):
        self.stream, self.effects, self.now = stream, effects, now
        self.first, self.started = SIMULATED["records"], now()
        self.set_up = 0  # runs before the first line
        self._ended, self._lock = threading.Event(), threading.Lock()
        self._thread = threading.Thread(target=self._redraw, daemon=True)

    def __enter__(self) -> ProgressBar:
        if self.stream.isatty():
            self._thread.start()
        return self

    def __exit__(self, *failure: Any) -> None:
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join()

    def __call__(self, line: str) -> None:
        """Print a line."""
        self.set_up = self.set_up or SIMULATED["records"] - self.first
        with self._lock:
            blank = BLANK if self._thread.is_alive() else ""
            print(f"{blank}{line}", file=self.stream, flush=True)

    def bar(self) -> str:
        """Return the bar as it is now."""
        runs, passed = SIMULATED["records"] - self.first, self.now() - self.started
        if not self.set_up:
            return f"{runs} runs, {_duration(passed)}"
        expected = max(self.set_up * (1.0 + PER_EFFECT * self.effects), 1.02 * runs)
        filled = int(WIDTH * runs / expected)
        return (
            f"[{'#' * filled}{'.' * (WIDTH - filled)}] {runs} of about {expected:.0f} runs, about"
            f" {_duration(passed * (expected / runs - 1.0))} left at most"
        )

    def _redraw(self) -> None:
        while not self._ended.wait(0.5):
            with self._lock:
                print(f"{BLANK}{self.bar()}", end="", file=self.stream, flush=True)
        print(BLANK, end="", file=self.stream, flush=True)


def _duration(seconds: float) -> str:
    """Return 40 s, 3 min."""
    return f"{seconds:.0f} s" if seconds < 90.0 else f"{seconds / 60.0:.0f} min"
