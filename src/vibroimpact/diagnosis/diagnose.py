"""From a campaign and a model to a verdict."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.config.schema import Config
from vibroimpact.diagnosis.run_cost import StageCosts
from vibroimpact.diagnosis.verdict.content import (
    WITH_AMBIGUITY_SET,
    WITH_EFFECTS,
    Misfit,
    MisfitBySplit,
    Verdict,
    not_run_sentence,
    write_verdict,
)
from vibroimpact.diagnosis.verdict.content import not_testable as not_testable_verdict
from vibroimpact.diagnosis.verdict.misfit import makes_worse, not_offered
from vibroimpact.effects.effect import Effect
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.io.records import write_record, write_table, write_text

from .comparison import Comparison
from .completed import completed_model, effect_rows
from .constants import LEAST_GAIN, LEFT
from .decision import (
    Decision,
    ambiguity,
    beside_spectra,
    counted,
    decide,
    gains,
    refuted,
)
from .evidence import evidence_of
from .explanations import Point, Structure
from .floor import floor_of
from .free_runs import FreeRuns, distance, distances, free_runs, regions, surely_off, with_after
from .free_search import far, free_search
from .identified.identified import PREDICTION, Identified, identified
from .identified.search import left_and_floor, search_laws
from .identified.structure_file import model_of
from .linear_records import with_linear_records
from .measurement.attached_model import with_channel_points
from .measurement.signals import Signals, signals_of
from .measurement.usable import Refused, checks_of_completed, not_testable, usable
from .next_measurement import next_measurement
from .search import Hypothesis, Search, search, search_from

EFFORTS = {"quick": 1, "standard": 2, "thorough": 3}  # effects at once, at most
REGIONS = 12
RANKING = ("ids", "location", "probability", "gain", "gain_apart", "error")

Log = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict and its grounds, which are None if the campaign was refused."""

    verdict: Verdict
    comparison: Comparison | None = None
    identified: Identified | None = None  # in place of a comparison, if there is no model
    signals: Signals | None = None
    search: Search | None = None
    decision: Decision | None = None
    runs: FreeRuns | None = None
    completed: str = "# not testable: the model is as it was\n"
    without_model: bool = False

    @property
    def chosen(self) -> Hypothesis | None:
        """Return the hypothesis that the completed model holds, None for the model as given."""
        if self.decision is None or self.verdict.verdict in ("none", "unknown"):
            return None
        return self.decision.best


def diagnose(
    campaign: xr.Dataset | str | Path,
    model: Config | MeasuredStructure | str | Path,
    effort: str = "standard",
    threads: int = 1,
) -> Verdict:
    """Return the Verdict on the effects that a model lacks, given a measured campaign.

    campaign: a campaign Dataset, or the path of its file. model: a checked Config, the path of a
    configuration, or "identified": modes are identified from the campaign; known facts of such a
    structure are in a MeasuredStructure or its file. effort: "quick" looks for one effect,
    "standard" for two, "thorough" for three at once; for "identified" both add all that gain.
    threads: runs at a time; no number depends on it.

    A campaign that can not be compared gives the verdict "not_testable". Raises ConfigError for a
    configuration that can not be used, ValueError for another effort.
    """
    return run_diagnosis(campaign, model, effort, threads).verdict


