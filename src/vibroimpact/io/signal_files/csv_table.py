"""Signals of a CSV file."""

import io
import re
from pathlib import Path

import numpy as np

from .arrays import Arrays, signals_of_arrays
from .signals import UNREAD, ImportProblem, Signal

HEADER_UNIT = re.compile(r"\s*(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]\s*")  # acc top [m/s^2]
NUMBER = re.compile(
    r"\s*[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|inf|infinity|nan)\s*", re.ASCII | re.IGNORECASE
)
SHOWN = 5  # cells that are not numbers; more are counted
COMMENT = "#%"
TWO_BYTES = (b"\xff\xfe", b"\xfe\xff")  # marks of UTF 16
READ_AS_WINDOWS = "is not UTF-8: read as Windows-1252 (Latin-1)"
LABVIEW = "LabVIEW Measurement"


def read_csv(path: str | Path) -> list[Signal]:
    """Return the Signals of a CSV file.

    One line of names stands above the table, "name" or "name [unit]", as a comment or not; a column
    "time" gives the sampling. The separator is a comma, semicolon, tab or blanks; with a semicolon
    or tab, decimal commas are read. Raises ImportProblem for a table without names, two columns of
    one name or a cell that is not a number.
    """
    numbered, lines, note = _numbered_lines(path)
    separator = next((mark for mark in "\t;," if mark in lines[1][1]), None)
    header = _header(path, numbered, lines, separator)
    if len(lines) < 2:
        raise ImportProblem(f"{path}: holds one sample: a record takes two at least")
    names, units = _columns(path, header)
    if separator in ("\t", ";") and not any("." in line for _, line in lines):
        lines = [(number, line.replace(",", ".")) for number, line in lines]
    # a separator at the begin or the end of each line makes a column without name and values
    rows = [line.split(separator) for _, line in lines]
    empty = {
        index
        for index, name in enumerate(names)
        if not name and all(row[index : index + 1] in ([""], []) for row in rows)
    }
    table = _numbers(path, lines, (names, empty), separator)
    kept = [name for index, name in enumerate(names) if index not in empty]
    columns = {name: table[:, index] for index, name in enumerate(kept)}
    places = np.array([number for number, _ in lines])
    arrays = Arrays(path, columns, units, "header of the file", note=note, lines=places)
    return signals_of_arrays(arrays)


def _numbered_lines(path):
    """Return [(number, line)] of a file, those that are not a comment, and a note on its encoding.
    Raises ImportProblem if there is no table.
    """
    text, note = _read_encoded(path)
    if text.startswith(LABVIEW):
        raise ImportProblem(f"{path}: {UNREAD['.lvm']}")
    rows = enumerate(io.StringIO(text, newline=None), start=1)
    numbered = [(number, line.rstrip("\n")) for number, line in rows if line.strip()]
    lines = [(number, line) for number, line in numbered if line[0] not in COMMENT]
    if len(lines) < 2:
        raise ImportProblem(
            f"{path}: holds no table: a header line with names, then one line per sample"
        )
    return numbered, lines, note


def _read_encoded(path: str | Path) -> tuple[str, str]:
    """Return (text, note) of a file in UTF-8, in UTF 16 with its mark, or else in Windows-1252.

    Instruments write µ and ² in the code page of their system. In those of Windows and in Latin-1
    both are the same bytes, which are not UTF-8; a wrong guess gives a unit or a name that is not
    known, which is refused. The note says that Windows-1252 was read. Raises ImportProblem for a
    binary file.
    """
    raw = Path(path).read_bytes()
    wide = raw.startswith(TWO_BYTES)
    encodings = ("utf_16",) if wide else ("utf-8-sig", "cp1252")
    if not wide and b"\0" in raw:
        raise ImportProblem(f"{path}: is a binary file: export it as text, in UTF-8")
    for encoding in encodings:
        try:
            return raw.decode(encoding), READ_AS_WINDOWS if encoding == "cp1252" else ""
        except UnicodeDecodeError as error:
            line = raw[: error.start].count(b"\n") + 1
    raise ImportProblem(
        f"{path}: line {line}: a character that is neither UTF-8 nor Windows-1252: save the file as"
        " UTF-8"
    )


