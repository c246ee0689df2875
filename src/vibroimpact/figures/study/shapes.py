"""Deflection shapes along the tube (figure 10), and the singular values behind them (figure 11)."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GAP_COLOURS,
    GREY,
    PALE,
    gap_label,
    ordered_colours,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.linear.modes import first_mode_shape

from .cases_of_gap import spread_loads
from .linear_limits import contact_stiffness
from .seed_scatter import over_seeds

SHOWN_SHAPES = 6
SHOWN_VALUES = 5
LOWEST_VALUE = 1.0e-6  # of the first: below is the rounding of the stored spectra


def figure_10_shapes(config, model, curves, rows):
    """Return the Sheet of the deflection shapes of one gap, their MAC and their quadrature part.

    The MAC is with the linear tube. curves: {Case: Dataset}; rows: table rows of that gap.
    """
    axis = config.record.shape_line.direction
    caption = (
        "Operational deflection shape around the main peak (first singular vector of the spectra"
        " above 1/25 of the peak), gap"
        f" {gap_label(next(iter(curves)).gap_m, outer_width(config.structure.section))}. Top:"
        f" displacement along {axis}, part in phase, against the arc length from one root to the"
        " other, median over seeds, by load; black: first mode of the linear tube, free (dashed)"
        " and in full bilateral contact (solid); grey: the supports. Bottom left: MAC with the"
        " linear tube's own shape against its support stiffness (first seed); the dot is the"
        " largest value on this grid. Bottom right: size of the part in quadrature over that in"
        " phase: zero for a motion that is one real shape."
    )
    sheet = Sheet(
        "figure_10_shapes",
        "Deflection shape against load",
        caption,
        [["shape", "shape"], ["mac", "quadrature"]],
        size=(7.6, 6.2),
        height_ratios=(1.35, 1.0),
    )
    found = {case: dataset for case, dataset in curves.items() if "ods_re" in dataset}
    loads = [
        load
        for load in spread_loads(rows, SHOWN_SHAPES)
        if any(case.load_rms_N == load for case in found)
    ]
    _shapes(sheet, sheet.axes["shape"], model, found, loads)
    _likeness(sheet, sheet.axes["mac"], found, loads)
    quadrature = [
        {
            "load_rms_N": case.load_rms_N,
            "quadrature": np.linalg.norm(dataset["ods_im"]) / np.linalg.norm(dataset["ods_re"]),
        }
        for case, dataset in found.items()
    ]
    over_seeds(
        sheet,
        sheet.axes["quadrature"],
        quadrature,
        "load_rms_N",
        "quadrature",
        "quadrature",
        color=BLUE,
        marker="o",
    )
    sheet.axes["quadrature"].set_title("part in quadrature")
    sheet.axes["quadrature"].set_xscale("log")
    sheet.axes["quadrature"].set_ylim(bottom=0.0)
    return [sheet]


def _shapes(sheet, axes, model, found, loads):
    """Draw the shapes of some loads, the linear tube's limits and the supports."""
    axes.set_title("shape along the tube")
    place = model.line_arc_length
    few = len(model.support_names) <= 3
    for number_of_support in np.unique(model.support_of_point):
        middle = model.contact_position[model.support_of_point == number_of_support].mean(axis=0)
        nearest = place[np.argmin(np.linalg.norm(model.line_positions - middle, axis=1))]
        axes.axvspan(nearest - 0.012, nearest + 0.012, color=PALE, linewidth=0, zorder=0)
        axes.annotate(
            f"support {model.support_names[number_of_support]}"
            if few
            else model.support_names[number_of_support],
            (nearest, 0.98),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0) if few else (0, 0),
            textcoords="offset points",
            rotation=0.0 if few else 90.0,
            ha="left" if few else "center",
            fontsize=8,
            color=GREY,
            va="top",
        )
    for k, name, dash in (
        (0.0, "linear, free", (0, (4, 2))),
        (contact_stiffness(model), "linear, in full contact", "-"),
    ):
        sheet.line(
            axes,
            ("arc_length_m", place),
            ("shape", _unit(first_mode_shape(model, k))),
            name,
            color=BLACK,
            linestyle=dash,
            label=name,
            linewidth=1.0,
            zorder=5,
        )
    colours = ordered_colours(loads or [1.0])
    for load in loads:
        shapes = np.array(
            [
                _unit(dataset["ods_re"].values)
                for case, dataset in found.items()
                if case.load_rms_N == load
            ]
        )
        sheet.line(
            axes,
            ("arc_length_m", place),
            ("shape", _unit(np.median(shapes, axis=0))),
            "ods",
            low=shapes.min(axis=0),
            high=shapes.max(axis=0),
            tags={"load_rms_N": load},
            color=colours[load],
            marker=".",
            label=f"{load:.3g} N",
        )
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    sheet.legend(axes, loc="lower center", bbox_to_anchor=(0.5, 0.08))


