"""Convergence of frequencies with the mesh and with the number of contact points."""

from __future__ import annotations

from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Item, Mark, Panel, Plot, Series, Text
from vibroimpact.reports.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    number,
    ordered_colours,
)

POINTS = {
    ("equal", 1): (PINK, ":"),
    ("equal", 2): (ORANGE, "--"),
    ("equal", 3): (GREEN, "-."),
    ("equal", 5): (BLUE, "-"),
    ("equal", 9): (BLACK, "--"),
    ("trapezoidal", 5): (RED, ":"),
}
THEORY_STYLES = {
    "euler_bernoulli": {"marker": "o", "size": 3.5},
    "timoshenko": {"marker": "^", "size": 4, "line": "--"},
}
SHOWN_STIFFNESS = 4.0e6  # N/m, of the mesh figure
SMALLEST = 1.0e-10  # relative, of the axes


def slope_line(start, order, ends) -> list[Item]:
    """Return a grey line of slope `order` through start (x, y), with the order beside it.

    ends: x values of its ends.
    """
    x = np.array(ends, dtype=float)
    y = start[1] * (x / start[0]) ** order
    words = f"order {order:g}"
    look: dict[str, Any] = {"shift": (3, -2), "align": ("left", "top"), "size": 8.5}
    return [
        Series(words, x, y, colour=GREY, line=":", width=1.2),
        Text(words, x[0], y[0], colour=GREY, **look),
    ]


def mesh(rows):
    """Return the Plot of the changes of frequencies with each halving of the elements.

    rows: of `mesh_rows`.
    """
    caption = (
        f"Relative change of the first seven frequencies (k = {SHOWN_STIFFNESS:g} N/m per support)"
        " when the elements are halved. Left: the legs refined, bend at 80 elements; middle: the"
        " bend refined, 20 elements per span; right: both. Colour: the mode, from dark (1) to"
        " light (7). Euler-Bernoulli elements converge with order 4 on the legs; Timoshenko"
        " elements add a part of order 2, because their shear angle is constant. In the bend both"
        " have order 2: a chord is shorter than its arc. Below about 1e-9 round-off decides."
    )
    colours = ordered_colours(sorted({row["mode"] for row in rows}))
    panels = {}
    for refined in ("legs", "bend", "both"):
        items: list[Item] = []
        for theory, style in THEORY_STYLES.items():
            for mode, colour in colours.items():
                own = [
                    row
                    for row in rows
                    if (row["refined"], row["theory"], row["mode"], row["stiffness_N_per_m"])
                    == (refined, theory, mode, SHOWN_STIFFNESS)
                    and row["change"] > SMALLEST
                ]
                sizes, changes = [row["size"] for row in own], [row["change"] for row in own]
                look = style | {"colour": colour, "width": 0.9}
                look["label"] = theory.replace("_", "-") if mode == 4 else ""
                name, tags = f"{theory} mode {mode}", {"mode": mode}
                items.append(Series(name, sizes, changes, tags, **look))
        for order, start in ((4, 3.0e-8), (2, 3.0e-4)) if refined == "legs" else ((2, 1.0e-4),):
            items += slope_line((1.0, start * 4), order, (1.0, 0.25))
        axes = Axis("element_size", True), Axis("relative_change", True, SMALLEST, 2.0e-2)
        panels[refined] = Panel(*axes, items, f"{refined} refined")
    title = "Mesh: what halving the elements changes"
    size = (7.6, 3.9)
    return [Plot("validation_convergence_mesh", title, caption, panels, size=size, legend=2)]


def contact_points(rows, refinement):
    """Return the Plot of the first frequency by number of contact points.

    rows, refinement: of `contact_point_rows` and `refinement_rows`.
    """
    caption = (
        "First frequency against the bilateral stiffness per support (the paper's figure 4). Left:"
        " by number of contact points; grey: a continuous layer. Middle: how far each is from the"
        " layer. One point never clamps; five equal points are within 0.3 % up to the stiffness of"
        " the contact (4e6 N/m) and within 2 % everywhere. Right: N equal points with both edges"
        " included have a rotational stiffness that is too high by 2/(N - 1), so that they converge"
        " with order 1 only; half a share for the edge points gives order 2 ('trapezoidal'), four"
        " times closer with five points."
    )
    curves: dict[str, list[Item]] = {"frequency": [], "distance": []}
    for (weights, points), (colour, line) in {("layer", 0): (GREY, "-"), **POINTS}.items():
        own = [row for row in rows if (row["weights"], row["points"]) == (weights, points)]
        k = [row["stiffness_N_per_m"] for row in own]
        kind = "trapezoidal" if weights == "trapezoidal" else "point" + "s" * (points > 1)
        name = f"{points} {kind}" if points else "layer"
        look = {"colour": colour, "line": line, "label": name}
        look |= {"width": 1.4, "alpha": 1.0} if points else {"width": 4.0, "alpha": 0.45}
        first = [row["first_frequency_Hz"] for row in own]
        curves["frequency"].append(Series(name, k, first, **look))
        if points:
            apart = [abs(row["from_layer"]) for row in own]
            curves["distance"].append(Series(name, k, apart, **look))
    limit = Mark("contact stiffness", "x", SHOWN_STIFFNESS, colour=GREY, width=0.9, line=":")
    stiffness = Axis("support_stiffness_N_per_m", True, label="Stiffness k per support (N/m)")
    panels = {
        "frequency": Panel(
            stiffness,
            Axis("first_frequency_Hz"),
            [*curves["frequency"], limit],
            "first frequency",
        ),
        "distance": Panel(
            stiffness,
            Axis("from_layer", True, 1.0e-5, 0.3),
            [*curves["distance"], limit],
            "distance from the layer",
        ),
        "order": _orders(refinement),
    }
    name = "validation_convergence_contact_points"
    title = "Contact points: first frequency over the whole range of stiffness"
    return [Plot(name, title, caption, panels, size=(7.6, 4.1), legend=4)]


def _orders(refinement):
    """Return the Panel of the changes of the first frequency with halved spacing, by weights."""
    markers = dict(
        zip(sorted({row["stiffness_N_per_m"] for row in refinement}), "osD", strict=False)
    )
    items: list[Item] = []
    for weights, colour in (("equal", BLUE), ("trapezoidal", RED)):
        for k, marker in markers.items():
            own = [
                row
                for row in refinement
                if (row["weights"], row["stiffness_N_per_m"]) == (weights, k)
                and np.isfinite(row["change"])
            ]
            sizes, changes = [row["size"] for row in own], [row["change"] for row in own]
            look = {"colour": colour, "marker": marker, "width": 0.9}
            look["label"] = f"k = {number(k)} N/m" if weights == "equal" else ""
            tags = {"support_stiffness_N_per_m": k}
            items.append(Series(f"{weights}, k = {k:g}", sizes, changes, tags, **look))
    items += slope_line((0.5, 8.0e-3), 1.0, (0.5, 0.0625))
    items += slope_line((0.5, 6.0e-4), 2.0, (0.5, 0.0625))
    axes = Axis("point_spacing", True), Axis("point_change", True)
    return Panel(*axes, items, "change with halved spacing", legend="lower right")
