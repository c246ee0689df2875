"""The report of one campaign as a single HTML file with embedded figures.

It has the verdict, the effects, misfit, map, ranking and checks.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from vibroimpact.discrepancy.results_folder import best_places
from vibroimpact.display_units import display_unit
from vibroimpact.effects.effect import TESTS
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.verdict.content import Misfit, Verdict

from .number_text import digits, percent
from .page_style import STYLE

TEMPLATE = Path(__file__).with_suffix(".html")
SPLITS = {"fit": "fitted", "holdout": "held out"}
MOST_ROWS, MOST_MODES = 20, 6
LEVEL_ORDER = {"refuse": 0, "warn": 1, "pass": 2}
NOTHING_COMPARED = Misfit(before_dB=None, after_dB=None, floor_dB=None, closed_fraction=None)
# Meanings of the floor of the misfit.
SEEDS = "that between two seeds of the completed model"
NOISE = "the scatter of the measurement itself, between periods or averages"


def discrepancy_page(
    name: str,
    verdict: Verdict,
    figures: Iterable[Path],
    floor: str = SEEDS,
    quick_s: float | None = None,
) -> str:
    """Return the HTML page.

    name: of the campaign.
    verdict: its Verdict.
    figures: PNG files in their order, each with its caption in a .txt file of the same name.
    floor: meaning of the floor of the misfit, SEEDS or NOISE.
    quick_s: s of each record that a quick run used, None for a full run.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    tests = [
        f"{test}, {TESTS[test]}" if test in TESTS else str(test)
        for test in verdict.broken_invariances
    ]
    return template.render(
        style=STYLE,
        name=name,
        verdict=verdict,
        floor=floor,
        quick_s=None if quick_s is None else digits(quick_s),
        sentence=verdict_sentence(verdict),
        effects=[*_effect_rows(verdict)],
        misfit=[*_misfit_rows(verdict)],
        p_before=_probability(verdict.p_global_before),
        p_after=_probability(verdict.p_global_after),
        regions=[_region_row(region) for region in verdict.regions[:MOST_ROWS]],
        broken="; ".join(tests),
        figures=embedded(figures),
        ranking=[
            {
                "ids": in_words(row["ids"]),
                "location": ", ".join((row.get("location") or "").split("+")),
                "score": digits(row["heldout_score"]),
                "closed": percent(row["closed_fraction"]),
            }
            for row in best_places([row.to_values() for row in verdict.ranking])[:MOST_ROWS]
        ],
        checks=sorted(verdict.checks, key=lambda row: LEVEL_ORDER[row.level]),
        seconds=digits(verdict.seconds),
        provenance=[*_flat(verdict.provenance)],
    )


def embedded(figures: Iterable[Path]) -> list[dict]:
    """Return {name, caption, data} of PNG files; data is the text of a data: address.

    The caption is in a .txt file of the same name.
    """
    return [
        {
            "name": file.stem,
            "caption": file.with_suffix(".txt").read_text(encoding="utf-8"),
            "data": base64.b64encode(file.read_bytes()).decode(),
        }
        for file in map(Path, figures)
    ]


def verdict_sentence(verdict: Verdict) -> str:
    """Return the verdict in one or two sentences."""
    held_out = verdict.misfit.holdout
    closed = None if held_out is None else held_out.closed_fraction
    shrinks = (
        f" Adding it closes {percent(closed)} of the excess misfit on records that were not fitted."
        if closed is not None
        else ""
    )
    named = "; and ".join(map(_with_parameters, verdict.effects))
    alternatives = [
        ids
        for ids in verdict.ambiguity_set
        if sorted(ids) != sorted(effect.id for effect in verdict.effects)
    ]
    others = (
        f" This campaign can not distinguish it from {sets_in_words(alternatives)}."
        if named and alternatives
        else ""
    )
    near = [effect.id for effect in verdict.most_probable]
    nearest = f" The best candidate, {in_words(near)}, does not explain it." if near else ""
    refusals = " ".join(row.message for row in verdict.checks if row.level == "refuse")
    sentences = {
        "none": (
            "No effect is missing: the model explains the campaign within the scatter of its seeds"
            f" (p-value of the map: {_probability(verdict.p_global_before)})."
        ),
        "named": f"The model lacks {named}.{shrinks}{others}",
        "partly_explained": (
            f"The model lacks {named}, and something else that is not in the catalogue: the"
            f" remaining difference is significant.{shrinks}{others}"
        ),
        "ambiguous": (
            "One of these is missing, and this campaign can not decide which:"
            f" {sets_in_words(verdict.ambiguity_set)}."
            + shrinks.replace("Adding it", "Adding the most probable of them")
        ),
        "unknown": (
            "The model and the measurement disagree, and no effect of the catalogue explains it:"
            f" the map says where to look.{nearest}"
        ),
        "not_testable": f"The campaign can not be judged. {refusals}".strip(),
    }
    return sentences[verdict.verdict]


