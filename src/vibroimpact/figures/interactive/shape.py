"""The deflection shape along the tube at any load, animated, above the contact of its supports."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.figures.style import BLACK, BLUE, GREY, PALE
from vibroimpact.linear.modes import first_mode_shape
from vibroimpact.reports.study_statistics import StudyStatistics
from vibroimpact.study.cases import case_from_id

from .plot import Plot, axis, layout, numbers

Place = tuple[float, float]  # gap in m, load
ALONG = "Arc length along the tube (m)"


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


def support_places(model: Any) -> np.ndarray:
    """Return (support,) arc lengths in m of the middles of the supports, on the shape line."""
    middles = [
        model.contact_position[model.support_of_point == index].mean(axis=0)
        for index in range(len(model.support_names))
    ]
    nearest = [
        np.argmin(np.linalg.norm(model.line_positions - middle, axis=1)) for middle in middles
    ]
    return model.line_arc_length[np.array(nearest, dtype=int)]


def shape_plot(
    model: Any,
    shapes: dict[Place, np.ndarray],
    places: Sequence[tuple[str, Place]],
    stiffness: float,
    direction: str,
) -> Plot:
    """Return the Plot of the deflection shape by gap and load.

    shapes: of shapes_of.
    places: (key of the frame, (gap, load)).
    stiffness: N/m of a support in full contact.
    direction: of the displacement, such as y.
    """
    frames = {key: _traces(shapes[place]) for key, place in places if place in shapes}
    limits = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": name,
            "x": "@place",
            "y": numbers(shape / shape[np.argmax(np.abs(shape))]),
            "line": {"color": GREY, "width": 1, "dash": dash},
            "hoverinfo": "skip",
        }
        for name, k, dash in (
            ("linear, without contact", 0.0, "dash"),
            ("linear, in full contact", stiffness, "solid"),
        )
        for shape in (first_mode_shape(model, k),)
    ]
    return Plot(
        "shape",
        "Deflection shape along the tube",
        (
            "Shape of the motion around the main peak (largest = 1): its value over one cycle"
            " (blue, Play moves it), its envelope (pale), and the first mode of the linear tube"
            " (grey). Vertical lines are the supports; a shape that moves as one has no part left"
            " where it passes through zero."
        ),
        layout(
            axis(ALONG, range=_tube_range(model.line_arc_length)),
            axis(f"Shape, {direction} (largest = 1)", range=[-1.15, 1.15]),
            height=400,
            shapes=[_support_line(place) for place in support_places(model)],
        ),
        {key: [*limits, *traces] for key, traces in frames.items()},
        ("gap", "load"),
        shared={"place": numbers(model.line_arc_length)},
        empty="No shape of this load: no main peak was found, or the load is not in the selection.",
    )


def _traces(shape: np.ndarray) -> list[dict]:
    """Return the envelope, the animated shape and its part in quadrature."""
    size = np.abs(shape)
    edge = {
        "type": "scatter",
        "mode": "lines",
        "x": "@place",
        "line": {"width": 0},
        "hoverinfo": "skip",
        "showlegend": False,
    }
    return [
        {**edge, "y": numbers(-size)},
        {
            **edge,
            "y": numbers(size),
            "fill": "tonexty",
            "fillcolor": "rgba(0,114,178,0.14)",
            "name": "envelope",
            "showlegend": True,
        },
        {
            "type": "scatter",
            "mode": "lines+markers",
            "name": "with contact",
            "x": "@place",
            "y": numbers(shape.real),
            "line": {"color": BLUE, "width": 2},
            "marker": {"size": 4, "color": BLUE},
            "hovertemplate": "%{x:.3f} m: %{y:.3f}<extra></extra>",
            "meta": {"re": numbers(shape.real), "im": numbers(shape.imag)},
        },
    ]


def _support_line(place: float) -> dict:
    return {
        "type": "line",
        "yref": "paper",
        "x0": float(place),
        "x1": float(place),
        "y0": 0,
        "y1": 1,
        "line": {"color": PALE, "width": 5},
        "layer": "below",
    }


def contact_along_plot(
    statistics: StudyStatistics, places: Sequence[tuple[str, Place]], model: Any
) -> Plot:
    """Return the Plot of the time in contact of each support, along the tube if there is one."""
    names = statistics.supports
    along = model.line_arc_length.size > 0 and len(names) == len(model.support_names)
    arc_lengths = numbers(support_places(model)) if along else names
    frames = {}
    for key, (gap, load) in places:
        rows = [statistics.spread("contact_fraction", gap, load, name) for name in names]
        if not any(np.isfinite(row.median) for row in rows):
            continue
        frames[key] = [
            {
                "type": "bar",
                "x": arc_lengths,
                "y": numbers([100.0 * row.median for row in rows]),
                "customdata": names,
                "marker": {"color": BLUE},
                "error_y": {
                    "type": "data",
                    "symmetric": False,
                    "array": numbers([100.0 * (row.high - row.median) for row in rows]),
                    "arrayminus": numbers([100.0 * (row.median - row.low) for row in rows]),
                    "color": BLACK,
                    "thickness": 1,
                },
                "hovertemplate": "support %{customdata}: in contact %{y:.3g} % of the time"
                "<extra></extra>",
                "width": 0.02 * float(model.line_arc_length[-1]) if along else 0.3,
                "text": names,
                "textposition": "outside",
                "textangle": 0,
                "constraintext": "none",
                "cliponaxis": False,
            }
        ]
    return Plot(
        "contact_along",
        "Time in contact of each support" + (" along the tube" if along else ""),
        (
            "Share of the time that each support is touched at the chosen gap and load, median and"
            " range over seeds. Supports of a symmetric structure are touched alike; one that"
            " stands out carries more of the wear."
        ),
        layout(
            (
                axis(ALONG, range=_tube_range(model.line_arc_length))
                if along
                else axis("Support", type="category")
            ),
            axis("Time in contact (%)", range=[0, 112]),
            height=400,
            showlegend=False,
        ),
        frames,
        ("gap", "load"),
        empty="No contact was recorded here.",
    )


def _tube_range(arc_length: np.ndarray) -> list[float | None]:
    """Return the range of an axis from end to end of the tube, whose ends are no line points."""
    step = float(arc_length[1] - arc_length[0]) if arc_length.size > 1 else 0.1
    return numbers([arc_length[0] - step, arc_length[-1] + step])
