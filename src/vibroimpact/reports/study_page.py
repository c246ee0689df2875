"""The page of a study: one HTML file that needs nothing else, with interactive plots.

The answer comes first, then spectra and shapes at any load, contact, wear, stress, the energy
balance, every figure, and the configuration as it ran.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from .captions import CATEGORIES, Caption
from .number_text import digits
from .page import rendered
from .study_content import StudyContent
from .study_words import answers_by_place

SCRIPT = Path(__file__).with_suffix(".js")


class Picture(NamedTuple):
    """A figure of the study.

    caption: its Caption.
    details: how to read it in full, with the values of the configuration.
    data: the picture as base64 text of a PNG file.
    """

    caption: Caption
    details: str
    data: str


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
    chosen = _useful_controls(plots)
    return rendered(
        "study_page.html",
        content=content,
        digits=digits,
        sections=plots.sections,
        controls=chosen,
        categories=_by_category(pictures),
        library=plots.library,
        data=_as_json(
            {
                "plots": [plot.drawn() for section in plots.sections.values() for plot in section],
                "controls": [
                    {"name": control.name, "numbers": control.numbers, "values": control.values}
                    for control in plots.controls
                ],
                "here": answers_by_place(content),
            }
        ),
        script=SCRIPT.read_text(encoding="utf-8"),
    )


def _useful_controls(plots: PagePlots) -> list[Any]:
    """Return the controls with more than one position that some plot uses."""
    used = {
        name for section in plots.sections.values() for plot in section for name in plot.controls
    }
    return [
        control for control in plots.controls if len(control.values) > 1 and control.name in used
    ]


def _by_category(pictures: Iterable[Picture]) -> list[tuple[str, list[Picture]]]:
    """Return (category, pictures) in the order of CATEGORIES, those without pictures left out."""
    groups = {
        category: [picture for picture in pictures if picture.caption.category == category]
        for category in CATEGORIES
    }
    return [(category, group) for category, group in groups.items() if group]


def _as_json(values: Any) -> str:
    """Return values as JSON that can stand inside a script element."""
    text = json.dumps(values, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return text.replace("<", "\\u003c")
