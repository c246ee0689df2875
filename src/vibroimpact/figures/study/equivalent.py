"""The equivalent support: k and c against load (figure 13) and against load over gap."""

from __future__ import annotations

import numpy as np

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    GAP_COLOURS,
    GAP_MARKERS,
    GREY,
    METHODS,
    OPEN_METHODS,
    PINK,
    gap_label,
)
from vibroimpact.geometry.sections import outer_width
from vibroimpact.study.method_agreement import COMPARED, collapse_rows, summary_rows

from .linear_limits import contact_stiffness
from .seed_scatter import medians, over_seeds

PREDICTED = ("statistical_linearisation", "secant")

MOST_COLUMNS = 4  # gaps side by side; more begin another block below


def figure_13_equivalent_support(config, model, rows, level="load_rms_N", study=None, caption=""):
    """Return the Sheet of k and c against load, a colour and marker per method.

    There is a column per gap, and per group of supports and direction where there are several.

    rows: the consistency table, list of {column: value}.
    level: column of the loads; response_rms_m where they are the RMS of the response.
    study: {gap in m: rows of a study} whose curve is drawn behind measured points; None for none.
    caption: in the place of that of a study.
    """
    places = _places(rows)
    columns = "a column per gap" if len(places) == 1 else "a column per group of supports and gap"
    caption = caption or (
        f"Equivalent bilateral support by each method against load, {columns}: stiffness k"
        " (top) and damping c on top of the modal damping (bottom), per support; median over seeds,"
        " bars from the smallest to the largest seed. What a method does not resolve is left out:"
        " near the free tube none sees k. The shape carries no damping. Lines without bars:"
        " statistical linearisation (from the load alone) and the mean secant stiffness of the"
        " simulated contact forces. Dashed: the contact stiffness, the upper limit."
    )
    gaps = sorted({row["gap_m"] for row in rows}, reverse=True)
    panels = {
        (gap, place): tuple(f"{name}, {' in '.join(place)}, gap {gap:.5g} m" for name in "kc")
        for place in places
        for gap in gaps
    }
    mosaic = _in_blocks(list(panels.values()))
    sheet = Sheet(
        "figure_13_equivalent_support",
        "Equivalent stiffness and damping by every method",
        caption,
        mosaic,
        size=(max(2.6 + 2.6 * len(mosaic[0]), 6.4), 3.2 * len(mosaic)),
        sharex=True,
    )
    for (gap, place), (top, bottom) in panels.items():
        chosen = [row for row in rows if row["gap_m"] == gap and _place(row) == place]
        beside = [row for row in (study or {}).get(gap, ()) if _place(row) == place]
        for key, column in ((top, "k_N_per_m"), (bottom, "c_N_s_per_m")):
            _study_curve(sheet, sheet.axes[key], beside, column)
        _methods(sheet, sheet.axes[top], chosen, "k_N_per_m", (*METHODS,), level)
        damped = (*OPEN_METHODS, "lscf", "broadband")
        _methods(sheet, sheet.axes[bottom], chosen, "c_N_s_per_m", damped, level)
        title = f"gap {gap_label(gap, outer_width(config.structure.section))}"
        if len(places) > 1:
            title = f"{place[0]} in {place[1]}" + (f", {gap * 1e3:.3g} mm" * (len(gaps) > 1))
        sheet.axes[top].set_title(title)
        sheet.mark(
            sheet.axes[top],
            "k_N_per_m",
            contact_stiffness(model, place[0]),
            "contact stiffness",
            vertical=False,
            color=GREY,
            linestyle="--",
            linewidth=1.0,
            label="contact stiffness",
        )
    _alike(sheet, mosaic, config, len(places) == 1)
    for place in places:
        _same_limits([sheet.axes[panels[gap, place][1]] for gap in gaps])
    handles, labels = sheet.axes[mosaic[0][0]].get_legend_handles_labels()
    for key, _ in panels.values():  # a method may be resolved at one gap only
        for handle, label in zip(*sheet.axes[key].get_legend_handles_labels(), strict=True):
            if label not in labels:
                handles.append(handle)
                labels.append(label)
    sheet.figure.legend(
        handles, labels, loc="outside lower center", ncols=(2, 4, 5)[min(len(mosaic[0]), 3) - 1]
    )
    return [sheet]


