"""A job of the workflow, and its log file."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

from .stopwatch import Stopwatch
from .whole_file import folder_problem


def run_job(stage: Callable[..., Stopwatch | None], job: Any, *more: Any) -> None:
    """Run a stage as a job; its log ends with the CPU seconds of the job.

    stage: called with the job's input, output and params, and more arguments.
    job: has the attributes input, output, params and log; log[0] is the path.
    """
    redirect_output(job.log[0])
    parts = stage(job.input, job.output, job.params, *more)
    print((Stopwatch() if parts is None else parts).line())


def redirect_output(path: str | Path) -> None:
    """Send all that this process prints, errors included, to a new file, line by line.

    An error of this package says all in its message, and the log ends with that. Of any other error
    it holds the whole traceback. If the log cannot be written, the message goes to the terminal.

    Raises SystemExit with a sentence if the file cannot be made.
    """
    path = Path(path)
    try:
        sys.stderr = sys.stdout = path.open("w", buffering=1, encoding="utf-8")
    except OSError as error:
        reason = folder_problem(path.parent, error.errno or 0) or error.strerror
        sys.exit(f"{path}: cannot be written: {reason}")
    sys.excepthook = _write_error


def _write_error(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    try:
        if kind.__module__.split(".")[0] == "vibroimpact":
            print(f"{kind.__name__}: {error}", file=sys.stderr)
        else:
            sys.__excepthook__(kind, error, trace)
    except OSError:
        print(f"{kind.__name__}: {error}", file=sys.__stderr__)
