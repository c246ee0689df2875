"""The law that records demand at supports and local elements, beside the model's."""

from __future__ import annotations

import numpy as np
import xarray as xr

from vibroimpact.diagnosis.law import SEEN
from vibroimpact.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.figures.style import BLACK, GREY, PALE, label_of, shown

from .states import (
    AS_GIVEN,
    COLOURS,
    bars,
    before_and_after,
    level_in_words,
    name_rows,
    percent,
    shown_states,
)

MOST_UNSEEN = 12  # bars of places
MOST_PLACES = 3  # supports and elements
ACROSS = 3  # panels
NARROW_IN = 7.4  # of the figure: its title has room
DOTS = 1200  # of the demanded law
BINS, LEAST_IN_BIN = 36, 6
IN_CONTACT = 0.15  # of the largest force: from it on a place is drawn as pressed
SCATTER = 4.0  # times the median force, which is scatter where contacts are short
ALIVE = 0.03  # of the largest force of all places
CLEARLY = 1.3  # times the gain of the first level
LARGEST = 0.995  # quantile that stands for the largest

CAPTION = (
    "Dots: the force on the structure that the sensors demand, without any law of contact, against"
    " the motion there, both in the band of the comparison; their scatter where nothing touches"
    " says how well the sensors tell a force. Lines: the median force of the model's own law in a"
    " run that is held to the sensors. Per cent: error of the model's force over the demanded"
    " force, instant by instant. {panels}{static}{unseen}"
)
ORBIT = (
    "Panels with two motions: where the structure is while a force acts (demanded: black; model: in"
    " its colour) and while none does (grey). "
)
STATIC = "A static part of motion or force is not measured and is left out of both."


def law_figure(evidence: xr.Dataset) -> Sheet:
    """Return the Sheet of force against motion at each support that the sensors tell of."""
    evidence = evidence.isel(law_stretch=[telling_level(evidence)])
    told, unseen = _told_places(evidence)
    level = level_in_words(evidence, int(evidence["law_of_stretch"].values[0]))
    if not told:
        return _unseen(evidence, level, unseen)
    panels = _panels(evidence, told)
    states = shown_states(evidence)
    errors = [force_error(evidence, state, told) for state, _ in states]
    words = ("model as given", "completed")
    title = f"Demanded forces: error of {before_and_after(errors, words)}"
    mosaic = _mosaic(evidence, panels)
    sheet = Sheet(
        "diagnosis_law",
        title,
        f"{level}. "
        + CAPTION.format(panels=ORBIT if _has_orbit(panels) else "", static=STATIC, unseen=unseen),
        mosaic,
        size=(min(max(0.6 + 3.1 * len(mosaic[0]), NARROW_IN), WIDTH_IN), 1.0 + 2.5 * len(mosaic)),
    )
    for key, places in panels.items():
        axes = sheet.axes[key]
        if len(places) == 1:
            _law_panel(sheet, axes, evidence, places[0], states)
        else:
            _orbit_panel(sheet, axes, evidence, places, states)
    handles, labels = sheet.axes[mosaic[0][0]].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3, markerscale=3)
    return sheet


def _unseen(evidence, level, unseen):
    """Return the Sheet of how little the sensors know of each force."""
    known, names = evidence["resolution"].values[0], evidence["place_name"].values
    order = np.argsort(-known, kind="stable")[:MOST_UNSEEN]
    sheet = Sheet(
        "diagnosis_law",
        "The law at the supports is not seen by these sensors",
        f"{level}. Share of the force at each place that the sensors tell; below"
        f" {100.0 * SEEN:.0f} % it is not shown against the motion.{unseen}",
        size=(WIDTH_IN, 1.3 + 0.28 * len(order)),
    )
    axes, places = sheet.axes["main"], np.arange(len(order))
    gid = sheet.record(axes, "known", place=names[order], known_share=known[order])
    bars(axes, places, 100.0 * known[order], [""] * len(order), gid, color=GREY)
    axes.axvline(100.0 * SEEN, color=BLACK, linewidth=0.8, linestyle=":")
    name_rows(axes, names[order])
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel(label_of("known_share"))
    return sheet


