"""The law that records demand at supports and local elements, against the model's."""

import numpy as np
import xarray as xr

from vibroimpact.diagnosis.law import SEEN
from vibroimpact.reports.figures.plot import Axis, Bars, Mark, Panel, Plot, Series, in_rows
from vibroimpact.reports.figures.sheet import WIDTH_IN
from vibroimpact.reports.figures.style import BLACK, GREY, PALE

from .states import AS_GIVEN, COLOURS, level_in_words, percent, shown_states

MOST_UNSEEN = 12  # bars of places
MOST_PLACES = 3  # supports and elements
ACROSS = 3  # panels
NARROW_IN = 7.4  # of the figure: its title has room
DOTS = 1200  # of the demanded law
BINS, LEAST_IN_BIN = 36, 6
IN_CONTACT = 0.15  # of the largest force: from it on a place is drawn as pressed
SCATTER = 4.0  # times the median force, which is scatter if contacts are short
ALIVE = 0.03  # of the largest force of all places
ALMOST = 0.25  # of the largest gain, which another level may lack
LARGEST = 0.995  # quantile that stands for the largest

CAPTION = (
    "Dots: the force on the structure that the sensors demand, without any law of contact, against"
    " the motion there, both in the band of the comparison; their scatter where nothing touches"
    " says how well the sensors tell a force. Lines: the median force of the model's own law in a"
    " run that is held to the sensors. Per cent: error of the model's force over the demanded"
    " force, instant by instant. {panels}A static part of motion or force is not measured and is"
    " left out of both.{unseen}"
)
ORBIT = (
    "Panels with two motions: where the structure is while a force acts (demanded: black; model: in"
    " its colour) and while none does (grey). "
)


def law_figure(evidence: xr.Dataset) -> Plot:
    """Return the Plot of force against motion at each support whose force the sensors resolve."""
    evidence = evidence.isel(law_stretch=[telling_level(evidence)])
    told, unseen = _told_places(evidence)
    level = level_in_words(evidence, int(evidence["law_of_stretch"].values[0]))
    if not told:
        return _unseen(evidence, level, unseen)
    panels = _panels(evidence, told)
    states = shown_states(evidence)
    errors = [force_error(evidence, state, told) for state, _ in states]
    told_errors = zip(("model as given", "completed"), map(percent, errors), strict=False)
    title = f"Demanded forces: error of {', '.join(map(' '.join, told_errors))}"
    owned: dict[str, list[str]] = {}  # a row of panels per support if one has several
    for key, places in panels.items():
        owned.setdefault(str(evidence["owner_name"].values[places[0]]), []).append(key)
    rows = in_rows(list(panels), min(ACROSS, len(panels)))
    if len(owned) < len(panels):
        across = max(map(len, owned.values()))
        rows = [filled for row in owned.values() for filled in in_rows(row, across)]
    orbit = any(len(places) == 2 for places in panels.values())
    about = CAPTION.format(panels=ORBIT if orbit else "", unseen=unseen)
    return Plot(
        "diagnosis_law",
        title,
        f"{level}. {about}",
        {
            key: (_law_panel if len(places) == 1 else _orbit_panel)(evidence, places, states)
            for key, places in panels.items()
        },
        rows,
        (min(max(0.6 + 3.1 * len(rows[0]), NARROW_IN), WIDTH_IN), 1.0 + 2.5 * len(rows)),
        legend=3,
    )


def _unseen(evidence, level, unseen):
    """Return the Plot of the shares of each force that the sensors resolve."""
    known, names = evidence["resolution"].values[0], evidence["place_name"].values
    order = np.argsort(-known, kind="stable")[:MOST_UNSEEN]
    bars = Bars("known", range(len(order)), known[order], {"place": names[order]}, colour=GREY)
    limit = Mark("", "x", SEEN, width=0.8, line=":")
    axes = Axis("known_share", False, 0.0, 1.0), Axis("place", names=names[order].tolist())
    return Plot(
        "diagnosis_law",
        "The law at the supports is not seen by these sensors",
        f"{level}. Share of the force at each place that the sensors tell; below"
        f" {100.0 * SEEN:.0f} % it is not shown against the motion.{unseen}",
        {"main": Panel(*axes, [bars, limit])},
        size=(WIDTH_IN, 1.3 + 0.28 * len(order)),
    )