def run_diagnosis(
    campaign: xr.Dataset | str | Path,
    model: Config | MeasuredStructure | str | Path,
    effort: str = "standard",
    threads: int = 1,
    provenance: dict[str, Any] | None = None,
    log: Log = lambda text: None,
) -> Diagnosis:
    """Return the Diagnosis; arguments as of `diagnose`. provenance: of verdict.json. log: receives
    a line for each fitted hypothesis.
    """
    if effort not in EFFORTS:
        raise ValueError(f"effort = '{effort}': give one of {', '.join(EFFORTS)}")
    config = model_of(model)
    if isinstance(config, MeasuredStructure):
        return _run_identified(campaign, config, EFFORTS[effort], provenance or {}, log)
    costs = StageCosts()
    checks: list[dict[str, Any]] = []
    try:
        with costs("reading and checks"):
            found, checks = usable(campaign, config)
            whole = with_channel_points(config, found)
            comparison = Comparison(signals_of(found), Structure(whole, found), threads=threads)
            comparison = with_linear_records(comparison)
        with costs("free runs"):
            runs = free_runs(comparison.structure, comparison.signals, None)
        with costs("search"):
            comparison, searched, runs = _searched(comparison, runs, EFFORTS[effort], log)
    except Refused as refusal:
        return Diagnosis(_refused(refusal, checks, provenance or {}, costs))
    with costs("floor"):
        level, floor = _level_and_floor(comparison, searched)
    for first in searched.other_firsts if EFFORTS[effort] > 1 else ():
        if not level - floor > LEFT:
            break
        with costs("search"):
            searched = search_from(comparison, searched, first, _seen_effects(comparison), log)
        with costs("floor"):
            level, floor = _level_and_floor(comparison, searched)
    with costs("free runs"):
        decision, runs = _run_free(comparison, searched, (level, floor), runs, log)
        decision, runs = free_search(comparison, searched, decision, runs, log)
    return _concluded(
        _Found(
            *(comparison.signals, searched, decision, runs, checks, provenance or {}, comparison),
            campaign=campaign,
        ),
        costs.total(),
    )


def _searched(
    comparison: Comparison, runs: FreeRuns, most: int, log: Log
) -> tuple[Comparison, Search, FreeRuns]:
    """Return (the Comparison that shows more, its Search, FreeRuns); runs: of the model as given.

    Some records hold the right model, but not one that lacks much. If nothing gains on the records
    that hold the given one, and its spectra are far off with the fitted nuisances too, the others
    are compared.
    """
    signals, effects = comparison.signals, _seen_effects(comparison)
    searched = search(comparison, most, effects, log)
    if gains(searched) or not far(runs, signals):
        return comparison, searched, runs
    runs = with_after(runs, comparison.structure, signals, searched.nothing.point)
    if comparison.lost and far(runs, signals):
        log("nothing gains on the records that hold the model: the others are compared too")
        wider = comparison.widened()
        again = search(wider, most, effects, log)
        if gains(again):
            return wider, again, replace(runs, after=runs.before)
    return comparison, searched, runs


def _seen_effects(comparison: Comparison) -> list[Effect]:
    """Return the effects of the catalogue that a campaign can show."""
    unseen = not_testable(comparison.structure.campaign)
    return [each for each in EFFECTS.values() if each.reported not in unseen]


def _level_and_floor(comparison: Comparison, searched: Search) -> tuple[float, float]:
    """Return the mean log power of the holding force with the best hypothesis, and its floor."""
    best = max(searched.hypotheses, key=lambda each: each.gain, default=searched.nothing)
    return floor_of(comparison, best.fit)


def _run_free(
    comparison: Comparison,
    searched: Search,
    levels: tuple[float, float],
    runs: FreeRuns,
    log: Log,
) -> tuple[Decision, FreeRuns]:
    """Return (Decision on a Search, FreeRuns with its best hypothesis).

    If spectra are surely off with the best hypothesis, an effect is missing: then it may gain
    little, if it brings them as near as chance allows.
    """
    decision = decide(searched, *levels)
    if decision.verdict in ("none", "unknown") or decision.best is None:
        return decision, runs
    runs, off = _with_best(comparison, decision, runs)
    if not off:
        return decision, runs
    wider = decide(searched, *levels, needed=lambda gained: LEAST_GAIN)
    if wider.best is not None and set(wider.best.ids) > set(decision.best.ids):
        closer, off = _with_best(comparison, wider, runs)
        log(f"{wider.best.point.name}: {'off' if off else 'near'}, and off without the last effect")
        if not off:
            return wider, closer
    return replace(decision, surely_off=decision.verdict != "partly_explained"), runs


def _with_best(
    comparison: Comparison, decision: Decision, runs: FreeRuns
) -> tuple[FreeRuns, list[int]]:
    """Return (FreeRuns with the best hypothesis, the records that are surely off with it)."""
    assert decision.best is not None
    signals, structure, point = comparison.signals, comparison.structure, decision.best.point
    runs = with_after(runs, structure, signals, point)
    return runs, surely_off(runs, structure, signals, point, range(len(signals.load)))


