"""A support from the side and in section, with the profile of its hole (figure 1)."""

from typing import Any

import numpy as np
from matplotlib.patches import Circle, Polygon, Rectangle

from vibroimpact.geometry.sections import outer_width, section_kind
from vibroimpact.reports.figures.style import BLACK, GREY, ORANGE, PALE, RED, number, shown
from vibroimpact.structure.contact.outline import (
    facing_angle,
    hole_outline,
    radial_gap,
    support_gap,
)

SCALES = (10.0, 5.0, 2.0, 1.0)  # a gap to scale would be thinner than the lines
WIDEST = 0.8  # largest drawn clearance, as a fraction of the tube's radius
SHOWN_HOLES = 4
LONGEST_TITLE = 24  # characters
EDGE = {"color": BLACK, "linewidth": 1.2}
PLATE = {"facecolor": GREY, "alpha": 0.55}


def distinct_holes(config: Any) -> list[tuple[list[str], Any]]:
    """Return [(names of supports, one of them)]: supports whose holes differ, in their order."""
    holes: dict[str, tuple[list[str], Any]] = {}
    for support in config.supports:
        keys = ("profile", "gap_m", "gap_factor", "centre_offset_m")
        text = repr([getattr(support, key) for key in keys])
        holes.setdefault(text, ([], support))[0].append(support.name)
    return list(holes.values())


def drawn_scale(config: Any, gap: float) -> float:
    """Return the factor by which gaps are drawn too large: 10, or less if that would hide the
    tube.
    """
    radius = 0.5 * outer_width(config.structure.section)
    widest = max(
        (
            abs(support_gap(support, gap)) + getattr(support.profile, "depth_m", 0.0)
            for support in config.supports
            if support.profile.kind != "lobes" or support.profile.depth_m
        ),
        default=gap,
    )
    return next((scale for scale in SCALES if scale * widest <= WIDEST * radius), SCALES[-1])


def titled(names: list[str]) -> str:
    """Return the names of supports as a title, cut if it would be too long."""
    text = ", ".join(names)
    if len(text) <= LONGEST_TITLE:
        return text
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return names[0][: LONGEST_TITLE - len(more)] + more


def support_side(sheet, axes, config, structure, gap, scale):
    """Draw the first support from the side: the tube in the hole, and its contact points.

    The section is along the direction of the first stop or land; a side without stop is open.
    """
    radius = 0.5 * outer_width(config.structure.section)
    support = config.supports[0] if config.supports else None
    axes.set_title(f"from the side (gap × {scale:g})")
    half = 0.5 * support.height_m if support else radius
    walls = {-1: np.inf, 1: np.inf}
    if support:
        angle = facing_angle(support.profile)
        ways = np.array([angle + np.pi, angle])
        clearance = radial_gap(support.profile, support_gap(support, gap), ways)
        walls = dict(zip((-1, 1), radius + scale * clearance, strict=True))
    closed = [wall for wall in walls.values() if np.isfinite(wall)] or [radius]
    reach = 2.2 * max(closed)
    for side, wall in walls.items():
        if np.isfinite(wall):
            left = min(side * wall, side * (reach / 1.1))
            corner, look = (left, -half), {"edgecolor": BLACK, "linewidth": 0.6}
            _box(axes, corner, reach / 1.1 - wall, 2 * half, **PLATE, **look)
            sheet.record(axes, "wall", across_m=side * wall)
        x, y = ("across_m", [side * radius] * 2), ("along_m", [-2 * half, 2 * half])
        sheet.line(axes, x, y, "edge of the tube", **EDGE)
    look = {"facecolor": PALE, "alpha": 0.6, "edgecolor": "none", "zorder": 0}
    _box(axes, (-radius, -2 * half), 2 * radius, 4 * half, **look)
    axes.axvline(0.0, color=GREY, linewidth=0.8, dashes=(8, 2, 1, 2))
    if support:
        places = structure.contact.arc_length[structure.contact.support == 0]
        x, y = ("across_m", np.zeros(places.size)), ("along_m", places - places.mean())
        dots = {"color": RED, "linestyle": "none", "marker": "o", "zorder": 5}
        sheet.line(axes, x, y, "contact points", **dots)
        points = f"{support.points} contact point{'s' * (support.points > 1)}"
        text = f"{points},\n{number(np.sum(support.stiffness_N_per_m))} N/m in all"
        place = {"ha": "center", "va": "bottom", "fontsize": 8.5}
        axes.text(0, shown("along_m", 2.05 * half), text, **place)
    axes.set_xlim(-1e3 * reach, 1e3 * reach)
    axes.set_ylim(-1.6e3 * half, 3.4e3 * half)


