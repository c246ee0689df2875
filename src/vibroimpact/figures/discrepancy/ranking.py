"""Scores of the candidates on held-out records, and the parameters of the named effects.

Parameters are shown as profiles of the score, and level by level.
"""

from __future__ import annotations

import numpy as np

from vibroimpact.discrepancy.results_folder import best_places
from vibroimpact.display_units import display_unit
from vibroimpact.figures.sheet import Sheet
from vibroimpact.figures.style import (
    BLACK,
    BLUE,
    GAP_COLOURS,
    GAP_MARKERS,
    GREY,
    ORANGE,
    RED,
    SKY,
    label_of,
    number,
)

MOST_BARS = 16
MOST_PROFILES = 6
# Log likelihood beyond which scores are drawn on a logarithmic scale; a linear one would hide the
# range near zero, which decides.
WIDE = 3000.0
NO_UNIT = ("", "1", "-")


def ranking_figure(ranking, named=()):
    """Return [Sheet] of the ranking.

    Bars are the held-out score, rings the fitted score, a line the null threshold.

    ranking: rows {ids, fit_score, heldout_score, closed_fraction, threshold, tested}, ids joined by
    +.
    named: ids of the verdict.
    """
    rows = best_places(sorted(ranking, key=lambda row: -_value(row["heldout_score"])))[:MOST_BARS]
    caption = (
        "Candidates by how much better they explain the records that they were not fitted on (bars)"
        " and those that they were (rings), against the model as given or, where the lowest record"
        " shows a linear effect, the model with it. Red line: the best that chance does on"
        " campaigns with nothing hidden (98 % of them lie below). Text: share of the excess misfit"
        " that the candidate closes on the records that took no part. Pale bars were judged by the"
        " emulator alone, dark ones by direct simulation; the named effect, or the most probable of"
        " several, is orange."
    )
    sheet = Sheet(
        "discrepancy_ranking",
        "Which effect explains it",
        caption,
        size=(9.0, 1.5 + 0.3 * max(len(rows), 4)),
    )
    axes = sheet.axes["main"]
    if not rows:
        sheet.note(axes, "no candidate was scored", "heldout_score", "place_in_list")
        axes.set_yticks([])
        return [sheet]
    names = ["+".join(sorted(str(row["ids"]).split("+"))) for row in rows]
    wanted = "+".join(sorted(named))
    held, fit = (
        np.array([_value(row[key]) for row in rows]) for key in ("heldout_score", "fit_score")
    )
    places = np.arange(len(rows))
    colours = [
        ORANGE if name == wanted else BLUE if _true(row.get("tested", True)) else SKY
        for name, row in zip(names, rows, strict=True)
    ]
    axes.barh(places, held, color=colours, height=0.62, zorder=2)
    axes.plot(
        fit,
        places,
        "o",
        markerfacecolor="none",
        color=BLACK,
        markersize=5,
        label="score on the fitted records",
        zorder=3,
    )
    for place, (row, name) in enumerate(zip(rows, names, strict=True)):
        sheet.record(
            axes,
            name,
            heldout_score=held[place],
            fit_score=fit[place],
            closed_fraction=_value(row.get("closed_fraction")),
            threshold=_value(row.get("threshold")),
        )
    _thresholds(axes, rows, places)
    closed = [_value(row.get("closed_fraction")) for row in rows]
    right = max(
        np.nanmax([*held, *fit, 0.0]),
        *(
            _value(row.get("threshold"))
            for row in rows
            if np.isfinite(_value(row.get("threshold")))
        ),
        0.0,
    )
    left = np.nanmin([*held, *fit, 0.0])
    for place, fraction in enumerate(closed):
        if np.isfinite(fraction):
            axes.text(
                right + 0.02 * (right - left),
                place,
                f"closes {100 * fraction:.0f} %",
                va="center",
                fontsize=8,
                color=GREY if fraction <= 0 else BLACK,
            )
    axes.set_xlim(left - 0.02 * (right - left), right + 0.2 * (right - left))
    if np.nanmax(np.abs([*held, *fit])) > WIDE:
        axes.set_xscale("symlog", linthresh=100.0)
        axes.set_xlim(min(2.0 * left, -50.0), max(20.0 * right, 1000.0))
    axes.set_yticks(places, [_label(row, names) for row in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel(label_of("heldout_score" if np.isfinite(held).any() else "fit_score"))
    axes.grid(False, axis="y")
    axes.axvline(0.0, color=BLACK, linewidth=0.8)
    sheet.figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return [sheet]


def _label(row, names):
    """Return the effects of a row in words, with their place where it distinguishes them."""
    ids = str(row["ids"]).split("+")
    told_by_place = names.count("+".join(sorted(ids))) > 1 or len(set(ids)) < len(ids)
    place = f" ({row['location']})" if told_by_place and row.get("location") else ""
    return f"{row['ids']}{place}".replace("_", " ").replace("+", " + ")


def _thresholds(axes, rows, places):
    """Draw the null threshold: one line where all candidates share it, else a mark per bar."""
    values = np.array([_value(row.get("threshold")) for row in rows])
    known = np.isfinite(values)
    if not known.any():
        return
    if np.ptp(values[known]) <= 1e-6 * max(np.abs(values[known]).max(), 1e-12):
        axes.axvline(
            values[known][0],
            color=RED,
            linestyle="--",
            linewidth=1.4,
            label="best by chance (98 %)",
            zorder=4,
        )
        return
    axes.vlines(
        values[known],
        places[known] - 0.42,
        places[known] + 0.42,
        color=RED,
        linestyle="-",
        linewidth=1.6,
        label="best by chance (98 %)",
        zorder=4,
    )


def _value(value):
    """Return a cell of a table as a number, NaN where it has none."""
    try:
        return float(value)
    except (TypeError, ValueError):
        return float("nan")


def _true(value):
    return value in (True, 1, "True", "true", "1")


def profiles_figure(candidates, effects):
    """Return [Sheet] of score against parameter value for the named effects.

    Where none is named, those of the best candidate are shown. Effects identified on the lowest
    record have no profile.

    candidates: contents of candidates/*.json, best first: {ids, parameters: {name: {value}},
    profile: [{parameter, unit, values, score, simulated}]}.
    effects: those of verdict.json.
    """
    shown = named_of(candidates, effects)
    curves = [curve for candidate in shown for curve in candidate.get("profile", [])][
        :MOST_PROFILES
    ]
    caption = (
        "Score against each parameter, the others re-fitted, where they were scanned. Line: value"
        " of the verdict; shaded: its 90 % interval. Ticks: values that were simulated; between"
        " those far apart the curve forgives what it does not know. A curve that is flat there"
        " tells nothing about its parameter."
    )
    if not curves:
        sheet = Sheet("discrepancy_profiles", "How well the parameters are known", caption)
        why = "no parameter was scanned" + ": what is named was read off the lowest record" * bool(
            effects
        )
        sheet.note(sheet.axes["main"], why, "parameter", "score")
        return [sheet]
    across = min(3, len(curves))
    keys = [f"{index} {curve['parameter']}" for index, curve in enumerate(curves)]
    padded = keys + ["."] * (-len(keys) % across)
    mosaic = [padded[row : row + across] for row in range(0, len(padded), across)]
    sheet = Sheet(
        "discrepancy_profiles",
        "How well the parameters are known",
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
    score = np.asarray(curve["score"], float)[order]
    place = sheet.record(
        axes, curve["parameter"], parameter=np.asarray(curve["values"], float)[order], score=score
    )
    axes.plot(values, score, color=BLUE, marker="o", markersize=4, gid=place)
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
    if values.min() > 0.0 and values.max() > 30.0 * values.min():
        axes.set_xscale("log")
    axes.set_xlabel(axis_label(curve["parameter"], unit))
    axes.set_ylabel(label_of("score"))


def levels_figure(candidates, effects):
    """Return [Sheet] of each named parameter fitted level by level; a correct law is constant.

    candidates: as in profiles_figure, with by_level: [{parameter, unit, load_rms_N, gap_m, value,
    low, high}], lists of equal length.
    """
    curves = next(
        (
            candidate["by_level"]
            for candidate in named_of(candidates, effects)
            if candidate.get("by_level")
        ),
        [],
    )[:MOST_PROFILES]
    caption = (
        "Parameters of the named effect, fitted to each record alone, with 90 % intervals, against"
        " load; the band is the interval of the fit to all records. A law that is right gives the"
        " same value at every level and gap; a trend says that another law hides behind the name."
    )
    if not curves:
        sheet = Sheet("discrepancy_levels", "Is the parameter the same at every level?", caption)
        sheet.note(
            sheet.axes["main"], "no parameter was fitted level by level", "load_rms_N", "parameter"
        )
        return [sheet]
    keys = [f"{index} {curve['parameter']}" for index, curve in enumerate(curves)]
    sheet = Sheet(
        "discrepancy_levels",
        "Is the parameter the same at every level?",
        caption,
        [keys],
        size=(1.0 + 3.4 * len(keys), 3.6),
    )
    for key, curve in zip(keys, curves, strict=True):
        axes = sheet.axes[key]
        unit, factor = display_unit(curve["unit"], curve["value"])
        load, value, low, high = (
            np.asarray(curve[part], float) for part in ("load_rms_N", "value", "low", "high")
        )
        sheet.record(
            axes,
            curve["parameter"],
            load_rms_N=load,
            gap_m=np.asarray(curve["gap_m"], float),
            parameter=value,
            parameter_low=low,
            parameter_high=high,
        )
        gaps = np.asarray(curve["gap_m"], float)
        for index, gap in enumerate(sorted(set(gaps.tolist()), reverse=True)):
            here = (
                np.flatnonzero(gaps == gap)
                if np.isfinite(gap)
                else np.flatnonzero(~np.isfinite(gaps))
            )
            spread = (
                factor
                * np.array([np.maximum(value - low, 0.0), np.maximum(high - value, 0.0)])[:, here]
            )
            axes.errorbar(
                load[here] * 1.04**index,
                factor * value[here],
                spread,
                fmt=GAP_MARKERS[index % len(GAP_MARKERS)],
                color=GAP_COLOURS[index % len(GAP_COLOURS)],
                capsize=3,
                label=f"gap {gap * 1e3:.3g} mm" if np.isfinite(gap) else None,
            )
        found = found_of(effects, curve["parameter"])
        if found is not None:
            axes.axhspan(
                factor * found.low, factor * found.high, color=BLACK, alpha=0.1, linewidth=0
            )
        axes.set_xscale("log")
        axes.margins(x=0.15, y=0.12)
        axes.set_xlabel(label_of("load_rms_N"))
        axes.set_ylabel(axis_label(curve["parameter"], unit))
        sheet.legend(axes)
    return [sheet]


def axis_label(parameter, unit):
    """Return the label of a parameter's axis: its name in words and its unit."""
    return f"{parameter.replace('_', ' ').replace('.', ', ')} ({'-' if unit in NO_UNIT else unit})"
