"""From a campaign and a model to a verdict."""

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
    share_right,
    weighed,
)
from .evidence import evidence_of
from .explanations import Structure
from .floor import floor_of
from .free_runs import FreeRuns, free_runs
from .free_search import far, free_search
from .identified.identified import PREDICTION, Identified, identified
from .identified.search import left_and_floor, search_laws
from .identified.structure_file import model_of
from .linear_records import with_linear_records
from .measurement.attached_model import with_channel_points
from .measurement.signals import signals_of
from .measurement.usable import Refused, checks_of_completed, not_testable, usable
from .next_measurement import next_measurement
from .search import Hypothesis, Search, search, search_from

EFFORTS = {"quick": 1, "standard": 2, "thorough": 3}  # effects at once, at most
REGIONS = 12
RANKING = ("ids", "location", "probability", "gain", "gain_apart", "error")
COMPLETED = "The model with the effects that the campaign shows to be missing; modes are corrected."
NOT_HELD = (
    "the sensors are too few to hold the model through its impacts. It is compared by its spectra"
    " alone; more sensors help, between the supports and in both directions."
)
SENSITIVE = (
    "The spectra of free runs are off with the model as given, and as measured once its"
    " frequencies, its damping and the force are changed within their uncertainty: the motion is"
    " sensitive to them, and no effect is asked for."
)
AT_REST = (
    "as measured and as simulated, less than 2 % of the speed of the fastest channel, and so not"
    " compared: a sensor picks up as much across its axis, and a force a degree off its direction"
    " makes as much."
)
BY_FREE_RUNS = (
    "The holding force does not show what is missing, spectra of free runs do: they compare"
    " statistics of a chaotic motion. The kind of the effect and its place are told, its value"
    " within the interval only."
)

Log = Callable[[str], None]
Rows = list[dict[str, Any]]


