"""Detection against the strength of the hidden effect."""

from __future__ import annotations

import numpy as np

from evidence.acceptance.detection_limit import (
    FEWEST,
    POWER,
    WEAKEST,
    detection_curve,
    detection_limit,
    probability,
    single_effects,
)
from evidence.acceptance.intervals import wilson
from vibroimpact.reports.figures.sheet import Sheet
from vibroimpact.reports.figures.style import BLACK, BLUE, GREEN, RED, label_of, number, shown

POINTS = 200
ROOM = 1.25  # factor beyond the weakest and the strongest campaign
BINS = 4  # bins with equal numbers of campaigns


def strength_figure(rows):
    """Return [Sheet] of the share of detected effects against strength, and of every campaign.

    The share is drawn with the fitted curve and the limit. rows: judged rows.
    """
    caption = (
        "Campaigns with one effect hidden that the catalogue holds. Above: share whose set of"
        f" explanations holds it; points: up to {BINS} groups of equally many campaigns at their"
        " median strength, with 95 % intervals (Wilson); line: logistic curve of all"
        " (Firth's regression on the logarithm of the strength); green: strength at which"
        f" {100 * POWER:.0f} % are found, the detection limit, and its 95 % interval. Below: each"
        " campaign, by what was hidden. Strength is the excess of the bare model's misfit over its"
        f" floor on the held-out records, in floors, the misfit between two seeds; below {WEAKEST}"
        f" it is drawn at {WEAKEST}."
    )
    rows = single_effects(rows)
    names = sorted({row["hidden"] for row in rows})
    below = 0.24 * max(len(names), 3)
    sheet = Sheet(
        "acceptance_strength",
        "How strong must an effect be to be found?",
        caption,
        [["curve"], ["effects"]],
        size=(8.0, 3.6 + below),
        height_ratios=[2.2, below],
        sharex=True,
    )
    if not rows:
        sheet.note(
            sheet.axes["curve"],
            "no campaign with one effect hidden",
            "strength_over_floor",
            "found",
        )
        sheet.axes["curve"].set(xticks=[], yticks=[])
        sheet.axes["effects"].set_axis_off()
        return [sheet]
    strength = np.maximum([row["strength"] for row in rows], WEAKEST)
    found = np.array([row["in_set"] for row in rows], bool)
    sheet.axes["effects"].set(xscale="log", xlim=(strength.min() / ROOM, strength.max() * ROOM))
    _curve(sheet, sheet.axes["curve"], strength, found)
    _effects(sheet, sheet.axes["effects"], names, rows, strength, found)
    handles, labels = (
        sum(parts, [])
        for parts in zip(
            *(axes.get_legend_handles_labels() for axes in sheet.axes.values()), strict=True
        )
    )
    sheet.figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return [sheet]


def _curve(sheet, axes, strength, found):
    """Draw the shares found, the curve, and the limit or why there is none."""
    order = np.array_split(
        np.argsort(strength, kind="stable"), min(BINS, max(1, found.size // FEWEST))
    )
    bounds = np.array([wilson(found[group].sum(), group.size) for group in order])
    sheet.line(
        axes,
        ("strength_over_floor", [np.median(strength[group]) for group in order]),
        ("found", [found[group].mean() for group in order]),
        "groups",
        bounds[:, 0],
        bounds[:, 1],
        {"campaigns": [group.size for group in order]},
        band=False,
        fmt="o",
        color=BLACK,
        label="campaigns in groups",
    )
    limit = detection_limit(strength, found)
    if found.size >= FEWEST and 0 < found.sum() < found.size:
        grid = np.geomspace(strength.min(), strength.max(), POINTS)
        sheet.line(
            axes,
            ("strength_over_floor", grid),
            ("found", probability(detection_curve(strength, found), grid)),
            "logistic curve",
            color=BLUE,
            label="logistic curve",
        )
    axes.axhline(shown("found", POWER), color=GREEN, linewidth=0.8, linestyle=":")
    if np.isfinite(limit["limit"]):
        sheet.record(axes, "limit", strength_over_floor=limit["limit"])
        label = "detection limit, its 95 % interval"
        axes.axvline(float(shown("strength_over_floor", limit["limit"])), color=GREEN, label=label)
        low, high = (
            np.nan_to_num(limit[key], nan=at)
            for key, at in (("low", strength.min()), ("high", strength.max()))
        )
        axes.axvspan(low, high, color=GREEN, alpha=0.12, linewidth=0)
    axes.set_title(
        limit["note"]
        or f"{found.sum()} of {found.size} found; {100 * POWER:.0f} % at {_limit_words(limit)}"
    )
    axes.set_ylim(-4.0, 104.0)
    axes.set_xlabel("")


def _limit_words(limit):
    """Return a limit in words with its interval, as far as that is bounded."""
    bounds = [
        f"{word} {number(limit[key])}"
        for word, key in (("from", "low"), ("to", "high"))
        if np.isfinite(limit[key])
    ]
    return f"{number(limit['limit'])} floors (95 %: {' '.join(bounds) or 'not bounded'})"


def _effects(sheet, axes, names, rows, strength, found):
    """Draw each campaign as a mark in the line of its effect."""
    places = np.array([names.index(row["hidden"]) for row in rows])
    for words, chosen, style in (
        ("in the set", found, {"marker": "o", "color": BLUE}),
        ("not in the set", ~found, {"marker": "x", "color": RED}),
    ):
        if chosen.any():
            hidden, numbers = (
                np.array([row[key] for row in rows])[chosen] for key in ("hidden", "campaign")
            )
            gid = sheet.record(
                axes,
                words,
                campaign=numbers,
                hidden=hidden,
                strength_over_floor=strength[chosen],
                found=found[chosen],
            )
            axes.plot(
                strength[chosen],
                places[chosen],
                linestyle="",
                markersize=6,
                label=words,
                gid=gid,
                alpha=0.8,
                **style,
            )
    axes.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlabel(label_of("strength_over_floor"))
