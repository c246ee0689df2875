"""Evidence of the paper's claims: limits, damping, rank, node, valleys, response points."""

from __future__ import annotations

import numpy as np

from evidence.validation.claims.response import peaks_by_sensor, valleys
from evidence.validation.claims.shapes import node_places, quadrature
from evidence.validation.study_curves import POLES, median
from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED
from vibroimpact.linear.poles import first_pole

COLOURS = (BLUE, ORANGE, GREEN, RED)


def claims_of_the_peak(model, gaps):
    """Return the Sheet of frequency and damping of the main peak against load.

    Frequency by response point is drawn with the linear limits, damping by method.
    """
    wide, tight = gaps
    sheet = Sheet(
        "validation_claims_peak",
        "Claims on the main peak",
        "Largest gap. Left: frequency of the main peak of the mean PSD at each response point,"
        " between the linear tube's limits (dashed: k = 1 N/m and the contact's own stiffness);"
        " grey: at the smallest gap, at the load that has the same load/gap. Right: damping ratio"
        " of the same peak by half-power, 1/4 and 1/25 widths and by LSCF, medians over seeds.",
        mosaic=(("frequency", "damping"),),
        size=(7.6, 3.6),
    )
    axes = sheet.axes["frequency"]
    for (name, values), colour in zip(peaks_by_sensor(wide).items(), COLOURS, strict=False):
        sheet.line(
            axes,
            ("load_rms_N", wide.load),
            ("frequency_Hz", values),
            name,
            label=name,
            color=colour,
            marker="o",
            markersize=3,
            linewidth=1,
        )
    scale = wide.gap_m / tight.gap_m
    sheet.line(
        axes,
        ("load_rms_N", tight.load * scale),
        ("frequency_Hz", median(tight.pole_frequency["lscf"])),
        "smallest gap, load scaled",
        label="smallest gap, load scaled",
        color=GREY,
        linewidth=1.4,
    )
    held = float(np.bincount(model.support_of_point, model.contact_stiffness).mean())
    for k, label in ((1.0, "free"), (held, "held")):
        sheet.mark(
            axes,
            "frequency_Hz",
            abs(first_pole(model, k, 0.0)) / (2.0 * np.pi),
            label,
            vertical=False,
            color=BLACK,
            linestyle="--",
            linewidth=0.9,
        )
    sheet.legend(axes, loc="upper left")
    axes = sheet.axes["damping"]
    for method, colour in zip(POLES, COLOURS, strict=True):
        sheet.line(
            axes,
            ("load_rms_N", wide.load),
            ("damping_ratio", median(wide.pole_damping[method])),
            method,
            label=method,
            color=colour,
            marker="o",
            markersize=3,
            linewidth=1,
        )
    sheet.legend(axes, loc="upper left")
    for axes in sheet.axes.values():
        axes.set_xscale("log")
    return sheet


def claims_of_the_shape(model, gaps):
    """Return the Sheet of the deflection shape against load.

    It shows singular values, node, quadrature, and the filling of anti-resonances.
    """
    wide, tight = gaps
    sheet = Sheet(
        "validation_claims_shape",
        "Claims on shape and anti-resonances",
        "Singular values of the response around the main peak over the first one, and the"
        " quadrature part of the first shape (largest gap, medians over seeds); place of the"
        " shape's node, as arc length from the root (smallest gap; dotted: the plate); height of"
        " the measured valleys above the anti-resonances of the equivalent linear tube (largest"
        " gap).",
        mosaic=(("rank", "quadrature"), ("node", "valleys")),
        size=(7.6, 5.4),
    )
    axes = sheet.axes["rank"]
    for order, colour in ((1, BLUE), (2, ORANGE), (3, GREEN)):
        ratio = np.median(wide.singular[:, :, order] / wide.singular[:, :, 0], axis=1)
        sheet.line(
            axes,
            ("load_rms_N", wide.load),
            ("singular_value_ratio", ratio),
            f"value {order + 1}",
            label=f"value {order + 1}",
            color=colour,
            marker="o",
            markersize=3,
            linewidth=1,
        )
    axes.set_yscale("log")
    sheet.legend(axes, loc="lower right")
    share = [np.median([quadrature(shape) for shape in seeds]) for seeds in wide.shape]
    sheet.line(
        sheet.axes["quadrature"],
        ("load_rms_N", wide.load),
        ("quadrature_share", np.array(share)),
        "first shape",
        color=BLUE,
        marker="o",
        markersize=3,
        linewidth=1,
    )
    places = node_places(tight)
    sheet.line(
        sheet.axes["node"],
        ("load_rms_N", tight.load),
        ("node_arc_length_m", places),
        "node",
        color=BLUE,
        marker="o",
        markersize=3,
        linewidth=1,
    )
    plate = float(np.mean(model.contact_position[model.support_of_point == 0][:, 2]))
    sheet.mark(
        sheet.axes["node"],
        "node_arc_length_m",
        plate,
        "plate",
        vertical=False,
        color=GREY,
        linestyle=":",
    )
    found = {load: values[:, 2] for load, values in valleys(wide, model).items() if len(values)}
    loads = np.concatenate(
        [np.full(len(values), load) for load, values in found.items()] or [np.zeros(0)]
    )
    raised = np.concatenate(list(found.values()) or [np.zeros(0)])
    sheet.line(
        sheet.axes["valleys"],
        ("load_rms_N", loads),
        ("valley_height_dB", raised),
        "valleys",
        color=RED,
        marker="o",
        markersize=4,
        linestyle="none",
    )
    for axes in sheet.axes.values():
        axes.set_xscale("log")
        axes.set_xlim(wide.load[0], wide.load[-1])
    return sheet
