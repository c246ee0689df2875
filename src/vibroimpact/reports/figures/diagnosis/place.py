"""The places of the named effects: the structure with its supports, forces and
channels, and the places marked.
"""

import re
from dataclasses import dataclass

import numpy as np

from vibroimpact.effects.places import arc_length_m, place_in_words
from vibroimpact.effects.registry import EFFECTS, effects_in_words
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.support_spans import support_middles
from vibroimpact.reports.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, GREY, ORANGE
from vibroimpact.reports.figures.view import THICK_LINE, View, spread_labels

TUBES = ("u_tube", "path")
LINE_POINTS = 300
# Height of the figure: of title, labels and legend, without the structure; least and largest.
AROUND_IN, LEAST_IN, MOST_IN = 1.7, 2.6, 4.4
ARROW = 0.07  # length of an arrow of a direction, of the largest extent drawn
# Locations of measuring faults: the forces, the channels, or both.
FORCES, CHANNELS = ("force", "force_and_responses"), ("responses", "force_and_responses")


@dataclass(frozen=True)
class Places:
    """The known positions, m: line (point, 3) of a tube, None for other structures; supports,
    points, channels, forces {name: (3,)}; directions {channel or force: (3,)}.
    """

    line: np.ndarray | None
    supports: dict
    points: dict
    channels: dict
    forces: dict
    directions: dict

    def named(self):
        """Return {name: (3,)} of all that has a name."""
        return self.points | self.forces | self.channels | self.supports

    def known(self):
        """Return (point, 3) of all that has a place."""
        return np.array([*self.named().values(), *([] if self.line is None else self.line)])

    def tips(self, length):
        """Return (tip, 3) of the arrows of channels and forces, of a length (m)."""
        at = self.channels | self.forces
        return np.array([at[name] + length * self.directions[name] for name in at])

    def of(self, effect):
        """Return [(3,)] of the places of a FoundEffect, empty if it acts on the whole structure."""
        location, named = effect.location, self.named()
        if location in named:
            return [named[location]]
        arc_length = arc_length_m(location)
        if arc_length is not None and self.line is not None:
            steps = np.linalg.norm(np.diff(self.line, axis=0), axis=1)
            along = np.append(0.0, np.cumsum(steps))
            return [np.array([np.interp(arc_length, along, axis) for axis in self.line.T])]
        known = EFFECTS.get(effect.id)
        if location in ("all", "") and known is not None and known.acts_on == "contact":
            return [*self.supports.values()]
        found = [*self.forces.values()] if location in FORCES else []
        found += [*self.channels.values()] if location in CHANNELS else []
        if location == "roots" and self.line is not None:
            found = [self.line[0], self.line[-1]]
        words = re.findall(r"[\w.-]+", location)
        return found or [named[word] for word in dict.fromkeys(words) if word in named]


def places_of(config, data):
    """Return the Places of a configuration (None if the structure has no model) and of a Dataset
    with the points and directions of channels and forces.
    """
    line, supports, points = None, {}, {}
    if config is not None and config.structure.kind in TUBES:
        tube = build_centreline(config.structure)
        line = np.array([tube.position(at) for at in np.linspace(0.0, tube.length, LINE_POINTS)])
        supports = {
            support.name: np.mean([tube.position(at) for at in support_middles(tube, support)], 0)
            for support in config.supports
        }
        points = {
            name: tube.position(tube.locate(place, name)) for name, place in config.points.items()
        }
    elif config is not None:
        points = {name: np.array(place) for name, place in config.points.items()}
        supports = {
            support.name: points[support.point]
            for support in config.supports
            if support.point in points
        }
    found: dict = {}
    directions: dict = {}
    for role in ("channel", "force_channel"):
        names = data[f"{role}_name"].values if f"{role}_name" in data else ["force"]
        places = data[f"{role}_point"].values.astype(float)
        along = data[f"{role}_direction"].values.astype(float)
        rows = [*zip(map(str, names), places, along, strict=False)]
        found[role] = {name: place for name, place, _ in rows if np.isfinite(place).all()}
        directions |= {name: way for name, _, way in rows}
    return Places(line, supports, points, found["channel"], found["force_channel"], directions)


