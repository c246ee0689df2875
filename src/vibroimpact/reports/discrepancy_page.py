"""The report of one campaign as a single HTML file with embedded figures.

It tells one story: what was concluded and how sure, where model and measurement part, the law that
the records demand, the effect with its values, what adding it does on records that took no part,
what was ruled out and why, and what would separate what is left.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from vibroimpact.effects.effect import TESTS
from vibroimpact.effects.places import place_in_words
from vibroimpact.effects.registry import EFFECTS, effects_in_words
from vibroimpact.verdict.content import Misfit, Verdict

from .explanations import best_places, chance_text, explanations_of
from .number_text import digits, percent
from .page_style import STYLE
from .verdict_words import (
    for_reading,
    judgement,
    next_steps,
    probability_text,
    unit_text,
    verdict_sentence,
    where_it_shows,
    withdrawn_sentence,
)

TEMPLATE = Path(__file__).with_suffix(".html")
# The records of each misfit, what took no part first.
SPLITS = {
    "holdout": "held out: not fitted",
    "fit": "fitted",
}
HEADINGS = {
    "named": "What is missing",
    "partly_explained": "What is missing, as far as it is known",
    "ambiguous": "The most probable of them",
}
# Section of the page by the figure's name; others go to what adding the effect does.
SECTIONS = {
    "diagnosis_ranking": "sure",
    "diagnosis_holding": "where",
    "diagnosis_law": "law",
    "diagnosis_place": "what",
}
BAR_PX = 240  # of a probability of 1
MOST_ROWS, MOST_REGIONS, MOST_MODES = 20, 10, 6
WHOLE_PX = 1216  # of a figure as wide as the page: 7.6 in at 160 dpi
LEVEL_ORDER = {"refuse": 0, "warn": 1, "not checked": 2, "pass": 3}
# Meanings of the floor of the misfit.
FREE_RUNS = "that between two free runs of one model"
NOISE = "the scatter of the measurement itself, between periods or averages"


def discrepancy_page(
    name: str,
    verdict: Verdict,
    figures: Iterable[Path],
    floor: str = FREE_RUNS,
    model: str | None = None,
) -> str:
    """Return the HTML page.

    name: of the campaign.
    verdict: its Verdict.
    figures: PNG files in their order, each with its caption in a .txt file of the same name.
    floor: meaning of the floor of the misfit, FREE_RUNS or NOISE.
    model: path of the completed model, model_updated.yaml beside the page where None.
    """
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True)
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    tests = [
        f"{test}, {TESTS[test]}" if test in TESTS else str(test)
        for test in verdict.broken_invariances
    ]
    shown = verdict.shown_effects()
    return template.render(
        misfit=[*_misfit_rows(verdict)],
        p_before=_chance(verdict.p_global_before),
        p_after=_chance(verdict.p_global_after),
        style=STYLE,
        name=name,
        verdict=verdict,
        floor=floor,
        sentence=verdict_sentence(verdict),
        withdrawn=withdrawn_sentence(verdict),
        effects=[*_effect_rows(verdict)],
        families=any(effect.family for effect in shown),
        laws=any(effect.law_fits for effect in shown),
        completed=bool(shown),
        heading=HEADINGS.get(verdict.verdict, "The structure"),
        separates=bool(verdict.next_measurement),
        probabilities=_probabilities(verdict),
        regions=[_region_row(region) for region in verdict.regions[:MOST_REGIONS]],
        where_it_shows=where_it_shows(verdict),
        broken="; ".join(tests),
        figures=_by_section(figures),
        ranking=_ranking_rows(verdict),
        scored=any(row.heldout_score is not None for row in verdict.ranking),
        untestable=", ".join(effects_in_words([name]) for name in verdict.not_testable),
        steps=next_steps(verdict, model or "model_updated.yaml"),
        checks=sorted(verdict.checks, key=lambda row: LEVEL_ORDER[row.level]),
        seconds=digits(verdict.seconds),
        stages=_stages(verdict),
        provenance=[*_flat(verdict.provenance)],
    )


def _chance(value):
    """Return a p-value as text, None where there is none."""
    return None if value is None else probability_text(value)


def _by_section(figures):
    """Return {section: [{name, caption, data}]} of PNG files."""
    sections: dict[str, list] = {
        section: [] for section in ("sure", "where", "law", "what", "adding", "ruled_out")
    }
    for figure in embedded(figures):
        sections[SECTIONS.get(figure["name"], "adding")].append(figure)
    return sections


def _ranking_rows(verdict):
    rows, known = [], set()
    for row in best_places([row.to_values() for row in verdict.ranking])[:MOST_ROWS]:
        ids = tuple(sorted(row["ids"]))
        rows.append(
            {
                "ids": effects_in_words(row["ids"]),
                "location": ", ".join(map(place_in_words, (row.get("location") or "").split("+"))),
                "probability": chance_text(row.get("probability")),
                "score": digits(row["heldout_score"]),
                "closed": percent(row["closed_fraction"]),
                "judgement": judgement(verdict, row, ids not in known),
            }
        )
        known.add(ids)
    return rows


def _probabilities(verdict):
    """Return [{words, probability, width of its bar in pixels}], the most probable first."""
    return [
        {
            "words": row.words,
            "probability": chance_text(row.probability),
            "width": round(BAR_PX * row.probability),
        }
        for row in explanations_of(verdict)[:MOST_ROWS]
    ]


def _stages(verdict):
    if verdict.cost is None:
        return []
    return [
        {
            "stage": stage,
            "seconds": digits(cost.cpu_seconds),
            "simulations": cost.simulations,
        }
        for stage, cost in verdict.cost.by_stage.items()
    ]


def embedded(figures: Iterable[Path]) -> list[dict]:
    """Return {name, caption, data, percent} of PNG files; data is the text of a data: address,
    percent the share of the page's width with which their letters are as large as in others.

    The caption is in a .txt file of the same name.
    """
    return [_embedded(file, file.read_bytes()) for file in map(Path, figures)]


def _embedded(file, content):
    """Return the row of embedded of a file and its content."""
    pixels = int.from_bytes(content[16:20], "big")  # the width in the header of a PNG file
    return {
        "name": file.stem,
        "caption": file.with_suffix(".txt").read_text(encoding="utf-8"),
        "data": base64.b64encode(content).decode(),
        "percent": min(100, round(100 * pixels / WHOLE_PX)),
    }


def _effect_rows(verdict):
    for effect in verdict.shown_effects():
        known = EFFECTS.get(effect.id)
        head = {
            "effect": effects_in_words([effect.id]),
            "explanation": known.explanation if known else "",
            "family": effect.family or "",
            "law_fits": effect.law_fits or "",
            "location": _where(effect.location or "all", known),
        }
        for name, value in [
            (name, for_reading(row)) for name, row in effect.parameters.items()
        ] or [("", None)]:
            yield {
                **head,
                "parameter": name.replace("_", " "),
                "value": digits(value["value"]) if value else "",
                "interval": _interval(value) if value else "",
                "unit": unit_text(value["unit"]).strip() or "-" if value else "",
            }
            head = dict.fromkeys(head, "")


def _interval(value):
    """Return "0.128 to 0.171", "not known" where an end is missing."""
    if value["low"] is None or value["high"] is None:
        return "not known"
    return f"{digits(value['low'])} to {digits(value['high'])}"


def _where(location, effect):
    """Return a location in words; effect: its entry of the catalogue, None."""
    of_supports = effect is not None and effect.acts_on == "contact" and location == "all"
    return "all supports" if of_supports else place_in_words(location)


def _misfit_rows(verdict):
    for split, words in SPLITS.items():
        misfit: Misfit | None = getattr(verdict.misfit, split)
        if misfit is None or misfit.before_dB is None:
            continue
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
        "discrepancy": _signed(region.discrepancy_dB),
        "z": _signed(region.z),
        "modes": _modes(region.nearest_modes_Hz or ()),
    }


def _signed(value):
    """Return a number with its sign, - where there is none."""
    return "-" if value is None else f"{value:+.1f}"


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
