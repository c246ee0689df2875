"""The tube: layout with supports, points and sensors (figure 1), and free modes (figure 2)."""

from __future__ import annotations

import numpy as np
from matplotlib.patches import Circle, Polygon, Rectangle

from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PALE,
    RED,
    gap_label,
    number,
    shown,
)
from vibroimpact.geometry.sections import outer_width, section_kind
from vibroimpact.reduction.ritz_basis import eigenmodes, uncoupled_groups
from vibroimpact.structure.beam_elements import DOF_PER_NODE

GAP_EXAGGERATION = 10.0  # a gap to scale would be thinner than the lines
SHOWN_MODES = 6
SHAPE_SIZE = 0.22  # largest drawn displacement, as a fraction of the tube's largest extent
OBLIQUE = (0.75, 0.45)  # how a unit out of plane is seen: right and up


def view_axes(positions):
    """Return the indices (horizontal, vertical, depth) of the global axes for a front view.

    positions (point, 3): m; the view is on the plane of their largest extents.
    """
    extent = np.ptp(positions, axis=0)
    depth = int(np.argmin(extent))
    horizontal, vertical = (axis for axis in range(3) if axis != depth)
    return horizontal, vertical, depth


def figure_01_layout(config, structure):
    """Return the Sheet of the layout: front view, and a support from the side and from above."""
    section = config.structure.section
    gap = max(config.grid.gap_m)
    caption = (
        f"Layout of the tube ({_section_in_words(section)}). Left: front view to scale with its"
        " supports"
        " (grey plates), the contact points on the centreline, the named points, the sensors and"
        " the drive; arrows are directions in the plane, a circle with a dot is the direction out"
        " of the plane, towards the reader. Right: a support from the side and in section; the"
        f" tube can move by the gap, {gap_label(gap, outer_width(section))} here, before it"
        f" touches; the gap is drawn {GAP_EXAGGERATION:g} times too large. The tube is the one of"
        " the configuration, not the drawing of a rig."
    )
    sheet = Sheet(
        "figure_01_layout",
        "The tube, its supports, sensors and drive",
        caption,
        [["front", "side"], ["front", "section"]],
        size=(7.6, 5.2),
        width_ratios=(1.45, 1.0),
    )
    _front_view(sheet, sheet.axes["front"], config, structure)
    _support_side(sheet, sheet.axes["side"], config, structure, gap)
    _support_section(sheet, sheet.axes["section"], config, gap)
    return [sheet]


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
    view = view_axes(line)
    columns = ["xyz"[axis] + "_m" for axis in view[:2]]
    axes.set_title(f"front view, to scale ({'xyz'[view[2]]} towards the reader)")
    sheet.line(
        axes,
        (columns[0], line[:, view[0]]),
        (columns[1], line[:, view[1]]),
        "centreline",
        color=PALE,
        linewidth=5,
        solid_capstyle="butt",
        zorder=1,
        label="tube",
    )
    axes.plot(
        line[:, view[0]], line[:, view[1]], color=GREY, linewidth=0.8, dashes=(8, 2, 1, 2), zorder=2
    )
    for index, support in enumerate(config.supports):
        points = structure.contact.position[structure.contact.support == index]
        _draw_plate(axes, structure, points, view, support.name)
        sheet.line(
            axes,
            (columns[0], points[:, view[0]]),
            (columns[1], points[:, view[1]]),
            f"contact points of {support.name}",
            color=RED,
            linestyle="none",
            marker=".",
            markersize=3.5,
            zorder=4,
            label="contact points" if index == 0 else None,
        )
    for end in (0, -1):
        axes.plot(
            *line[end, view[:2]],
            marker="s",
            color=BLACK,
            markersize=8,
            zorder=5,
            linestyle="none",
            label="root" if end == 0 else None,
        )
    sheet.record(
        axes,
        "roots",
        **{column: line[[0, -1], axis] for column, axis in zip(columns, view[:2], strict=True)},
    )
    _draw_points(sheet, axes, config, structure, view, columns)
    axes.set_aspect("equal")
    tall = np.ptp(line[:, view[1]]) >= np.ptp(line[:, view[0]])
    axes.margins(
        *((0.34, 0.08) if tall else (0.15, 0.35))
    )  # room for the names beside, or above and below
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower left", ncols=5)