def _likeness(sheet, axes, found, loads):
    """Draw the MAC against the stiffness for some loads; a note where supports differ."""
    axes.set_title("MAC with the linear tube's shape")
    lowest = min((case.seed for case in found), default=0)
    colours = ordered_colours(loads or [1.0])
    for case, dataset in found.items():
        if case.load_rms_N in loads and case.seed == lowest and "mac_k" in dataset:
            k, mac = dataset["mac_k"].values, dataset["mac"].values
            sheet.line(
                axes,
                ("support_stiffness_N_per_m", k),
                ("mac", mac),
                "MAC",
                tags={"load_rms_N": case.load_rms_N},
                color=colours[case.load_rms_N],
            )
            best = int(np.argmax(mac))
            axes.plot(k[best], mac[best], marker="o", color=colours[case.load_rms_N])
    axes.set_xscale("log")
    if not axes.lines:
        note = "no shape found" if not loads else "each support has its own stiffness"
        sheet.note(axes, note, "support_stiffness_N_per_m", "mac")


def _unit(shape):
    """Return a real shape (point,) with its largest component equal to +1."""
    return shape / shape[np.argmax(np.abs(shape))]


def figure_11_singular_values(config, curves):
    """Return the Sheet of the singular values over the band of the main peak, against load."""
    caption = (
        "Singular values of the spectra along the tube over the band above 1/25 of the main peak,"
        " divided by the first, gap"
        f" {gap_label(next(iter(curves)).gap_m, outer_width(config.structure.section))}: median"
        " and range over seeds. One value alone means that the whole band moves in one shape, as a"
        " linear tube does near a resonance; where others rise, in the transition, no single shape"
        " describes the motion."
    )
    sheet = Sheet(
        "figure_11_singular_values",
        "Size of the other shapes beside the first",
        caption,
        size=(7.6, 4.2),
    )
    axes = sheet.axes["main"]
    axes.set_title("singular values relative to the first")
    for order in range(1, SHOWN_VALUES):
        values = [
            {
                "load_rms_N": case.load_rms_N,
                "singular_value": dataset["singular_value"].values[order],
                "order": order + 1,
            }
            for case, dataset in curves.items()
            if "singular_value" in dataset
        ]
        over_seeds(
            sheet,
            axes,
            values,
            "load_rms_N",
            "singular_value",
            f"value {order + 1}",
            tags=("order",),
            color=GAP_COLOURS[order - 1],
            marker="os^D"[order - 1],
            label=f"{('second', 'third', 'fourth', 'fifth')[order - 1]} value",
        )
    sheet.mark(
        axes,
        "singular_value",
        1.0,
        "first value",
        vertical=False,
        color=BLACK,
        linewidth=1.0,
        label="first value",
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(bottom=max(axes.get_ylim()[0], LOWEST_VALUE))
    if not axes.get_xlabel():
        sheet.note(axes, "no shape found", "load_rms_N", "singular_value")
    sheet.legend(axes, loc="upper left", bbox_to_anchor=(0.0, 0.92), ncols=5)
    return [sheet]
