"""A table of texts on a page, and the few values of many that it has room for."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

# A number, an interval or none.
NUMBER = re.compile(r"-|((< |over )?[-+]?\d[-+.e\d]*( to -?\d[-+.e\d]*)?( %)?)")
LONG_CELL = 30  # characters of a cell that holds a sentence


class Table(NamedTuple):
    """A table of texts.

    columns: their headings, with units.
    rows: one tuple of cells per row.
    """

    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]

    def numeric(self) -> list[bool]:
        """Return for each column whether it holds numbers, which are aligned to the right."""
        cells = [[row[at] for row in self.rows] for at in range(len(self.columns))]
        return [bool(column) and all(map(NUMBER.fullmatch, column)) for column in cells]

    def wordy(self) -> bool:
        """Whether some cells hold sentences, so that a narrow screen shows a row as a block."""
        return any(len(cell) > LONG_CELL for row in self.rows for cell in row)


def table_of(rows: Iterable[Mapping[str, Any]], left_out: Sequence[str] = ()) -> Table:
    """Return the Table of rows {heading: cell}, all with the same headings, some left out.

    Without rows it has no columns.
    """
    rows = list(rows)
    columns = tuple(name for name in (rows[0] if rows else ()) if name not in left_out)
    return Table(columns, [tuple(str(row[name]) for name in columns) for row in rows])


def spread_evenly(values: Sequence, most: int) -> list:
    """Return at most `most` of the values, both ends among them, evenly spaced in their order."""
    if len(values) <= most:
        return list(values)
    return [values[round(at * (len(values) - 1) / (most - 1))] for at in range(most)]
