"""The documentation stays short: words of a page, items of a release."""

import re

import pytest

from tests.docs.markdown import PAGES, ROOT, name

WORDS = 1800
LONGER = {"docs/decisions.md": 2500}
ITEMS = 10  # of a release in the changelog


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_a_page_has_at_most_1800_words(page):
    assert len(page.read_text(encoding="utf-8").split()) <= LONGER.get(name(page), WORDS)


def test_a_release_has_at_most_ten_items():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.split(r"^## ", text, flags=re.M)[1:]
    counts = {part.split()[0]: len(re.findall(r"^- ", part, re.M)) for part in releases}
    counts.pop("Unreleased", None)  # shortened when it becomes a release: docs/release.md
    assert counts and {release: n for release, n in counts.items() if n > ITEMS} == {}
