"""The figures of a study as small pictures inside its page."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping
from pathlib import Path

from PIL import Image

from vibroimpact.io.records import read_text
from vibroimpact.reports.captions import Caption
from vibroimpact.reports.study_page import Picture

LARGE_BYTES = 150_000  # files above it get a palette, which takes a third of their size
COLOURS = 256


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
