"""Captions of figures and tables: reStructuredText files that name a category and a title.

The workflow gives the same files to `snakemake --report`, so that it and the page of a study say
the same. Their first lines are comments of reStructuredText: `.. category: Response` and
`.. title: Spectra of all loads`.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from vibroimpact.io.whole_file import read_text

# In the order in which a reader needs them.
CATEGORIES = ("Equivalent support", "Response", "Contact, wear and stress", "Checks", "Model")
HEADER = re.compile(r"^\.\. (category|title): (.+)$", flags=re.M)


class CaptionError(ValueError):
    """A caption without category, title or text; the message names the file."""


@dataclass(frozen=True)
class Caption:
    """The caption of a figure or table.

    name: stem of the file that is described.
    category: one of CATEGORIES.
    title: a few words.
    text: one or two sentences.
    """

    name: str
    category: str
    title: str
    text: str


def read_caption(path: str | Path) -> Caption:
    """Return the Caption of a .rst file.

    Raises CaptionError if the category is not one of CATEGORIES, or if the title or the text
    is missing; RecordError if there is no such file.
    """
    path = Path(path)
    source = read_text(path)
    header = dict(HEADER.findall(source))
    text = " ".join(HEADER.sub("", source).split())
    if header.get("category") not in CATEGORIES:
        raise CaptionError(
            f"{path}: category '{header.get('category', '')}' is none of {', '.join(CATEGORIES)}:"
            " write a line '.. category: NAME'"
        )
    if not header.get("title") or not text:
        raise CaptionError(f"{path}: give a line '.. title: WORDS' and a sentence below it")
    return Caption(path.stem, header["category"], header["title"], text)
