"""The places of the named effects: the structure with its supports, forces and
channels, and the places marked.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from vibroimpact.effects.places import arc_length_m, place_in_words
from vibroimpact.effects.registry import EFFECTS, effects_in_words
from vibroimpact.geometry.centreline import build_centreline
from vibroimpact.geometry.support_spans import support_middles
from vibroimpact.reports.figures.labels import spread_labels
from vibroimpact.reports.figures.sheet import WIDTH_IN, Sheet
from vibroimpact.reports.figures.study.tube import view_axes
from vibroimpact.reports.figures.style import BLACK, BLUE, GREY, ORANGE, PALE

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
    view = view_axes(drawn)[:2]  # that its channels point in
    across, up = np.ptp(drawn, axis=0)[list(view)]
    height = np.clip(AROUND_IN + WIDTH_IN * up / max(across, 1e-3 * size), LEAST_IN, MOST_IN)
    sheet = Sheet("diagnosis_place", title, f"{caption}.", size=(WIDTH_IN, float(height)))
    axes = sheet.axes["main"]
    columns = tuple("xyz"[axis] + "_m" for axis in view)
    _structure(sheet, axes, places, view, columns)
    for role, colour, marker in (("channels", BLUE, "o"), ("forces", BLACK, "s")):
        _directed(
            sheet,
            axes,
            getattr(places, role),
            places.directions,
            (view, columns, size),
            (role, colour, marker),
        )
    labels = [_marked(sheet, axes, places, effect, view, columns) for effect in effects]
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.2, 0.12)  # the bars of supports reach beyond the tube
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    spread_labels(sheet.figure, [label for label in labels if label is not None])
    return sheet


def _structure(sheet, axes, places, view, columns):
    """Draw the tube, or the named points of another structure, and the supports."""
    if places.line is None and places.points:
        named = np.array([*places.points.values()])
        sheet.line(
            axes,
            (columns[0], named[:, view[0]]),
            (columns[1], named[:, view[1]]),
            "named points",
            color=GREY,
            marker=".",
            linestyle="none",
            zorder=1,
            label="named point",
        )
    if places.line is not None:
        sheet.line(
            axes,
            (columns[0], places.line[:, view[0]]),
            (columns[1], places.line[:, view[1]]),
            "structure",
            color=PALE,
            linewidth=5,
            solid_capstyle="butt",
            zorder=1,
        )
    for number, (name, place) in enumerate(places.supports.items()):
        angle = 0.0
        if places.line is not None:
            along = _tangent(places.line, place)[list(view)]
            angle = np.degrees(np.arctan2(along[1], along[0])) + 90.0
        sheet.line(
            axes,
            (columns[0], place[[view[0]]]),
            (columns[1], place[[view[1]]]),
            f"support {name}",
            color=GREY,
            marker=(2, 0, angle - 90.0),
            markersize=26,
            markeredgewidth=5,
            linestyle="none",
            zorder=2,
            label="support" if number == 0 else None,
        )


def _tangent(line, place):
    """Return the direction (3,) of a line at the point of it that is nearest to a place."""
    at = int(np.clip(np.argmin(np.linalg.norm(line - place, axis=1)), 1, len(line) - 2))
    return line[at + 1] - line[at - 1]


def _directed(sheet, axes, named, directions, seen, look):
    """Draw channels or forces with arrows along their directions, as far as these lie in the plane
    that is seen.
    """
    (view, columns, size), (role, colour, marker) = seen, look
    for number, (name, place) in enumerate(named.items()):
        spot, way = place[list(view)], directions[name][list(view)] * ARROW * size
        sheet.line(
            axes,
            (columns[0], spot[:1]),
            (columns[1], spot[1:]),
            name,
            color=colour,
            marker=marker,
            markersize=5,
            linestyle="none",
            zorder=4,
            label=role.removesuffix("s") if number == 0 else None,
        )
        if np.linalg.norm(way) > 0.1 * ARROW * size:
            style = {"arrowstyle": "->", "color": colour, "linewidth": 1.0}
            axes.annotate("", spot + way, spot, arrowprops=style, zorder=4)


def _marked(sheet, axes, places, effect, view, columns):
    """Mark the place of an effect; return its label, None if there is nothing to mark."""
    spots = places.of(effect)
    whole = not spots
    if whole:
        spots = [*places.channels.values()] if places.line is None else places.line
    across, up = (np.array(spots)[:, axis] for axis in view)
    style = {"linewidth": 9, "alpha": 0.35} if whole and places.line is not None else {}
    sheet.line(
        axes,
        (columns[0], across),
        (columns[1], up),
        f"{effect.id} at {place_in_words(effect.location or 'all')}",
        color=ORANGE,
        zorder=3 if whole else 5,
        **(
            style
            or {
                "marker": "o",
                "markersize": 18,
                "markerfacecolor": "none",
                "markeredgewidth": 2.5,
                "linestyle": "none",
            }
        ),
    )
    top = int(np.argmax(up))
    return axes.annotate(
        effects_in_words([effect.id]),
        (across[top], up[top]),
        xytext=(14, 12),
        textcoords="offset points",
        color=ORANGE,
        fontweight="bold",
        zorder=6,
    )
