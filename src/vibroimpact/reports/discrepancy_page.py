"""The report of one campaign as a single HTML file with embedded figures.

It tells one story: what is missing, how sure, where it shows, what adding it does on records that
took no part, what was ruled out and why, and what to do next.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable
from pathlib import Path

from jinja2 import Environment, StrictUndefined

from vibroimpact.discrepancy.results_folder import best_places
from vibroimpact.effects.effect import TESTS
from vibroimpact.effects.places import place_in_words
from vibroimpact.effects.registry import EFFECTS, effects_in_words
from vibroimpact.verdict.content import Misfit, Verdict

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
    "verification": "verification: took no part",
    "holdout": "held out: not fitted",
    "selection": "selection: the name was chosen with them",
    "fit": "fitted",
}
# Section of the page by the figure's name; others go to what adding the effect does.
SECTIONS = {
    "discrepancy_place": "what",
    "mounting": "what",
    "restoring_force": "what",
    "discrepancy_profiles": "sure",
    "discrepancy_map": "where",
    "where": "where",
    "discrepancy_ranking": "ruled_out",
}
BAR_PX = 240  # of a probability of 1
LEAST_SHOWN = 0.005  # of the probabilities of explanations
MOST_ROWS, MOST_REGIONS, MOST_MODES = 20, 10, 6
WHOLE_PX = 1216  # of a figure as wide as the page: 7.6 in at 160 dpi
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
    compared_s: float | None = None,
    model: str | None = None,
) -> str:
    """Return the HTML page.

    name: of the campaign.
    verdict: its Verdict.
    figures: PNG files in their order, each with its caption in a .txt file of the same name.
    floor: meaning of the floor of the misfit, SEEDS or NOISE.
    compared_s: s of each record that the search compared, None where the structure was identified.
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
        style=STYLE,
        name=name,
        verdict=verdict,
        floor=floor,
        compared_s=None if compared_s is None else digits(compared_s),
        sentence=verdict_sentence(verdict),
        withdrawn=withdrawn_sentence(verdict),
        effects=[*_effect_rows(verdict)],
        families=any(effect.family for effect in shown),
        laws=any(effect.law_fits for effect in shown),
        completed=bool(shown),
        probabilities=_probabilities(verdict),
        misfit=[*_misfit_rows(verdict)],
        p_before=probability_text(verdict.p_global_before),
        p_after=probability_text(verdict.p_global_after),
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


def _by_section(figures):
    """Return {section: [{name, caption, data}]} of PNG files."""
    sections: dict[str, list] = {
        section: [] for section in ("what", "sure", "where", "adding", "ruled_out")
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
                "probability": percent(row.get("probability")),
                "score": digits(row["heldout_score"]),
                "closed": percent(row["closed_fraction"]),
                "judgement": judgement(verdict, row, ids not in known),
            }
        )
        known.add(ids)
    return rows


def _probabilities(verdict):
    """Return [{words, probability, width of its bar in pixels}] of nothing, something else and the
    explanations that have a probability worth a row, at all places together, the most probable
    first.
    """
    known: dict[tuple[str, ...], float] = {}
    for row in verdict.ranking:
        if row.probability is not None:
            ids = tuple(sorted(row.ids))
            known[ids] = known.get(ids, 0.0) + row.probability
    sets = zip(verdict.ambiguity_set, verdict.ambiguity_probability, strict=False)
    known |= {tuple(sorted(ids)): probability for ids, probability in sets}
    rows = [
        (effects_in_words(ids), chance) for ids, chance in known.items() if chance >= LEAST_SHOWN
    ]
    rows.append(("nothing is missing", verdict.probability_none))
    rows.append(("something that is not in the catalogue", verdict.probability_something_else))
    told = sorted([row for row in rows if row[1] is not None], key=lambda row: -row[1])
    return [
        {"words": words, "probability": percent(value), "width": round(BAR_PX * value)}
        for words, value in told[:MOST_ROWS]
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
            cells = {key: digits(value[key]) if value else "" for key in ("value", "low", "high")}
            yield {
                **head,
                "parameter": name.replace("_", " "),
                **cells,
                "unit": unit_text(value["unit"]).strip() or "-" if value else "",
            }
            head = dict.fromkeys(head, "")


def _where(location, effect):
    """Return a location in words; effect: its entry of the catalogue, None."""
    of_supports = effect is not None and effect.acts_on == "contact" and location == "all"
    return "all supports" if of_supports else place_in_words(location)


def _misfit_rows(verdict):
    for split, words in SPLITS.items():
        misfit = getattr(verdict.misfit, split)
        if misfit is None and split in ("verification", "selection"):
            continue
        misfit = misfit or NOTHING_COMPARED
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
