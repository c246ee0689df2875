"""Links of the documentation: every relative link leads to a file, every anchor to a heading."""

import pytest

from tests.docs.markdown import PAGES, ROOT, anchors, links, name


def broken(page):
    """The page's relative links that lead nowhere."""
    found = []
    for link in links(page):
        if link.startswith(("http://", "https://", "mailto:")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        if not target.exists():
            found.append(link)
        elif anchor and anchor not in anchors(target):
            found.append(link)
    return found


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_relative_links_and_anchors_resolve(page):
    assert broken(page) == []


def test_a_broken_link_is_seen(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# One heading\n[a](#one-heading) [b](#other) [c](gone.md) [d](page.md)\n")
    assert broken(page) == ["#other", "gone.md"]


def test_every_page_is_in_the_site():
    listed = "\n".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").rglob("*.md"))
    pages = [page for page in PAGES if ROOT / "docs" in page.parents and page.stem != "index"]
    assert [name(page) for page in pages if page.stem not in listed] == []


def test_every_figure_is_shown_in_a_page():
    shown = {link.split("/")[-1] for page in PAGES for link in links(page)}
    figures = (ROOT / "docs" / "figures").glob("*")
    assert sorted(figure.name for figure in figures if figure.name not in shown) == []
