"""The log of a job: all that its process prints, errors among it, in one file."""

import sys
from pathlib import Path


def redirect_output(path):
    """Send what this process prints from here on to a new file, line by line."""
    sys.stderr = sys.stdout = Path(path).open("w", buffering=1, encoding="utf-8")
