"""Files that appear complete or not at all, and the sentence if one cannot be written or read."""

import errno
import os
import re
import shutil
import socket
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

HOST = re.sub(r"[^A-Za-z0-9-]", "-", socket.gethostname())
# .name.of.the.file.HOST.PID: process and machine show whether a file was left over.
TEMPORARY = re.compile(r"\..+\.(?P<host>[A-Za-z0-9-]+)\.(?P<process>\d+)")
PROBE_BYTES = 2**20
FULL = (errno.ENOSPC, errno.EDQUOT)
MAKE_AGAIN = "delete it and run again"  # a result that cannot be read
READ_ONLY, FORBIDDEN = (errno.EROFS,), (errno.EACCES, errno.EPERM)


class RecordError(Exception):
    """A file that cannot be read or written; the message names it."""


def read_text(path: str | Path) -> str:
    """Return the text of a file. Raises RecordError when there is no such file, or no text."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise RecordError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise RecordError(f"{path}: is not text in UTF-8 ({error.reason}): {MAKE_AGAIN}") from error


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path in the folder of a file, which takes the file's name at the end of
    the block.

    Its content is on the disk before it is renamed: after a power failure too there is the old file
    or the new one. The folder is created if it is missing. If the block raises, no file remains.

    Raises RecordError with the reason and the remedy if the folder cannot be written or is full,
    whatever the library that failed in the block said of it.
    """
    path = Path(path)
    temporary = path.with_name(f".{path.name}.{HOST}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        with open(temporary, "rb") as written:
            os.fsync(written.fileno())  # 4 ms on a local disk
        os.replace(temporary, path)  # lost by a power failure, the old file or none is there
    except (OSError, RuntimeError) as error:
        reason = _reason(path.parent, error)
        if reason is None:
            raise
        raise RecordError(f"{path}: cannot be written: {reason}") from error
    finally:
        with suppress(OSError):
            # A library that failed to write it may keep it open: its space is freed at once.
            os.truncate(temporary, 0)
            temporary.unlink()


def _reason(folder: Path, error: Exception) -> str | None:
    """Return why a file of a folder could not be written and the remedy; None if the error is
    not of the folder.
    """
    number = error.errno if isinstance(error, OSError) else None
    if number in (None, *FORBIDDEN):  # netCDF gives these for any failure: see for ourselves
        number = _error_of_writing(folder) or number
    return None if number is None else folder_problem(folder, number)


def _error_of_writing(folder: Path) -> int | None:
    """Return the error number of writing a little to a folder, None if it can be written."""
    try:
        with tempfile.TemporaryFile(dir=_existing(folder)) as file:
            file.write(bytes(PROBE_BYTES))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return error.errno
    return None


def folder_problem(folder: str | Path, number: int) -> str | None:
    """Return a sentence on a folder that gave an error, with its remedy; None for other errors."""
    folder = Path(folder)
    if number in FULL:
        usage = shutil.disk_usage(_existing(folder))
        return (
            f"{folder} is full: {usage.free / 1e6:.0f} MB left of {usage.total / 1e6:.0f} MB:"
            " free space and run again"
        )
    if number in READ_ONLY:
        return f"{folder} is read-only: make it writable, or run in another folder"
    if number in FORBIDDEN:
        return f"there is no permission to write in {folder}: change it, or run in another folder"
    return None


def problem_of(folder: str | Path) -> str | None:
    """Return a sentence on a folder that cannot be written or is full, None if all is well."""
    number = _error_of_writing(Path(folder))
    return None if number is None else folder_problem(folder, number)


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that is there."""
    return next((each for each in (folder, *folder.parents) if each.is_dir()), Path("."))


def remove_left_over(folders: Iterable[str | Path]) -> list[Path]:
    """Remove the temporary files that killed processes of this machine left in folders.

    Returns them. Those of processes that are alive, or of other machines, stay.
    """
    found = []
    for folder in map(Path, folders):
        for entry in os.scandir(folder) if folder.is_dir() else ():
            match = TEMPORARY.fullmatch(entry.name)
            if match and match["host"] == HOST and not process_lives(int(match["process"])):
                with suppress(OSError):
                    os.unlink(entry.path)
                    found.append(Path(entry.path))
    return found


def process_lives(process: int) -> bool:
    """Return whether a process of this machine is alive. One that has ended and whose parent has
    not asked for its exit status, as in a container without an init, is not.
    """
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        return True
    with suppress(OSError):  # on Linux; the state follows the name, which may hold anything
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    return True
