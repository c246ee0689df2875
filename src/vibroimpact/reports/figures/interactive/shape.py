"""The deflection shape along the tube at any load, animated."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.identify.spectra.welch import complex_values
from vibroimpact.reports.figures.plot import Axis, Panel, Series
from vibroimpact.reports.figures.study.cases_of_gap import paths_at
from vibroimpact.reports.figures.study.shapes import linear_limits, supports
from vibroimpact.reports.figures.style import BLUE, GREY

from .page_plot import PagePlot, Place


def shapes_of(
    paths: Sequence[str | Path], read: Callable, places: Sequence[Place]
) -> dict[Place, np.ndarray]:
    """Return {(gap, load): complex deflection shape (line_point,)} of the first seed that has one.

    The largest component has length one.

    paths: files of estimates named after their cases; read: function as records.read_record.
    """
    found: dict[Place, np.ndarray] = {}
    for place, path in paths_at(paths, places):
        if place in found:
            continue
        dataset = read(path)
        if "ods_re" in dataset:  # no main peak, no shape
            shape = complex_values(dataset, "ods")
            found[place] = shape / np.abs(shape).max()
    return found


def shape_plot(model: Any, shapes: dict[Place, np.ndarray], direction: str) -> PagePlot:
    """Return the plot of the deflection shape by gap and load.

    shapes: of shapes_of.
    direction: of the displacement, such as y.
    """
    along = model.line_arc_length
    behind = [*supports(model), *linear_limits(model, colour=GREY)]
    step = along[1] - along[0]  # the ends of the tube are no line points
    axes = (
        Axis("arc_length_m", False, along[0] - step, along[-1] + step),
        Axis("shape", False, -1.15, 1.15, f"Shape, {direction} (largest = 1)"),
    )
    frames: dict[tuple, Panel] = {}
    look: dict[str, Any] = {"colour": BLUE, "marker": "o", "size": 2.5, "width": 2.0}
    look |= {"label": "with contact", "band": True}
    for place, shape in shapes.items():
        size = np.abs(shape)  # its envelope
        motion: dict[str, Any] = {"low": -size, "high": size, "moving": shape.imag}
        item = Series("with contact", along, shape.real, **motion, **look)
        frames[place] = Panel(*axes, [*behind, item])
    return PagePlot(
        "shape",
        "Deflection shape along the tube",
        (
            "Shape of the motion around the main peak (largest = 1): its value over one cycle"
            " (blue, Play moves it), its envelope (pale), and the first mode of the linear tube"
            " (grey). Vertical lines are the supports; a shape that moves as one has no part left"
            " where it passes through zero."
        ),
        frames,
        ("gap", "load"),
        empty="No shape of this load: no main peak was found, or the load is not in the selection.",
        height=400,
    )
