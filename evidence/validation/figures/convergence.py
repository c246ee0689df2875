"""Convergence of frequencies with the mesh and with the number of contact points."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    number,
    ordered_colours,
    shown,
)

POINTS = {
    ("equal", 1): (PINK, (0, (1, 1))),
    ("equal", 2): (ORANGE, (0, (4, 1))),
    ("equal", 3): (GREEN, (0, (4, 1, 1, 1))),
    ("equal", 5): (BLUE, "-"),
    ("equal", 9): (BLACK, (0, (6, 2))),
    ("trapezoidal", 5): (RED, (0, (2, 1))),
}
THEORY_STYLES = {
    "euler_bernoulli": {"marker": "o", "markersize": 3.5},
    "timoshenko": {"marker": "^", "markersize": 4, "linestyle": "--"},
}
SHOWN_STIFFNESS = 4.0e6  # N/m, of the mesh figure
SMALLEST = 1.0e-10  # relative, of the axes


def slope_line(sheet, axes, columns, start, order, ends, curve):
    """Draw a grey line of slope `order` through start (x, y), labelled with the order.

    ends: x values of its ends.
    """
    x = np.array(ends, dtype=float)
    y = start[1] * (x / start[0]) ** order
    sheet.line(
        axes, (columns[0], x), (columns[1], y), curve, color=GREY, linestyle=":", linewidth=1.2
    )
    axes.annotate(
        f"order {order:g}",
        (shown(columns[0], x[0]), shown(columns[1], y[0])),
        xytext=(3, -2),
        textcoords="offset points",
        color=GREY,
        fontsize=8.5,
        va="top",
    )


def mesh(rows):
    """Return the Sheet of the changes of frequencies with each halving of the elements.

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
    sheet = Sheet(
        "validation_convergence_mesh",
        "Mesh: what halving the elements changes",
        caption,
        [["legs", "bend", "both"]],
        size=(7.6, 3.9),
    )
    colours = ordered_colours(sorted({row["mode"] for row in rows}))
    for panel, axes in sheet.axes.items():
        axes.set_title(
            {"legs": "legs refined", "bend": "bend refined", "both": "both refined"}[panel]
        )
        for theory, style in THEORY_STYLES.items():
            for mode, colour in colours.items():
                own = [
                    row
                    for row in rows
                    if (row["refined"], row["theory"], row["mode"], row["stiffness_N_per_m"])
                    == (panel, theory, mode, SHOWN_STIFFNESS)
                    and row["change"] > SMALLEST
                ]
                sheet.line(
                    axes,
                    ("element_size", [row["size"] for row in own]),
                    ("relative_change", [row["change"] for row in own]),
                    f"{theory} mode {mode}",
                    tags={"mode": mode},
                    color=colour,
                    linewidth=0.9,
                    label=theory.replace("_", "-") if mode == 4 else None,
                    **style,
                )
        axes.set_xscale("log", base=2)
        axes.set_yscale("log")
        axes.set_ylim(SMALLEST, 2.0e-2)
        for order, start in ((4, 3.0e-8), (2, 3.0e-4)) if panel == "legs" else ((2, 1.0e-4),):
            slope_line(
                sheet,
                axes,
                ("element_size", "relative_change"),
                (1.0, start * 4),
                order,
                (1.0, 0.25),
                f"order {order}",
            )
    for panel in ("bend", "both"):
        sheet.axes[panel].set_ylabel("")
    sheet.figure.legend(
        *sheet.axes["legs"].get_legend_handles_labels(), loc="outside lower center", ncols=2
    )
    return [sheet]


def contact_points(rows, refinement):
    """Return the Sheet of the first frequency by number of contact points.

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
    sheet = Sheet(
        "validation_convergence_contact_points",
        "Contact points: first frequency over the whole range of stiffness",
        caption,
        [["frequency", "distance", "order"]],
        size=(7.6, 4.1),
    )
    frequency, distance, order = sheet.axes.values()
    for (weights, points), (colour, dash) in {("layer", 0): (GREY, "-"), **POINTS}.items():
        own = [row for row in rows if (row["weights"], row["points"]) == (weights, points)]
        k = [row["stiffness_N_per_m"] for row in own]
        name = (
            "layer"
            if points == 0
            else (
                f"{points}"
                f" {'trapezoidal' if weights == 'trapezoidal' else 'point' + 's' * (points > 1)}"
            )
        )
        style = {
            "color": colour,
            "linestyle": dash,
            "label": name,
            "linewidth": 4.0 if points == 0 else 1.4,
            "alpha": 0.45 if points == 0 else 1.0,
        }
        sheet.line(
            frequency,
            ("support_stiffness_N_per_m", k),
            ("first_frequency_Hz", [row["first_frequency_Hz"] for row in own]),
            name,
            **style,
        )
        if points:
            sheet.line(
                distance,
                ("support_stiffness_N_per_m", k),
                ("from_layer", [abs(row["from_layer"]) for row in own]),
                name,
                **style,
            )
    for axes, title in ((frequency, "first frequency"), (distance, "distance from the layer")):
        axes.set_title(title)
        axes.set_xscale("log")
        axes.set_xlabel("Stiffness k per support (N/m)")
        sheet.mark(
            axes,
            "support_stiffness_N_per_m",
            SHOWN_STIFFNESS,
            "contact stiffness",
            color=GREY,
            linewidth=0.9,
            linestyle=":",
        )
    distance.set_yscale("log")
    distance.set_ylim(shown("from_layer", 1.0e-5), shown("from_layer", 0.3))
    _orders(sheet, order, refinement)
    sheet.figure.legend(*frequency.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return [sheet]


def _orders(sheet, axes, refinement):
    """Draw the changes of the first frequency with halved spacing, by way of sharing."""
    axes.set_title("change with halved spacing")
    markers = dict(
        zip(sorted({row["stiffness_N_per_m"] for row in refinement}), "osD", strict=False)
    )
    for weights, colour in (("equal", BLUE), ("trapezoidal", RED)):
        for k, marker in markers.items():
            own = [
                row
                for row in refinement
                if (row["weights"], row["stiffness_N_per_m"]) == (weights, k)
                and np.isfinite(row["change"])
            ]
            sheet.line(
                axes,
                ("point_spacing", [row["size"] for row in own]),
                ("point_change", [row["change"] for row in own]),
                f"{weights}, k = {k:g}",
                tags={"support_stiffness_N_per_m": k},
                color=colour,
                marker=marker,
                linewidth=0.9,
                label=f"k = {number(k)} N/m" if weights == "equal" else None,
            )
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    columns = ("point_spacing", "point_change")
    slope_line(sheet, axes, columns, (0.5, 8.0e-3), 1.0, (0.5, 0.0625), "order 1")
    slope_line(sheet, axes, columns, (0.5, 6.0e-4), 2.0, (0.5, 0.0625), "order 2")
    sheet.legend(axes, loc="lower right")
