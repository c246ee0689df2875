"""What the tests of the documentation read from a Markdown page: links, anchors, blocks of code."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "evidence" / "truth" / "README.md",
    *sorted(
        page
        for page in (ROOT / "docs").rglob("*.md")
        if not {"_build", "generated"} & set(page.relative_to(ROOT).parts)
    ),
]
FENCE = re.compile(r"^```([^\n]*)\n(.*?)^```\s*$", flags=re.M | re.S)


def name(page):
    """The page's path from the root of the repository."""
    return str(page.relative_to(ROOT))


def prose(page):
    """The page's text without its blocks of code."""
    return FENCE.sub("", page.read_text(encoding="utf-8"))


def links(page):
    """The targets of the page's links and images, inline code left out."""
    return re.findall(r"!?\[[^\]]*\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", prose(page)))


def anchors(page):
    """The anchors of the page's headings, as GitHub and the site make them."""
    headings = re.findall(r"^#+ +(.*?)\s*$", prose(page), flags=re.M)
    plain = [re.sub(r"[`*]|\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings]
    return {re.sub(r"[^\w\- ]", "", heading).lower().replace(" ", "-") for heading in plain}


def blocks(language):
    """(page, number, text) of every block of code in a language, over all pages."""
    return [
        (page, number, text)
        for page in PAGES
        for number, (info, text) in enumerate(FENCE.findall(page.read_text(encoding="utf-8")), 1)
        if info.strip() == language
    ]


def shell_lines():
    """(page, line) of every command in the pages: blocks without language, indented lines and
    inline code.
    """
    found = []
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        plain = [body for info, body in FENCE.findall(text) if info.strip() in ("", "bash", "sh")]
        lines = "\n".join(plain).replace("\\\n", " ").splitlines()
        lines += re.findall(r"`([^`\n]+)`", prose(page))
        lines += re.findall(r"^    (\S.*)$", prose(page), flags=re.M)
        found += [(page, line.strip()) for line in lines]
    return found
