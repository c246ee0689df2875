"""What is known while a diagnosis goes on."""

from __future__ import annotations

import json
from pathlib import Path

from vibroimpact.records import write_text


class SoFar:
    """Prints each line of progress, and keeps all of them in a file so_far.json."""

    def __init__(self, path: str | Path):
        self.path, self.lines = Path(path), []  # type: tuple[Path, list[str]]

    def __call__(self, line: str) -> None:
        """Add a line."""
        print(line, flush=True)
        self.lines.append(line)
        write_text(json.dumps({"so_far": self.lines}, indent=1), self.path)
