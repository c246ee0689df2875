"""The equivalent support: k and c against load (figure 13) and against load over gap."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from vibroimpact.identify.estimate import method_name
from vibroimpact.reports.figures.plot import Axis, Mark, Panel, Plot, Series, extent, in_rows
from vibroimpact.reports.figures.style import (
    GAP_COLOURS,
    GAP_MARKERS,
    GREY,
    METHODS,
    OPEN_METHODS,
    gap_label,
)
from vibroimpact.study.equivalent_table import VALUES
from vibroimpact.study.method_agreement import COMPARED, collapse_rows, summary_rows

from .linear_limits import contact_stiffness
from .seed_scatter import grouped, medians, over_seeds, spread

PREDICTED = ("statistical_linearisation", "secant")
DRAWN = {"k": tuple(METHODS), "c": (*OPEN_METHODS, "lscf", "broadband")}
HIGHEST_K = 2e7  # N/m, of the axis
MOST_COLUMNS = 4  # gaps side by side; more begin another block below


def look_of(method: str) -> dict[str, Any]:
    """Return how the curve of a method looks, in every plot."""
    colour, marker = METHODS.get(method, (GREY, "o"))
    look = {"label": method_name(method), "colour": colour, "marker": marker}
    if method in PREDICTED:
        line = "-" if method == "secant" else "--"
        return look | {"line": line, "size": 3.5, "width": 1.0, "order": 1}
    hollow = method in OPEN_METHODS
    return look | {"width": 0.8, "hollow": hollow, "order": 3 if hollow else 4}


def figure_13_equivalent_support(config, model, rows, level="load_rms_N", study=None, caption=""):
    """Return the Plot of k and c against load, a colour and marker per method.

    There is a column per gap, and per group of supports and direction if there are several.

    rows: the consistency table, list of {column: value}.
    level: column of the loads; response_rms_m if they are the RMS of the response.
    study: {gap in m: rows of a study} whose curve is drawn behind measured points; None for none.
    caption: in the place of that of a study.
    """
    places = _places(rows)
    columns = "a column per gap" if len(places) == 1 else "a column per group of supports and gap"
    caption = caption or (
        f"Equivalent bilateral support by each method against load, {columns}: stiffness k"
        " (top) and damping c on top of the modal damping (bottom), per support; median over seeds,"
        " bars from the smallest to the largest seed. Unresolved values are left out:"
        " near the free tube none sees k. The shape carries no damping. Lines without bars:"
        " statistical linearisation (from the load alone) and the mean secant stiffness of the"
        " simulated contact forces. Dashed: the contact stiffness, the upper limit."
    )
    gaps = sorted({row["gap_m"] for row in rows}, reverse=True)
    loads = Axis(level, True, *extent([row["load_rms_N"] for row in rows], log=True))
    across = -(-len(places) * len(gaps) // -(-len(places) * len(gaps) // MOST_COLUMNS))
    lowest = config.identification.stiffness_range_N_per_m[0]
    level_of_k = Axis(VALUES["k"], True, 0.5 * lowest, HIGHEST_K)
    panels: dict[str, Panel] = {}
    for place in places:
        limit, name = contact_stiffness(model, place[0]), "contact stiffness"
        limit = Mark(name, "y", limit, label=name, colour=GREY, line="--", width=1.0)
        own = {gap: _of(rows, gap, place) for gap in gaps}
        beside = {gap: _of((study or {}).get(gap, ()), None, place) for gap in gaps}
        items = {
            (gap, name): [*_study_curve(beside[gap], column), *_methods(own[gap], name, level)]
            for gap in gaps
            for name, column in VALUES.items()
        }
        level_of_c = Axis(VALUES["c"], False, *extent(_values(items[gap, "c"] for gap in gaps)))
        for gap in gaps:
            top, bottom = (f"{name}, {' in '.join(place)}, gap {gap:.5g} m" for name in "kc")
            inner, why = bool(len(panels) // 2 % across), _why_empty(own[gap])
            title = f"gap {gap_label(config, gap)}"
            if len(places) > 1:
                title = " in ".join(place) + (f", {gap * 1e3:.3g} mm" * (len(gaps) > 1))
            axes = replace(loads, bare=True), replace(level_of_k, bare=inner)
            panels[top] = Panel(*axes, [*items[gap, "k"], limit], title, why)
            axes = loads, replace(level_of_c, bare=inner and len(places) == 1)
            panels[bottom] = Panel(*axes, items[gap, "c"], note=why)
    halves = (in_rows([*panels][half::2], across) for half in (0, 1))
    blocks = [row for block in zip(*halves, strict=True) for row in block]
    return Plot(
        "figure_13_equivalent_support",
        "Equivalent stiffness and damping by every method",
        caption,
        panels,
        blocks,
        (max(2.6 + 2.6 * across, 6.4), 3.2 * len(blocks)),
        legend=(2, 4, 5)[min(across, 3) - 1],
    )


def _values(found):
    """Return all values of lists of series along y."""
    parts = [part for items in found for item in items for part in (item.y, item.low, item.high)]
    return [value for part in parts if part is not None for value in part]


def _study_curve(rows, column):
    """Return the median of a study's compared methods against load, with their range."""
    compared = [row for row in rows if row["method"] in COMPARED]
    loads, values, _ = grouped(compared, "load_rms_N", column)
    if not loads:
        return []
    middle, low, high = spread(values)
    look = {"colour": GREY, "width": 1.6, "order": 0}
    label = "study, range of methods and seeds"
    return [Series("study", loads, middle, {}, low, high, True, label=label, **look)]


