"""The deflection shape along the tube at any load, animated, above the contact of its supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Bars, Panel, Series, Span
from vibroimpact.reports.figures.study.shapes import linear_shape, support_places
from vibroimpact.reports.figures.style import BLUE, GREY, PALE
from vibroimpact.reports.study_statistics import StudyStatistics
from vibroimpact.study.cases import case_from_id

from .page_plot import PagePlot

Place = tuple[float, float]  # gap in m, load
HALF_SUPPORT_m = 0.01  # of a support, as it is drawn


def shapes_of(
    paths: Sequence[str | Path], read: Callable, places: Sequence[Place]
) -> dict[Place, np.ndarray]:
    """Return {(gap, load): complex deflection shape (line_point,)} of the first seed that has one.

    The largest component has length one.

    paths: files of estimates named after their cases; read: function as records.read_record.
    """
    found: dict[Place, np.ndarray] = {}
    for path in paths:
        case = case_from_id(Path(path).stem)
        place = case.gap_m, case.load_rms_N
        if place not in places or place in found:
            continue
        dataset = read(path)
        if "ods_re" not in dataset:  # no main peak, no shape
            continue
        shape = dataset["ods_re"].values + 1j * dataset["ods_im"].values
        found[place] = shape / np.abs(shape).max()
    return found


def shape_plot(
    model: Any,
    shapes: dict[Place, np.ndarray],
    places: Sequence[tuple[str, Place]],
    stiffness: float,
    direction: str,
) -> PagePlot:
    """Return the plot of the deflection shape by gap and load.

    shapes: of shapes_of.
    places: (key of the frame, (gap, load)).
    stiffness: N/m of a support in full contact.
    direction: of the displacement, such as y.
    """
    along = model.line_arc_length
    limits = [
        Series("linear", along, linear_shape(model, k), label=name, colour=GREY, line=line, width=1)
        for name, k, line in (
            ("linear, without contact", 0.0, "--"),
            ("linear, in full contact", stiffness, "-"),
        )
    ]
    supports = [
        Span("x", place - HALF_SUPPORT_m, place + HALF_SUPPORT_m, PALE)
        for place in support_places(model)
    ]
    across = Axis("shape", False, -1.15, 1.15, f"Shape, {direction} (largest = 1)")
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
            key: Panel(
                _tube_axis(along), across, [*supports, *limits, _moving(along, shapes[place])]
            )
            for key, place in places
            if place in shapes
        },
        ("gap", "load"),
        empty="No shape of this load: no main peak was found, or the load is not in the selection.",
        height=400,
    )


def _moving(along: np.ndarray, shape: np.ndarray) -> Series:
    """Return the shape with its envelope; a page can play it."""
    size = np.abs(shape)
    return Series(
        "with contact",
        along,
        shape.real,
        low=-size,
        high=size,
        band=True,
        moving=shape.imag,
        label="with contact",
        colour=BLUE,
        marker="o",
        size=2.5,
        width=2.0,
    )


def contact_along_plot(
    statistics: StudyStatistics, places: Sequence[tuple[str, Place]], model: Any
) -> PagePlot:
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
            look: dict[str, Any] = {
                "colour": BLUE,
                "label": "in contact",
                "texts": names,
                "thickness": width,
            }
            bars = Bars("contact", at, middle, {}, low, high, **look)
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