def _run_identified(
    campaign: xr.Dataset | str | Path,
    stated: MeasuredStructure,
    most: int,
    provenance: dict[str, Any],
    log: Log,
) -> Diagnosis:
    """Return the Diagnosis of a structure that is identified from its own records."""
    costs = StageCosts()
    try:
        with costs("reading, checks and modes"):
            own, checks = identified(campaign, stated, log)
            signals = replace(signals_of(own.campaign), band_Hz=own.band_Hz)
        with costs("search"):
            searched = search_laws(own.setting, most, log)
            decision = decide(searched, *left_and_floor(own.setting, searched))
            if decision.verdict not in ("none", "unknown"):
                decision = own.completed(decision, checks)
        with costs("free runs"):
            chosen = None if decision.verdict in ("none", "unknown") else decision.best
            runs = own.free_runs(chosen)
    except Refused as refusal:
        return Diagnosis(_refused(refusal, [], provenance, costs), without_model=True)
    return _concluded(
        _Found(signals, searched, decision, runs, checks, provenance, identified=own),
        costs.total(),
    )


@dataclass(frozen=True, eq=False)
class _Found:
    """The results of the stages."""

    signals: Signals
    searched: Search
    decision: Decision
    runs: FreeRuns
    checks: list[dict[str, Any]]
    provenance: dict[str, Any]
    comparison: Comparison | None = None
    identified: Identified | None = None
    campaign: xr.Dataset | str | Path | None = None

    def checks_with(self, decision: Decision) -> list[dict[str, Any]]:
        """Return the rows of checks, given the model that a Decision completes."""
        if self.comparison is None or decision.best is None or self.campaign is None:
            return self.checks
        if decision.verdict in ("none", "unknown"):
            return self.checks
        completed = self.comparison.structure.configuration(decision.best.point.terms)
        return checks_of_completed(self.checks, self.campaign, completed)

    def effect_rows(self, hypothesis: Hypothesis) -> list[dict[str, Any]]:
        """Return the rows of the effects of a hypothesis."""
        if self.identified is not None:
            return self.identified.effect_rows(hypothesis)
        return effect_rows(hypothesis, self.signals)

    def model_text(self, point: Point, sentence: str) -> str:
        """Return the text of the completed model."""
        if self.comparison is not None:
            return completed_model(self.comparison.structure, point, sentence)
        return self.identified.model_text(point, sentence) if self.identified is not None else ""

    def not_testable(self) -> list[str]:
        """Return the effects that the campaign can not show."""
        return not_testable(self.comparison.structure.campaign) if self.comparison else []


def write_diagnosis(diagnosis: Diagnosis, folder: str | Path) -> None:
    """Write verdict.json, ranking.csv, spectra.nc, evidence.nc and model_updated.yaml into a
    folder.
    """
    folder = Path(folder)
    write_verdict(diagnosis.verdict, folder / "verdict.json")
    write_table(_ranking_table(diagnosis.decision), folder / "ranking.csv", columns=RANKING)
    write_record(spectra(diagnosis), folder / "spectra.nc")
    write_record(evidence(diagnosis), folder / "evidence.nc")
    write_text(diagnosis.completed, folder / "model_updated.yaml")
    if diagnosis.without_model:
        own = diagnosis.identified
        rows = [] if own is None else own.prediction(diagnosis.chosen)
        write_table(rows, folder / "prediction.csv", columns=PREDICTION)


def spectra(diagnosis: Diagnosis) -> xr.Dataset:
    """Return psd (state, record, channel, frequency): measured, and of free runs before and
    after.
    """
    runs, signals = diagnosis.runs, diagnosis.signals
    if runs is None or signals is None:
        return xr.Dataset(attrs={"title": "no spectra: the campaign can not be tested"})
    values = np.stack([runs.measured, runs.before.mean(axis=1), runs.after.mean(axis=1)])
    return xr.Dataset(
        {
            "psd": (
                ("state", "record", "channel", "frequency"),
                values.astype(np.float32),
                {"units": "squared SI unit of the channel per Hz"},
            ),
            "load": ("record", signals.load, {"units": signals.load_unit}),
            "record_name": ("record", list(signals.record_names)),
            "channel_name": ("channel", list(signals.names)),
            "channel_kind": ("channel", [str(kind) for kind in signals.kinds]),
            "split": ("record", [str(split) for split in signals.split]),
        },
        coords={
            "state": ["measured", "before", "after"],
            "frequency": ("frequency", runs.frequency, {"units": "Hz"}),
        },
    )


