"""CPU seconds by name: where the time of a job goes."""

from contextlib import contextmanager
from time import process_time


class Stopwatch(dict):
    """{name: CPU seconds}, added to by `with stopwatch(name):`."""

    @contextmanager
    def __call__(self, name):
        start = process_time()
        try:
            yield
        finally:
            self[name] = self.get(name, 0.0) + process_time() - start

    def line(self) -> str:
        """One line for a log, that `timing.read_line` reads back: CPU seconds: kernel 7.012, spectra 0.840, all 9.310."""
        named = {**self, "all": process_time()}
        return "CPU seconds: " + ", ".join(f"{name} {seconds:.3f}" for name, seconds in named.items())
