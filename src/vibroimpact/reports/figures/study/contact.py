"""The contact law and its discretisation (figure 3), and the number of points (figure 4)."""

import numpy as np

from vibroimpact.config.stage_settings import StageSettings
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.reports.figures.plot import (
    Axis,
    Item,
    Mark,
    Panel,
    Plot,
    Series,
    Span,
    Text,
    extent,
)
from vibroimpact.reports.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    SKY,
    gap_label,
    number,
)
from vibroimpact.structure.contact.outline import (
    facing_angle,
    radial_gap,
    static_force,
    support_gap,
)
from vibroimpact.structure.contact.profiles import with_plain_profiles

from .linear_limits import HELD, driven_frequencies

POINTS = {1: PINK, 2: ORANGE, 3: GREEN, 5: BLUE, 9: BLACK}  # contact points per support -> colour
LINES = {1: ":", 2: "--", 3: "-.", 5: "-", 9: "--"}
# Kind of a profile -> the direction of the displacement in figure 3.
WAYS = {
    "circular": "in any radial direction",
    "planes": "along the normal of the first stop",
    "lobes": "along the direction of the first land",
}
STIFFNESS = np.logspace(0.0, 11.0, 89)  # N/m per support
# A range belongs to a limit if the frequency is within this share of the distance to the next.
NEAR = 0.05


def figure_03_contact_law(config, structure):
    """Return the Plot of the discretised layer of stiffness and of the force law.

    The law is drawn with its tangent and secant stiffness.
    """
    support = with_plain_profiles(config, structure.contact).supports[0]
    gap = support_gap(support, max(config.grid.gap_m))
    stiffness = float(np.sum(structure.contact.stiffness[structure.contact.support == 0]))
    caption = (
        f"Contact law of support '{support.name}'. Left: the layer of stiffness over the height of"
        f" the support (total {stiffness:.3g} N/m) and the contact points that stand for it; each"
        " point carries the stiffness written next to it. Right: contact force against displacement"
        f" of the tube {WAYS[support.profile.kind]}, all points together, gap"
        f" {gap_label(config, gap)}. The slope past the gap is"
        " the tangent stiffness; force over displacement is the secant stiffness, which rises with"
        " the amplitude: this is why an equivalent linear support stiffens with the load."
    )
    panels = {"layer": _layer(support, structure), "law": _law(support, gap)}
    title = "Contact: a discretised elastic layer behind a gap"
    size = (7.6, 3.7)
    return Plot("figure_03_contact_law", title, caption, panels, size=size, widths=(1, 1.35))


def _layer(support, structure):
    """Return the Panel of the stiffness over the height and the points that discretise it."""
    members = structure.contact.support == 0
    places, values = structure.contact.arc_length[members], structure.contact.stiffness[members]
    height = places - places.mean()
    half = 0.5 * support.height_m
    density = values.sum() / support.height_m
    share = values / (support.height_m / len(values))
    layer = np.array([0.0, density, density, 0.0]), np.array([-half, -half, half, half])
    tags = {"contact_stiffness_N_per_m": values}
    look = {"colour": RED, "marker": "o", "line": "", "label": "contact points"}
    items: list[Item] = [
        Series("layer", *layer, label="elastic layer", colour=GREY, width=1.0),
        Series("contact points", share, height, tags, **look),
    ]
    for place, size, value in zip(height, share, values, strict=True):
        items.append(Series("", [0.0, size], [place, place], colour=RED, width=1.2))
        words, align = f"{number(value)} N/m", ("center", "bottom")
        items.append(Text(words, 0.4, place, "x", (0, 2), align))
    axes = (
        Axis("stiffness_density_N_per_m2", False, 0.0, 1.25 * max(share.max(), density)),
        Axis("height_in_support_m", False, -1.5 * half, 1.75 * half),
    )
    legend = {"legend": "upper right", "legend_columns": 2}
    return Panel(*axes, items, "stiffness over the height", **legend)


def _law(support, gap):
    """Return the Panel of the force along the first stop or land, with secants to two points."""
    angle = facing_angle(support.profile)
    ahead, behind = radial_gap(support.profile, gap, np.array([angle, angle + np.pi]))
    reach = 1.6 * max(abs(side) for side in (ahead, behind) if np.isfinite(side)) or 1e-5
    displacement = np.linspace(-reach, reach, 321)
    force = static_force(support, gap, angle, displacement)
    secant = np.divide(force, displacement, out=np.zeros_like(force), where=displacement != 0.0)
    tags = {
        "tangent_stiffness_N_per_m": np.gradient(force, displacement),
        "secant_stiffness_N_per_m": secant,
    }
    label = "contact force"
    if support.hertz_N_per_m15 == 0.0:
        label += f"; tangent {number(np.sum(support.stiffness_N_per_m))} N/m past the gap"
    look = {"colour": BLUE, "width": 2.2, "label": label}
    items: list[Item] = [Series("contact force", displacement, force, tags, **look)]
    for far, colour, line in ((1.2, ORANGE, "--"), (1.5, RED, ":")) if ahead > 0.0 else ():
        (top,) = static_force(support, gap, angle, np.array([far * ahead]))
        label = f"secant at {far:g} gap: {number(top / (far * ahead))} N/m"
        look = {"colour": colour, "line": line, "marker": "o", "label": label}
        items.append(Series(f"secant at {far:g} gap", [0.0, far * ahead], [0.0, top], **look))
    for side in {side for side in (-behind, ahead) if np.isfinite(side)}:
        items.append(Mark("gap", "x", side, colour=GREY, width=0.9, line=":"))
        if side == ahead:
            items.append(Text("gap", side, 0.02, "y", shift=(3, 0), colour=GREY))
    span = np.ptp(force)
    axes = (
        Axis("radial_displacement_m"),
        Axis("contact_force_N", False, force.min() - 0.08 * span, force.max() + 0.5 * span),
    )
    return Panel(*axes, items, "force, tangent and secant stiffness", legend="upper left")


