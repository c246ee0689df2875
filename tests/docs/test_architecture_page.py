"""docs/architecture.md beside the tree: packages in their order, and files that exist."""

import re

from tests.docs.markdown import ROOT

PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PACKAGES, ROOMS = PAGE.split("## Which room")
LIBRARY = ROOT / "src" / "vibroimpact"


def test_every_package_has_its_sentence():
    listed = re.findall(r"^\| `(\w+)` \|", PACKAGES, flags=re.M)
    there = {entry.stem for entry in LIBRARY.iterdir() if entry.suffix == ".py" or entry.is_dir()}
    assert sorted(listed) == sorted(there - {"__init__", "__main__", "__pycache__"})


def test_packages_stand_in_the_order_of_their_imports():
    source = (ROOT / "tests" / "test_architecture.py").read_text(encoding="utf-8")
    order = re.findall(r'"(\w+)"', re.search(r"^PACKAGES = \((.*?)^\)", source, re.M | re.S)[1])
    listed = re.findall(r"^\| `(\w+)` \|", PACKAGES, flags=re.M)
    assert listed == [package for package in order if package in listed]


def test_every_room_exists():
    paths = re.findall(r"`([\w/]+/[\w./]*)`", ROOMS.split("## Rules")[0])
    assert len(paths) > 20
    assert [
        path for path in paths if not any((base / path).exists() for base in (LIBRARY, ROOT))
    ] == []


def test_packages_of_the_site_exist():
    source = (ROOT / "docs" / "site_pages.py").read_text(encoding="utf-8")
    public = re.findall(r'"(\w+)"', re.search(r"^PUBLIC = \((.*?)^\)", source, re.M | re.S)[1])
    assert public and [name for name in public if not (LIBRARY / name).exists()] == []


def test_there_are_at_most_40_decisions_of_four_parts():
    text = (ROOT / "docs" / "decisions.md").read_text(encoding="utf-8")
    entries = re.split(r"^### ", text, flags=re.M)[1:]
    assert 0 < len(entries) <= 40
    for entry in entries:
        parts = re.findall(r"^- \*\*(Context|Choice|Reason|Reversed by)\b", entry, flags=re.M)
        assert parts == ["Context", "Choice", "Reason", "Reversed by"], entry.splitlines()[0]
