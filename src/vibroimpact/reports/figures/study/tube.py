"""The tube: layout with supports, points and sensors (figure 1), and free modes (figure 2)."""

import re
import textwrap

import numpy as np
from matplotlib.patches import Polygon

from vibroimpact.geometry.sections import outer_width, section_kind
from vibroimpact.reduction.ritz_basis import eigenmodes, uncoupled_groups
from vibroimpact.reports.figures.plot import in_rows
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, PALE, RED, gap_label
from vibroimpact.reports.figures.view import THICK_LINE, View, spread_labels
from vibroimpact.structure.beam_elements import DOF_PER_NODE
from vibroimpact.structure.contact.profiles import with_plain_profiles

from .support_views import (
    SHOWN_HOLES,
    distinct_holes,
    drawn_scale,
    support_section,
    support_side,
    titled,
)

SHOWN_MODES = 6
STILL = 1e-6  # a mode that moves less per radian of twist, over the length of the tube, only twists
SHAPE_SIZE = 0.22  # largest drawn displacement, as a fraction of the tube's largest extent
# Labels of the front view: the longest line of a name, and lengths in inches of a character, of the
# space next to the tube and of the width of the panel.
LINE = 14
CHARACTER_IN, LABEL_OFFSET_IN, FRONT_IN = 0.06, 0.2, 4.1
# The point of a label at which the line to its place begins.
RELATIVE = {"left": (0.0, 0.5), "right": (1.0, 0.5), "center": (0.5, 0.5)}
FEW, FONT_PT, SMALL_FONT_PT = 6, 8.5, 7.0  # supports that are named in the usual size of letters
MIDDLE_LINE = {"color": GREY, "linewidth": 0.8, "dashes": (8, 2, 1, 2)}


def figure_01_layout(config, structure):
    """Return the Sheet of the layout: front view, and a support from the side and from above."""
    config = with_plain_profiles(config, structure.contact)
    section = config.structure.section
    gap = max(config.grid.gap_m)
    scale, holes = drawn_scale(config, gap), distinct_holes(config)
    hidden = len(holes) - SHOWN_HOLES
    left_out = f" {hidden} more supports with other holes are not drawn in section."
    left_out = left_out if hidden > 0 else ""
    caption = (
        f"Layout of the tube ({_section_in_words(section)}). Left: front view to scale with its"
        " supports"
        " (grey plates), the contact points on the centreline, the named points, the sensors and"
        " the drive; arrows are directions in the plane, a circle with a dot is a direction out of"
        " the plane, towards the reader, with a cross away from the reader. Right: a support from"
        " the side, and in section with the profile of its hole; the tube can move by the gap,"
        f" {gap_label(config, gap)} here if a support has none of its own,"
        f" before it touches; gaps are drawn {scale:g} times too large."
        f"{left_out} The tube is the one of the configuration, not the drawing of a rig."
    )
    panels = ["section"] if len(holes) < 2 else [f"section {n + 1}" for n in range(len(holes))]
    panels = panels[:SHOWN_HOLES]
    pairs = in_rows(panels, 2)
    beside = [["side"], panels] if len(panels) == 1 else [["side", "side"], *pairs]
    sheet = Sheet(
        "figure_01_layout",
        "The tube, its supports, sensors and drive",
        caption,
        [["front", beside]],
        size=(7.6, 5.2 if len(pairs) < 2 else 6.6),
        width_ratios=(1.45, 1.0),
    )
    support_side(sheet, sheet.axes["side"], config, structure, gap, scale)
    for panel, (names, support) in zip(panels, holes or [([], None)], strict=False):
        axes = sheet.axes[panel]
        axes.set_title("in section" if len(panels) == 1 else titled(names), wrap=True)
        support_section(sheet, axes, config, support, gap, scale)
        if len(panels) > 1:
            axes.set_xlabel("(mm)")
            axes.set_ylabel("")
    _front_view(sheet, sheet.axes["front"], config, structure)
    return sheet


def _section_in_words(section):
    """Return the dimensions of a cross-section in mm."""
    kind = section_kind(section)
    if kind == "tube":
        return (
            f"diameter {section.outer_diameter_m * 1e3:g} mm, wall"
            f" {section.wall_thickness_m * 1e3:g} mm"
        )
    if kind == "rectangle":
        first, second = section.sides_m
        return f"a bar of {first * 1e3:g} mm x {second * 1e3:g} mm, drawn by its smaller width"
    drawn = "a solid rod" if kind == "round" else "of general section, drawn by its smaller width"
    return f"{drawn}, {outer_width(section) * 1e3:g} mm"


