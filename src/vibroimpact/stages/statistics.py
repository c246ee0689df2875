"""Gather the statistics of all cases into one table."""

from typing import Any

from vibroimpact.io.records import write_table
from vibroimpact.study.case_files import read_case
from vibroimpact.study.statistics_table import statistics_rows


def make(given: Any, made: Any, params: Any) -> None:
    """given: records. made: table. params: config."""
    rows = [row for path in given.records for row in statistics_rows(read_case(path))]
    write_table(rows, made.table)
    cases = len(given.records)
    print(f"{params.config['study']}: {len(rows)} rows from {cases} cases")
