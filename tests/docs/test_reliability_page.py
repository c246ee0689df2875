"""The page of reliability has the rows that the tests state, and no others."""

import ast
import csv

import pytest

from tests.docs.markdown import ROOT
from tests.reliability_page import HEADERS, SEPARATOR, by_outcome, table_file

METHODS = {"fault": "faults", "inputs": "inputs", "scale": "scale"}


def stated(section):
    """Return the first cells that the tests state in a section, those in plain quotes."""
    texts = set()
    for file in sorted((ROOT / "tests").rglob("test_*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Attribute)
                and METHODS.get(node.func.attr) == section
                and isinstance(node.func.value, ast.Name)
                and node.func.value.id == "reliability"
                and isinstance(node.args[0], ast.Constant)
            ):
                texts.add(node.args[0].value)
    return texts


def rows(section):
    """Return the cells of the table of a section."""
    with table_file(section).open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))[1:]


@pytest.mark.parametrize("section", HEADERS)
def test_the_page_has_what_the_tests_state(section):
    listed = {name for row in rows(section) for name in row[0].split(SEPARATOR)}
    missing = {name for text in stated(section) for name in text.split(SEPARATOR)} - listed
    assert missing == set(), "run `make reliability`"


def test_faults_of_one_outcome_stand_together():
    table = [("a", "refused"), ("b", "continues"), ("c", "refused")]
    assert by_outcome(table) == [("a; c", "refused"), ("b", "continues")]


def test_at_least_two_thousand_inputs_were_tried():
    assert sum(int(row[1]) for row in rows("inputs")) >= 2000