def in_words(ids: Sequence[str]) -> str:
    """Return effect ids as words: dry friction and gap."""
    return " and ".join(str(name).replace("_", " ") for name in ids)


def sets_in_words(sets: Sequence[Sequence[str]]) -> str:
    """Return the members of an ambiguity set: dry friction, or foliate obstacle."""
    return ", or ".join(in_words(ids) for ids in sets)


def _with_parameters(effect):
    """Return an effect in words with its parameters.

    Example: dry friction at both plates (mu 0.149, between 0.128 and 0.171).
    """
    values = ", ".join(
        f"{name.replace('_', ' ')} {digits(value['value'])}{_unit(value['unit'])}, between"
        f" {digits(value['low'])} and {digits(value['high'])}"
        for name, value in ((name, _for_reading(row)) for name, row in effect.parameters.items())
    )
    place = f" at {effect.location}" if effect.location not in ("", "all") else ""
    return f"{in_words([effect.id])}{place}" + (f" ({values})" if values else "")


def _effect_rows(verdict):
    for effect in verdict.shown_effects():
        known = EFFECTS.get(effect.id)
        head = {
            "effect": in_words([effect.id]),
            "explanation": known.explanation if known else "",
            "location": effect.location or "all",
        }
        for name, value in [
            (name, _for_reading(row)) for name, row in effect.parameters.items()
        ] or [("", None)]:
            cells = {key: digits(value[key]) if value else "" for key in ("value", "low", "high")}
            yield {
                **head,
                "parameter": name.replace("_", " "),
                **cells,
                "unit": _unit(value["unit"]).strip() or "-" if value else "",
            }
            head = {"effect": "", "explanation": "", "location": ""}


def _misfit_rows(verdict):
    for split, words in SPLITS.items():
        misfit = getattr(verdict.misfit, split) or NOTHING_COMPARED
        yield {
            "records": words,
            "before": digits(misfit.before_dB),
            "after": digits(misfit.after_dB),
            "floor": digits(misfit.floor_dB),
            "closed": percent(misfit.closed_fraction),
        }


def _region_row(region):
    return {
        "band": " to ".join(digits(edge) for edge in region.band_Hz),
        "channel": region.channel,
        "load": digits(region.load_rms_N),
        "gap": digits(region.gap_m * 1e3) if region.gap_m is not None else "-",
        "discrepancy": f"{region.discrepancy_dB:+.1f}",
        "z": f"{region.z:+.1f}",
        "modes": _modes(region.nearest_modes_Hz or ()),
    }


def _modes(frequencies):
    """Return the modes of the model in or nearest to a band, to three digits, without duplicates.

    A symmetric tube has some modes twice.
    """
    shown = list(dict.fromkeys(digits(frequency) for frequency in frequencies))
    return ", ".join(shown[:MOST_MODES]) + (" ..." if len(shown) > MOST_MODES else "")


def _flat(values, prefix=""):
    for key, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _unit(unit):
    return "" if unit in ("1", "", "-", None) else f" {unit}"


def _for_reading(row):
    """Return {value, low, high, unit} of an Estimate in the unit that it is shown in."""
    values = {"value": row.value, "low": row.low, "high": row.high}
    unit, factor = display_unit(row.unit, values.values())
    return {
        "unit": unit,
        **{key: None if value is None else factor * value for key, value in values.items()},
    }


def _probability(value):
    if value is None:
        return "not computed"
    return "below 0.001" if value < 1e-3 else f"{value:.2g}"
