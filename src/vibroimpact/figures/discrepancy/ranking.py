"""The evidence of the explanations, and the parameters of the named effects as profiles of their
score.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.discrepancy.results_folder import best_places
from vibroimpact.display_units import display_unit
from vibroimpact.effects.registry import effects_in_words
from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    ORANGE,
    SKY,
    label_of,
    number,
)

MOST_BARS = 16
MOST_PROFILES = 6
# Log evidence beyond which it is drawn on a logarithmic scale; a linear one would hide the range
# near zero, which decides.
WIDE = 3000.0
NO_UNIT = ("", "1", "-")


def ranking_figure(ranking, named=()):
    """Return [Sheet] of the ranking: bars are the log evidence, beside them the probability.

    ranking: rows {ids, location, fit_score, closed_fraction, tested, probability}, the most
    probable first, ids joined by +.
    named: ids of the verdict.
    """
    rows = best_places(ranking)[:MOST_BARS]
    caption = (
        "Explanations, the most probable first, by the logarithm of how much more probable each"
        " makes the fitted records than nothing at all does, against the model as given or, where"
        " the lowest record shows a linear effect, the model with it. Where there is no bar, the"
        " effect brings the model no nearer. Text: probability, and the share of the excess misfit"
        " that it closes on the records that took no part. Pale bars are of the first runs alone,"
        " dark ones of more; the named effect, or the most probable of several, is orange."
    )
    sheet = Sheet(
        "discrepancy_ranking",
        "Which effect explains it",
        caption,
        size=(9.0, 1.5 + 0.3 * max(len(rows), 4)),
    )
    axes = sheet.axes["main"]
    score = np.array([_value(row["fit_score"]) for row in rows])
    if not np.nan_to_num(score).any():
        told = [_label(row, []) for row in rows if _value(row["fit_score"]) == 0.0]
        note = "no explanation brings the model nearer" if rows else "no explanation was run"
        note = f"the lowest record alone tells the {told[0]}" if told else note
        sheet.note(axes, note, "fit_score", "place_in_list")
        axes.set_yticks([])
        return [sheet]
    names = ["+".join(sorted(str(row["ids"]).split("+"))) for row in rows]
    wanted = "+".join(sorted(named))
    places = np.arange(len(rows))
    colours = [
        ORANGE if name == wanted else BLUE if _true(row.get("tested", True)) else SKY
        for name, row in zip(names, rows, strict=True)
    ]
    axes.barh(places, score, color=colours, height=0.62, zorder=2)
    for place, (row, name) in enumerate(zip(rows, names, strict=True)):
        sheet.record(
            axes,
            name,
            fit_score=score[place],
            closed_fraction=_value(row.get("closed_fraction")),
            probability=_value(row.get("probability")),
        )
    right, left = np.nanmax([*score, 0.0]), np.nanmin([*score, 0.0])
    right = max(right, left + 1.0)
    for place, row in enumerate(rows):
        axes.text(right + 0.02 * (right - left), place, _told(row), va="center", fontsize=8)
    axes.set_xlim(left - 0.02 * (right - left), right + 0.3 * (right - left))
    if max(right, -left) > WIDE:
        axes.set_xscale("symlog", linthresh=100.0)
        axes.set_xlim(min(2.0 * left, -50.0), max(20.0 * right, 1000.0))
    axes.set_yticks(places, [_label(row, names) for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(label_of("fit_score"))
    axes.grid(False, axis="y")
    axes.axvline(0.0, color=BLACK, linewidth=0.8)
    return [sheet]


def _told(row):
    """Return the probability of a row and what it closes, in words."""
    told = ("", _value(row.get("probability"))), ("closes ", _value(row.get("closed_fraction")))
    return ", ".join(f"{word}{100 * share:.0f} %" for word, share in told if np.isfinite(share))


def _label(row, names):
    """Return the effects of a row in words, with their place where it distinguishes them."""
    ids = str(row["ids"]).split("+")
    told_by_place = names.count("+".join(sorted(ids))) > 1 or len(set(ids)) < len(ids)
    place = f" ({row['location']})" if told_by_place and row.get("location") else ""
    return " + ".join(effects_in_words([name]) for name in ids) + place.replace("_", " ")


def _value(value):
    """Return a cell of a table as a number, NaN where it has none."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return float("nan")


def _true(value):
    return value in (True, 1, "True", "true", "1")


