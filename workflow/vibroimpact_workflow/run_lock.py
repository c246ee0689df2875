"""One run at a time in a folder, and what a killed one leaves behind.

The kernel gives the lock of a process back when it ends, however it ends: nobody has to. The text
of the locked file names the run, and stays when the run could not end itself.
"""

from __future__ import annotations

import atexit
import fcntl
import os
import re
import shlex
import time
from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

from vibroimpact.io.whole_file import HOST, RecordError, folder_problem

RUN = re.compile(r"process \d+ on \S+, begun .*")
CLOCK_S = 60.0  # that the clocks of two machines may differ


class FolderTaken(Exception):
    """Another run works in the folder; the message names it."""


def start_text(killed: str, removed: Sequence[Path]) -> list[str]:
    """Return what a run says at its start of one that was killed, "" for none, and of the temporary
    files left over that are removed.
    """
    lines = []
    if killed:
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


def take_folder(lock: str | Path, command: Sequence[str]) -> str:
    """Lock a folder for this process until it ends.

    lock: the file to lock; it is created.
    command: program and arguments of the run.

    Returns the run that was killed here, "" where the last one ended itself. Raises FolderTaken
    where another run is alive, or may be alive on another machine; RecordError where the file
    cannot be written.
    """
    lock = Path(lock)
    try:
        lock.parent.mkdir(parents=True, exist_ok=True)
        with ExitStack() as closing:
            file = closing.enter_context(lock.open("a+", encoding="utf-8"))
            before = _take(file, lock)
            _write(file, command)
            closing.pop_all()  # open until the process ends: closing gives the lock back
    except OSError as error:
        reason = folder_problem(lock.parent, error.errno or 0) or error.strerror
        raise RecordError(f"{lock}: cannot be written: {reason}") from error
    atexit.register(_end, file)
    return before


def _take(file: TextIO, lock: Path) -> str:
    locked, before = _lock(file), _run_in(file)
    if locked is False:
        raise FolderTaken(
            f"another run is at work in this folder, {before or 'which has just begun'}: wait until"
            " it ends, or run in another folder"
        )
    if before and (locked is None or f" on {HOST}, begun " not in before):
        raise FolderTaken(
            f"another run may be at work in this folder, {before}: where it no longer lives, delete"
            f" {lock} and run again"
        )
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


def _run_in(file: TextIO) -> str:
    """Return the run that the file names, "" for a text that names none."""
    file.seek(0)
    match = RUN.fullmatch(file.read())
    return match[0] if match else ""


def _write(file: TextIO, command: Sequence[str]) -> None:
    words = " ".join([Path(command[0]).name, *command[1:]])
    begun = f"{datetime.now(UTC):%Y-%m-%d %H:%M:%S} UTC"
    file.truncate(0)
    file.write(f"process {os.getpid()} on {HOST}, begun {begun} ({words})")
    file.flush()


def _end(file: TextIO) -> None:
    """Name no run in the file any more: this one has ended itself."""
    with suppress(OSError):
        file.truncate(0)
        file.close()
