"""CPU seconds by name, written as one line into the log of a job."""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from time import process_time
from typing import Any

LINE = re.compile(r"^CPU seconds: (.*)$", flags=re.M)


class Stopwatch(dict):
    """{name: CPU seconds}, added to by `with stopwatch(name):`."""

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Add the CPU seconds of a `with` block under a name."""
        start = process_time()
        try:
            yield
        finally:
            self.add({name: process_time() - start})

    def time(self, name: str, function: Callable, *arguments: Any) -> Any:
        """Return function(*arguments) and add its CPU seconds under a name."""
        with self(name):
            return function(*arguments)

    def add(self, seconds: Mapping[str, float]) -> None:
        """Add {name: CPU seconds}."""
        for name, value in seconds.items():
            self[name] = self.get(name, 0.0) + value

    def line(self) -> str:
        """Return the line for a log, e.g. `CPU seconds: kernel 7.012, spectra 0.840, all 9.310`.

        `all` is the CPU time of the process so far.
        """
        return "CPU seconds: " + ", ".join(
            f"{name} {seconds:.3f}" for name, seconds in {**self, "all": process_time()}.items()
        )


def seconds_in(log: str) -> dict[str, float]:
    """Return {name: CPU seconds} of a Stopwatch's last line in a log; empty if there is none."""
    lines = LINE.findall(log)
    pairs = (part.rsplit(" ", 1) for part in lines[-1].split(", ")) if lines else ()
    return {name: float(seconds) for name, seconds in pairs}
