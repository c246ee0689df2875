"""The README: short, one figure, and it says what the tube is."""

import re

from tests.docs.markdown import ROOT, prose

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_it_has_at_most_700_words():
    assert len(TEXT.split()) <= 700


def test_it_says_that_the_tube_is_a_stand_in():
    assert "stand-in" in TEXT and "GV-LOCAL" in TEXT and "in kind, not in number" in TEXT


def test_it_shows_one_figure():
    assert len(re.findall(r"!\[", prose(ROOT / "README.md"))) == 1


def test_the_release_is_the_same_everywhere():
    library = (ROOT / "src" / "vibroimpact" / "__init__.py").read_text()
    release = re.search(r'__version__ = "([^"]+)"', library)[1]
    project = (ROOT / "pyproject.toml").read_text()
    assert 'dynamic = ["version"]' in project or f'version = "{release}"' in project
    assert f"version: {release}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {release} (" in (ROOT / "CHANGELOG.md").read_text()
