"""CPU seconds by name: where the time of a job goes, in its log."""

import re
from contextlib import contextmanager
from time import process_time

LINE = re.compile(r"^CPU seconds: (.*)$", flags=re.M)


class Stopwatch(dict):
    """{name: CPU seconds}, added to by `with stopwatch(name):`."""

    @contextmanager
    def __call__(self, name):
        start = process_time()
        try:
            yield
        finally:
            self.add({name: process_time() - start})

    def time(self, name, function, *arguments):
        """Return function(*arguments), its CPU seconds added under a name."""
        with self(name):
            return function(*arguments)

    def add(self, seconds):
        """Add {name: CPU seconds}."""
        for name, value in seconds.items():
            self[name] = self.get(name, 0.0) + value

    def line(self) -> str:
        """The line for a log, that seconds_in reads: CPU seconds: kernel 7.012, spectra 0.840, all
        9.310. All: of the process, until now.
        """
        return "CPU seconds: " + ", ".join(
            f"{name} {seconds:.3f}" for name, seconds in {**self, "all": process_time()}.items()
        )


def seconds_in(log: str) -> dict[str, float]:
    """{name: CPU seconds} of the last line of a Stopwatch in the text of a log; nothing where there
    is none.
    """
    lines = LINE.findall(log)
    pairs = (part.rsplit(" ", 1) for part in lines[-1].split(", ")) if lines else ()
    return {name: float(seconds) for name, seconds in pairs}