def _study_curve(sheet, axes, rows, column):
    """Draw the median of a study's compared methods against load, and their range."""
    usable = [row for row in rows if row["method"] in COMPARED and np.isfinite(row[column])]
    loads = sorted({row["load_rms_N"] for row in usable})
    if not loads:
        return
    values = [[row[column] for row in usable if row["load_rms_N"] == load] for load in loads]
    sheet.line(
        axes,
        ("load_rms_N", np.array(loads)),
        (column, np.array([np.median(each) for each in values])),
        "study",
        [min(each) for each in values],
        [max(each) for each in values],
        color=GREY,
        linewidth=1.6,
        label="study, range of methods and seeds",
        zorder=0,
    )


def _methods(sheet, axes, rows, column, methods, level):
    """Draw one quantity by every method: predictions as lines, others with their seed scatter."""
    for method in methods:
        label, colour, marker = METHODS[method]
        chosen = [
            row
            for row in rows
            if row["method"] == method and (column != "k_N_per_m" or row[column] > 0.0)
        ]
        chosen = [{**row, level: row["load_rms_N"]} for row in chosen]
        if method in PREDICTED:
            place, value = medians(chosen, level, column)
            if place.size:
                sheet.line(
                    axes,
                    (level, place),
                    (column, value),
                    method,
                    color=colour,
                    linestyle="-" if method == "secant" else "--",
                    marker=marker,
                    markersize=3.5,
                    linewidth=1.0,
                    label=label,
                    zorder=1,
                )
            continue
        over_seeds(
            sheet,
            axes,
            chosen,
            level,
            column,
            method,
            color=colour,
            marker=marker,
            label=label,
            linewidth=0.8,
            markerfacecolor="white" if method in OPEN_METHODS else colour,
            zorder=3 if method in OPEN_METHODS else 4,
        )
    if not axes.get_xlabel():
        sheet.note(axes, _why_empty(rows), level, column)


def _why_empty(rows):
    """Return why no compared method has a value among rows of the consistency table."""
    reasons = [row["reason"] for row in rows if row["method"] in COMPARED and row["reason"]]
    return f"No method resolves it. {reasons[0] if reasons else ''}".strip()