def _draw_plate(axes, structure, points, view, name):
    """Draw a support as a plate through which the tube passes, and its name."""
    middle = points.mean(axis=0)
    tangent = structure.centreline.direction(structure.centreline.locate(middle, name))[
        list(view[:2])
    ]
    across = np.array([-tangent[1], tangent[0]])
    reach = 0.055 * np.ptp(structure.nodes, axis=0).max()
    half = max(0.5 * np.ptp(points @ np.eye(3)[:, list(view[:2])] @ tangent), 0.004)
    middle = middle[list(view[:2])]
    corners = [
        middle + s * reach * across + t * half * tangent
        for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    axes.add_patch(
        Polygon(corners, facecolor=GREY, alpha=0.55, edgecolor=BLACK, linewidth=0.6, zorder=0)
    )
    centre = structure.nodes[:, list(view[:2])].mean(axis=0)
    side = np.sign((middle - centre) @ across) or 1.0
    offset, alignment = _beside(side * across)
    axes.annotate(
        f"support\n{name}",
        middle + side * reach * across,
        xytext=5 * offset,
        textcoords="offset points",
        fontsize=8.5,
        **alignment,
    )


def _beside(direction):
    """Return (offset (2,), {ha, va}) of a text next to a point, on the side of direction (2,)."""
    if abs(direction[0]) > 0.4:
        return np.array([np.sign(direction[0]), 0.0]), {
            "ha": "left" if direction[0] > 0.0 else "right",
            "va": "center",
        }
    return np.array([0.0, np.sign(direction[1])]), {
        "ha": "center",
        "va": "bottom" if direction[1] > 0.0 else "top",
    }


def _draw_points(sheet, axes, config, structure, view, columns):
    """Draw the named points with the directions of their sensors, and the drive.

    Names at the same place share one label.
    """
    places = {}
    for name, position in config.points.items():
        place = structure.centreline.position(structure.centreline.locate(position, name))
        key = next(
            (other for other in places if np.allclose(other, place, atol=1e-6)), tuple(place)
        )
        places.setdefault(key, []).append(name)
    centre = structure.nodes.mean(axis=0)
    for index, (place, names) in enumerate(places.items()):
        spot = np.array(place)[list(view[:2])]
        sheet.line(
            axes,
            (columns[0], spot[:1]),
            (columns[1], spot[1:]),
            "points",
            tags={"names": " ".join(names)},
            color=BLUE,
            marker="o",
            markersize=6,
            linestyle="none",
            zorder=6,
            label="named point" if index == 0 else None,
        )
        tangent = structure.centreline.direction(structure.centreline.locate(place, names[0]))[
            list(view[:2])
        ]
        outward = spot - centre[list(view[:2])]
        outward = outward - (outward @ tangent) * tangent
        outward = outward / (np.linalg.norm(outward) or 1.0)
        lines = [", ".join(names)]
        if set(names) & set(config.record.sensors.points):
            lines.append(f"sensors {', '.join(config.record.sensors.directions)}")
        if config.excitation.point in names:
            lines[0] = (
                ", ".join(name for name in names if name != config.excitation.point) or "drive"
            )
            lines.append(f"drive '{config.excitation.point}'")
            _direction(axes, spot, np.array(config.excitation.direction), view)
        offset, alignment = _beside(
            -outward if abs(outward[0]) <= 0.4 else outward
        )  # above and below a bend there is more room inside
        axes.annotate(
            "\n".join(lines),
            spot,
            xytext=13 * offset,
            textcoords="offset points",
            fontsize=8.5,
            zorder=7,
            **alignment,
        )


def _direction(axes, spot, direction, view):
    """Draw a force as an arrow; as a circle with a dot or cross along the line of sight.

    The dot points towards the reader.
    """
    direction = direction / np.linalg.norm(direction)
    inside = direction[list(view[:2])]
    if np.linalg.norm(inside) > 0.5:
        axes.annotate(
            "",
            spot + 0.12 * inside,
            spot,
            arrowprops={"arrowstyle": "-|>", "color": GREEN, "linewidth": 2},
            zorder=8,
        )
        return
    axes.plot(
        *spot,
        marker="o",
        markersize=12,
        markerfacecolor="none",
        markeredgecolor=GREEN,
        markeredgewidth=2,
        zorder=8,
        linestyle="none",
        label="drive, out of plane",
    )
    axes.plot(*spot, marker=".", markersize=4, color=GREEN, zorder=9)


def _support_side(sheet, axes, config, structure, gap):
    """Draw the first support from the side: the tube in the hole, and its contact points."""
    radius = 0.5 * outer_width(config.structure.section)
    support = config.supports[0] if config.supports else None
    axes.set_title(f"a support from the side (gap × {GAP_EXAGGERATION:g})")
    half = 0.5 * support.height_m if support else radius
    wall = radius + GAP_EXAGGERATION * gap
    for side in (-1, 1):
        axes.add_patch(
            Rectangle(
                (min(side * wall, side * 2.0 * wall) * 1e3, -half * 1e3),
                wall * 1e3,
                2 * half * 1e3,
                facecolor=GREY,
                alpha=0.55,
                edgecolor=BLACK,
                linewidth=0.6,
            )
        )
        sheet.line(
            axes,
            ("across_m", [side * radius] * 2),
            ("along_m", [-2 * half, 2 * half]),
            "edge of the tube",
            color=BLACK,
            linewidth=1.2,
        )
    axes.add_patch(
        Rectangle(
            (-radius * 1e3, -2 * half * 1e3),
            2 * radius * 1e3,
            4 * half * 1e3,
            facecolor=PALE,
            alpha=0.6,
            edgecolor="none",
            zorder=0,
        )
    )
    axes.axvline(0.0, color=GREY, linewidth=0.8, dashes=(8, 2, 1, 2))
    if support:
        places = structure.contact.arc_length[structure.contact.support == 0]
        along = places - places.mean()
        sheet.line(
            axes,
            ("across_m", np.zeros(along.size)),
            ("along_m", along),
            "contact points",
            color=RED,
            linestyle="none",
            marker="o",
            zorder=5,
        )
        axes.text(
            0,
            shown("along_m", 2.05 * half),
            f"{support.points} contact points, {number(np.sum(support.stiffness_N_per_m))} N/m"
            " in all",
            ha="center",
            va="bottom",
            fontsize=8.5,
        )
    axes.set_xlim(-2.2e3 * wall, 2.2e3 * wall)
    axes.set_ylim(-1.8e3 * half, 2.4e3 * half)


def _support_section(sheet, axes, config, gap):
    """Draw the tube in its circular obstacle."""
    section = config.structure.section
    radius = 0.5 * outer_width(section)
    inner = radius - section.wall_thickness_m if section_kind(section) == "tube" else 0.0
    turn = np.linspace(0.0, 2.0 * np.pi, 121)
    wall = radius + GAP_EXAGGERATION * gap
    axes.set_title(f"in section (gap × {GAP_EXAGGERATION:g})")
    axes.add_patch(
        Rectangle(
            (-1.5e3 * wall, -1.35e3 * wall),
            3e3 * wall,
            2.7e3 * wall,
            facecolor=GREY,
            alpha=0.55,
            edgecolor="none",
        )
    )
    axes.add_patch(Circle((0, 0), wall * 1e3, facecolor="white", edgecolor="none"))
    axes.add_patch(Circle((0, 0), radius * 1e3, facecolor=PALE, edgecolor="none"))
    axes.add_patch(Circle((0, 0), inner * 1e3, facecolor="white", edgecolor="none"))
    curves = [("obstacle", wall, RED), ("tube, outside", radius, BLACK)]
    if inner > 0.0:
        curves.append(("tube, inside", inner, BLACK))
    for curve, size, colour in curves:
        sheet.line(
            axes,
            ("section_e1_m", size * np.cos(turn)),
            ("section_e2_m", size * np.sin(turn)),
            curve,
            color=colour,
            linewidth=1.2,
        )
    for start, end in ((wall * 1.3, wall), (radius * 0.75, radius)):
        axes.annotate(
            "",
            (end * 1e3, 0),
            (start * 1e3, 0),
            arrowprops={"arrowstyle": "->", "color": ORANGE, "linewidth": 1.6},
        )
    axes.text(
        0,
        0,
        f"gap\n{gap * 1e3:.3g} mm\n({gap / outer_width(section) * 100:.3g} % of D)",
        ha="center",
        va="center",
        fontsize=7.5,
    )
    axes.set_aspect("equal")
    axes.set_xlim(-1.5e3 * wall, 1.5e3 * wall)
    axes.set_ylim(-1.35e3 * wall, 1.35e3 * wall)


def free_modes(structure, highest_Hz, count=SHOWN_MODES):
    """Return (frequency (mode,) Hz, shapes (mode, node, 3)) of the lowest modes without contact.

    The largest displacement of a shape is 1. Fewer than `count` modes are returned where fewer lie
    below highest_Hz.
    """
    groups = uncoupled_groups(structure.mass, structure.stiffness, structure.contact_rows())
    found = []
    for group in groups:
        omega, vectors = eigenmodes(group.stiffness, group.mass, highest_Hz)
        for index in range(min(count, len(omega))):
            dofs = np.zeros(structure.dofs)
            dofs[group.dofs] = vectors[:, index]
            motion = (structure.transformation @ dofs).reshape(-1, DOF_PER_NODE)[:, :3]
            found.append(
                (omega[index] / (2.0 * np.pi), motion / motion.ravel()[np.argmax(np.abs(motion))])
            )
    found = sorted(found, key=lambda mode: mode[0])[:count]
    return np.array([mode[0] for mode in found]), np.array([mode[1] for mode in found])


def figure_02_free_modes(config, structure):
    """Return the Sheet of the first free mode shapes, drawn on the tube seen obliquely."""
    caption = (
        "Mode shapes of the tube without contact, lowest first, with their frequencies. Grey: the"
        " tube at rest; colour: displaced in the mode, largest displacement drawn as"
        f" {SHAPE_SIZE:g} of the tube's extent. The tube is seen obliquely: out-of-plane motion"
        " appears towards the upper right."
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
    view = view_axes(nodes)
    scale = SHAPE_SIZE * np.ptp(nodes, axis=0).max()
    for order, (axes, value, shape) in enumerate(
        zip(sheet.axes.values(), frequency, shapes, strict=False), start=1
    ):
        across = np.sum(shape[:, view[2]] ** 2) > 0.5 * np.sum(shape**2)
        axes.set_title(f"{order} {'out of plane' if across else 'in plane'}, {value:.2f} Hz")
        ribs = np.linspace(0, len(nodes) - 1, 41).astype(int)
        for index in ribs:
            pair = np.array([nodes[index], nodes[index] + scale * shape[index]])
            axes.plot(
                *(pair[:, view[:2]] + pair[:, [view[2]]] * OBLIQUE).T,
                color=PALE,
                linewidth=0.8,
                zorder=1,
            )
        for curve, points, style in (
            ("at rest", nodes, {"color": GREY, "linewidth": 1.0}),
            (
                "mode",
                nodes + scale * shape,
                {"color": BLUE if across else ORANGE, "linewidth": 2.2},
            ),
        ):
            seen = points[:, view[:2]] + points[:, [view[2]]] * OBLIQUE
            tags = (
                {
                    "frequency_Hz": value,
                    "shape_x": shape[:, 0],
                    "shape_y": shape[:, 1],
                    "shape_z": shape[:, 2],
                }
                if curve == "mode"
                else {}
            )
            sheet.line(
                axes,
                ("horizontal_m", seen[:, 0]),
                ("vertical_m", seen[:, 1]),
                curve,
                tags=tags,
                **style,
            )
        axes.plot(
            *(nodes[[0, -1]][:, view[:2]] + nodes[[0, -1]][:, [view[2]]] * OBLIQUE).T,
            linestyle="none",
            marker="s",
            color=BLACK,
            markersize=5,
        )
        _draw_supports_obliquely(axes, structure, view)
        axes.set_aspect("equal")
        axes.margins(0.1)
        axes.label_outer()
    return [sheet]


def _draw_supports_obliquely(axes, structure, view):
    """Draw the middle of each support as a small cross."""
    for support in np.unique(structure.contact.support):
        middle = structure.contact.position[structure.contact.support == support].mean(axis=0)
        axes.plot(
            *(middle[list(view[:2])] + middle[view[2]] * np.array(OBLIQUE)),
            marker="P",
            color=RED,
            markersize=6,
            linestyle="none",
        )
