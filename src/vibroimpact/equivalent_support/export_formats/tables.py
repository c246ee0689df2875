"""Springs and dampers as CSV and JSON: one row per point and direction."""

import csv
import io
import json
from typing import Any

from vibroimpact.io.records import plain_values

from ..springs import SpringSet
from .frames import UnitSystem

COLUMNS = (
    *("point", "support", "x", "y", "z"),
    *("direction_x", "direction_y", "direction_z", "k", "c"),
)


def rows(springs: SpringSet) -> list[dict[str, Any]]:
    """Return one dict per point and direction that has a spring, with the keys COLUMNS.

    c is None if it is not resolved.
    """
    table = []
    for spring in springs.springs:
        for axis, k, c in zip(spring.axes, spring.k, spring.c, strict=True):
            if k is None:
                continue
            values = (spring.name, spring.support, *map(float, (*spring.position, *axis)), k, c)
            table.append(dict(zip(COLUMNS, values, strict=True)))
    return table


def csv_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the CSV text: a header and the rows; c is empty if it is not resolved.

    Warnings stand before the header, in lines that begin with #.
    """
    file = io.StringIO()
    file.writelines(f"# WARNING: {sentence}.\n" for sentence in springs.warnings)
    writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows(springs))
    return file.getvalue()


def json_text(springs: SpringSet, unit: UnitSystem, first_number: int) -> str:
    """Return the JSON text: units, notes, the omissions, and the rows."""
    content = {
        "units": unit.name,
        "warnings": springs.warnings,
        "notes": springs.notes,
        "left_out": springs.left_out,
        "springs": rows(springs),
    }
    return json.dumps(plain_values(content), indent=1) + "\n"