def profiles_figure(candidates, effects):
    """Return [Sheet] of what is left against parameter value for the named effects.

    Where none is named, those of the best candidate are shown. Effects identified on the lowest
    record have no profile.

    candidates: contents of candidates/*.json, best first: {ids, parameters: {name: {value}},
    profile: [{parameter, unit, log, values, left, simulated}]}.
    effects: those of verdict.json.
    """
    shown = named_of(candidates, effects)
    curves = [curve for candidate in shown for curve in candidate.get("profile", [])][
        :MOST_PROFILES
    ]
    caption = (
        "What is expected to be left of the differences (chi-square per value; dashed: as much as"
        " chance leaves) against each parameter, the others as in the verdict. Line: value of the"
        " verdict; shaded: its 90 % interval. Ticks: values that were simulated; far from them more"
        " is left, since less is known. A curve that is flat tells nothing about its parameter."
    )
    if not curves:
        sheet = Sheet("discrepancy_profiles", "How well the parameters are known", caption)
        why = "no parameter was scanned" + ": what is named was read off the lowest record" * bool(
            effects
        )
        sheet.note(sheet.axes["main"], why, "parameter", "left")
        return [sheet]
    title = "How well the parameters are known"
    if not effects:
        ids = " + ".join(effects_in_words([name]) for name in shown[0]["ids"])
        title = f"What comes nearest, {ids}: how well its parameters are known"
    across = min(3, len(curves))
    keys = [f"{index} {curve['parameter']}" for index, curve in enumerate(curves)]
    padded = keys + ["."] * (-len(keys) % across)
    mosaic = [padded[row : row + across] for row in range(0, len(padded), across)]
    sheet = Sheet(
        "discrepancy_profiles",
        title,
        caption,
        mosaic,
        size=(1.0 + 3.4 * across, 0.9 + 2.8 * len(mosaic)),
    )
    for key, curve in zip(keys, curves, strict=True):
        _profile(sheet, sheet.axes[key], curve, effects)
    return [sheet]


def named_of(candidates, effects):
    """Return [candidate] of the effects of a verdict; the best candidate where none is named.

    Estimates are compared too, since a catalogue may hold two laws of one effect. The candidate
    with most effects is taken.
    """
    if not effects:
        return candidates[:1]
    named = [
        candidate
        for candidate in candidates
        if all(
            _same(effects, name, row["value"])
            for name, row in candidate.get("parameters", {}).items()
        )
        and set(candidate["ids"]) <= {effect.id for effect in effects}
    ]
    most = max((len(candidate["ids"]) for candidate in named), default=0)
    return [candidate for candidate in named if len(candidate["ids"]) == most]


def found_of(effects, name):
    """Return the Estimate of a parameter, None where the effects do not have it.

    name: of the parameter, or effect.parameter.
    """
    effect_id, _, parameter = name.rpartition(".")
    rows = [effect.parameters for effect in effects if not effect_id or effect.id == effect_id]
    return next((row[parameter] for row in rows if parameter in row), None)


def _same(effects, name, value):
    found = found_of(effects, name)
    return found is not None and bool(np.isclose(found.value, value, rtol=1e-6, atol=0.0))


def _profile(sheet, axes, curve, effects):
    """Draw one profile, with the interval of the verdict where it names the parameter."""
    unit, factor = display_unit(curve["unit"], curve["values"])
    order = np.argsort(curve["values"])
    values = np.asarray(curve["values"], float)[order] * factor
    left = np.asarray(curve["left"], float)[order]
    place = sheet.record(
        axes, curve["parameter"], parameter=np.asarray(curve["values"], float)[order], left=left
    )
    axes.axhline(1.0, color=BLACK, linestyle="--", linewidth=0.8)
    axes.set_yscale("log")
    axes.plot(values, left, color=BLUE, marker="o", markersize=4, gid=place)
    simulated = np.asarray(curve.get("simulated", []), float)
    if len(simulated):
        place = sheet.record(axes, f"{curve['parameter']} simulated", parameter=simulated)
        axes.plot(
            factor * simulated,
            np.full(len(simulated), 0.025),
            "|",
            color=BLACK,
            markersize=10,
            transform=axes.get_xaxis_transform(),
            gid=place,
        )
    found = found_of(effects, curve["parameter"])
    if found is not None:
        axes.axvspan(
            factor * found.low,
            factor * found.high,
            color=ORANGE,
            alpha=0.2,
            linewidth=0,
            zorder=0,
        )
        axes.axvline(factor * found.value, color=ORANGE, linewidth=1.6)
        axes.set_title(
            f"{number(factor * found.value)} ({number(factor * found.low)} to"
            f" {number(factor * found.high)}) {'' if unit in NO_UNIT else unit}"
        )
    if curve.get("log", True) and values.min() > 0.0 and values.max() > 30.0 * values.min():
        axes.set_xscale("log")
    axes.set_xlabel(axis_label(curve["parameter"], unit))
    axes.set_ylabel(label_of("left"))


def axis_label(parameter, unit):
    """Return the label of a parameter's axis: its name in words and its unit."""
    return f"{parameter.replace('_', ' ').replace('.', ', ')} ({'-' if unit in NO_UNIT else unit})"
