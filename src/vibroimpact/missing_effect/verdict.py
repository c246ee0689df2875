"""The files of a verdict: verdict.json, ranking.csv, the maps before and after, the candidates and
the model that runs.
"""

from pathlib import Path
from typing import Any

import numpy as np

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.discrepancy import discrepancy_map as mapping
from vibroimpact.discrepancy import power_balance
from vibroimpact.discrepancy.completed_model import not_offered
from vibroimpact.discrepancy.invariances import broken_invariances, one_sided_rows
from vibroimpact.discrepancy.next_measurement import next_measurement
from vibroimpact.effects.effect import Values
from vibroimpact.linear_stage.counted_cells import counted
from vibroimpact.linear_stage.prepared import Prepared
from vibroimpact.records import write_record, write_table, write_text
from vibroimpact.verdict.content import (
    WITH_AMBIGUITY_SET,
    WITH_EFFECTS,
    Verdict,
)
from vibroimpact.verdict.file import write_verdict

from . import candidate_files
from .decision import Decision, partly_decision, withdrawn_decision
from .null import Null
from .ranking import COLUMNS, ranking_rows
from .rows import SHOWN, bounds, contract_checks, effects_of
from .search import Search
from .updated_model import updated_model
from .verification import Closing, without_chosen


def write(
    folder: Path,
    prepared: Prepared,
    search: Search,
    found: tuple[Decision, Closing],
    cost: dict[str, Any],
    provenance: Values,
) -> None:
    """Write everything into the folder; found: the Decision and its Closing; cost: that of
    verdict.json.
    """
    (decision, closed), bench = found, search.bench
    withdrawn = None
    stands_for_family = decision.family_alone and closed.partial
    if decision.chosen is not None and (closed.no_part or stands_for_family):
        withdrawn = {
            "effects": effects_of(prepared, decision, bench.bare),
            "misfit": closed.misfit,
        }
        decision = withdrawn_decision(decision)
        closed = without_chosen(closed, bench)
    elif closed.partial:
        decision = partly_decision(decision)
    given, whole = closed.benches
    compared = mapping.z_of(given, search.null, closed.before.features)
    after = compared
    if closed.after is not closed.before:
        law = None if decision.chosen is None else closed.after.compared
        after = mapping.z_of(whole, search.null, closed.after.features, law)
    ranking = ranking_rows(search, prepared, decision, closed)
    content = {
        **decision_rows(search, prepared, decision, ranking),
        **evidence_rows(search, prepared, decision, closed, compared),
        "cost": cost,
        "seconds": cost["cpu_seconds"],
        "simulations": cost["simulations"],
        "withdrawn": withdrawn,
        "load_unit": bench.signals.load_unit,
        "provenance": provenance,
    }
    write_verdict(Verdict.from_values(content), folder / "verdict.json")
    write_table(ranking, folder / "ranking.csv", columns=COLUMNS)
    for name, of, runs, told in (
        ("map", given, closed.before, compared),
        ("map_after", whole, closed.after, after),
    ):
        mapped = mapping.map_dataset(of, told, runs.features, runs.shown)
        write_record(mapped.assign_attrs(plain_attributes(provenance)), folder / f"{name}.nc")
    candidate_files.write(search, decision, folder / "candidates")
    write_text(
        not_offered(withdrawn)
        if withdrawn is not None and decision.verdict == "unknown" and closed.after is closed.before
        else updated_model(bench, decision, prepared),
        folder / "model_updated.yaml",
    )


