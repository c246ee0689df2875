"""The page docs/reliability.md, written by the tests: `make reliability`.

A test states what it has shown through the fixture `reliability`. A statement counts if its test
passes. Parallel workers send theirs to the main process with the report of the test.
"""

import csv
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reliability.md"
TABLES = ROOT / "docs" / "evidence"
RELIABILITY = pytest.StashKey[list]()
HEADERS = {
    "faults": ("fault", "outcome"),
    "inputs": ("input", "tried", "refused with a sentence", "right"),
    "scale": ("quantity", "measured"),
}
TITLES = {
    "faults": "Faults",
    "inputs": "Input",
    "scale": "Scale",
}
SEPARATOR = "; "  # between the faults of one outcome
INTRODUCTION = """# Reliability

<!-- Written by `make reliability`: do not edit. -->

Every row of these tables is stated by a test that passed.

- **Programs.** A profile of Snakemake is a program, and so is a configuration with `__use_yte__`
  under `--workflow-profile none`: Snakemake runs it before this package reads it. Run
  `vibroimpact check FILE` on files of others first; it runs nothing.
- **Numbers.** Every number of a configuration acts or is refused: a test moves each and demands
  another model, force or setting of a stage. Exceptions: velocities, criterion and turbulence of
  `flow` (`vibroimpact stability` alone), `record.stress_limit_Pa` (a flag), the rows of matrices in
  files, the sampling frequency of a force (that of its file). The stiffness of a support with a
  Hertzian contact acts on its friction alone, and `grid.gap_m` names the case if every support
  has a gap of its own.
- **Results** of another configuration than the one in their folder are refused by `vibroimpact
  equivalent` and `vibroimpact wear`.
- **Campaigns** are checked without a model. This cannot show a swap of two sensors with like
  gains, the polarity of a sensor across the force that does not follow it, and a factor below 4
  of a record or below 5 of a channel.
"""
SECTION = """## {title}

{summary} ([table](evidence/{file})).

```{{csv-table}}
:file: evidence/{file}
:header-rows: 1
```
"""


class Statements:
    """What one test has shown, as rows of the page."""

    def __init__(self, record_property) -> None:
        self._record = record_property

    def fault(self, fault: str, outcome: str) -> None:
        """State a fault that was tried, and what happens then."""
        self._record("faults", [fault, outcome])

    def inputs(self, what: str, tried) -> None:
        """State how many generated inputs were refused or right.

        tried: the `Tried` of the test (tests/properties/guarded.py).
        """
        counts = tried.outcomes
        self._record(
            "inputs", [what, *map(str, (counts.total(), counts["refused"], counts["right"]))]
        )

    def scale(self, what: str, measured: str) -> None:
        """State a figure of scale that the test has measured or counted."""
        self._record("scale", [what, measured])


@pytest.fixture
def reliability(record_property):
    """What a test states on the page of reliability."""
    return Statements(record_property)


def pytest_addoption(parser):
    """Add --reliability, which writes the page."""
    parser.addoption(
        "--reliability",
        action="store_true",
        help=f"run only the tests that state something, and write {PAGE.name}",
    )


def pytest_configure(config):
    """Start the list of rows."""
    config.stash[RELIABILITY] = []
    config.pluginmanager.register(_Collector(config), "reliability-collector")


def pytest_collection_modifyitems(config, items):
    """Leave out the tests that state nothing, where the page is to be written."""
    if config.getoption("--reliability"):
        stating = [item for item in items if "reliability" in item.fixturenames]
        config.hook.pytest_deselected(items=[item for item in items if item not in stating])
        items[:] = stating


class _Collector:
    """Collects the rows of passed tests, and writes the page at the end."""

    def __init__(self, config) -> None:
        self.config = config

    def pytest_runtest_logreport(self, report):
        """Keep what a passed test has stated."""
        if report.when == "call" and report.passed:
            self.config.stash[RELIABILITY] += [
                (section, row) for section, row in report.user_properties if section in HEADERS
            ]

    def pytest_sessionfinish(self, session):
        """Write the page in the main process."""
        if self.config.getoption("--reliability") and not hasattr(self.config, "workerinput"):
            write(self.config.stash[RELIABILITY])


def write(rows):
    """Write the page and its tables from rows (section, cells)."""
    parts = [INTRODUCTION]
    for section, header in HEADERS.items():
        table = sorted({tuple(cells) for name, cells in rows if name == section})
        if section == "faults":
            table = by_outcome(table)
        with table_file(section).open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *table])
        parts.append(
            SECTION.format(
                title=TITLES[section],
                summary=summary(section, table),
                file=table_file(section).name,
            )
        )
    PAGE.write_text("\n".join(parts), encoding="utf-8")


def table_file(section):
    """Return the path of the table of a section."""
    return TABLES / f"reliability_{section}.csv"


def summary(section, table):
    """Return the sentence above the table of a section."""
    if section == "faults":
        count = sum(len(row[0].split(SEPARATOR)) for row in table)
        return f"{count} faults were tried; those with one outcome share a row"
    if section == "inputs":
        tried, refused, right = (sum(int(row[i]) for row in table) for i in (1, 2, 3))
        return (
            f"{tried:,} generated inputs of {len(table)} kinds: {refused:,} were refused with a"
            f" sentence, {right:,} gave right results, none crashed"
        )
    return "Costs that must not grow with the size of a study"


def by_outcome(rows):
    """Return rows (fault, outcome) with the faults of one outcome in one cell, in the order of
    the first fault.
    """
    faults = {}
    for fault, outcome in rows:
        faults.setdefault(outcome, []).append(fault)
    return [(SEPARATOR.join(group), outcome) for outcome, group in faults.items()]