def telling_level(evidence: xr.Dataset) -> int:
    """Return the number of the level at which the completed model gains most in its forces at all
    places; the first, where contact is sharpest, unless another gains clearly more.
    """
    levels = range(evidence.sizes["law_stretch"])
    places = list(range(evidence.sizes["place"]))
    gains = []
    for level in levels:
        own = evidence.isel(law_stretch=[level])
        before, after = (min(force_error(own, state, places), 2.0) for state in (0, 1))
        gains.append(before - after)
    best = int(np.argmax(np.nan_to_num(gains)))
    return best if gains[best] > CLEARLY * max(gains[0], 0.0) else 0


def force_error(evidence: xr.Dataset, state: int, places: list[int]) -> float:
    """Return the RMS error of the model's forces at places over that of the demanded ones."""
    demanded = evidence["demanded_force"].values[0, places].astype(float)
    model = np.nan_to_num(evidence["model_force"].values[state, 0, places].astype(float))
    power = float(np.sum(demanded**2))
    return float(np.sqrt(np.sum((model - demanded) ** 2) / power)) if power > 0.0 else np.nan


def _told_places(evidence):
    """Return (places whose force is known and acts, words on the others)."""
    resolution = evidence["resolution"].values[0]
    size = evidence["demanded_force"].values[0].std(axis=-1)
    names = evidence["place_name"].values
    known = resolution >= SEEN
    alive = size > ALIVE * size[known].max(initial=0.0)
    hidden = [
        f"{names[place]} (known to {percent(resolution[place])})"
        for place in np.flatnonzero(~known)
    ]
    still = [str(names[place]) for place in np.flatnonzero(known & ~alive)]
    words = f" Too few sensors tell of {', '.join(hidden)}." if hidden else ""
    words += f" Next to no force acts at {', '.join(still)}." if still else ""
    order = dict.fromkeys(evidence["owner_name"].values[np.argsort(-size)])
    kept = list(order)[:MOST_PLACES]
    told = np.flatnonzero(known & alive & np.isin(evidence["owner_name"].values, kept))
    return [int(place) for place in told], words


def _panels(evidence, told):
    """Return {key: places}: a panel per support or element, along the larger force, and one of both
    directions of a support.
    """
    panels, owners = {}, evidence["owner_name"].values
    size = evidence["demanded_force"].values[0].std(axis=-1)
    for owner in dict.fromkeys(owners[told]):
        own = [place for place in told if owners[place] == owner]
        largest = own[int(np.argmax(size[own]))]
        panels[str(evidence["place_name"].values[largest])] = [largest]
        if len(own) == 2:
            panels[f"{owner}, both"] = own
    return panels


def _mosaic(evidence, panels):
    """Return the rows of keys: a row per support where one has several panels."""
    rows: dict[str, list[str]] = {}
    for key, places in panels.items():
        rows.setdefault(str(evidence["owner_name"].values[places[0]]), []).append(key)
    across = max(map(len, rows.values()))
    if across == 1:
        keys = list(panels)
        own = [keys[first : first + ACROSS] for first in range(0, len(keys), ACROSS)]
    else:
        own = list(rows.values())
    across = max(map(len, own))
    return [[*row, *["."] * (across - len(row))] for row in own]


def _has_orbit(panels):
    """Return whether any panel shows both directions of a support."""
    return any(len(places) == 2 for places in panels.values())


