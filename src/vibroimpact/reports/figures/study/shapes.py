"""Deflection shapes along the tube (figure 10), and the singular values behind them (figure 11)."""

from typing import Any

import numpy as np

from vibroimpact.identify.linear.modes import first_mode_shape
from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series, Span, Text
from vibroimpact.reports.figures.style import (
    BLACK,
    BLUE,
    GAP_COLOURS,
    GREY,
    PALE,
    gap_label,
    ordered_colours,
)

from .cases_of_gap import spread_loads
from .linear_limits import contact_stiffness
from .seed_scatter import over_seeds

SHOWN_SHAPES = 6
ORDERS = ("second", "third", "fourth", "fifth")
LOWEST_VALUE = 1.0e-6  # of the first: below is the rounding of the stored spectra
HALF_SUPPORT_m = 0.012  # of a support, as it is drawn


def figure_10_shapes(config, model, curves, rows):
    """Return the Plot of the deflection shapes of one gap, their MAC and their quadrature part.

    The MAC is with the linear tube. curves: {Case: Dataset}; rows: table rows of that gap.
    """
    axis = config.record.shape_line.direction
    caption = (
        "Operational deflection shape around the main peak (first singular vector of the spectra"
        " above 1/25 of the peak), gap"
        f" {gap_label(config, next(iter(curves)).gap_m)}. Top:"
        f" displacement along {axis}, part in phase, against the arc length from one root to the"
        " other, median over seeds, by load; black: first mode of the linear tube, free (dashed)"
        " and in full bilateral contact (solid); grey: the supports. Bottom left: MAC with the"
        " linear tube's own shape against its support stiffness (first seed); the dot is the"
        " largest value on this grid. Bottom right: size of the part in quadrature over that in"
        " phase: zero for a motion that is one real shape."
    )
    found = {case: dataset for case, dataset in curves.items() if "ods_re" in dataset}
    there = {case.load_rms_N for case in found}
    loads = [load for load in spread_loads(rows, SHOWN_SHAPES) if load in there]
    quadrature = []
    for case, dataset in found.items():
        share = np.linalg.norm(dataset["ods_im"]) / np.linalg.norm(dataset["ods_re"])
        quadrature.append({"load_rms_N": case.load_rms_N, "quadrature": share})
    look = {"colour": BLUE, "marker": "o"}
    points = over_seeds(quadrature, "load_rms_N", "quadrature", "quadrature", **look)
    axes = Axis("load_rms_N", True), Axis("quadrature", low=0.0)
    panels = {
        "shape": _shapes(model, found, loads),
        "mac": _likeness(found, loads),
        "quadrature": Panel(*axes, points, "part in quadrature"),
    }
    rows = [["shape", "shape"], ["mac", "quadrature"]]
    title, look = "Deflection shape against load", {"size": (7.6, 6.2), "heights": (1.35, 1.0)}
    return Plot("figure_10_shapes", title, caption, panels, rows, **look)


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


def linear_limits(model: Any, **look: Any) -> list[Series]:
    """Return the first mode of the linear tube, free and in full contact, its largest value +1."""
    return [
        Series(
            name,
            model.line_arc_length,
            _unit(first_mode_shape(model, k)),
            label=name,
            line=line,
            width=1.0,
            **look,
        )
        for name, k, line in (
            ("linear, free", 0.0, "--"),
            ("linear, in full contact", contact_stiffness(model), "-"),
        )
    ]


def supports(model: Any) -> list[Item]:
    """Return the supports as shaded ranges, with their names in a printed figure."""
    items: list[Item] = []
    few = len(model.support_names) <= 3
    for name, place in zip(model.support_names, support_places(model), strict=True):
        items.append(Span("x", place - HALF_SUPPORT_m, place + HALF_SUPPORT_m, PALE))
        look: dict[str, Any] = {"of_panel": "y", "colour": GREY, "rotation": 0.0 if few else 90.0}
        look |= {"align": ("left" if few else "center", "top"), "shift": (4 * few, 0)}
        items.append(Text(f"support {name}" if few else name, place, 0.98, **look))
    return items


def _shapes(model, found, loads):
    """Return the Panel of the shapes of some loads, the linear tube's limits and the supports."""
    place = model.line_arc_length
    items: list[Item] = [*supports(model), *linear_limits(model, colour=BLACK, order=5)]
    colours = ordered_colours(loads or [1.0])
    for load in loads:
        shapes = [
            _unit(dataset["ods_re"].values)
            for case, dataset in found.items()
            if case.load_rms_N == load
        ]
        low, high = np.min(shapes, axis=0), np.max(shapes, axis=0)
        middle, tags = _unit(np.median(shapes, axis=0)), {"load_rms_N": load}
        look = {"colour": colours[load], "marker": ".", "label": f"{load:.3g} N"}
        items.append(Series("ods", place, middle, tags, low, high, True, **look))
    items.append(Mark("", "y", 0.0, colour=GREY, width=0.8))
    axes = Axis("arc_length_m"), Axis("shape")
    return Panel(*axes, items, "shape along the tube", legend="center")


def _likeness(found, loads):
    """Return the Panel of the MAC against the stiffness; a note if supports differ."""
    lowest, items = min((case.seed for case in found), default=0), []
    colours = ordered_colours(loads or [1.0])
    for case, dataset in found.items():
        if case.load_rms_N in loads and case.seed == lowest and "mac_k" in dataset:
            k, mac = dataset["mac_k"].values, dataset["mac"].values
            colour, tags = colours[case.load_rms_N], {"load_rms_N": case.load_rms_N}
            items.append(Series("MAC", k, mac, tags, colour=colour))
            best = [int(np.argmax(mac))]
            look = {"line": "", "marker": "o", "colour": colour}
            items.append(Series("", k[best], mac[best], **look))
    note = "each support has its own stiffness" if loads else "no shape found"
    axes = Axis("support_stiffness_N_per_m", True), Axis("mac")
    return Panel(*axes, items, "MAC with the linear tube's shape", note)


def _unit(shape):
    """Return a real shape (point,) with its largest component equal to +1."""
    return shape / shape[np.argmax(np.abs(shape))]


def figure_11_singular_values(config, curves):
    """Return the Plot of the singular values over the band of the main peak, against load."""
    caption = (
        "Singular values of the spectra along the tube over the band above 1/25 of the main peak,"
        " divided by the first, gap"
        f" {gap_label(config, next(iter(curves)).gap_m)}: median"
        " and range over seeds. One value alone means that the whole band moves in one shape, as a"
        " linear tube does near a resonance; if others rise, in the transition, no single shape"
        " describes the motion."
    )
    items = []
    x, y = "load_rms_N", "singular_value"
    known = {case: dataset[y].values for case, dataset in curves.items() if y in dataset}
    for order, word in enumerate(ORDERS, start=1):
        values = [
            {x: case.load_rms_N, y: found[order], "order": order + 1}
            for case, found in known.items()
        ]
        look = {"colour": GAP_COLOURS[order - 1], "marker": "os^D"[order - 1]}
        look["label"] = f"{word} value"
        items += over_seeds(values, x, y, f"value {order + 1}", ("order",), **look)
    low = min((np.min(item.low) for item in items), default=0.1)
    items.append(Mark("first value", "y", 1.0, width=1.0, label="first value"))
    panel = Panel(
        Axis(x, True),
        Axis(y, True, max(0.5 * low, LOWEST_VALUE)),
        items,
        "singular values relative to the first",
        "no shape found",
    )
    title = "Size of the other shapes over the first"
    return Plot("figure_11_singular_values", title, caption, {"main": panel}, legend=5)
