"""The display of a run on a terminal: a bar with the time left, and the jobs by their
messages.

Snakemake finds this package by its name: `--logger vibroimpact`, which the profile of the workflow
gives if the output is a terminal. Everything that is no job and no progress is shown in
Snakemake's own words; its log file is as ever.
"""

from __future__ import annotations

import re
from logging import LogRecord

from rich.console import Console
from rich.text import Text
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from .display import Display

# What the bar or the end of the run says better, or no one reads at every start.
PASSED_OVER = re.compile(
    r"\s*(Select jobs to execute|Execute \d+ jobs|Building DAG of jobs|Using shell:|"
    r"Provided (cores|resources|remote)|Rules claiming more threads|host:|"
    r"Assuming unrestricted shared filesystem|Shutting down, this might|"
    r"Exiting because a job execution failed|RuleException:\s*CalledProcessError|None|$)"
)
UNSHOWN = (LogEvent.JOB_STARTED, LogEvent.RESOURCES_INFO, LogEvent.WORKFLOW_STARTED)


class RunConsole(Console):
    """A console that falls silent when nobody reads it any more; the run goes on."""

    def on_broken_pipe(self) -> None:
        """Write nothing from now on."""
        self.quiet = True


class LogHandler(LogHandlerBase):
    """Shows the events of a run on a terminal."""

    def __post_init__(self) -> None:
        """Open the console: standard error, as Snakemake's own messages."""
        settings = self.common_settings
        self.console = RunConsole(
            stderr=not settings.stdout,
            no_color=settings.nocolor or None,  # None: as NO_COLOR says
            highlight=False,
            soft_wrap=True,
        )
        self.display = Display(self.console)

    def emit(self, record: LogRecord) -> None:
        """Show a record that passed Snakemake's filter, which knows --quiet."""
        try:
            self._show(record, event_of(record))
        except Exception:
            self.handleError(record)

    def _show(self, record: LogRecord, event: LogEvent | None) -> None:
        if self.common_settings.dryrun:
            self._print(record)
        elif event == LogEvent.RUN_INFO:
            stats = dict(record.stats)  # type: ignore[attr-defined]
            self.display.plan(stats, stats.pop("total", sum(stats.values())))
        elif event == LogEvent.JOB_INFO:
            rule = record.rule_name  # type: ignore[attr-defined]
            title = getattr(record, "rule_msg", None) or rule.removeprefix("_")
            self.display.start(record.jobid, rule, title)  # type: ignore[attr-defined]
        elif event == LogEvent.JOB_FINISHED:
            self.display.end(record.job_id)  # type: ignore[attr-defined]
        elif event == LogEvent.PROGRESS:
            self.display.progress(record.done, record.total)  # type: ignore[attr-defined]
        elif event == LogEvent.JOB_ERROR:
            # The log of the job is shown at the end of the run, where nothing scrolls it away.
            self.display.fail(record.jobid, record.rule_name)  # type: ignore[attr-defined]
        elif event not in UNSHOWN:
            self._print(record)

    def _print(self, record: LogRecord) -> None:
        """Print a record in Snakemake's words, unless it says nothing."""
        text = self.format(record)
        if self.common_settings.dryrun or not PASSED_OVER.match(text):
            self.console.print(Text(text, style="red" if record.levelname == "ERROR" else ""))

    def close(self) -> None:
        """Take the bar away."""
        self.display.close()
        super().close()

    @property
    def writes_to_stream(self) -> bool:
        """This plug-in takes the place of Snakemake's messages on the terminal."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """Snakemake writes its log file itself."""
        return False

    @property
    def has_filter(self) -> bool:
        """Snakemake's filter is used: it knows --quiet."""
        return False

    @property
    def has_formatter(self) -> bool:
        """Snakemake's formatter is used for its own messages."""
        return False

    @property
    def needs_rulegraph(self) -> bool:
        """The graph of the rules is not needed."""
        return False


def event_of(record: LogRecord) -> LogEvent | None:
    """Return the event of a record, None for a plain message."""
    return getattr(record, "event", None)
