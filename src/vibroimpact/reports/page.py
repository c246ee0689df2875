"""Every page: one template with blocks, one style sheet on the screen and on paper."""

import base64
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

FOLDER = Path(__file__).parent
STYLE = (FOLDER / "page.css").read_text(encoding="utf-8")
MARKS = ("pass", "warn", "refuse")  # words of a table that have a colour
WHOLE_PX = 1216  # of a figure as wide as the page: 7.6 in at 160 dpi


def rendered(template: str, **values: Any) -> str:
    """Return a page.

    template: name of a file of this folder that extends page.html.
    values: those shown.
    """
    environment = Environment(
        loader=FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    environment.globals["marks"] = MARKS
    return environment.get_template(template).render(style=STYLE, **values)


def embedded(figures: Iterable[Path]) -> list[dict]:
    """Return {name, caption, data, percent} of PNG files; data is the text of a data: address,
    percent the share of the page's width with which their letters are as large as in others.

    The caption is in a .txt file of the same name.
    """
    found = []
    for file in map(Path, figures):
        content = file.read_bytes()
        pixels = int.from_bytes(content[16:20], "big")  # the width in the header of a PNG file
        found.append(
            {
                "name": file.stem,
                "caption": file.with_suffix(".txt").read_text(encoding="utf-8"),
                "data": base64.b64encode(content).decode(),
                "percent": min(100, round(100 * pixels / WHOLE_PX)),
            }
        )
    return found