@dataclass(frozen=True, eq=False)
class Grounds:
    """What the verdict on a campaign that was compared rests on; checks: rows. own: the comparison
    with a model or, without one, the structure that was identified.
    """

    own: Comparison | Identified
    search: Search
    decision: Decision
    runs: FreeRuns
    checks: Rows

    @property
    def chosen(self) -> Hypothesis | None:
        """Return the hypothesis that the completed model holds, None for the model as given."""
        return added(self.decision)


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict, its Grounds, None if the campaign was refused, and the text of the completed
    model.
    """

    verdict: Verdict
    grounds: Grounds | None = None
    completed: str = "# not testable: the model is as it was\n"
    without_model: bool = False


def added(decision: Decision) -> Hypothesis | None:
    """Return the hypothesis that a Decision adds to the model, None if it adds none."""
    return None if decision.verdict in ("none", "unknown") else decision.best


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
    checks: Rows = []
    try:
        with costs("reading and checks"):
            found, checks = usable(campaign, config)
            whole = with_channel_points(config, found)
            comparison = Comparison(signals_of(found), Structure(whole, found), threads=threads)
            comparison = with_linear_records(comparison)
        with costs("free runs"):
            runs = free_runs(comparison.structure, comparison.signals)
        with costs("search"):
            comparison, searched, runs = _searched(comparison, runs, EFFORTS[effort], log)
    except Refused as refusal:
        return _refused(refusal, checks, provenance, costs)
    with costs("floor"):
        levels = _level_and_floor(comparison, searched)
    for first in searched.other_firsts if EFFORTS[effort] > 1 else ():
        if not levels[0] - levels[1] > LEFT:
            break
        with costs("search"):
            searched = search_from(comparison, searched, first, _seen_effects(comparison), log)
        with costs("floor"):
            levels = _level_and_floor(comparison, searched)
    with costs("free runs"):
        decision, runs = _run_free(searched, levels, runs, log)
        decision, runs = free_search(comparison, searched, decision, runs, log)
    grounds = Grounds(comparison, searched, decision, runs, checks)
    return _concluded(grounds, campaign, provenance, costs)


def _searched(
    comparison: Comparison, runs: FreeRuns, most: int, log: Log
) -> tuple[Comparison, Search, FreeRuns]:
    """Return (the Comparison that shows more, its Search, FreeRuns); runs: of the model as given.

    Some records hold the right model, but not one that lacks much. If nothing gains on the records
    that hold the given one, and its spectra are far off with the fitted nuisances too, the others
    are compared.
    """
    effects = _seen_effects(comparison)
    searched = search(comparison, most, effects, log)
    if gains(searched) or not far(runs):
        return comparison, searched, runs
    runs = runs.completed(searched.nothing.point)
    if comparison.lost and far(runs):
        log("nothing gains on the records that hold the model: the others are compared too")
        wider = comparison.widened()
        again = search(wider, most, effects, log)
        if gains(again):
            return wider, again, runs.as_given
    return comparison, searched, runs


def _seen_effects(comparison: Comparison) -> list[Effect]:
    """Return the effects of the catalogue that a campaign can show."""
    unseen = not_testable(comparison.structure.campaign)
    return [each for each in EFFECTS.values() if each.reported not in unseen]


def _level_and_floor(comparison: Comparison, searched: Search) -> tuple[float, float]:
    """Return the mean log power of the holding force with the best hypothesis, and its floor."""
    best = max([searched.nothing, *searched.hypotheses], key=lambda each: each.gain)
    return floor_of(comparison, best.fit)


def _run_free(
    searched: Search, levels: tuple[float, float], runs: FreeRuns, log: Log
) -> tuple[Decision, FreeRuns]:
    """Return (Decision on a Search, FreeRuns with its best hypothesis).

    Rivals share their probability by the spectra of their own free runs, too. If spectra are surely
    off with the best hypothesis, an effect is missing: then it may gain little, if it brings them
    as near as chance allows.
    """
    decision = decide(searched, *levels)
    if added(decision) is None:
        return decision, runs
    own = {each.point: runs.completed(each.point) for each in decision.rivals}
    if len(own) > 1:
        shares = [share_right(counted(_misfits(each)), True) for each in own.values()]
        log("rivals, by spectra: " + ", ".join(f"{share:.2f}" for share in shares))
        decision = weighed(decision, shares)
    best = decision.ranked[0][0]
    runs = own[best.point]
    if not runs.surely_off():
        return decision, runs
    wider = decide(searched, *levels, needed=lambda gained: LEAST_GAIN)
    if wider.best is not None and set(wider.best.ids) > set(best.ids):
        closer = runs.completed(wider.best.point)
        off = closer.surely_off()
        log(f"{wider.best.point.name}: {'off' if off else 'near'}, and off without the last effect")
        if not off:
            return wider, closer
    return replace(decision, surely_off=decision.verdict != "partly_explained"), runs


def _run_identified(
    campaign: xr.Dataset | str | Path,
    stated: MeasuredStructure,
    most: int,
    provenance: dict[str, Any] | None,
    log: Log,
) -> Diagnosis:
    """Return the Diagnosis of a structure that is identified from its own records."""
    costs = StageCosts()
    try:
        with costs("reading, checks and modes"):
            own, checks = identified(campaign, stated, log)
        with costs("search"):
            searched = search_laws(own, most, log)
            decision = decide(searched, *left_and_floor(own, searched))
            if added(decision) is not None:
                decision = own.completed(decision, checks)
        with costs("free runs"):
            runs = own.free_runs(added(decision))
    except Refused as refusal:
        return replace(_refused(refusal, [], provenance, costs), without_model=True)
    grounds = Grounds(own, searched, decision, runs, checks)
    return replace(_concluded(grounds, campaign, provenance, costs), without_model=True)


def write_diagnosis(diagnosis: Diagnosis, folder: str | Path) -> None:
    """Write verdict.json, ranking.csv, spectra.nc, evidence.nc and model_updated.yaml into a
    folder, and prediction.csv if there was no model.
    """
    folder, found = Path(folder), diagnosis.grounds
    write_verdict(diagnosis.verdict, folder / "verdict.json")
    ranking = [] if found is None else _ranking_table(found.decision)
    write_table(ranking, folder / "ranking.csv", columns=RANKING)
    untold = "no {}: the campaign can not be tested"
    if found is None:
        spectra, evidence = (
            xr.Dataset(attrs={"title": untold.format(name)}) for name in ("spectra", "evidence")
        )
    else:
        spectra, evidence = _spectra(found.runs), _evidence(found)
    write_record(spectra, folder / "spectra.nc")
    write_record(evidence, folder / "evidence.nc")
    write_text(diagnosis.completed, folder / "model_updated.yaml")
    if diagnosis.without_model:
        rows = []
        if found is not None and isinstance(found.own, Identified):
            rows = found.own.prediction(found.chosen)
        write_table(rows, folder / "prediction.csv", columns=PREDICTION)


def _spectra(runs: FreeRuns) -> xr.Dataset:
    """Return psd (state, record, channel, frequency): measured, and of free runs before and
    after.
    """
    signals = runs.signals
    values = np.stack([runs.measured, runs.before.mean(axis=1), runs.after.mean(axis=1)])
    return xr.Dataset(
        {
            "psd": (
                ("state", "record", "channel", "frequency"),
                values.astype(np.float32),
                {"units": "squared SI unit of the channel per Hz"},
            ),
            "compared": (("record", "channel"), runs.compared.astype(np.int8)),
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


def _evidence(found: Grounds) -> xr.Dataset:
    """Return the forces, laws and waveforms before and after completion, see evidence_of."""
    if isinstance(found.own, Identified):
        return found.own.evidence(found.chosen)
    nothing = found.search.nothing
    return evidence_of(found.own, nothing.point, (found.chosen or nothing).point)


def _refused(
    refusal: Refused, checks: Rows, provenance: dict[str, Any] | None, costs: StageCosts
) -> Diagnosis:
    """Return the Diagnosis of an untestable campaign; checks: rows before those of the refusal."""
    rows = _contract([*checks, *refusal.checks])
    return Diagnosis(not_testable_verdict(rows, provenance or {}, str(refusal), costs.total()))


def _contract(checks: Rows) -> Rows:
    """Return the rows of checks with the keys of the contract alone."""
    keys = ("check", "level", "record", "channel", "message")
    return [{key: row.get(key) for key in keys} for row in checks]


def _concluded(
    found: Grounds,
    campaign: xr.Dataset | str | Path,
    provenance: dict[str, Any] | None,
    costs: StageCosts,
) -> Diagnosis:
    """Return the Diagnosis of a campaign that was compared.

    An explanation that makes held-out records worse, or leaves them far off, is dropped: the
    verdict is unknown and states it as withdrawn, or is none if there was no excess. More runs
    confirm that this is not by chance.
    """
    misfits, effects, withdrawn = _misfits(found.runs), _effects(found), None
    decision = _verified(found, misfits)
    if decision.verdict != found.decision.verdict and found.runs.structure is not None:
        found = replace(found, runs=found.runs.repeated())
        misfits = _misfits(found.runs)
        decision = _verified(found, misfits)
    if decision.verdict == "none" and effects:  # refuted, and nothing is missing
        found = replace(found, runs=found.runs.as_given)
        misfits, effects = _misfits(found.runs), []
    elif decision.verdict == "unknown" and found.chosen is not None:
        withdrawn = {"effects": effects, "misfit": misfits}
    found = replace(found, decision=decision)
    failed, cost = list(found.search.failed), costs.total()
    content = {
        **_decided(decision, effects),
        "regions": [] if decision.verdict == "none" else found.runs.regions(REGIONS),
        "misfit": misfits,
        "p_global_before": None,
        "p_global_after": None,
        "checks": _contract(_checks(found, campaign)),
        "not_run": failed,
        "not_testable": (
            not_testable(found.own.structure.campaign) if isinstance(found.own, Comparison) else []
        ),
        "provenance": provenance or {},
        "load_unit": found.runs.signals.load_unit,
        "withdrawn": withdrawn,
        "cost": cost,
        "seconds": cost["cpu_seconds"],
        "simulations": cost["simulations"],
    }
    completed = not_offered(withdrawn) if withdrawn else _model_text(found)
    return Diagnosis(Verdict.from_values(content), found, completed)


def _verified(found: Grounds, misfits: dict[str, Any]) -> Decision:
    """Return the Decision given the distances of free runs; misfits: of the splits."""
    signals = found.runs.signals
    if isinstance(found.own, Comparison):
        records = signals.holdout() if len(signals.holdout()) else signals.fit()
        return beside_spectra(found.decision, misfits, found.runs.farther(records))
    worse = found.chosen is not None and makes_worse(counted(misfits))
    return refuted(found.decision) if worse else found.decision


def _misfits(runs: FreeRuns) -> dict[str, Any]:
    """Return `misfit` of verdict.json."""
    splits = {"fit": runs.signals.fit(), "holdout": runs.signals.holdout()}
    return {
        split: runs.distance(records) if len(records) else None for split, records in splits.items()
    }


def _effects(found: Grounds) -> list[dict[str, Any]]:
    """Return the rows of the effects of the best hypothesis, none if nothing is missing."""
    decision, own = found.decision, found.own
    if decision.best is None or decision.verdict == "none":
        return []
    fits = "yes" if decision.verdict in ("named", "ambiguous") else "no"
    if isinstance(own, Identified):
        rows = own.effect_rows(decision.best)
    else:
        rows = effect_rows(decision.best, own.signals)
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
    terms = decision.best.point.terms if named and decision.best else ()
    return {
        "verdict": conclusion,
        "effects": effects if named else [],
        "ambiguity_set": sets,
        "ambiguity_probability": chances,
        "probability_none": decision.nothing,
        "probability_something_else": decision.something_else,
        "ranking": ranking,
        "next_measurement": next_measurement(sets),
        "broken_invariances": sorted({test for term in terms for test in term.effect.broken}),
        "most_probable": effects,
    }


def _model_text(found: Grounds) -> str:
    """Return the text of the completed model, without effects if none is offered."""
    sentence, conclusion = COMPLETED, found.decision.verdict
    if found.chosen is None:
        sentence = f"The verdict is {conclusion}: no effect was added, modes are corrected."
    sentence += not_run_sentence(found.search.failed)
    point = (found.chosen or found.search.nothing).point
    if isinstance(found.own, Identified):
        return found.own.model_text(point, sentence)
    return completed_model(found.own.structure, point, sentence)


def _checks(found: Grounds, campaign: xr.Dataset | str | Path) -> Rows:
    """Return the rows of checks given the completed model, with those on records that do not hold
    the model, and on what free runs alone tell.
    """
    if isinstance(found.own, Identified):
        return found.checks
    rows, chosen, moved = found.checks, found.chosen, found.runs.after is not found.runs.before
    if chosen is not None:
        completed = found.own.structure.configuration(chosen.point.terms)
        rows = checks_of_completed(rows, campaign, completed)
    names = [str(found.own.signals.record_names[record]) for record in found.own.lost]
    lost = [check_row("not held", "warn", f"record {name}: {NOT_HELD}", name) for name in names]
    told = []
    if resting := ", ".join(found.runs.resting):
        told.append(check_row("at rest", "warn", f"{resting}: {AT_REST}"))
    if found.decision.verdict == "none" and moved:
        told.append(check_row("sensitive motion", "warn", SENSITIVE))
    elif found.decision.by_free_runs and chosen is not None:
        told.append(check_row("told by free runs", "warn", BY_FREE_RUNS))
    return [*rows, *lost, *told]


def _ranking_table(decision: Decision) -> list[dict[str, Any]]:
    """Return the rows of ranking.csv."""
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