def _in_blocks(pairs):
    """Return the mosaic of pairs of panels (top, bottom), side by side in blocks of two rows."""
    count = len(pairs)
    blocks = -(-count // MOST_COLUMNS)
    columns = -(-count // blocks)
    rows = []
    for first in range(0, count, columns):
        block = pairs[first : first + columns]
        rows += [[pair[row] for pair in block] + ["."] * (columns - len(block)) for row in (0, 1)]
    return rows


def _alike(sheet, mosaic, config, one_place):
    """Give all panels the same loads and stiffnesses, labels at the outside only.

    one_place: whether all panels are of one group of supports, with comparable dampings.
    """
    lowest = config.identification.stiffness_range_N_per_m[0]
    tops = [sheet.axes[key] for row in mosaic[::2] for key in row if key != "."]
    for axes in tops:
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylim(0.5 * lowest, 2e7)
        axes.set_xlabel("")
    _same_limits(tops)
    for row in mosaic:
        for key in (key for key in row[1:] if key != "."):
            sheet.axes[key].set_ylabel("")
            if one_place or sheet.axes[key] in tops:
                sheet.axes[key].tick_params(labelleft=False)
    sheet.figure.align_ylabels([sheet.axes[row[0]] for row in mosaic])


def _same_limits(group):
    """Give some axes the same limits along y."""
    limits = [axes.get_ylim() for axes in group]
    for axes in group:
        axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


def _place(row):
    """Return the (group of supports, direction) of a row."""
    return str(row["group"]), str(row["direction"])


def _places(rows):
    """Return the (group of supports, direction) of all rows, each once."""
    return list(dict.fromkeys(map(_place, rows)))


def collapse(config, model, rows):
    """Return the Sheet of k and c of all gaps against load over gap.

    rows: the consistency table, list of {column: value}.
    """
    caption = (
        "Equivalent support against load divided by gap, all gaps: stiffness k (left) and damping"
        " c (right) per support. The tube with impacts is homogeneous: what it does, measured in"
        " gaps, depends on load/gap only, so that the points of all gaps must fall on one curve."
        " Markers: median over seeds and over the methods"
        f" {', '.join(METHODS[method][0] for method in COMPARED)} (the shape gives no c), bars from"
        " the smallest to the largest value. Lines: statistical linearisation and the mean secant"
        " stiffness, of all gaps."
    )
    places = _places(rows)
    keys = {place: tuple(f"{name}, {' in '.join(place)}" for name in "kc") for place in places}
    sheet = Sheet(
        "collapse",
        _collapse_title(rows),
        caption,
        [list(pair) for pair in keys.values()],
        size=(7.6, 1.0 + 3.2 * len(places)),
    )
    table = [{**row, "load_over_gap_N_per_m": row["load_over_gap"]} for row in rows]
    for place, (top, bottom) in keys.items():
        own = [row for row in table if _place(row) == place]
        axes = (sheet.axes[top], sheet.axes[bottom])
        _collapse_of(sheet, axes, config, own)
        axes[0].set_ylim(
            0.5 * config.identification.stiffness_range_N_per_m[0], 2.5 * contact_stiffness(model)
        )
        of = "" if len(places) == 1 else f", {' in '.join(place)}"
        axes[0].set_title(f"stiffness{of}")
        axes[1].set_title("damping on top of the modal damping" if not of else f"damping{of}")
    handles, labels = axes[0].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return [sheet]


def _collapse_title(rows):
    """Return the title of the figure: how far the curves of the gaps are apart."""
    ratios = [
        row["k_ratio"]
        for row in collapse_rows(summary_rows(rows))
        if row["method"] in COMPARED and np.isfinite(row["k_ratio"])
    ]
    if not ratios:
        return "Equivalent support against load / gap"
    return f"k of the gaps at equal load / gap: within {100.0 * (max(ratios) - 1.0):.0f} %"


def _collapse_of(sheet, axes, config, rows):
    """Draw k and c of one group of supports and direction against load over gap."""
    for index, gap in enumerate(sorted({row["gap_m"] for row in rows}, reverse=True)):
        compared = [row for row in rows if row["gap_m"] == gap and row["method"] in COMPARED]
        for place, column in zip(axes, ("k_N_per_m", "c_N_s_per_m"), strict=True):
            over_seeds(
                sheet,
                place,
                compared,
                "load_over_gap_N_per_m",
                column,
                "identified",
                tags=("gap_m", "load_rms_N"),
                color=GAP_COLOURS[index % len(GAP_COLOURS)],
                marker=GAP_MARKERS[index % len(GAP_MARKERS)],
                linestyle="none",
                label=f"gap {gap_label(gap, outer_width(config.structure.section))}",
            )
    for method, colour, dash in (("statistical_linearisation", PINK, "--"), ("secant", BLACK, "-")):
        place, value = medians(
            [row for row in rows if row["method"] == method and row["k_N_per_m"] > 0.0],
            "load_over_gap_N_per_m",
            "k_N_per_m",
        )
        if place.size:
            sheet.line(
                axes[0],
                ("load_over_gap_N_per_m", place),
                ("k_N_per_m", value),
                method,
                color=colour,
                linestyle=dash,
                linewidth=1.2,
                label=METHODS[method][0],
                zorder=1,
            )
    for place, column in zip(axes, ("k_N_per_m", "c_N_s_per_m"), strict=True):
        if not place.get_xlabel():
            sheet.note(place, _why_empty(rows), "load_over_gap_N_per_m", column)
        place.set_xscale("log")
    axes[0].set_yscale("log")
    axes[1].axhline(0.0, color=GREY, linewidth=0.8)
    axes[1].sharex(axes[0])