def _box(axes, corner, width, height, **look):
    """Draw a rectangle from its lower left corner, lengths in m, on axes in mm."""
    left, bottom = corner
    axes.add_patch(Rectangle((left * 1e3, bottom * 1e3), width * 1e3, height * 1e3, **look))


def support_section(sheet, axes, config, support, gap, scale):
    """Draw the tube in the hole of a support, with the profile of the hole.

    support: None for a tube without supports.
    """
    section = config.structure.section
    radius = 0.5 * outer_width(section)
    inside = radius - section.wall_thickness_m if section_kind(section) == "tube" else 0.0
    reach = 1.5 * radius
    if support:
        own = support_gap(support, gap)
        offset = np.reshape(support.centre_offset_m, (-1, 2)).mean(axis=0)
        angle = facing_angle(support.profile)
        depth = getattr(support.profile, "depth_m", 0.0)
        reach = 1.35 * (radius + scale * (max(own, 0.0) + depth + np.hypot(*offset)))
        hole = hole_outline(support.profile, own, radius, scale, 1.05 * reach) + scale * offset
        # a side without stop is open to the edge of the picture
        _box(axes, (-reach, -reach), 2 * reach, 2 * reach, **PLATE, edgecolor="none")
        axes.add_patch(Polygon(hole * 1e3, facecolor="white", edgecolor="none"))
        x, y = ("section_e1_m", hole[:, 0]), ("section_e2_m", hole[:, 1])
        sheet.line(axes, x, y, "obstacle", color=RED, linewidth=1.2)
        # two arrows that meet in the gap, in the direction of the first stop or land
        way, wall = np.array([np.cos(angle), np.sin(angle)]), radius + scale * own
        arrow = {"arrowstyle": "->", "linewidth": 1.6, "color": ORANGE}
        ends = (0.25 * radius + wall, wall, scale * offset), (0.75 * radius, radius, 0.0 * offset)
        for start, end, shift in ends:
            tip, tail = (end * way + shift) * 1e3, (start * way + shift) * 1e3
            axes.annotate("", tip, tail, arrowprops=arrow)
    turn = np.linspace(0.0, 2.0 * np.pi, 121)
    for size, colour in ((radius, PALE), (inside, "white")):
        axes.add_patch(Circle((0, 0), size * 1e3, facecolor=colour, edgecolor="none"))
    curves = [("tube, outside", radius), ("tube, inside", inside)]
    for curve, size in curves if inside > 0.0 else curves[:1]:
        x, y = ("section_e1_m", size * np.cos(turn)), ("section_e2_m", size * np.sin(turn))
        sheet.line(axes, x, y, curve, **EDGE)
    if support:
        text = f"gap\n{own * 1e3:.3g} mm"
        if len(distinct_holes(config)) == 1:
            text += f"\n({own / outer_width(section) * 100:.3g} % of D)"
        axes.text(0, 0, text, ha="center", va="center", fontsize=7.5)
    axes.set_aspect("equal")
    axes.set_xlim(-1e3 * reach, 1e3 * reach)
    axes.set_ylim(-1e3 * reach, 1e3 * reach)
