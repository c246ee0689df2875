"""Files of cases, read with a check that their content fits their names."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import xarray as xr

from vibroimpact.identify.estimate import METHODS, table_rows, unresolved
from vibroimpact.identify.linear.support_groups import reached_supports
from vibroimpact.io.records import MAKE_AGAIN, RecordError, read_record, read_table
from vibroimpact.reduction.modal_model import ModalModel

from .cases import case_from_id

PLACE = ("group", "direction", "method")
CASE = ("load_rms_N", "gap_m", "seed")
COLUMNS = frozenset(table_rows([unresolved("", "")], {"load_rms_N": 1, "gap_m": 1, "seed": 0})[0])


def read_case(path: str | Path, names: Iterable[str] | None = None) -> xr.Dataset:
    """Return the dataset of results/<study>/<kind>/<case>.nc; names as in records.read_record.

    Raises RecordError if it cannot be read, or is of another case or study.
    """
    path, dataset = Path(path), read_record(path, names)
    for what, expected in (("case", path.stem), ("study", path.parent.parent.name)):
        found = dataset.attrs.get(what)
        if found != expected:
            holds = "states no" if found is None else f"is of {what} '{found}', not of"
            raise RecordError(f"{path}: {holds} {what} '{expected}': {MAKE_AGAIN}")
    return dataset


def read_estimates(
    paths: Sequence[str | Path], model: ModalModel, groups: str | tuple
) -> list[list[dict]]:
    """Return the rows of each table of estimates, one per case.

    groups: of the supports, as in the configuration.
    Raises RecordError if a table is not of its case, or has not one row for each method, group
    of supports and direction: medians over fewer would look like results.
    """
    directions, _ = reached_supports(model, groups)
    expected = [(each.group, each.direction, method) for each in directions for method in METHODS]
    return [_whole_table(Path(path), expected) for path in paths]


def _whole_table(path: Path, expected: list[tuple[str, str, str]]) -> list[dict]:
    rows, case = read_table(path, PLACE), case_from_id(path.stem)
    problem = ""
    if any(set(row) != COLUMNS for row in rows):
        problem = "has other columns than a table of estimates"
    elif any(row[key] != getattr(case, key) for row in rows for key in CASE):
        problem = "has rows of another case"
    else:
        found = Counter(tuple(row[key] for key in PLACE) for row in rows)
        wrong = [place for place in expected if found[place] != 1]
        if wrong or len(rows) != len(expected):
            first = dict(zip(PLACE, (wrong or list(found - Counter(expected)))[0], strict=True))
            problem = (
                f"has {len(rows)} of {len(expected)} estimates, the first that is missing or twice"
                f" is {first}"
            )
    if problem:
        raise RecordError(f"{path}: {problem}: {MAKE_AGAIN}")
    return rows
