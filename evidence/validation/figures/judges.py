"""The impacting tube in OpenSees and ours: displacement and contact force, and convergence."""

from __future__ import annotations

import numpy as np

from vibroimpact.reports.figures.columns import COLUMNS
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, GREY, ORANGE, SKY, shown

POINT = 0  # the lower edge of the left plate
ZOOM_S = (0.088, 0.100)
COMPLETE_HZ = 1.0e5  # a basis with modes beyond this is complete; drawn at the right edge
CURVES = {"displacement": (BLUE, "o"), "contact force": (ORANGE, "s")}
OURS, JUDGE = {"color": BLACK, "linewidth": 0.8}, {"color": SKY, "linewidth": 3.0}


def judged_impacts(verdicts, gap_m):
    """Return the Sheet of the comparison with OpenSees; without OpenSees it says so.

    verdicts: of validation.judges.table. gap_m: m.
    """
    caption = (
        "The same tube, force, gaps, Rayleigh damping and step in OpenSees (broad, light blue; all"
        " degrees of freedom, Newton) and here (black, reduced basis, recurrence and fixed point),"
        " across the plane, at the lower edge of the left plate. Top: displacement, the gap dotted;"
        " contact force of the last twelve milliseconds. Bottom left: the relative difference over"
        " all ten contact points (largest for the displacement, RMS for the force) against the free"
        " modes kept, both codes on the same nodes; the last point has all modes, and what is left"
        " there is the contact iteration (1e-4 of the force per step). Bottom right: against the"
        " elements of our bend, OpenSees having 160; grey: order 2, because a chord is shorter than"
        " its arc."
    )
    sheet = Sheet(
        "validation_judges",
        "OpenSees and ours: an impacting tube",
        caption,
        [["displacement", "force"], ["modes", "mesh"]],
        size=(7.6, 6.2),
    )
    if not verdicts.impacts:
        for name, columns in {
            "displacement": ("moment_s", "across_plane_m"),
            "force": ("moment_s", "push_N"),
            "modes": ("free_modes_to_Hz", "judged_difference"),
            "mesh": ("bend_elements", "judged_difference"),
        }.items():
            sheet.note(sheet.axes[name], "OpenSeesPy is not installed", *columns)
            sheet.record(
                sheet.axes[name], "absent", **{column: np.array([np.nan]) for column in columns}
            )
        return sheet
    _traces(sheet, verdicts.impacts, gap_m)
    _differences(
        sheet, sheet.axes["modes"], ("free_modes_to_Hz", "free_modes_to_Hz"), verdicts.by_modes
    )
    _differences(
        sheet, sheet.axes["mesh"], ("bend_elements", "elements_per_bend"), verdicts.by_mesh
    )
    _second_order(sheet, sheet.axes["mesh"], verdicts.by_mesh)
    return sheet


def _traces(sheet, impacts, gap_m):
    """Draw displacement and force of both codes."""
    for name, style in (("OpenSees", JUDGE), ("ours", OURS)):
        run = impacts[name]
        zoom = (run.time >= ZOOM_S[0]) & (run.time <= ZOOM_S[1])
        sheet.line(
            sheet.axes["displacement"],
            ("moment_s", run.time),
            ("across_plane_m", run.displacement[POINT]),
            name,
            label=name,
            **style,
        )
        sheet.line(
            sheet.axes["force"],
            ("moment_s", run.time[zoom]),
            ("push_N", run.force[POINT, zoom]),
            name,
            label=name,
            **style,
        )
    for side in (-gap_m, gap_m):
        axes = sheet.axes["displacement"]
        sheet.record(axes, "gap", across_plane_m=side)
        place = float(shown("across_plane_m", side))
        axes.axhline(place, color=GREY, linestyle=":", linewidth=0.9)
    sheet.axes["force"].legend(loc="best")


def _differences(sheet, axes, names, rows):
    """Draw the relative differences against an axis.

    names: (column of the figure, key of the rows).
    """
    column, key = names
    for quantity, (colour, marker) in CURVES.items():
        own = [row for row in rows if row["quantity"] == quantity]
        places = np.array([row[key] for row in own], dtype=float)
        largest = max(places[places < COMPLETE_HZ], default=1.0)
        places = np.where(places < COMPLETE_HZ, places, 2.0 * largest)
        sheet.line(
            axes,
            (column, places),
            ("judged_difference", [row["difference"] for row in own]),
            quantity,
            color=colour,
            marker=marker,
            label=quantity,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.legend(loc="upper right")
    if column == "free_modes_to_Hz":
        axes.annotate(
            "all modes",
            (places[-1] * COLUMNS[column][1], own[-1]["difference"]),
            xytext=(0, -14),
            textcoords="offset points",
            ha="center",
            fontsize=8.5,
        )
        axes.margins(y=0.15)


def _second_order(sheet, axes, rows):
    """Draw a grey line of order 2 through the displacement's difference on the second mesh."""
    own = [row for row in rows if row["quantity"] == "displacement"]
    count = np.array([row["elements_per_bend"] for row in own], dtype=float)
    sheet.line(
        axes,
        ("bend_elements", count),
        ("judged_difference", own[1]["difference"] * (count / count[1]) ** -2.0),
        "order 2",
        color=GREY,
        linestyle=":",
        label="order 2",
    )
    axes.legend(loc="upper right")
