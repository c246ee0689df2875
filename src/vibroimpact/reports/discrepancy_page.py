"""The report of one campaign as a single HTML file with embedded figures.

The page shows the conclusion and its probability, the places of the largest differences, the law
that the records demand, the effect with its values, its gain on held-out records, the explanations
compared and why one is taken, and the measurement that would separate the rest.
"""

from collections.abc import Iterable
from pathlib import Path

from vibroimpact.diagnosis.verdict.content import Misfit, Verdict
from vibroimpact.effects.effect import TESTS
from vibroimpact.effects.places import place_in_words
from vibroimpact.effects.registry import EFFECTS, effects_in_words

from .number_text import digits, percent, span
from .page import embedded, rendered
from .table import table_of
from .verdict_words import (
    chance_text,
    explanations_of,
    for_reading,
    judgement,
    next_steps,
    unit_text,
    verdict_sentence,
    withdrawn_sentence,
)

# The records of each misfit, held-out ones first.
SPLITS = {"holdout": "held out: not fitted", "fit": "fitted"}
HEADINGS = {
    "named": "The missing effect",
    "partly_explained": "A part of the missing effects",
    "ambiguous": "The most probable of them",
}
# Section of the page by the figure's name; others go to the result of adding the effect.
SECTIONS = {
    "diagnosis_ranking": "sure",
    "diagnosis_holding": "where",
    "diagnosis_law": "law",
    "diagnosis_place": "what",
}
MOST_ROWS, MOST_REGIONS = 20, 10
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
    model: path of the completed model, model_updated.yaml next to the page if None.
    """
    tests = [
        f"{test}, {TESTS[test]}" if test in TESTS else str(test)
        for test in verdict.broken_invariances
    ]
    sections: dict[str, list] = {section: [] for section in (*SECTIONS.values(), "adding")}
    for figure in embedded(figures):
        sections[SECTIONS.get(figure["name"], "adding")].append(figure)
    return rendered(
        "discrepancy_page.html",
        name=name,
        verdict=verdict,
        floor=floor,
        sentence=verdict_sentence(verdict),
        withdrawn=withdrawn_sentence(verdict),
        completed=bool(verdict.shown_effects()),
        heading=HEADINGS.get(verdict.verdict, "The structure"),
        figures=sections,
        probabilities=bool(explanations_of(verdict)),
        regions=_regions(verdict),
        broken="; ".join(tests),
        effects=_effects(verdict),
        misfit=_misfit(verdict),
        ranking=_ranking(verdict),
        untestable=", ".join(effects_in_words([name]) for name in verdict.not_testable),
        steps=next_steps(verdict, model or "model_updated.yaml"),
        checks=_checks(verdict),
        seconds=digits(verdict.seconds),
        stages=_stages(verdict),
        provenance=verdict.provenance.items(),
    )


def _ranking(verdict):
    """Return the Table of the explanations that were tried, each at its best place."""
    rows, known = [], set()
    for row in [each.to_values() for each in verdict.ranking[:MOST_ROWS]]:
        ids = tuple(sorted(row["ids"]))
        rows.append(
            {
                "effects": effects_in_words(row["ids"]),
                "where": ", ".join(map(place_in_words, (row.get("location") or "").split("+"))),
                "probability": chance_text(row.get("probability")),
                "score on held-out records": digits(row["heldout_score"]),
                "excess closed there": percent(row["closed_fraction"]),
                "judgement": judgement(verdict, row, ids not in known),
            }
        )
        known.add(ids)
    return table_of(rows, () if explanations_of(verdict) else ("probability",))


def _checks(verdict):
    """Return the Table of the checks of the campaign, the gravest first."""
    rows = sorted(verdict.checks, key=lambda row: LEVEL_ORDER[row.level])
    return table_of(
        {
            "check": row.check,
            "level": row.level,
            "record": row.record or "",
            "channel": row.channel or "",
            "finding": row.message,
        }
        for row in rows
    )


def _stages(verdict):
    """Return the Table of the cost of the stages, without rows if it is not known."""
    stages = {} if verdict.cost is None else verdict.cost.by_stage
    return table_of(
        {"stage": stage, "CPU time (s)": digits(cost.cpu_seconds), "simulations": cost.simulations}
        for stage, cost in stages.items()
    )


def _effects(verdict):
    """Return the Table of the effects that are shown, a row per parameter."""
    rows, shown = [], verdict.shown_effects()
    for effect in shown:
        known = EFFECTS.get(effect.id)
        head = {
            "effect": effects_in_words([effect.id]),
            "mechanism": known.explanation if known else "",
            "family": effect.family or "",
            "law fits": effect.law_fits or "",
            "where": place_in_words(effect.location or "all"),
        }
        if known and known.acts_on == "contact" and effect.location in ("all", ""):
            head["where"] = "all supports"
        for cells in [*map(_parameter, effect.parameters.items())] or [NO_PARAMETER]:
            rows.append({**head, **cells})
            head = dict.fromkeys(head, "")
    empty = [name for name in ("family", "law fits") if not any(row[name] for row in rows)]
    return table_of(rows, empty)


NO_PARAMETER = dict.fromkeys(("parameter", "value", "90 % interval", "unit"), "")


def _parameter(item):
    """Return the cells of a (name, value) of an effect."""
    name, value = item[0], for_reading(item[1])
    known = value["low"] is not None and value["high"] is not None
    return {
        "parameter": name.replace("_", " "),
        "value": digits(value["value"]),
        "90 % interval": span(value["low"], value["high"]) if known else "not known",
        "unit": unit_text(value["unit"]).strip() or "-",
    }


def _misfit(verdict):
    """Return the Table of the misfit of the records, before and after an effect was added."""
    rows, completed = [], bool(verdict.shown_effects())
    before = "misfit before (dB)" if completed else "misfit (dB)"
    for split, words in SPLITS.items():
        misfit: Misfit | None = getattr(verdict.misfit, split)
        if misfit is not None and misfit.before_dB is not None:
            rows.append(
                {
                    "records": words,
                    before: digits(misfit.before_dB),
                    "after (dB)": digits(misfit.after_dB),
                    "floor (dB)": digits(misfit.floor_dB),
                    "excess closed": percent(misfit.closed_fraction),
                }
            )
    return table_of(rows, () if completed else ("after (dB)", "excess closed"))


def _regions(verdict):
    """Return the Table of the bands that differ most."""
    return table_of(
        {
            "band (Hz)": " to ".join(digits(edge) for edge in region.band_Hz),
            "channel": region.channel,
            f"load ({verdict.load_unit} RMS)": digits(region.load_rms_N),
            "gap (mm)": digits(region.gap_m * 1e3) if region.gap_m is not None else "-",
            "measured / simulated (dB)": _signed(region.discrepancy_dB),
            "z": _signed(region.z),
        }
        for region in verdict.regions[:MOST_REGIONS]
    )


def _signed(value):
    """Return a number with its sign, - if there is none."""
    return "-" if value is None else f"{value:+.1f}"
