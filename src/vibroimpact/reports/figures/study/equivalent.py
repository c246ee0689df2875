"""The equivalent support: k and c against load (figure 13) and against load over gap."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from vibroimpact.reports.figures.plot import Axis, Mark, Panel, Plot, Series, extent, in_rows
from vibroimpact.reports.figures.style import (
    GAP_COLOURS,
    GAP_MARKERS,
    GREY,
    METHODS,
    OPEN_METHODS,
    gap_label,
)
from vibroimpact.study.method_agreement import COMPARED, collapse_rows, summary_rows

from .linear_limits import contact_stiffness
from .seed_scatter import grouped, medians, over_seeds, spread

COLUMNS = {"k": "k_N_per_m", "c": "c_N_s_per_m"}
PREDICTED = ("statistical_linearisation", "secant")
DRAWN = {"k": tuple(METHODS), "c": (*OPEN_METHODS, "lscf", "broadband")}
HIGHEST_K = 2e7  # N/m, of the axis
MOST_COLUMNS = 4  # gaps side by side; more begin another block below


def look_of(method: str) -> dict[str, Any]:
    """Return how the curve of a method looks, in every plot."""
    label, colour, marker = METHODS.get(method, (method, GREY, "o"))
    look = {"label": label, "colour": colour, "marker": marker}
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
    lowest = config.identification.stiffness_range_N_per_m[0]
    panels: dict[str, Panel] = {}
    pairs = []
    for place in places:
        items = {
            gap: _items(_of(rows, gap, place), _of((study or {}).get(gap, ()), None, place), level)
            for gap in gaps
        }
        damping = extent([value for found in items.values() for value in _values(found["c"])])
        for gap in gaps:
            pair = tuple(f"{name}, {' in '.join(place)}, gap {gap:.5g} m" for name in "kc")
            inner = bool(len(pairs) % _across(len(places) * len(gaps)))
            why = _why_empty(_of(rows, gap, place))
            panels[pair[0]] = Panel(
                replace(loads, bare=True),
                Axis(COLUMNS["k"], True, 0.5 * lowest, HIGHEST_K, bare=inner),
                [*items[gap]["k"], _limit(model, place)],
                _title(config, gap, place, len(places), len(gaps)),
                why,
            )
            bottom = Axis(COLUMNS["c"], False, *damping, bare=inner and len(places) == 1)
            panels[pair[1]] = Panel(loads, bottom, items[gap]["c"], note=why)
            pairs.append(pair)
    blocks = _in_blocks(pairs)
    return Plot(
        "figure_13_equivalent_support",
        "Equivalent stiffness and damping by every method",
        caption,
        panels,
        blocks,
        (max(2.6 + 2.6 * len(blocks[0]), 6.4), 3.2 * len(blocks)),
        legend=(2, 4, 5)[min(len(blocks[0]), 3) - 1],
    )


def _title(config, gap, place, places, gaps):
    if places > 1:
        return f"{place[0]} in {place[1]}" + (f", {gap * 1e3:.3g} mm" * (gaps > 1))
    return f"gap {gap_label(config, gap)}"


def _limit(model, place):
    """Return the Mark of the contact stiffness of a group of supports."""
    name = "contact stiffness"
    value = contact_stiffness(model, place[0])
    return Mark(name, "y", value, label=name, colour=GREY, line="--", width=1.0)


def _values(items):
    """Return all values of series along y."""
    parts = [(item.y, item.low, item.high) for item in items]
    return [value for part in parts for array in part if array is not None for value in array]


def _items(rows, beside, level):
    """Return {k, c: items} of the rows of one place, over the curve of a study."""
    return {
        quantity: [*_study_curve(beside, column), *_methods(rows, quantity, level)]
        for quantity, column in COLUMNS.items()
    }


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
    column, found = COLUMNS[quantity], []
    for method in DRAWN[quantity]:
        chosen = [
            {**row, level: row["load_rms_N"]}
            for row in rows
            if row["method"] == method and (quantity != "k" or row[column] > 0.0)
        ]
        if method not in PREDICTED:
            found += over_seeds(chosen, level, column, method, **look_of(method))
            continue
        place, value = medians(chosen, level, column)
        found += [Series(method, place, value, **look_of(method))] if place.size else []
    return found


def _why_empty(rows):
    """Return why no compared method has a value among rows of the consistency table."""
    reasons = [row["reason"] for row in rows if row["method"] in COMPARED and row["reason"]]
    return f"No method resolves it. {reasons[0] if reasons else ''}".strip()


def _across(count):
    """Return the number of pairs of panels in a row."""
    return -(-count // -(-count // MOST_COLUMNS))


def _in_blocks(pairs):
    """Return the rows of pairs of panels (top, bottom), side by side in blocks of two rows."""
    across = _across(len(pairs))
    halves = (in_rows([pair[half] for pair in pairs], across) for half in (0, 1))
    return [row for block in zip(*halves, strict=True) for row in block]


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
        f" {', '.join(METHODS[method][0] for method in COMPARED)} (the shape gives no c), bars from"
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
        stiffness = [*_of_gaps(config, own, "k"), *_predictions(own)]
        damping = _of_gaps(config, own, "c")
        shown = [value for item in [*stiffness, *damping] for value in item.x]
        loads = Axis("load_over_gap_N_per_m", True, *extent(shown, log=True))
        level = Axis(COLUMNS["k"], True, 0.5 * lowest, 2.5 * contact_stiffness(model))
        name, zero = " in ".join(place), Mark("", "y", 0.0, colour=GREY, width=0.8)
        title = f"damping{of}" if of else "damping on top of the modal damping"
        panels[f"k, {name}"] = Panel(loads, level, stiffness, f"stiffness{of}", why)
        panels[f"c, {name}"] = Panel(loads, Axis(COLUMNS["c"]), [*damping, zero], title, why)
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
        found += over_seeds(own, x, COLUMNS[quantity], "identified", tags, line="", **look)
    return found


def looks_of_gaps(config, gaps) -> Iterator[tuple[float, dict[str, Any]]]:
    """Yield (gap in m, how its curve looks, with its label) of the gaps, the largest first."""
    for index, gap in enumerate(sorted(set(gaps), reverse=True)):
        yield gap, look_of_gap(index) | {"label": f"gap {gap_label(config, gap)}"}


def look_of_gap(index: int) -> dict[str, Any]:
    """Return colour and marker of the curve of a gap."""
    colours, markers = GAP_COLOURS, GAP_MARKERS
    return {"colour": colours[index % len(colours)], "marker": markers[index % len(markers)]}


def _predictions(rows):
    """Return k by the methods that need no response."""
    found = []
    for method in PREDICTED:
        known = [row for row in rows if row["method"] == method and row["k_N_per_m"] > 0.0]
        place, value = medians(known, "load_over_gap_N_per_m", COLUMNS["k"])
        look = look_of(method) | {"marker": "", "width": 1.2}
        found += [Series(method, place, value, **look)] if place.size else []
    return found
