"""One run at a time in a folder, and what a killed one leaves behind.

The kernel gives the lock of a process back when it ends, however it ends: nobody has to. A mark
beside it tells whose the lock is, and whether the last run could end itself.
"""

from __future__ import annotations

import atexit
import fcntl
import json
import os
import shlex
import time
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

from vibroimpact.io.whole_file import HOST, RecordError, folder_problem, process_lives

BOOT = Path("/proc/sys/kernel/random/boot_id")  # on Linux; a new one at each start of the machine
CLOCK_S = 60.0  # that the clocks of two machines may differ


class FolderTaken(Exception):
    """Another run works in the folder; the message names it."""


@dataclass(frozen=True)
class Owner:
    """A run: its machine and the start of that, its process, when it began, its command."""

    host: str
    boot: str
    process: int
    started: str
    command: str

    def __str__(self) -> str:
        return f"process {self.process} on {self.host}, begun {self.started} ({self.command})"


def start_text(killed: Owner | None, removed: Sequence[Path]) -> list[str]:
    """Return what a run says at its start of one that was killed; nothing where none was.

    removed: temporary files that were left over and are removed.
    """
    lines = []
    if killed is not None:
        lines.append(
            f"The last run was killed: {killed}. It is continued: complete files are kept, and what"
            " it was writing is made again."
        )
    if removed:
        lines.append(f"{len(removed)} temporary files of killed jobs are removed.")
    return lines


def require_past(files: Iterable[str | Path]) -> None:
    """Raise RecordError for files that are dated in the future.

    Snakemake takes what is made of them for older than they are, and deletes it.
    """
    now = time.time()
    ahead = {Path(file) for file in files if os.path.isfile(file)}
    ahead = {file for file in ahead if file.stat().st_mtime > now + CLOCK_S}
    if ahead:
        first = min(ahead)
        hours = (first.stat().st_mtime - now) / 3600.0
        more = f", and {len(ahead) - 1} more" if len(ahead) > 1 else ""
        raise RecordError(
            f"{first} is dated {hours:.2g} hours in the future{more}: what is made of it would seem"
            " older and be thrown away. Set the clock of this machine, or of the one that wrote it,"
            f" then give it the present time: touch {shlex.join(map(str, sorted(ahead)[:5]))}"
        )


def take_folder(mark: str | Path, command: Sequence[str]) -> Owner | None:
    """Take a folder for this process until it ends.

    mark: the file that tells whose the folder is; it is created.
    command: program and arguments of the run.

    Returns the Owner whose run was killed and is continued, None where the last run ended itself.
    Raises FolderTaken where another run is alive, or may be alive on another machine; RecordError
    where the mark cannot be written.
    """
    mark = Path(mark)
    try:
        mark.parent.mkdir(parents=True, exist_ok=True)
        with ExitStack() as closing:
            file = closing.enter_context(mark.open("a+", encoding="utf-8"))
            before = _take(file, mark, command)
            closing.pop_all()  # open until the process ends: closing gives the lock back
        return before
    except OSError as error:
        reason = folder_problem(mark.parent, error.errno or 0) or error.strerror
        raise RecordError(f"{mark}: cannot be written: {reason}") from error


def _take(file: TextIO, mark: Path, command: Sequence[str]) -> Owner | None:
    locked = _lock(file)
    before = _owner(file)
    if locked is False or (locked is None and before is not None and _may_live(before)):
        raise FolderTaken(
            f"another run is at work in this folder, {before or 'which has just begun'}: wait until"
            " it ends, or run in another folder"
        )
    if before is not None and before.host != HOST:
        raise FolderTaken(
            f"another run may be at work in this folder, {before}: where it no longer lives, delete"
            f" {mark} and run again"
        )
    _write(file, _this_run(command))
    atexit.register(_end, file)
    return before


def _lock(file: TextIO) -> bool | None:
    """Return whether this process now has the lock; None where the file system knows no locks."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True


def _owner(file: TextIO) -> Owner | None:
    file.seek(0)
    try:
        return Owner(**json.load(file))
    except (ValueError, TypeError):  # empty after a run that ended itself
        return None


def _this_run(command: Sequence[str]) -> Owner:
    boot = BOOT.read_text(encoding="ascii").strip() if BOOT.is_file() else ""
    started = f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC"
    words = " ".join([Path(command[0]).name, *command[1:]])
    return Owner(HOST, boot, os.getpid(), started, words)


def _may_live(owner: Owner) -> bool:
    """Return whether the process of an owner may be alive."""
    here = _this_run(["any"])
    return owner.host != HOST or (owner.boot == here.boot and process_lives(owner.process))


def _write(file: TextIO, owner: Owner) -> None:
    file.truncate(0)
    json.dump(asdict(owner), file)
    file.flush()


def _end(file: TextIO) -> None:
    """Say in the mark that the run has ended itself."""
    with suppress(OSError):
        file.truncate(0)
        file.close()