def _front_view(sheet, axes, config, structure):
    """Draw the tube seen along the depth axis, with supports, points and sensors."""
    places = np.linspace(0.0, structure.centreline.length, 300)
    line = np.array([structure.centreline.position(place) for place in places])
    view = View.of(line)
    side = "towards" if view.towards > 0 else "away from"
    axes.set_title(f"front view, to scale ({'xyz'[view.depth]} {side} the reader)")
    sheet.line(axes, *view.columns(line), "centreline", **THICK_LINE, label="tube")
    axes.plot(*view.seen(line).T, **MIDDLE_LINE, zorder=2)
    labels = []
    fontsize = FONT_PT if len(config.supports) <= FEW else SMALL_FONT_PT
    dots = {"color": RED, "linestyle": "none", "marker": ".", "markersize": 3.5, "zorder": 4}
    for index, support in enumerate(config.supports):
        points = structure.contact.position[structure.contact.support == index]
        labels.append(_draw_plate(axes, structure, points, view, support.name, fontsize))
        dots["label"] = "contact points" if index == 0 else None
        sheet.line(axes, *view.columns(points), f"contact points of {support.name}", **dots)
    ends = line[held_ends(config.structure)]
    squares = {"marker": "s", "color": BLACK, "markersize": 8, "zorder": 5, "linestyle": "none"}
    axes.plot(*view.seen(ends).T, **squares, label="held end")
    sheet.record(axes, "held ends", **dict(view.columns(ends)))
    labels += _draw_points(sheet, axes, config, structure, view)
    axes.set_aspect("equal", adjustable="datalim")
    _leave_room_for_names(axes, view.seen(line), labels)
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower left", ncols=5)
    spread_labels(sheet.figure, labels)


def _leave_room_for_names(axes, line, labels):
    """Set the limits around a line (point, 2), with room for the labels on either side, or above
    and below; a straight tube gets a width to stand in.
    """
    low, high = line.min(axis=0), line.max(axis=0)
    extents = high - low
    longest = max((len(row) for label in labels for row in label.get_text().split("\n")), default=0)
    size = min((label.get_fontsize() for label in labels), default=FONT_PT) / FONT_PT
    beside = CHARACTER_IN * size * longest + LABEL_OFFSET_IN
    shares = beside / (FRONT_IN - 2.0 * beside), 0.08
    half = (0.5 + np.array(shares)) * np.maximum(extents, 0.2 * extents.max())
    if extents[1] < extents[0]:
        half[1] = max(half[1], 0.85 * extents[1])
    middle = 0.5 * (low + high)
    # Not limits but data: equal scales widen one of the two to fill the panel.
    axes.update_datalim([middle - half, middle + half])
    axes.margins(0.0)
    axes.autoscale_view()
    for label in labels:
        label.set_in_layout(False)  # the limits leave room: the axes need not shrink for them


def wrapped(name):
    """Return a name in lines short enough for the space next to the tube, broken at underscores."""
    lines = [""]
    for part in re.split(r"(?<=[_. -])", name):
        for piece in textwrap.wrap(part, LINE, drop_whitespace=False) or [""]:
            if len(lines[-1]) + len(piece) > LINE:
                lines.append("")
            lines[-1] += piece
    return "\n".join(lines)


def held_ends(structure):
    """Return the indices, of 0 and -1, of the ends of a tube that are held."""
    if structure.kind == "path":
        ends = {0: structure.start, -1: structure.end}
        return [index for index, end in ends.items() if end.kind != "free"]
    return [0, -1]