def telling_level(evidence: xr.Dataset) -> int:
    """Return the number of the highest level, which shows most of a law, at which the completed
    model gains nearly as much in its forces at all places as at any other.
    """
    places, gains = list(range(evidence.sizes["place"])), []
    for level in range(evidence.sizes["law_stretch"]):
        own = evidence.isel(law_stretch=[level])
        before, after = (min(force_error(own, state, places), 2.0) for state in (0, 1))
        gains.append(before - after)
    gained = np.nan_to_num(gains)
    least = gained.max() - ALMOST * abs(gained.max())
    return int(np.flatnonzero(gained >= least)[-1])


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


def _law_panel(evidence, places, states):
    """Return the Panel of force against motion of one place."""
    (place,) = places
    name = str(evidence["place_name"].values[place])
    motion = evidence["demanded_motion"].values[0, place].astype(float)
    force = evidence["demanded_force"].values[0, place].astype(float)
    some = slice(None, None, max(1, len(motion) // DOTS))
    look = {"colour": GREY, "line": "", "marker": ".", "size": 2.5, "order": 1}
    look["label"] = "demanded by the sensors"
    items = [Series("demanded", motion[some], force[some], {"place": name}, **look)]
    for state, word in states:
        own = evidence["model_motion"].values[state, 0, place].astype(float)
        law = evidence["model_force"].values[state, 0, place].astype(float)
        if np.isfinite(own).all():  # else the model has no such element
            look = {"colour": COLOURS[word], "line": "--" if word == AS_GIVEN else "-"}
            look |= {"width": 1.8, "label": word, "order": 3}
            items.append(Series(word, *median_law(own, law), {"place": name}, **look))
    errors = [percent(force_error(evidence, state, [place])) for state, _ in states]
    title = f"{name.replace('_', ' ')}: {' → '.join(errors)}"
    return Panel(Axis("place_motion_m"), Axis("place_force_N"), items, title)


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


def _orbit_panel(evidence, places, states):
    """Return the Panel of the motion across a support, with the points at which it is pressed."""
    items = []
    for state, name in states:
        motion, force = (
            evidence[f"model_{part}"].values[state, 0, places] for part in ("motion", "force")
        )
        kept = _some(np.flatnonzero(pressed(force)))
        items.append(_dots(motion[:, kept], f"{name}, pressed", COLOURS[name], 6.0))
    motion, force = (evidence[f"demanded_{part}"].values[0, places] for part in ("motion", "force"))
    under = pressed(force)
    free, held = _some(np.flatnonzero(~under)), _some(np.flatnonzero(under))
    items.append(_dots(motion[:, free], "demanded, free", PALE, 2.0))
    items.append(_dots(motion[:, held], "demanded, pressed", BLACK, 2.5))
    names = [str(name) for name in evidence["place_name"].values[places]]
    along, across = (f"Motion in {name.rpartition(', ')[2]} (mm)" for name in names)
    axes = Axis("place_motion_m", label=along), Axis("across_motion_m", label=across)
    return Panel(*axes, items, names[0].rpartition(", ")[0] + ": where forces act", equal=True)


def pressed(force: np.ndarray) -> np.ndarray:
    """Return (sample,) bool: whether a force (2, sample) in N stands out of its own scatter."""
    size = np.hypot(*force.astype(float))
    largest = np.quantile(size, LARGEST)
    return size > max(IN_CONTACT * largest, min(SCATTER * np.median(size), 0.5 * largest))


def _some(numbers):
    """Return at most some DOTS of numbers (sample,), evenly spread."""
    return numbers[:: max(1, len(numbers) // DOTS + 1)]


def _dots(motion, curve, colour, size):
    """Return dots of motion (2, sample) in m."""
    return Series(curve, *motion, colour=colour, line="", marker=".", size=size)
