"""The notebooks run from top to bottom, use the public interface only and hold no outputs."""

import ast
import os
import re

import nbformat
import pytest
from nbclient import NotebookClient

import vibroimpact
from tests.docs.markdown import ROOT

NOTEBOOKS = sorted((ROOT / "docs" / "notebooks").glob("*.ipynb"))
SECONDS = 600  # a cell may compile the kernels


def name(path):
    """The file's name without its ending."""
    return path.stem


def executed(path):
    """The notebook with its outputs, run in its own folder with the library of this checkout."""
    book = nbformat.read(path, as_version=4)
    where = {"metadata": {"path": str(path.parent)}}
    client = NotebookClient(book, timeout=SECONDS, kernel_name="python3", resources=where)
    client.execute(env=os.environ | {"PYTHONPATH": str(ROOT / "src")})
    return book


def outputs(book):
    """(printed text and representations, number of pictures) of an executed notebook."""
    found = [output for cell in book.cells for output in cell.get("outputs", [])]
    texts = [
        output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in found
    ]
    return "\n".join(texts), sum("image/png" in output.get("data", {}) for output in found)


def test_there_are_three_notebooks():
    assert [path.stem[:2] for path in NOTEBOOKS] == ["01", "02", "03"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=name)
def test_no_output_is_stored(path):
    cells = [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    assert len(cells) > 3
    assert [cell.id for cell in cells if cell.outputs or cell.execution_count is not None] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=name)
def test_only_public_names_are_used(path):
    code = [cell.source for cell in nbformat.read(path, 4).cells if cell.cell_type == "code"]
    tree = ast.parse("\n".join(code))
    imported = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for alias in node.names
        if "vibroimpact" in (getattr(node, "module", None) or alias.name)
    }
    used = {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "vi"
    }
    assert imported == {"vibroimpact"} and used
    assert used - set(vibroimpact.PUBLIC) == set()


def test_first_notebook_reaches_spectrum_and_stiffness():
    text, pictures = outputs(executed(NOTEBOOKS[0]))
    assert pictures == 3
    k = {method: float(value) for method, value in re.findall(r"^(\w+) +([\d.e+]+) ±", text, re.M)}
    assert k["ods"] == pytest.approx(k["lscf"], rel=0.25)  # the methods agree
    loads = dict(re.findall(r"^ +(\d+) N RMS: +([\d.e+]+) N/m", text, re.M))
    assert float(loads["20"]) > k["lscf"] > float(loads["2"])  # louder is stiffer


def test_second_notebook_gives_contact_wear_and_frequencies():
    text, pictures = outputs(executed(NOTEBOOKS[1]))
    assert pictures == 3
    by_library, by_hand = re.search(
        r"vibroimpact: \[(.*)\] Hz; by hand: \[(.*)\] Hz", text
    ).groups()
    assert by_library == by_hand
    assert "is 0.5000 m off the tube" in text
    assert all(float(power) > 100.0 for power in re.findall(r"er: ([\d.e+]+) mW", text))


@pytest.mark.slow
def test_third_notebook_draws_the_collapse_of_a_study():
    text, pictures = outputs(executed(NOTEBOOKS[2]))
    assert pictures == 2
    ratios = re.search(r"over that at the narrow gap: \[(.*)\]", text)[1].split()
    assert len(ratios) >= 2 and all(0.5 < float(ratio) < 2.0 for ratio in ratios)
    assert text.count("agree ") >= 5