def evidence(diagnosis: Diagnosis) -> xr.Dataset:
    """Return the evidence of a diagnosis: forces, laws, waveforms; see evidence.evidence_of."""
    if diagnosis.identified is not None:
        return diagnosis.identified.evidence(diagnosis.chosen)
    if diagnosis.comparison is None or diagnosis.search is None:
        return xr.Dataset(attrs={"title": "no evidence: the campaign can not be tested"})
    chosen = diagnosis.chosen
    after = diagnosis.search.nothing.point if chosen is None else chosen.point
    return evidence_of(diagnosis.comparison, diagnosis.search.nothing.point, after)


def _refused(refusal: Refused, checks, provenance, costs) -> Verdict:
    """Return the verdict on an untestable campaign; checks: rows before those of the refusal."""
    empty = Misfit(before_dB=None, after_dB=None, floor_dB=None, closed_fraction=None)
    return not_testable_verdict(
        _contract([*checks, *refusal.checks]),
        provenance,
        next_measurement=str(refusal),
        misfit=MisfitBySplit(fit=empty, holdout=empty),
        cost=costs.total(),
    )


def _contract(checks):
    """Return the rows of checks with the keys of the contract alone."""
    keys = ("check", "level", "record", "channel", "message")
    return [{key: row.get(key) for key in keys} for row in checks]


def _concluded(found: _Found, cost: dict[str, Any]) -> Diagnosis:
    """Return the Diagnosis of a campaign that was compared.

    An explanation that makes held-out records worse, or leaves them far off, is dropped: the
    verdict is unknown and states it as withdrawn, or is none if there was no excess.
    """
    misfits, effects, withdrawn = _misfits(found), _effects(found), None
    decision = _verified(found, misfits)
    if decision.verdict == "none" and effects:  # refuted, and nothing is missing
        found = replace(found, decision=decision, runs=replace(found.runs, after=found.runs.before))
        misfits, effects = _misfits(found), []
    elif decision.verdict == "unknown" and found.decision.verdict not in ("none", "unknown"):
        withdrawn = {"effects": effects, "misfit": misfits}
    checks = [*found.checks_with(decision), *_lost_rows(found), *_free_rows(decision, found)]
    content = {
        **_decided(decision, effects),
        "regions": (
            [] if decision.verdict == "none" else regions(found.runs, found.signals, REGIONS)
        ),
        "misfit": misfits,
        "p_global_before": None,
        "p_global_after": None,
        "checks": _contract(checks),
        "not_run": list(found.searched.failed),
        "not_testable": found.not_testable(),
        "provenance": found.provenance,
        "load_unit": found.signals.load_unit,
        "withdrawn": withdrawn,
        "cost": cost,
        "seconds": cost["cpu_seconds"],
        "simulations": cost["simulations"],
    }
    completed = (
        not_offered(withdrawn)
        if withdrawn
        else found.model_text(
            _offered(found.searched, decision),
            _sentence(decision.verdict) + not_run_sentence(found.searched.failed),
        )
    )
    return Diagnosis(
        Verdict.from_values(content),
        found.comparison,
        found.identified,
        found.signals,
        found.searched,
        decision,
        found.runs,
        completed,
        found.identified is not None,
    )


def _verified(found: _Found, misfits: dict[str, Any]) -> Decision:
    """Return the Decision given the distances of free runs; misfits: of the splits."""
    told = counted(found.decision, misfits)
    if found.comparison is not None:
        return beside_spectra(found.decision, told, distances(found.runs, found.signals))
    worse = found.decision.verdict not in ("none", "unknown") and makes_worse(told)
    return refuted(found.decision) if worse else found.decision


