"""The log file of a job."""

import sys
from pathlib import Path


def redirect_output(path: str | Path) -> None:
    """Send all that this process prints, errors included, to a new file, line by line."""
    sys.stderr = sys.stdout = Path(path).open("w", buffering=1, encoding="utf-8")