def _header(path, numbered, lines, separator):
    """Return the cells of the line of names, which is taken out of lines if it is not a comment.

    It is the first line of the table, or the last comment above it if that holds numbers.
    """
    number, first = lines[0]
    cells = first.split(separator)
    if not all(NUMBER.fullmatch(cell) for cell in cells if cell.strip()):
        lines.pop(0)
        return _split(first, len(lines[0][1].split(separator)), separator)
    above = [line.lstrip(COMMENT) for at, line in numbered if at < number]
    if not above:
        raise ImportProblem(
            f"{path}: line {number} holds numbers, the names of the columns are missing: write a"
            " line of names above it, such as time [s],force [N],tip [m/s^2]"
        )
    names = _split(above[-1], len(cells), separator)
    if len(names) != len(cells):
        raise ImportProblem(
            f"{path}: the comment above line {number} has {len(names)} names for {len(cells)}"
            " columns: write a line of names, one for each"
        )
    return names


def _split(line, columns, separator):
    """Return the cells of a line of names: by the separator that gives as many as there are
    columns, else by that of the table.
    """
    for mark in (*([separator] if separator else []), *",;\t", None):
        cells = line.split(mark)
        if len(cells) == columns and len([cell for cell in cells if cell.strip()]) == columns:
            return cells
    return line.split(separator)


def _columns(path, cells):
    """Return (names, {name: unit}) of the columns. Raises ImportProblem for equal names."""
    cells = [cell.strip(' \t",;') for cell in cells]
    parts = [HEADER_UNIT.fullmatch(cell) for cell in cells]
    names = [part[1] if part else cell for part, cell in zip(parts, cells, strict=True)]
    twice = [name for name in dict.fromkeys(filter(None, names)) if names.count(name) > 1]
    if twice:
        raise ImportProblem(
            f"{path}: {names.count(twice[0])} columns are called '{twice[0]}': give each column a"
            " name of its own"
        )
    return names, {name: part[2] for name, part in zip(names, parts, strict=True) if part}


def _numbers(path, lines, columns, separator):
    """Return (sample, column) the numbers of numbered lines, without the empty columns.

    columns: (names, numbers of the empty ones). Raises ImportProblem.
    """
    names, empty = columns
    wanted = [index for index in range(len(names)) if index not in empty]
    rows = [line for _, line in lines]
    try:
        if any(len(row.split(separator)) != len(names) for row in rows):
            raise ValueError("lines of several lengths")
        return np.loadtxt(rows, delimiter=separator, comments=None, ndmin=2, usecols=wanted)
    except ValueError as error:
        faults = _faults(path, lines, columns, separator)
        raise ImportProblem("\n".join(faults) or f"{path}: no table ({error})") from error


def _faults(path, lines, columns, separator):
    """Return a sentence for each of the first cells that are not numbers and lines too long."""
    faults = []
    names, empty = columns
    for number, line in lines:
        cells = line.split(separator)
        if len(cells) != len(names):
            faults.append(
                f"{path}: line {number}: {len(cells)} cells under {len(names)} names: complete the"
                " line, or cut it off"
            )
            continue
        faults += [
            f"{path}: line {number}, column {name}: '{cell.strip()[:40]}' is no number with a point"
            " as decimal sign: correct it, or write nan for a sample that is missing"
            for index, (name, cell) in enumerate(zip(names, cells, strict=True))
            if index not in empty and not NUMBER.fullmatch(cell)
        ]
    more = len(faults) - SHOWN
    return faults[:SHOWN] + ([f"{path}: {more} more of this kind"] if more > 0 else [])
