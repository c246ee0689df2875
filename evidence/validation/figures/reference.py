"""The reference cases: order of the contact times in the step, and the exact random-stop law."""

from __future__ import annotations

import numpy as np

from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLUE, GREY, label_of


def reference(checks, order):
    """Return the Sheet of R3's order and of R11.

    checks: rows of validation.csv. order: rows {step_s, contact_time_error_s}.
    """
    sheet = Sheet(
        "validation_reference",
        "Reference cases: order of the step and exact law",
        "Left: RMS error of the contact times of R3 (a mass driven against a stiff stop) against"
        " the step, with the slope of second order. Right: R11, statistics of an oscillator between"
        " elastic stops under white noise over their exact values, with 3 standard errors and the"
        " step's error; s0 = RMS displacement without stops over the gap, r = stop stiffness over"
        " spring.",
        mosaic=(("order", "law"),),
        size=(9.6, 5.2),
        width_ratios=(1, 1.2),
    )
    axes = sheet.axes["order"]
    steps, errors = (
        np.array([row[name] for row in order], dtype=float)
        for name in ("step_s", "contact_time_error_s")
    )
    sheet.line(
        axes,
        ("step_of_order_s", steps),
        ("contact_time_error_s", errors),
        "R3",
        label="R3",
        color=BLUE,
        marker="o",
    )
    sheet.line(
        axes,
        ("step_of_order_s", steps),
        ("contact_time_error_s", errors[-1] * (steps / steps[-1]) ** 2),
        "slope 2",
        label="slope 2",
        color=GREY,
        linestyle="--",
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.legend(loc="upper left")
    rows = [
        row
        for row in checks
        if row["case"] == "R11" and not str(row["quantity"]).startswith("standard error")
    ]
    ratio, width = (
        np.array(values, dtype=float)
        for values in zip(
            *[(row["ours"] / row["reference"], row["tolerance"]) for row in rows], strict=True
        )
    )
    places = np.arange(len(rows), dtype=float)[::-1]
    axes = sheet.axes["law"]
    sheet.record(
        axes,
        "R11",
        law_number=places,
        law_ratio=ratio,
        law_ratio_low=ratio - width,
        law_ratio_high=ratio + width,
    )
    axes.errorbar(
        ratio, places, xerr=width, linestyle="none", marker="o", markersize=4, capsize=2, color=BLUE
    )
    axes.axvline(1.0, color=GREY, linewidth=0.9)
    axes.set_yticks(places, [str(row["quantity"]) for row in rows], fontsize=7.5)
    axes.set_xlabel(label_of("law_ratio"))
    return sheet