def _misfits(found: _Found) -> dict[str, Any]:
    """Return `misfit` of verdict.json."""
    signals = found.signals
    return {
        split: distance(found.runs, signals, records) if len(records) else None
        for split, records in (("fit", signals.fit()), ("holdout", signals.holdout()))
    }


def _effects(found: _Found) -> list[dict[str, Any]]:
    """Return the rows of the effects of the best hypothesis, none if nothing is missing."""
    decision = found.decision
    if decision.best is None or decision.verdict == "none":
        return []
    fits = "yes" if decision.verdict in ("named", "ambiguous") else "no"
    rows = found.effect_rows(decision.best)
    return [row | {"law_fits": fits} for row in rows]


def _decided(decision: Decision, effects: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the part of verdict.json on the missing effects and their probabilities."""
    conclusion = decision.verdict
    named = conclusion in WITH_EFFECTS
    sets, chances = ambiguity(decision) if conclusion in WITH_AMBIGUITY_SET else ([], [])
    ranking = [
        {
            "ids": row["ids"].split("+"),
            "heldout_score": row["gain_apart"],
            "closed_fraction": None,
            "location": row["location"],
            "probability": row["probability"],
        }
        for row in _ranking_table(decision)
    ]
    broken = {
        test
        for term in (decision.best.point.terms if named and decision.best else ())
        for test in term.effect.broken
    }
    return {
        "verdict": conclusion,
        "effects": effects if named else [],
        "ambiguity_set": sets,
        "ambiguity_probability": chances,
        "probability_none": decision.nothing,
        "probability_something_else": decision.something_else,
        "ranking": ranking,
        "next_measurement": next_measurement(sets),
        "broken_invariances": sorted(broken),
        "most_probable": effects,
    }


def _offered(searched: Search, decision: Decision) -> Point:
    """Return the Point of the completed model, without effects if none is offered."""
    if decision.verdict in ("none", "unknown") or decision.best is None:
        return searched.nothing.point
    return decision.best.point


def _sentence(conclusion):
    """Return the sentence at the head of the file of the completed model."""
    if conclusion in ("none", "unknown"):
        return f"The verdict is {conclusion}: no effect was added, modes are corrected."
    return "The model with the effects that the campaign shows to be missing; modes are corrected."


def _lost_rows(found: _Found) -> list[dict[str, Any]]:
    """Return the rows of checks for records that do not hold the model."""
    lost = () if found.comparison is None else found.comparison.lost
    names = [str(found.signals.record_names[record]) for record in lost]
    return [
        check_row(
            "not held",
            "warn",
            f"record {name}: the sensors are too few to hold the model through its impacts. It is"
            " compared by its spectra alone; more sensors help, between the supports and in both"
            " directions.",
            record=name,
        )
        for name in names
    ]


def _free_rows(decision: Decision, found: _Found) -> list[dict[str, Any]]:
    """Return the row of checks for an effect that only spectra of free runs show, or for spectra
    that only the fitted nuisances bring to their floor.
    """
    moved = found.comparison is not None and found.runs.after is not found.runs.before
    if decision.verdict == "none" and moved:
        sentence = (
            "The spectra of free runs are off with the model as given, and as measured once its"
            " frequencies, its damping and the force are changed within their uncertainty: the"
            " motion is sensitive to them, and no effect is asked for."
        )
        return [check_row("sensitive motion", "warn", sentence)]
    if not decision.by_free_runs or decision.verdict in ("none", "unknown"):
        return []
    sentence = (
        "The holding force does not show what is missing, spectra of free runs do: they compare"
        " statistics of a chaotic motion. The kind of the effect and its place are told, its value"
        " within the interval only."
    )
    return [check_row("told by free runs", "warn", sentence)]


def _ranking_table(decision: Decision | None) -> list[dict[str, Any]]:
    """Return the rows of ranking.csv."""
    if decision is None:
        return []
    return [
        {
            "ids": "+".join(each.point.ids),
            "location": "+".join(term.location for term in each.point.terms),
            "probability": chance,
            "gain": each.gain,
            "gain_apart": each.apart,
            "error": each.error,
        }
        for each, chance in decision.ranked
    ]