def _methods(rows, quantity, level):
    """Return one quantity by every method: predictions as lines, others with their range."""
    column, found = VALUES[quantity], []
    table = [{**row, level: row["load_rms_N"]} for row in rows]
    for method in DRAWN[quantity]:
        chosen = [row for row in table if row["method"] == method]
        chosen = [row for row in chosen if quantity != "k" or row[column] > 0.0]
        if method in PREDICTED:
            found += _predicted(chosen, level, method)
        else:
            found += over_seeds(chosen, level, column, method, **look_of(method))
    return found


def _predicted(rows, x, method, **look: Any):
    """Return the line of k by a method that needs no response, in a list, empty without values."""
    place, value = medians(rows, x, VALUES["k"])
    return [Series(method, place, value, **(look_of(method) | look))] if place.size else []


def _why_empty(rows):
    """Return why no compared method has a value among rows of the consistency table."""
    reasons = [row["reason"] for row in rows if row["method"] in COMPARED and row["reason"]]
    return f"No method resolves it. {reasons[0] if reasons else ''}".strip()


def _place(row):
    """Return the (group of supports, direction) of a row."""
    return str(row["group"]), str(row["direction"])


def _places(rows):
    """Return the (group of supports, direction) of all rows, each once."""
    return list(dict.fromkeys(map(_place, rows)))


def _of(rows, gap, place):
    """Return the rows of a place at a gap, at all gaps if it is None."""
    return [row for row in rows if _place(row) == place and gap in (None, row["gap_m"])]


def collapse(config, model, rows):
    """Return the Plot of k and c of all gaps against load over gap.

    rows: the consistency table, list of {column: value}.
    """
    caption = (
        "Equivalent support against load divided by gap, all gaps: stiffness k (left) and damping"
        " c (right) per support. The tube with impacts is homogeneous: its motion, measured in"
        " gaps, depends on load/gap only, so that the points of all gaps must fall on one curve."
        " Markers: median over seeds and over the methods"
        f" {', '.join(map(method_name, COMPARED))} (the shape gives no c), bars from"
        " the smallest to the largest value. Lines: statistical linearisation and the mean secant"
        " stiffness, of all gaps."
    )
    places = _places(rows)
    table = [{**row, "load_over_gap_N_per_m": row["load_over_gap"]} for row in rows]
    lowest = config.identification.stiffness_range_N_per_m[0]
    panels: dict[str, Panel] = {}
    for place in places:
        own = [row for row in table if _place(row) == place]
        of = "" if len(places) == 1 else f", {' in '.join(place)}"
        why = _why_empty(own)
        stiffness, x = _of_gaps(config, own, "k"), "load_over_gap_N_per_m"
        for method in PREDICTED:
            known = [row for row in own if row["method"] == method and row["k_N_per_m"] > 0.0]
            stiffness += _predicted(known, x, method, marker="", width=1.2)
        damping = _of_gaps(config, own, "c")
        shown = [value for item in [*stiffness, *damping] for value in item.x]
        loads = Axis(x, True, *extent(shown, log=True))
        level = Axis(VALUES["k"], True, 0.5 * lowest, 2.5 * contact_stiffness(model))
        name, zero = " in ".join(place), Mark("", "y", 0.0, colour=GREY, width=0.8)
        title = f"damping{of}" if of else "damping on top of the modal damping"
        panels[f"k, {name}"] = Panel(loads, level, stiffness, f"stiffness{of}", why)
        panels[f"c, {name}"] = Panel(loads, Axis(VALUES["c"]), [*damping, zero], title, why)
    pairs = in_rows(list(panels), 2)
    size = (7.6, 1.0 + 3.2 * len(places))
    return Plot("collapse", _collapse_title(rows), caption, panels, pairs, size, legend=3)


def _collapse_title(rows):
    """Return the title of the figure: the distance between the curves of the gaps."""
    ratios = [
        row["k_ratio"]
        for row in collapse_rows(summary_rows(rows))
        if row["method"] in COMPARED and np.isfinite(row["k_ratio"])
    ]
    if not ratios:
        return "Equivalent support against load / gap"
    return f"k of the gaps at equal load / gap: within {100.0 * (max(ratios) - 1.0):.0f} %"


def _of_gaps(config, rows, quantity):
    """Return the values of the compared methods at each gap."""
    found, x, tags = [], "load_over_gap_N_per_m", ("gap_m", "load_rms_N")
    for gap, look in looks_of_gaps(config, [row["gap_m"] for row in rows]):
        own = [row for row in rows if row["gap_m"] == gap and row["method"] in COMPARED]
        found += over_seeds(own, x, VALUES[quantity], "identified", tags, line="", **look)
    return found


def looks_of_gaps(config, gaps) -> Iterator[tuple[float, dict[str, Any]]]:
    """Yield (gap in m, how its curve looks, with its label) of the gaps, the largest first."""
    for index, gap in enumerate(sorted(set(gaps), reverse=True)):
        yield gap, look_of_gap(index) | {"label": f"gap {gap_label(config, gap)}"}


def look_of_gap(index: int) -> dict[str, Any]:
    """Return colour and marker of the curve of a gap."""
    colours, markers = GAP_COLOURS, GAP_MARKERS
    return {"colour": colours[index % len(colours)], "marker": markers[index % len(markers)]}