def _law_panel(sheet, axes, evidence, place, states):
    """Draw force against motion of one place."""
    motion = evidence["demanded_motion"].values[0, place].astype(float)
    force = evidence["demanded_force"].values[0, place].astype(float)
    some = slice(None, None, max(1, len(motion) // DOTS))
    sheet.line(
        axes,
        ("place_motion_m", motion[some]),
        ("place_force_N", force[some]),
        "demanded",
        tags={"place": str(evidence["place_name"].values[place])},
        color=GREY,
        linewidth=0,
        marker=".",
        markersize=2.5,
        markeredgewidth=0,
        label="demanded by the sensors",
        zorder=1,
    )
    for state, name in states:
        own = evidence["model_motion"].values[state, 0, place].astype(float)
        law = evidence["model_force"].values[state, 0, place].astype(float)
        if not np.isfinite(own).all():
            continue  # the model has no such element
        middle, median = median_law(own, law)
        sheet.line(
            axes,
            ("place_motion_m", middle),
            ("place_force_N", median),
            name,
            tags={"place": str(evidence["place_name"].values[place])},
            color=COLOURS[name],
            linestyle="--" if name == AS_GIVEN else "-",
            linewidth=1.8,
            label=name,
            zorder=3,
        )
    errors = [percent(force_error(evidence, state, [place])) for state, _ in states]
    name = str(evidence["place_name"].values[place]).replace("_", " ")
    axes.set_title(f"{name}: {' → '.join(errors)}")


def median_law(motion: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (motion (bin,), force (bin,)): medians of (sample,) in bins of equal width."""
    edges = np.linspace(motion.min(), motion.max(), BINS + 1)
    number = np.clip(np.digitize(motion, edges) - 1, 0, BINS - 1)
    rows = [
        (np.median(motion[number == own]), np.median(force[number == own]))
        for own in range(BINS)
        if np.sum(number == own) >= LEAST_IN_BIN
    ]
    middle, median = np.array(rows).T if rows else (np.zeros(0), np.zeros(0))
    return middle, median


def _orbit_panel(sheet, axes, evidence, places, states):
    """Draw where a place is across its support, and where it is pressed."""
    for state, name in states:
        motion, force = (
            evidence[f"model_{part}"].values[state, 0, places] for part in ("motion", "force")
        )
        kept = _some(np.flatnonzero(pressed(force)))
        _dots(sheet, axes, motion[:, kept], f"{name}, pressed", (COLOURS[name], 6.0))
    motion, force = (evidence[f"demanded_{part}"].values[0, places] for part in ("motion", "force"))
    under = pressed(force)
    _dots(sheet, axes, motion[:, _some(np.flatnonzero(~under))], "demanded, free", (PALE, 2.0))
    _dots(sheet, axes, motion[:, _some(np.flatnonzero(under))], "demanded, pressed", (BLACK, 2.5))
    axes.set_aspect("equal", adjustable="datalim")
    names = evidence["place_name"].values[places]
    axes.set_title(str(names[0]).rpartition(", ")[0] + ": where forces act")
    for name, label in zip(names, (axes.set_xlabel, axes.set_ylabel), strict=True):
        label(f"Motion in {str(name).rpartition(', ')[2]} (mm)")


def pressed(force: np.ndarray) -> np.ndarray:
    """Return (sample,) bool: where a force (2, sample) in N stands out of its own scatter."""
    size = np.hypot(*force.astype(float))
    largest = np.quantile(size, LARGEST)
    return size > max(IN_CONTACT * largest, min(SCATTER * np.median(size), 0.5 * largest))


def _some(numbers):
    """Return at most some DOTS of numbers (sample,), evenly spread."""
    return numbers[:: max(1, len(numbers) // DOTS + 1)]


def _dots(sheet, axes, motion, curve, style):
    """Draw dots of motion (2, sample) in m; style: colour and size in points."""
    colour, size = style
    place = sheet.record(axes, curve, place_motion_m=motion[0], across_motion_m=motion[1])
    axes.plot(
        *(shown("place_motion_m", values) for values in motion),
        linestyle="none",
        marker=".",
        markersize=size,
        markeredgewidth=0,
        color=colour,
        gid=place,
    )
