"""The last job: fresh seeds of the bare and the completed model, the maps before and after,
verdict.json, ranking.csv, and the model that runs.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import xarray as xr

from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.records import plain_values, write_record, write_table, write_text
from vibroimpact.verdict.content import (
    WITH_AMBIGUITY_SET,
    WITH_EFFECTS,
    Misfit,
    MisfitBySplit,
    Verdict,
    not_testable,
)
from vibroimpact.verdict.file import write_verdict

from . import jobs, mapping, misfit, naming, power_balance, priors, verdict
from .by_level import by_level
from .candidates import Pair, candidate_named
from .completed_model import not_offered, updated_model
from .cost import total_cost, with_cost
from .estimate_scatter import with_scatter
from .invariances import broken_invariances, one_sided_rows
from .law_directions import within_any_law
from .next_measurement import next_measurement
from .prepared import workbench
from .same_quantity import by_other_laws
from .survivors import survivors

FRESH = 20000  # first seed of the verification: none of the calibration's
FRESH_RUNS, LEAST_FRESH = 32, 4  # runs of whole records in all, seeds of each at least
BOUND = 0.02  # of a searched range: an estimate nearer to its end is at a bound


def refused(folder, prepared, provenance, cost):
    """Write the verdict of a campaign that can not be tested; cost: of verdict.json."""
    folder = Path(folder)
    empty = Misfit(before_dB=None, after_dB=None, floor_dB=None, closed_fraction=None)
    write_verdict(
        not_testable(
            contract_checks(prepared.checks),
            provenance,
            next_measurement=prepared.refusal,
            misfit=MisfitBySplit(fit=empty, holdout=empty),
            cost=cost,
        ),
        folder / "verdict.json",
    )
    write_table([], folder / "ranking.csv", columns=COLUMNS)
    for name in ("map", "map_after"):
        write_record(
            xr.Dataset(attrs={"title": "no map: the campaign can not be tested"}),
            folder / f"{name}.nc",
        )
    write_text("# not testable: the model is as it was\n", folder / "model_updated.yaml")


COLUMNS = (
    "ids",
    "location",
    "fit_score",
    "heldout_score",
    "closed_fraction",
    "threshold",
    "tested",
)


def contract_checks(rows):
    """Return the rows of checks with the keys of the contract alone."""
    return [
        {key: row.get(key) for key in ("check", "level", "record", "channel", "message")}
        for row in rows
    ]


def conclude(run, screening, final_files, provenance, meter, quick=False):
    """Decide, verify on fresh seeds, and write everything into the folder of a Run; screening:
    content of its file; meter: the cost.Meter of this job.
    """
    if run.refused:
        cost = total_cost([Path(run.folder) / "prepared.json"], meter.read())
        refused(run.folder, run.prepared, provenance, cost)
        return
    folder, prepared, bench, null = run.folder, run.prepared, run.bench, run.null
    found, totals = jobs.ordered(bench, null, jobs.known_finalists(final_files))
    measured = bench.measured_features[null.records]
    if found and isinstance(found[0].candidate, Pair) and not quick:
        found, totals = jobs.ordered(
            bench,
            null,
            jobs.best_of_each([*found, *by_other_laws(bench, null, measured, found[0], prepared)]),
        )
    p_before = mapping.global_p(bench, null, measured)
    decision = verdict.decide(bench, null, prepared, found, screening["threshold"], p_before)
    if decision.chosen is not None:
        chosen = with_scatter(bench, null, measured, decision.chosen)
        chosen = chosen if quick else within_any_law(bench, null, chosen, prepared.scales)
        found = [chosen if row is decision.chosen else row for row in found]
        decision = replace(decision, chosen=chosen)
    whole = before_bench = run.whole_bench
    seeds = (
        LEAST_FRESH
        if quick
        else max(LEAST_FRESH, min(priors.FINAL_SEEDS, FRESH_RUNS // len(bench.signals.load)))
    )
    if prepared.adopted is not None:
        before_bench = workbench(
            run.config, run.campaign, replace(prepared, adopted=None, fit=None), prepared.longest_s
        )
        # the null holds what was adopted; the model as given does not
    before = verified(before_bench, before_bench.model(), seeds, bench)
    if prepared.adopted is not None:
        p_before = mapping.global_p(bench, null, measured, before.compared[null.records], law=False)
    most_probable = verdict.effects_of(prepared, decision, bench.bare)
    decision, after, gaps, withdrawn = offered(run, decision, before, seeds)
    own = null if decision.chosen is None else decision.chosen.own(null)
    p_after = p_before
    if after is not before:
        p_after = mapping.global_p(bench, own, measured, after.compared[null.records])
    compared = mapping.z_of(before_bench, null, before.features)
    compared_after = compared
    if after is not before:
        law = None if decision.chosen is None else after.compared
        compared_after = mapping.z_of(whole, own, after.features, law)
    ranking = ranking_rows(run, found, totals, screening, decision, (before, gaps))
    spent = total_cost(outputs(run, final_files), meter.read())
    content = {
        "verdict": decision.verdict,
        "effects": (
            verdict.effects_of(prepared, decision, bench.bare)
            if decision.verdict in WITH_EFFECTS
            else []
        ),
        "ambiguity_set": (decision.ambiguity if decision.verdict in WITH_AMBIGUITY_SET else []),
        "ranking": [
            {
                "ids": row["ids"].split("+"),
                "heldout_score": row["heldout_score"],
                "closed_fraction": row["closed_fraction"],
                "location": row["location"],
            }
            for row in ranking
        ],
        "next_measurement": next_measurement(decision.ambiguity),
        "broken_invariances": broken_invariances(
            bench, null, prepared, power_balance.broken(before_bench, before.shown)
        ),
        # where the records together are within chance, no band of them is marked
        "regions": (
            []
            if decision.verdict == "none"
            else mapping.regions(before_bench, *compared[:2], misfit.counted(whole))
        ),
        "misfit": gaps,
        "p_global_before": p_before,
        "p_global_after": p_after,
        "checks": (
            contract_checks(prepared.checks)
            + bounds(decision, prepared)
            + one_sided_rows(bench, null, measured, after.compared[null.records])
        ),
        **with_cost(spent),
        "not_testable": prepared.not_testable,
        "linear": prepared.linear[:SHOWN],
        "explained_z": decision.explained.tolist(),
        "most_probable": most_probable,
        "provenance": provenance,
        "withdrawn": withdrawn,
    }
    write_verdict(Verdict.from_values(content), folder / "verdict.json")
    write_table(ranking, folder / "ranking.csv", columns=COLUMNS)
    for name, bench_of, runs, told in (
        ("map", before_bench, before, compared),
        ("map_after", whole, after, compared_after),
    ):
        mapped = mapping.map_dataset(bench_of, told, runs.features, runs.shown)
        write_record(mapped.assign_attrs(provenance), folder / f"{name}.nc")
    levels = (
        {}
        if decision.chosen is None
        else {
            decision.chosen.candidate.name: by_level(
                bench, null, measured, decision.chosen, prepared.scales
            )
        }
    )
    write_candidates(found, prepared, totals, folder / "candidates", levels)
    corrected = bench if decision.chosen is None else bench.corrected_by(decision.chosen.nuisance)
    nothing_added = after is before and withdrawn is not None
    write_text(
        not_offered(withdrawn) if nothing_added else updated_model(corrected, decision, prepared),
        folder / "model_updated.yaml",
    )


def offered(run, decision, before, seeds):
    """Return (Decision, Verified, {split: misfit}, withdrawn) of the model that is offered: what a
    Decision completes it with, less whatever makes records worse that took no part.

    withdrawn: content.Withdrawn in plain values of what was tried and is not offered, else None.
    """
    whole, bench, prepared = run.whole_bench, run.bench, run.prepared
    after, withdrawn = completed(run, decision, before, seeds), None
    gaps = None if after is None else misfits(whole, before, after)
    if gaps is None or verdict.refuted(decision, gaps):  # nothing is added then
        if gaps is not None and misfit.makes_worse(gaps["holdout"]):
            effects = verdict.effects_of(prepared, decision, bench.bare)
            withdrawn = {"effects": effects, "misfit": gaps}
        measured = bench.measured_features[run.null.records]
        decision = replace(
            decision,
            verdict="unknown",
            chosen=None,
            ambiguity=[],
            explained=naming.bare_explained(bench, run.null, measured),
        )
        after = completed(run, decision, before, seeds)
        gaps = misfits(whole, before, after)
        if misfit.makes_worse(gaps["holdout"]):  # so does what the lowest record alone told
            after, gaps = before, misfits(whole, before, before)
    return decision, after, gaps, withdrawn


SHOWN = 8


def outputs(run, final_files):
    """Return [file]: what the jobs of a Run made for this verdict, those of a bank not among it."""
    own = [file for file in run.path_files if Path(file).parents[1] == Path(run.folder)]
    jsons = [Path(run.folder) / f"{name}.json" for name in ("prepared", "screening", "pairs")]
    return [*jsons, *run.nulls, *own, *final_files]


def completed(run, decision, before, seeds):
    """Return the Verified of the model with what was adopted and what a Decision chose, `before`
    itself where that is nothing, None where whole records throw it off.
    """
    if decision.chosen is None and run.prepared.adopted is None:
        return before
    whole, chosen = run.whole_bench, decision.chosen
    if chosen is None:
        return verified(whole, whole.model(), seeds, run.bench)
    whole = whole.corrected_by(chosen.nuisance)
    try:
        return verified(
            whole,
            whole.model(
                whole.variant(
                    chosen.candidate, chosen.candidate.physical(chosen.unit, run.prepared.scales)
                )
            ),
            seeds,
            run.bench,
        )
    except IntegrationError:
        return None


def misfits(whole, before, after):
    """Return {split: misfit.misfit_of} of what two Verified leave, nothing known where a split has
    no records.
    """
    cells = misfit.counted(whole)
    splits = {
        "fit": whole.signals.fit(),
        "holdout": whole.signals.holdout(),
    }
    return {
        name: (
            misfit.misfit_of(
                whole,
                records,
                cells,
                before.features.mean(axis=1),
                after.features.mean(axis=1),
                after.features,
            )
            if len(records)
            else {"before_dB": None, "after_dB": None, "floor_dB": None, "closed_fraction": None}
        )
        for name, records in splits.items()
    }


@dataclass(frozen=True)
class Verified:
    """Fresh seeds of a model on whole records: features (record, seed, feature); compared (record,
    feature): their mean over what candidates were calibrated on; shown (record, shown seed,
    channel, sample): responses with noise.
    """

    features: np.ndarray
    compared: np.ndarray
    shown: np.ndarray


def verified(whole, model, seeds, bench):
    """Return the Verified of a model on the Workbench of whole records; bench: that of what was
    compared.
    """
    records = len(whole.signals.load)
    runs = whole.runs(range(records), seeds, FRESH)
    responses = whole.respond(model, runs)
    features, compared = (
        window.noisy_features(runs, responses).reshape(records, seeds, -1)
        for window in (whole, bench)
    )
    stayed = survivors(features)
    features, compared = (
        np.take_along_axis(rows, stayed[..., None], axis=1) for rows in (features, compared)
    )
    responses = responses.reshape(records, seeds, *responses.shape[1:])[
        np.arange(records)[:, None], stayed[:, : mapping.SHOWN_SEEDS]
    ]
    noise = np.random.default_rng(11).standard_normal(
        responses.shape, dtype=np.float32
    ) * whole.signals.noise[:, None].astype(np.float32)
    shown = np.where(np.isfinite(whole.signals.force[:, :1])[:, None], responses + noise, np.nan)
    return Verified(features, compared.mean(axis=1), shown)


def ranking_rows(run, found, totals, screening, decision, verified_misfit):
    """Return the rows of ranking.csv: what was simulated directly, what the decision chose and then
    the best first, then what was screened, then linear effects that were not adopted.

    verified_misfit: (Verified of the model as given, {split: misfit} of the completed one).
    closed_fraction is that of the misfit on the records that took no part, by fresh seeds on whole
    records for what completes the model, by the runs of its search for all others.
    """
    bench, null, prepared = run.bench, run.null, run.prepared
    before, gaps = verified_misfit
    split = "holdout" if len(bench.signals.holdout()) else "fit"
    rows, seen = [], set()
    prefix = [] if prepared.adopted is None else candidate_named(prepared.adopted["name"]).ids
    for row in found:
        ids = [*([] if row.candidate.alone else prefix), *row.candidate.ids]
        gain, on_fit, held_out = totals[row.candidate.name]
        rows.append(
            {
                "ids": "+".join(ids),
                "location": where(row.candidate.name),
                "fit_score": on_fit,
                "heldout_score": held_out,
                "closed_fraction": (
                    gaps[split]["closed_fraction"]
                    if row is decision.chosen
                    else closed_by(bench, null, before, row.features)
                ),
                "threshold": screening["threshold"],
                "tested": True,
                "gain": np.inf if row is decision.chosen else gain,
            }
        )
        seen.add(row.candidate.name)
    if prefix:
        alone = decision.chosen is None and decision.verdict != "unknown"
        only = {
            "ids": "+".join(prefix),
            "location": where(prepared.adopted["name"]),
            "fit_score": 0.0,
            "heldout_score": 0.0,  # all others are scored against it
            "closed_fraction": (
                gaps[split]["closed_fraction"]
                if alone
                else closed_by(bench, null, before, null.features)
            ),
            "threshold": priors.LINEAR_GAIN,
            "tested": True,
            "gain": np.inf if alone else screening["threshold"],
        }
        rows.append(only)
    rows.sort(key=lambda row: -row["gain"])
    for row in screening["ranked"]:
        if row["name"] not in seen:
            candidate = candidate_named(row["name"])
            ids = [*([] if candidate.alone else prefix), *candidate.ids]
            rows.append(
                {
                    "ids": "+".join(ids),
                    "location": where(row["name"]),
                    "fit_score": row["score"],
                    "heldout_score": None,
                    "closed_fraction": None,
                    "threshold": screening["threshold"],
                    "tested": False,
                }
            )
    known = (
        0.0 if prepared.adopted is None else prepared.adopted["gain"]
    )  # against the model with it, as all others
    for row in prepared.linear[:SHOWN]:
        if prepared.adopted is None or row["name"] != prepared.adopted["name"]:
            rows.append(
                {
                    "ids": "+".join(candidate_named(row["name"]).ids),
                    "location": where(row["name"]),
                    "fit_score": row["gain"] - known,
                    "heldout_score": None,
                    "closed_fraction": None,
                    "threshold": priors.LINEAR_GAIN,
                    "tested": True,
                }
            )
    return [{key: row[key] for key in COLUMNS} for row in rows]


def closed_by(bench, null, before, features):
    """Return the closed share of the misfit on the records that took no part, by features (record
    of the null, seed, feature) of a model; before: Verified of the model as given.
    """
    records = np.intersect1d(misfit.judged(bench.signals), null.records)
    if not len(records):
        return None
    runs = np.zeros((len(before.compared), *features.shape[1:]))
    runs[null.records] = features
    cells = misfit.counted(bench)
    told = misfit.misfit_of(bench, records, cells, before.compared, runs.mean(axis=1), runs)
    return told["closed_fraction"]


def where(name):
    """Return the location in a candidate's name, both of a pair's joined with a plus; with its law
    where the catalogue has several of one effect.
    """
    places = []
    for part in name.split("+"):
        candidate = candidate_named(part)
        places.append(
            candidate.location
            + (f", {candidate.effect_id.replace('_', ' ')}" if candidate.effect.law_of else "")
        )
    return "+".join(places)


def bounds(decision, prepared):
    """Return rows of checks for estimates at a bound of their range."""
    if decision.chosen is None:
        return []
    parameters = decision.chosen.candidate.effect.parameters
    return [
        {
            "check": "bounds",
            "level": "warn",
            "record": None,
            "channel": None,
            "message": (
                f"{parameter.name} of {decision.chosen.candidate.name} is at a bound of its range."
            ),
        }
        for value, parameter in zip(decision.chosen.unit, parameters, strict=True)
        if min(value, 1.0 - value) < BOUND and parameter.name != "angle"
    ]


def write_candidates(found, prepared, totals, folder, levels):
    """Write candidates/<name>.json: parameters with their intervals, the score along each of them
    and the values that were simulated, and levels {name: see by_level}.
    """
    for row in found:
        parts = (
            [(row.candidate.first, 0), (row.candidate.second, row.candidate.split)]
            if isinstance(row.candidate, Pair)
            else [(row.candidate, 0)]
        )
        profile, parameters = [], {}
        for candidate, offset in parts:
            own = slice(offset, offset + len(candidate.effect.parameters))
            unit, interval = row.unit[own], np.array(row.interval[own])
            simulated = [
                candidate.physical(point, prepared.scales) for point in row.path.parameters[:, own]
            ]
            estimate = candidate.estimate(unit, interval, prepared.scales)
            for number, parameter in enumerate(candidate.effect.parameters):
                values, score = row.profile[offset + number]
                sizes = []
                for value in values:
                    moved = unit.copy()
                    moved[number] = value
                    sizes.append(candidate.physical(moved, prepared.scales)[parameter.name])
                name = (
                    parameter.name
                    if len(parts) == 1
                    else f"{candidate.effect.reported}.{parameter.name}"
                )
                profile.append(
                    {
                        "parameter": name,
                        "unit": parameter.unit,
                        "values": sizes,
                        "score": score.tolist(),
                        "simulated": sorted({point[parameter.name] for point in simulated}),
                    }
                )
                parameters[name] = dict(
                    zip(("value", "low", "high"), estimate[parameter.name], strict=True)
                ) | {"unit": parameter.unit}
        content = {
            "ids": row.candidate.ids,
            "name": row.candidate.name,
            "gain": totals[row.candidate.name][0],
            "profile": profile,
            "parameters": parameters,
            "by_level": levels.get(row.candidate.name, []),
        }
        write_text(
            json.dumps(plain_values(content), indent=1),
            folder / f"{row.candidate.name.replace('@', '_at_').replace('+', '_and_')}.json",
        )