def _draw_plate(axes, structure, points, view, name, fontsize):
    """Draw a support as a plate through which the tube passes; return the label of its name."""
    tangent = _tangent(structure, points.mean(axis=0), name, view)
    across = np.array([-tangent[1], tangent[0]])
    reach = 0.055 * np.ptp(structure.nodes, axis=0).max()
    half = max(0.5 * np.ptp(view.seen(points) @ tangent), 0.004)
    middle = view.seen(points.mean(axis=0))
    corners = [
        middle + s * reach * across + t * half * tangent
        for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    look = {"facecolor": GREY, "alpha": 0.55, "edgecolor": BLACK, "linewidth": 0.6}
    axes.add_patch(Polygon(corners, **look, zorder=0))
    centre = view.seen(structure.nodes).mean(axis=0)
    side = np.sign((middle - centre) @ across) or 1.0
    offset, alignment = _beside(side * across)
    line = {"arrowstyle": "-", "color": GREY, "linewidth": 0.5, "shrinkA": 1.0, "shrinkB": 0.0}
    return axes.annotate(
        wrapped(name),
        middle + side * reach * across,
        xytext=5 * offset,
        textcoords="offset points",
        fontsize=fontsize,
        arrowprops={**line, "relpos": RELATIVE[alignment["ha"]]},
        **alignment,
    )


def _tangent(structure, place, name, view):
    """Return the direction (2,) of the tube at a place (3,), as it is seen."""
    return view.seen(structure.centreline.direction(structure.centreline.locate(place, name)))


def _beside(direction):
    """Return (offset (2,), {ha, va}) of a text next to a point, on the side of direction (2,)."""
    right, up = np.sign(direction)
    if abs(direction[0]) > 0.4:
        return np.array([right, 0.0]), {"ha": "left" if right > 0.0 else "right", "va": "center"}
    return np.array([0.0, up]), {"ha": "center", "va": "bottom" if up > 0.0 else "top"}


def _draw_points(sheet, axes, config, structure, view):
    """Draw the named points with the directions of their sensors, and the drive; return the labels.

    Names at the same place share one label.
    """
    driven, sensors = getattr(config.excitation, "point", None), config.record.sensors
    labels = []
    dot = {"color": BLUE, "marker": "o", "markersize": 6, "linestyle": "none", "zorder": 6}
    for index, (place, names) in enumerate(_names_by_place(config, structure)):
        tags, label = {"names": " ".join(names)}, "named point" if index == 0 else None
        words = [wrapped(", ".join(name for name in names if name != driven))]
        if set(names) & set(sensors.points):
            words.append(f"sensors {', '.join(sensors.directions)}")
        if driven in names:
            words.append(f"drive\n{wrapped(driven)}")
        sheet.line(axes, *view.columns(place), "points", tags=tags, **dot, label=label)
        if driven in names:
            _direction(axes, view, place, np.array(config.excitation.direction))
        # out of a bend, or to the side of a straight tube
        tangent = _tangent(structure, place, names[0], view)
        outward = view.seen(place) - view.seen(structure.nodes.mean(axis=0))
        outward = outward - (outward @ tangent) * tangent
        if np.linalg.norm(outward) < 1e-6:
            outward = np.array([tangent[1], -tangent[0]])
        outward = outward / np.linalg.norm(outward)
        # above and below a bend there is more room inside
        offset, alignment = _beside(-outward if abs(outward[0]) <= 0.4 else outward)
        label = axes.annotate(
            "\n".join(filter(None, words)),
            view.seen(place),
            xytext=13 * offset,
            textcoords="offset points",
            fontsize=8.5,
            zorder=7,
            **alignment,
        )
        labels.append(label)
    return labels


def _names_by_place(config, structure):
    """Return [(place (3,) on the tube, its names)] of the named points."""
    found = []
    for name, position in config.points.items():
        place = structure.centreline.position(structure.centreline.locate(position, name))
        names = next((own for at, own in found if np.allclose(at, place, atol=1e-6)), None)
        if names is None:
            found.append((place, [name]))
        else:
            names.append(name)
    return found


def _direction(axes, view, place, direction):
    """Draw a force as an arrow; along the line of sight as a circle, with a dot if it points
    towards the reader and a cross if away.
    """
    spot, direction = view.seen(place), direction / np.linalg.norm(direction)
    inside = view.seen(direction)
    if np.linalg.norm(inside) > 0.5:
        arrow = {"arrowstyle": "-|>", "color": GREEN, "linewidth": 2}
        axes.annotate("", spot + 0.12 * inside, spot, arrowprops=arrow, zorder=8)
        return
    circle = {"marker": "o", "markersize": 12, "markerfacecolor": "none", "markeredgewidth": 2}
    circle |= {"markeredgecolor": GREEN, "linestyle": "none", "zorder": 8}
    axes.plot(*spot, **circle, label="drive, out of plane")
    towards = direction[view.depth] * view.towards > 0.0
    axes.plot(*spot, marker="." if towards else "x", markersize=5, color=GREEN, zorder=9)


def free_modes(structure, highest_Hz, count=SHOWN_MODES):
    """Return (frequency (mode,) Hz, shapes (mode, node, 3)) of the lowest modes without contact.

    The largest displacement of a shape is 1. Fewer than `count` modes are returned if fewer lie
    below highest_Hz.
    """
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    found = []
    for group in groups:
        omega, vectors = eigenmodes(group.stiffness, group.mass, highest_Hz)
        for index in range(min(count, len(omega))):
            dofs = np.zeros(structure.dofs)
            dofs[group.dofs] = vectors[:, index]
            moved = (structure.transformation @ dofs).reshape(-1, DOF_PER_NODE)
            motion, largest = moved[:, :3], np.abs(moved[:, :3]).max()
            # A straight tube that twists does not move: there is nothing to draw.
            if largest > STILL * structure.centreline.length * np.abs(moved[:, 3:]).max():
                motion = motion / motion.ravel()[np.argmax(np.abs(motion))]
                found.append((omega[index] / (2.0 * np.pi), motion))
    found = sorted(found, key=lambda mode: mode[0])[:count]
    return np.array([mode[0] for mode in found]), np.array([mode[1] for mode in found])


def figure_02_free_modes(config, structure):
    """Return the Sheet of the first free mode shapes, drawn on the tube seen obliquely."""
    caption = (
        "Mode shapes of the tube without contact, lowest first, with their frequencies. Grey: the"
        " tube at rest; colour: displaced in the mode, largest displacement drawn as"
        f" {SHAPE_SIZE:g} of the tube's extent. The tube is seen obliquely: motion away from the"
        " reader appears towards the upper right."
    )
    frequency, shapes = free_modes(structure, config.basis.free_modes_to_Hz)
    sheet = Sheet(
        "figure_02_free_modes",
        "The tube without contact: its first modes",
        caption,
        [[f"mode {order}" for order in row] for row in ((1, 2, 3), (4, 5, 6))],
        size=(7.6, 6.2),
        sharex=True,
        sharey=True,
    )
    nodes = structure.nodes
    view = View.of(nodes)
    squares = {"linestyle": "none", "marker": "s", "color": BLACK, "markersize": 5}
    cross = {"marker": "P", "color": RED, "markersize": 6, "linestyle": "none"}
    for order, (axes, value, shape) in enumerate(
        zip(sheet.axes.values(), frequency, shapes, strict=False), start=1
    ):
        across = np.sum(shape[:, view.depth] ** 2) > 0.5 * np.sum(shape**2)
        axes.set_title(f"{order} {'out of plane' if across else 'in plane'}, {value:.2f} Hz")
        look = {"color": BLUE if across else ORANGE, "linewidth": 2.2}
        displaced = nodes + SHAPE_SIZE * np.ptp(nodes, axis=0).max() * shape
        for index in np.linspace(0, len(nodes) - 1, 41).astype(int):
            pair = np.array([nodes[index], displaced[index]])
            axes.plot(*view.obliquely(pair).T, color=PALE, linewidth=0.8, zorder=1)
        tags = {"frequency_Hz": value, **{f"shape_{x}": shape[:, i] for i, x in enumerate("xyz")}}
        _tube_obliquely(sheet, axes, view, nodes, "at rest", {}, color=GREY, linewidth=1.0)
        _tube_obliquely(sheet, axes, view, displaced, "mode", tags, **look)
        axes.plot(*view.obliquely(nodes[held_ends(config.structure)]).T, **squares)
        for support in np.unique(structure.contact.support):
            middle = structure.contact.position[structure.contact.support == support].mean(axis=0)
            axes.plot(*view.obliquely(middle), **cross)
        axes.set_aspect("equal")
        axes.margins(0.1)
        axes.label_outer()
    for axes in list(sheet.axes.values())[len(frequency) :]:
        axes.set_visible(False)
    return sheet


def _tube_obliquely(sheet, axes, view, nodes, curve, tags, **style):
    """Draw the tube as a line through nodes (node, 3)."""
    across, up = view.obliquely(nodes).T
    sheet.line(axes, ("horizontal_m", across), ("vertical_m", up), curve, tags=tags, **style)
