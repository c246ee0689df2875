"""The page of a study: one HTML file that needs nothing else, with interactive plots.

The answer comes first, then spectra and shapes at any load, contact, wear, stress, the energy
balance, every figure, and the configuration as it ran.
"""

import base64
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from PIL import Image

from vibroimpact.io.records import read_text

from . import study_tables
from .captions import CATEGORIES, Caption
from .number_text import digits
from .page import rendered
from .study_content import StudyContent
from .study_words import answers_by_place
from .wear_life import wear_table

SCRIPT = Path(__file__).with_suffix(".js")
LARGE_BYTES = 150_000  # pictures above it get a palette, which takes a third of their size
COLOURS = 256


class Picture(NamedTuple):
    """A figure of the study.

    caption: its Caption.
    details: how to read it in full, with the values of the configuration.
    data: the picture as base64 text of a PNG file.
    """

    caption: Caption
    details: str
    data: str


def pictures(paths: Iterable[str | Path], captions: Mapping[str, Caption]) -> list[Picture]:
    """Return the Pictures of PNG files, each with its .txt file next to it, in their order.

    captions: {stem of the file: Caption}.

    Raises KeyError for a figure without a caption.
    """
    return [
        Picture(
            captions[path.stem],
            read_text(path.with_suffix(".txt")).strip(),
            base64.b64encode(few_colours(path)).decode(),
        )
        for path in map(Path, paths)
    ]


def few_colours(path: Path) -> bytes:
    """Return the bytes of a PNG file; those of a large one as a picture with COLOURS colours."""
    data = path.read_bytes()
    if len(data) <= LARGE_BYTES:
        return data
    target = io.BytesIO()
    with Image.open(path) as picture:
        # Median cut keeps the colour maps smooth.
        reduced = picture.convert("RGB").quantize(
            COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE
        )
    reduced.save(target, "PNG")
    return target.getvalue()


class PagePlots(NamedTuple):
    """The interactive plots of the page.

    sections: {answer, response, contact, stress or energy: plots with name, title, caption, wide
    and drawn()}.
    controls: with name, label, values and numbers.
    library: source text of plotly.js.
    """

    sections: Mapping[str, Sequence[Any]]
    controls: Sequence[Any]
    library: str


def study_page(content: StudyContent, plots: PagePlots, pictures: Sequence[Picture]) -> str:
    """Return the HTML page of a study.

    pictures: in their order within each category.
    """
    shown = [plot for section in plots.sections.values() for plot in section]
    used = {name for plot in shown for name in plot.controls}
    groups = {
        category: [picture for picture in pictures if picture.caption.category == category]
        for category in CATEGORIES
    }
    data = {
        "plots": [plot.drawn(plots.controls) for plot in shown],
        "controls": [
            {"name": control.name, "numbers": control.numbers, "values": control.values}
            for control in plots.controls
        ],
        "here": answers_by_place(content),
    }
    return rendered(
        "study_page.html",
        content=content,
        digits=digits,
        tables=study_tables,
        wear_table=wear_table,
        sections=plots.sections,
        controls=[each for each in plots.controls if len(each.values) > 1 and each.name in used],
        categories=[(category, group) for category, group in groups.items() if group],
        library=plots.library,
        # < is escaped, so that no text ends the script element
        data=json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False).replace(
            "<", "\\u003c"
        ),
        script=SCRIPT.read_text(encoding="utf-8"),
    )
