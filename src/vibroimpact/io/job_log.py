"""The log file of a job."""

import sys
from pathlib import Path
from types import TracebackType

from .whole_file import folder_problem


def redirect_output(path: str | Path) -> None:
    """Send all that this process prints, errors included, to a new file, line by line.

    An error of this package says all in its message, and the log ends with that. Of any other error
    it holds the whole traceback. Where the log cannot be written, the message goes to the terminal.

    Raises SystemExit with a sentence where the file cannot be made.
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
