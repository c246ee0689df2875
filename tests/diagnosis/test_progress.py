"""The bar of `vibroimpact diagnose`: how far it is, and the time left."""

import io

import pytest

from vibroimpact.diagnosis.progress import ProgressBar
from vibroimpact.diagnosis.run_cost import SIMULATED, count_simulated


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand; the runs of other tests do not count."""
    monkeypatch.setitem(SIMULATED, "records", 17)
    time = [100.0]
    return time, lambda: time[0]


def test_time_left_is_that_of_the_runs_left(clock):
    time, now = clock
    bar = ProgressBar(io.StringIO(), effects=2, now=now)
    count_simulated(100)
    time[0] += 10.0
    assert bar.bar() == "100 runs, 10 s"  # nothing is known yet of the whole
    bar("held")
    count_simulated(450)
    time[0] += 45.0  # 550 runs in 55 s, 1100 are expected
    assert bar.bar() == f"[{'#' * 12}{'.' * 12}] 550 of about 1100 runs, about 55 s left at most"
    count_simulated(1450)  # more than expected
    assert "2000 of about 2040 runs" in bar.bar()


def test_a_terminal_has_a_bar_that_is_taken_away(clock):
    terminal = Terminal()
    with ProgressBar(terminal, effects=1) as bar:
        bar("one")
        bar._ended.wait(0.7)
        bar("two")
    shown = terminal.getvalue()
    assert "one\n" in shown and "two\n" in shown and " runs, " in shown
    assert shown.endswith("\r\x1b[K")


def test_a_file_has_the_lines_alone(clock):
    file = io.StringIO()
    with ProgressBar(file, effects=1) as bar:
        bar("one")
    assert file.getvalue() == "one\n"
