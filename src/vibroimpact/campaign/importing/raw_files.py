"""The raw files of a folder: which are read, and the signals in them.

No file outside the folder is read.
"""

from collections.abc import Collection, Iterable
from pathlib import Path

from vibroimpact.io.records import MOST_READ
from vibroimpact.io.signal_files.array_files import read_matlab, read_netcdf
from vibroimpact.io.signal_files.csv_table import read_csv
from vibroimpact.io.signal_files.signals import UNREAD, ImportProblem, Signal

from .sidecar import NAME, read_sidecar
from .uff import read_uff

READERS = {
    **dict.fromkeys((".uff", ".unv", ".uf", ".ufb"), read_uff),
    ".mat": read_matlab,
    ".csv": read_csv,
    ".nc": read_netcdf,
}


def raw_files(folder: str | Path) -> list[Path]:
    """Return the files that the import of a folder reads, campaign.yaml first if there is one.

    Raises ImportProblem for a folder or a campaign.yaml that can not be read, if there is no
    measurement, and for a file that is a link out of the folder.
    """
    folder = Path(folder)
    inside = _files(folder)
    described = [file for file in inside if file.name == NAME]
    problems = _outside(folder, described)
    if problems:
        raise ImportProblem("\n".join(problems))
    wanted = (
        {name for record in read_sidecar(described[0]).records for name in record.all_files()}
        if described
        else None
    )
    measured = _measured(folder, inside, wanted)
    problems = [*_outside(folder, measured), *_unusual(measured)]
    if problems:
        raise ImportProblem("\n".join(problems))
    return [*described, *measured]


def read_signals(files: Iterable[Path]) -> dict[str, list[Signal]]:
    """Return {file name: Signals} of measured files. Raises ImportProblem with those of all."""
    found, problems = {}, []
    for file in files:
        try:
            found[file.name] = READERS[file.suffix.lower()](file)
        except ImportProblem as problem:
            problems.append(str(problem))
        except OSError as error:
            problems.append(f"{file}: can not be read ({error.strerror}): check its permissions")
    if problems:
        raise ImportProblem("\n".join(problems))
    return found


def _files(folder: Path) -> list[Path]:
    """Return the files in a folder. Raises ImportProblem."""
    try:
        return sorted(file for file in folder.iterdir() if file.is_file())
    except OSError as error:
        raise ImportProblem(
            f"{folder}: is no folder that can be read ({error.strerror}): give the folder that"
            " holds the measurements, --config import=FOLDER"
        ) from error


def _measured(folder: Path, inside: list[Path], wanted: Collection[str] | None) -> list[Path]:
    """Return the measurements among the files of a folder. Raises ImportProblem without any.

    wanted: names of the files to read; None for all.
    """
    files = [
        file
        for file in inside
        if file.suffix.lower() in READERS and (wanted is None or file.name in wanted)
    ]
    unread = [
        f"{file}: {UNREAD[file.suffix.lower()]}"
        for file in inside
        if file.suffix.lower() in UNREAD and (not files if wanted is None else file.name in wanted)
    ]
    if unread:
        raise ImportProblem("\n".join(unread))
    if not files and wanted is not None:
        raise ImportProblem(
            "\n".join(
                f"{folder / NAME}: record file '{name}' {absence(folder / name)} (read are"
                f" {', '.join(READERS)})"
                for name in sorted(wanted)
            )
        )
    if not files:
        raise ImportProblem(
            f"{folder}: holds no measurement: files ending in {', '.join(READERS)} are read"
        )
    return files


def absence(path: Path) -> str:
    """Return why a wanted file is not read."""
    if ".." in path.parts:
        return "is outside the folder: put a copy into it, only its own files are read"
    if path.is_dir():
        return "is a folder, not a file"
    if path.is_file():
        return f"ends in '{path.suffix}', a kind of file that is not read"
    return "is no ordinary file (a pipe or a device)" if path.exists() else "is not in the folder"


def _outside(folder: Path, files: list[Path]) -> list[str]:
    """Return a sentence for each file that is a link out of the folder."""
    home = folder.resolve()
    return [
        f"{file}: is a link to {file.resolve()}, out of the folder: only files of the folder itself"
        " are read, put a copy in its place"
        for file in files
        if not file.resolve().is_relative_to(home)
    ]


def _unusual(files: list[Path]) -> list[str]:
    """Return a sentence for each file that is too large, or whose name can not be written."""
    return [
        f"{file}: has {file.stat().st_size:.3g} bytes, at most {MOST_READ:.0e} are read from one"
        " file: store fewer signals or a shorter record in each"
        for file in files
        if file.stat().st_size > MOST_READ
    ] + [
        f"{str(file)!r}: has a name with characters that can not be printed: rename it"
        for file in files
        if not file.name.isprintable()
    ]