def model_with_points(config, points):
    """Return the ModalModel of a configuration with `points` equal contact points per support."""
    plain = {"points": points, "gap_factor": 1.0, "centre_offset_m": (0.0, 0.0)}
    supports = tuple(
        {**support, **plain, "stiffness_N_per_m": float(np.sum(support.stiffness_N_per_m))}
        for support in config.supports
    )
    return build_model(StageSettings({**config, "supports": supports}))


def figure_04_first_frequency(config):
    """Return the Plot of first frequency against bilateral stiffness, by number of points."""
    caption = (
        "First frequency of the driven plane against a bilateral stiffness k per support, shared"
        " by 1, 2, 3, 5 or 9 contact points over its height. Dotted: the frequencies of the free"
        " tube, of the tube pinned at the middle of each support and of the tube held over its"
        f" whole height. Shaded: the stiffness ranges with 9 points within {NEAR:.0%} of the"
        " step to the neighbouring limit. One point can pin the tube but never clamp it; five"
        " follow the layer over the whole range."
    )
    models = {points: model_with_points(config, points) for points in POINTS}
    finest = max(POINTS)
    frequency = {
        points: driven_frequencies(model, STIFFNESS)[:, 0] for points, model in models.items()
    }
    limits = {
        "free": driven_frequencies(models[1], 0.0)[0, 0],
        "pinned in the middle": driven_frequencies(models[1], HELD)[0, 0],
        "clamped over the height": driven_frequencies(models[finest], HELD)[0, 0],
    }
    items = _shaded_ranges(frequency[finest], *limits.values())
    for points, values in frequency.items():
        look = {"colour": POINTS[points], "line": LINES[points], "width": 1.4 + 0.8 * (points == 5)}
        look["label"] = f"{points} point{'s' * (points > 1)}"
        tags = {"contact_points": points}
        items.append(Series(f"{points} points", STIFFNESS, values, tags, **look))
    for name, value in limits.items():
        items.append(Mark(name, "y", value, colour=GREY, line=":", width=1.0))
        items.append(Text(f"{name}: {value:.2f} Hz", STIFFNESS[0], value, shift=(3, 2), size=8.5))
    for total in sorted({float(np.sum(each.stiffness_N_per_m)) for each in config.supports}):
        first = driven_frequencies(models[finest], total)[0, 0]
        look = {"label": f"full contact in the study, {number(total)} N/m: {first:.2f} Hz"}
        look |= {"colour": RED, "width": 1.0, "line": "--"}
        items.append(Mark("contact stiffness of the study", "x", total, **look))
    panel = Panel(
        Axis("support_stiffness_N_per_m", True, STIFFNESS[0], STIFFNESS[-1]),
        Axis("first_frequency_Hz", False, *extent([*frequency.values()], margin=0.08)),
        items,
        "first frequency of the driven plane, by number of contact points per support",
    )
    title, size = "First frequency against support stiffness", (7.6, 4.7)
    return Plot("figure_04_first_frequency", title, caption, {"main": panel}, size=size, legend=4)


def _shaded_ranges(frequency, free, pinned, clamped) -> list[Item]:
    """Return the stiffness ranges that belong to a limit, shaded, with their names."""
    steps = pinned - free, clamped - pinned
    ranges = {
        "free": frequency < free + NEAR * steps[0],
        "pinned": (frequency > pinned - NEAR * steps[0]) & (frequency < pinned + NEAR * steps[1]),
        "clamped": frequency > clamped - NEAR * steps[1],
    }
    items: list[Item] = []
    for name, inside in ranges.items():
        places = STIFFNESS[inside]
        if places.size == 0:
            continue
        items.append(Span("x", places[0], places[-1], SKY, 0.18))
        at_end = places[-1] == STIFFNESS[-1]
        x = places[-1] if at_end else np.sqrt(places[0] * places[-1])
        align = ("right" if at_end else "center", "bottom")
        items.append(Text(f"{name} range", x, 0.01, "y", align=align, size=8.5))
    return items