def decision_rows(
    search: Search, prepared: Prepared, decision: Decision, ranking: list[Values]
) -> Values:
    """Return the part of verdict.json that says what is missing, and how sure that is."""
    effects = effects_of(prepared, decision, search.bench.bare)
    chosen = decision.chosen
    fitting = "not tested" if chosen is None else "yes" if chosen.law_fits else "no"
    own = set() if chosen is None else set(chosen.candidate.ids)
    for row in effects:
        row["law_fits"] = fitting if row["id"] in own else "yes"
    filled = decision.verdict in WITH_AMBIGUITY_SET
    return {
        "verdict": decision.verdict,
        "effects": effects if decision.verdict in WITH_EFFECTS else [],
        "ambiguity_set": decision.ambiguity if filled else [],
        "ambiguity_probability": decision.probabilities if filled else [],
        "probability_none": decision.nothing,
        "probability_something_else": decision.something_else,
        "ranking": [
            {
                "ids": row["ids"].split("+"),
                "heldout_score": None,
                "closed_fraction": row["closed_fraction"],
                "location": row["location"],
                "probability": row["probability"],
            }
            for row in ranking
        ],
        "next_measurement": next_measurement(decision.ambiguity),
        "most_probable": effects,
        "linear": prepared.linear[:SHOWN],
        "not_testable": prepared.not_testable,
    }


def evidence_rows(
    search: Search, prepared: Prepared, decision: Decision, closed: Closing, compared: tuple
) -> Values:
    """Return the part of verdict.json that says how far model and measurement are apart."""
    null, (given, _) = search.null, closed.benches
    measured = search.bench.measured_features[null.records]
    rest = null.measured
    if decision.chosen is not None:
        rest = rest - search.fits[decision.chosen.candidate.name].mean
    p_before, p_after = by_chance(null, rest, measured, closed)
    own = rest.reshape(len(null.records), -1)
    count = own.shape[1]
    return {
        "broken_invariances": broken_invariances(
            search.bench, null, prepared, power_balance.broken(given, closed.before.shown)
        ),
        "regions": (
            []
            if decision.verdict == "none"
            else mapping.regions(given, compared[0], compared[1], counted(given))
        ),
        "misfit": closed.misfit,
        "p_global_before": p_before,
        "p_global_after": p_after,
        "explained_z": ((count - np.sum(own**2, axis=1)) / np.sqrt(2.0 * count)).tolist(),
        "checks": (
            contract_checks(prepared.checks)
            + bounds(decision)
            + one_sided_rows(
                search.bench,
                null,
                measured,
                closed.after.compared[null.records],
            )
            + left_out(search)
            + ended_early(search)
        ),
    }


def by_chance(
    null: Null, rest: np.ndarray, measured: np.ndarray, closed: Closing
) -> tuple[float, float]:
    """Return how probable the measurement (record, feature) is by chance with the model as given,
    and with the completed one, which leaves rest (value,).
    """
    given, whole = closed.benches
    off = measured - closed.before.compared[null.records]
    # along what effects change a Null is told of more than chance
    plain = null.plain
    # the null holds what was adopted; the model as given does not
    before = plain.probability(None if given is whole else plain.change(null.mean + off))
    if closed.after is closed.before:
        return before, before
    return before, plain.probability(null.out_of_units(rest))


def left_out(search: Search) -> list[Values]:
    """Return the rows of checks for explanations that could not be run at all."""
    return [
        check_row(
            "left out",
            "warn",
            f"{name} could not be run and is not among the explanations: {trial.failed[0][1]}",
        )
        for name, trial in search.trials.items()
        if trial.failed and not len(trial.noise)
    ]


def ended_early(search: Search) -> list[Values]:
    """Return the row of checks for a search that was ended by its Effort, none of another one."""
    if not search.ended:
        return []
    return [
        check_row(
            "search ended",
            "warn",
            f"The search ended after {search.ended / 1.0e9:.0f} thousand million time steps of"
            " modes, before all was run that may explain more: effort=thorough runs on.",
        )
    ]


def cost_rows(stages: dict[str, float], simulated: dict[str, int]) -> dict[str, Any]:
    """Return the `cost` of verdict.json of {stage: CPU seconds} and {stage: records simulated}."""
    return {
        "cpu_seconds": sum(stages.values()),
        "simulations": int(sum(simulated.values())),
        "by_stage": {
            stage: {"cpu_seconds": seconds, "simulations": int(simulated.get(stage, 0))}
            for stage, seconds in stages.items()
        },
    }


def plain_attributes(provenance: Values) -> Values:
    """Return the texts and numbers of a provenance, as attributes of a file."""
    return {key: value for key, value in provenance.items() if isinstance(value, str | int | float)}