def place_figure(config, data, effects):
    """Return the Sheet of the structure with the places of effects [FoundEffect] marked.

    config, data: as of places_of; data None if no campaign was compared.
    """
    caption = (
        "The structure, seen on the plane of its largest extents, to scale: supports (grey bars),"
        " channels (blue) and forces (black) with their directions in this plane"
    )
    if config is not None and config.structure.kind not in TUBES:
        caption += ", and the named points of the model (small grey dots)"
    if effects:
        caption += (
            ", in orange the place of the effect. An effect that acts everywhere marks all of it"
        )
    title = "Place of the effect" if effects else "The structure as it was measured"
    places = None if data is None or "channel_point" not in data else places_of(config, data)
    size = 0.0 if places is None else np.ptp(places.known(), axis=0).max()
    if places is None or size == 0.0:
        sheet = Sheet("diagnosis_place", title, f"{caption}.", size=(WIDTH_IN, LEAST_IN))
        sheet.note(sheet.axes["main"], "no places are known", "x_m", "z_m")
        return sheet
    drawn = np.vstack([places.known(), places.tips(ARROW * size)])  # of a straight tube, the plane
    view = View.of(drawn)  # that its channels point in
    across, up = np.ptp(view.seen(drawn), axis=0)
    height = np.clip(AROUND_IN + WIDTH_IN * up / max(across, 1e-3 * size), LEAST_IN, MOST_IN)
    sheet = Sheet("diagnosis_place", title, f"{caption}.", size=(WIDTH_IN, float(height)))
    axes = sheet.axes["main"]
    _structure(sheet, axes, places, view)
    for role, colour, marker in (("channel", BLUE, "o"), ("force", BLACK, "s")):
        _directed(sheet, axes, places, (view, ARROW * size), (role, colour, marker))
    labels = [_marked(sheet, axes, places, effect, view) for effect in effects]
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.2, 0.12)  # the bars of supports reach beyond the tube
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    spread_labels(sheet.figure, labels)
    return sheet


def _structure(sheet, axes, places, view):
    """Draw the tube, or the named points of another structure, and the supports."""
    if places.line is None and places.points:
        named = np.array([*places.points.values()])
        dots = {"color": GREY, "marker": ".", "linestyle": "none", "zorder": 1}
        sheet.line(axes, *view.columns(named), "named points", **dots, label="named point")
    if places.line is not None:
        sheet.line(axes, *view.columns(places.line), "structure", **THICK_LINE)
    bar = {"color": GREY, "markersize": 26, "markeredgewidth": 5, "linestyle": "none", "zorder": 2}
    for number, (name, place) in enumerate(places.supports.items()):
        angle = 0.0
        if places.line is not None:
            line = places.line
            nearest = np.argmin(np.linalg.norm(line - place, axis=1))
            at = int(np.clip(nearest, 1, len(line) - 2))
            along = view.seen(line[at + 1] - line[at - 1])
            angle = np.degrees(np.arctan2(along[1], along[0])) + 90.0
        bar |= {"marker": (2, 0, angle - 90.0), "label": "support" if number == 0 else None}
        sheet.line(axes, *view.columns(place), f"support {name}", **bar)


def _directed(sheet, axes, places, seen, look):
    """Draw channels or forces with arrows along their directions, as far as these lie in the plane
    that is seen; seen: (view, length of an arrow in m).
    """
    (view, length), (role, colour, marker) = seen, look
    spot = {"color": colour, "marker": marker, "markersize": 5, "linestyle": "none", "zorder": 4}
    arrow = {"arrowstyle": "->", "color": colour, "linewidth": 1.0}
    for number, (name, place) in enumerate(getattr(places, f"{role}s").items()):
        sheet.line(axes, *view.columns(place), name, **spot, label=None if number else role)
        at, way = view.seen(place), view.seen(places.directions[name]) * length
        if np.linalg.norm(way) > 0.1 * length:
            axes.annotate("", at + way, at, arrowprops=arrow, zorder=4)


def _marked(sheet, axes, places, effect, view):
    """Mark the place of an effect, all of the structure if it has none; return its label."""
    spots = places.of(effect)
    style = {"marker": "o", "markersize": 18, "markerfacecolor": "none", "markeredgewidth": 2.5}
    style |= {"linestyle": "none", "zorder": 5 if spots else 3}
    if not spots and places.line is not None:
        style = {"linewidth": 9, "alpha": 0.35, "zorder": 3}
    if not spots:
        spots = [*places.channels.values()] if places.line is None else places.line
    curve = f"{effect.id} at {place_in_words(effect.location or 'all')}"
    sheet.line(axes, *view.columns(np.array(spots)), curve, color=ORANGE, **style)
    seen = view.seen(spots)
    return axes.annotate(
        effects_in_words([effect.id]),
        seen[np.argmax(seen[:, 1])],
        xytext=(14, 12),
        textcoords="offset points",
        color=ORANGE,
        fontweight="bold",
        zorder=6,
    )
