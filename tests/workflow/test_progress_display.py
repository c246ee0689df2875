"""What a run shows on a terminal: jobs, time left, and Snakemake's own words for the rest."""

import io
import logging
from types import SimpleNamespace

import pytest
from rich.console import Console
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_vibroimpact import LogHandler
from snakemake_logger_plugin_vibroimpact.display import Display, duration
from snakemake_logger_plugin_vibroimpact.time_left import TimeLeft, kind_of

STUDY = {"_basis": 1, "_simulate": 24, "_identify_from_0.316": 1, "_identify_from_1": 1, "all": 1}


def run_of(jobs, cores, plan):
    """Run jobs [(rule, s)] in their order on some cores, each started when a core is free; return
    (times of the ends in s, time left foretold at each of them).
    """
    left = TimeLeft()
    left.plan(plan)
    free, waiting, running, ends, foretold, now = cores, list(enumerate(jobs)), [], [], [], 0.0
    while waiting or running:
        while waiting and len(running) < free:
            number, (rule, seconds) = waiting.pop(0)
            left.start(number, rule, now)
            running.append((now + seconds, number))
        running.sort()
        now, number = running.pop(0)
        left.end(number, now)
        ends.append(now)
        foretold.append(left.seconds(now))
    return ends, foretold


@pytest.mark.parametrize("cores", [1, 2, 4])
def test_time_left_is_exact_for_equal_jobs(cores):
    ends, foretold = run_of([("_simulate", 10.0)] * 24, cores, {"_simulate": 24})
    for end, left in zip(ends[cores - 1 : -1], foretold[cores - 1 : -1], strict=True):
        assert left == pytest.approx(ends[-1] - end, abs=10.0)
    assert foretold[12 * 1] == pytest.approx(ends[-1] - ends[12], abs=10.0)


def test_short_first_job_says_nothing_of_the_simulations():
    jobs = [("_basis", 1.0), *[("_simulate", 20.0)] * 24]
    jobs += [("_identify_from_0.316", 5.0), ("_identify_from_1", 5.0), ("all", 0.0)]
    ends, foretold = run_of(jobs, 1, STUDY)
    assert foretold[0] is None  # by the basis alone, 27 s would be left of 490
    assert foretold[1] == pytest.approx(ends[-1] - ends[1], rel=0.15)
    assert foretold[20] == pytest.approx(ends[-1] - ends[20], rel=0.3)


def test_jobs_of_a_checkpoint_count_as_they_appear():
    left = TimeLeft()
    left.plan({"_prepare": 1})
    left.start(0, "_prepare", 0.0)
    left.end(0, 4.0)
    assert left.seconds(4.0) is None  # nothing is planned any more
    left.start(1, "_candidate", 4.0)
    assert left.seconds(4.0) is None  # no candidate has ended
    left.end(1, 9.0)
    left.start(2, "_candidate", 9.0)
    assert left.seconds(10.0) == pytest.approx(4.0)


def test_rules_of_one_kind_are_measured_together():
    assert kind_of("_identify_from_0.316") == kind_of("_identify_from_10") == "identify"
    assert kind_of("all") == "all"


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.2, "1 s"), (59.0, "59 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min")],
)
def test_durations_read_as_one_says_them(seconds, text):
    assert duration(seconds) == text


def shown(display):
    """The lines of a display, as text of 80 columns."""
    console = Console(file=io.StringIO(), width=80)
    console.print(display.lines())
    return console.file.getvalue().splitlines()


def test_display_shows_bar_time_left_and_running_jobs():
    clock, output = [0.0], io.StringIO()
    display = Display(Console(file=output, width=80), now=lambda: clock[0])
    display.plan({"_simulate": 4}, 4)
    display.start(1, "_simulate", "Simulation at 1 N RMS: 12 of 48 cases")
    clock[0] = 8.0
    display.end(1)
    display.progress(1, 4)
    display.start(2, "_simulate", "Simulation at 2 N RMS: 12 of 48 cases")
    clock[0] = 10.0
    lines = shown(display)
    display.close()
    assert "✓ Simulation at 1 N RMS: 12 of 48 cases, 8 s" in output.getvalue()
    assert lines[0].split()[1:] == ["1", "of", "4", "jobs", "about", "22", "s", "left"]
    assert lines[1].strip() == "Simulation at 2 N RMS: 12 of 48 cases, 2 s"


def handler(**settings):
    """The plug-in as Snakemake makes it, writing to a text."""
    given = {"stdout": False, "nocolor": True, "dryrun": False, "quiet": set()} | settings
    made = LogHandler(SimpleNamespace(**given), None)
    made.console.file = io.StringIO()
    return made


def record(message="", level=logging.INFO, **extra):
    """A record as Snakemake sends it."""
    made = logging.LogRecord("snakemake", level, "", 0, message, None, None)
    vars(made).update(extra)
    return made


def test_plug_in_shows_jobs_and_keeps_other_messages():
    plug = handler()
    plug.emit(record("Building DAG of jobs..."))
    plug.emit(record(event=LogEvent.RUN_INFO, stats={"_basis": 1, "all": 1, "total": 2}))
    for job, rule, title in ((0, "_basis", "Reduced model"), (1, "_spectra", None)):
        about = {"jobid": job, "rule_name": rule, "rule_msg": title}
        plug.emit(record(event=LogEvent.JOB_INFO, **about))
    plug.emit(record(event=LogEvent.JOB_FINISHED, job_id=0))
    plug.emit(record(event=LogEvent.JOB_ERROR, jobid=1, rule_name="_spectra"))
    plug.emit(record("the headline"))
    plug.close()
    told = plug.console.file.getvalue()
    assert "✓ Reduced model, " in told and "✗ spectra" in told and "the headline" in told
    assert "Building DAG" not in told


def test_plug_in_leaves_a_dry_run_as_it_is():
    plug = handler(dryrun=True)
    plug.emit(record("Building DAG of jobs..."))
    plug.emit(record("job  count", event=LogEvent.RUN_INFO, stats={"all": 1, "total": 1}))
    plug.close()
    assert plug.console.file.getvalue() == "Building DAG of jobs...\njob  count\n"


class Closed(io.StringIO):
    """A stream whose reader has gone."""

    def write(self, text):
        """Raise as a broken pipe does."""
        raise BrokenPipeError


def test_plug_in_goes_on_when_nobody_reads():
    plug = handler()
    plug.console.file = Closed()
    plug.emit(record("the headline"))
    plug.close()
    assert plug.console.quiet
