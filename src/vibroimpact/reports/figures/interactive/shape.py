"""The deflection shape along the tube at any load, animated, above the contact of its supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.identify.spectra.welch import complex_values
from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Series, Span
from vibroimpact.reports.figures.study.cases_of_gap import paths_at
from vibroimpact.reports.figures.study.shapes import linear_shape, support_places
from vibroimpact.reports.figures.style import BLUE, GREY, PALE
from vibroimpact.reports.study_statistics import StudyStatistics

from .page_plot import Frames, PagePlot, Place

HALF_SUPPORT_m = 0.01  # of a support, as it is drawn


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


def shape_plot(
    model: Any,
    shapes: dict[Place, np.ndarray],
    places: Frames,
    stiffness: float,
    direction: str,
) -> PagePlot:
    """Return the plot of the deflection shape by gap and load.

    shapes: of shapes_of.
    places: (key of the frame, (gap, load)).
    stiffness: N/m of a support in full contact.
    direction: of the displacement, such as y.
    """
    along, limits = model.line_arc_length, []
    for state, k, line in (("without", 0.0, "--"), ("in full", stiffness, "-")):
        look: dict[str, Any] = {"colour": GREY, "line": line, "width": 1}
        look["label"] = f"linear, {state} contact"
        limits.append(Series("linear", along, linear_shape(model, k), **look))
    supports = [
        Span("x", place - HALF_SUPPORT_m, place + HALF_SUPPORT_m, PALE)
        for place in support_places(model)
    ]
    across = Axis("shape", False, -1.15, 1.15, f"Shape, {direction} (largest = 1)")
    axes = _tube_axis(along), across
    return PagePlot(
        "shape",
        "Deflection shape along the tube",
        (
            "Shape of the motion around the main peak (largest = 1): its value over one cycle"
            " (blue, Play moves it), its envelope (pale), and the first mode of the linear tube"
            " (grey). Vertical lines are the supports; a shape that moves as one has no part left"
            " where it passes through zero."
        ),
        {
            key: Panel(*axes, [*supports, *limits, _moving(along, shapes[place])])
            for key, place in places
            if place in shapes
        },
        ("gap", "load"),
        empty="No shape of this load: no main peak was found, or the load is not in the selection.",
        height=400,
    )


def _moving(along: np.ndarray, shape: np.ndarray) -> Series:
    """Return the shape with its envelope; a page can play it."""
    size, name = np.abs(shape), "with contact"
    motion: dict[str, Any] = {"low": -size, "high": size, "band": True, "moving": shape.imag}
    look: dict[str, Any] = {"colour": BLUE, "marker": "o", "size": 2.5, "width": 2.0}
    return Series(name, along, shape.real, **motion, label=name, **look)


def contact_along_plot(statistics: StudyStatistics, places: Frames, model: Any) -> PagePlot:
    """Return the plot of the time in contact of each support, along the tube if there is one."""
    names = statistics.supports
    along = model.line_arc_length.size > 0 and len(names) == len(model.support_names)
    if along:
        axis, at = _tube_axis(model.line_arc_length), support_places(model)
    else:
        axis, at = Axis("support", names=names), np.arange(len(names))
    width = 0.02 * float(model.line_arc_length[-1]) if along else 0.3
    frames = {}
    for key, (gap, load) in places:
        rows = [statistics.spread("contact_fraction", gap, load, name) for name in names]
        middle, low, high = np.array(rows, dtype=float).reshape(-1, 3).T
        if np.isfinite(middle).any():
            look: dict[str, Any] = {"colour": BLUE, "label": "in contact", "thickness": width}
            bars = Bars("contact", at, middle, {}, low, high, texts=names, **look)
            frames[key] = Panel(axis, Axis("contact_fraction", False, 0.0, 1.12), [bars])
    return PagePlot(
        "contact_along",
        "Time in contact of each support" + (" along the tube" if along else ""),
        (
            "Share of the time that each support is touched at the chosen gap and load, median and"
            " range over seeds. Supports of a symmetric structure are touched alike; one that"
            " stands out carries more of the wear."
        ),
        frames,
        ("gap", "load"),
        empty="No contact was recorded here.",
        height=400,
        more={"showlegend": False},
    )


def _tube_axis(arc_length: np.ndarray) -> Axis:
    """Return the axis from end to end of the tube, whose ends are not line points."""
    step = float(arc_length[1] - arc_length[0]) if arc_length.size > 1 else 0.1
    return Axis("arc_length_m", False, arc_length[0] - step, arc_length[-1] + step)
