"""Signals of a CSV file."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np

from .arrays import Arrays, signals_of_arrays
from .signals import ImportProblem, Signal
from .text_file import read_encoded

HEADER_UNIT = re.compile(r"\s*(.*?)\s*[\[(]\s*([^\])]+?)\s*[\])]\s*")  # acc top [m/s^2]
NUMBER = re.compile(
    r"\s*[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|inf|infinity|nan)\s*", re.ASCII | re.IGNORECASE
)
SHOWN = 5  # cells that are no numbers; more are counted


def read_csv(path: str | Path) -> list[Signal]:
    """Return the Signals of a CSV file.

    It has one header line with names, "name" or "name [unit]"; a column "time" gives the sampling.
    The separator is a comma, semicolon or tab. Raises ImportProblem for two columns of one name and
    where a cell is no number.
    """
    text, note = read_encoded(path)
    lines = [
        (number, line.rstrip("\n"))
        for number, line in enumerate(io.StringIO(text, newline=None), start=1)
        if line.strip() and not line.startswith("#")
    ]
    if len(lines) < 3:
        raise ImportProblem(
            f"{path}: holds no table: a header line with names, then one line per sample"
        )
    header = lines.pop(0)[1]
    separator = max(",;\t", key=header.count)
    names, units = _columns(path, header.split(separator))
    table = _numbers(path, lines, names, separator)
    return signals_of_arrays(
        Arrays(
            path,
            {name: table[:, index] for index, name in enumerate(names)},
            units,
            "header of the file",
            note=note,
            lines=np.array([number for number, _ in lines]),
        )
    )


def _columns(path, cells):
    """Return (names, {name: unit}) of the columns. Raises ImportProblem for equal names."""
    cells = [cell.strip().strip('"') for cell in cells]
    parts = [HEADER_UNIT.fullmatch(cell) for cell in cells]
    names = [part[1] if part else cell for part, cell in zip(parts, cells, strict=True)]
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if twice:
        raise ImportProblem(
            f"{path}: {names.count(twice[0])} columns are called '{twice[0]}': give each column a"
            " name of its own"
        )
    return names, {name: part[2] for name, part in zip(names, parts, strict=True) if part}


def _numbers(path, lines, names, separator):
    """Return (sample, column) the numbers of numbered lines. Raises ImportProblem."""
    try:
        table = np.loadtxt([line for _, line in lines], delimiter=separator, comments=None, ndmin=2)
    except ValueError as error:
        raise ImportProblem(
            "\n".join(_faults(path, lines, names, separator)) or f"{path}: no table ({error})"
        ) from error
    if table.shape[1] != len(names):
        raise ImportProblem("\n".join(_faults(path, lines, names, separator)))
    return table


def _faults(path, lines, names, separator):
    """Return a sentence for each of the first cells that are no numbers and lines too long."""
    faults = []
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
            for name, cell in zip(names, cells, strict=True)
            if not NUMBER.fullmatch(cell)
        ]
    more = len(faults) - SHOWN
    return faults[:SHOWN] + ([f"{path}: {more} more of this kind"] if more > 0 else [])
