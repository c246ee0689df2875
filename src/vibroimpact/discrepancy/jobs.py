"""The jobs of a discrepancy run, each from files to a file: null parts, candidates, finalists,
pairs.
"""

import json
from dataclasses import asdict

import numpy as np

from vibroimpact.effects.registry import EFFECTS
from vibroimpact.records import write_text

from . import naming, priors, second, store
from .bank import described
from .beside import begun_beside, charged, refined_beside, with_parts_beside
from .branches import pair_deviations
from .candidates import Candidate, Pair, candidate_named, elsewhere, other_places
from .dag import NULL_PARTS
from .finalists import (
    PLACED_FROM,
    SEARCHED,
    STARTS,
    gain_of_part,
    own,
    placed,
    placed_again,
    refine,
    started,
)
from .nuisance import Nuisance
from .nuisance_directions import unknowns_free
from .null import UNSEEN, unseen_damping
from .path_scores import gains_of
from .screening import simulate_path
from .search import ROUNDS
from .verdict import idle

UNSEEN_SEEDS = 4  # of each damping


def null_part(run, part, path):
    """Simulate a part of the null's seeds and of those with other damping of unseen modes; the
    features of what is screened are of the same runs.
    """
    bench, records = run.bench, run.records
    each, unseen = priors.NULL_SEEDS // NULL_PARTS, UNSEEN_SEEDS * len(UNSEEN) // NULL_PARTS
    arrays = {}
    which, turn = (
        part % len(UNSEEN),
        part // len(UNSEEN),
    )  # a part runs one of the other dampings: few runs would leave most lanes of a batch empty
    models = [
        ("features", bench.model(), each, each * part),
        (
            store.UNSEEN[which],
            unseen_damping(bench, bench.values, UNSEEN[which]),
            unseen,
            900 + unseen * turn,
        ),
    ]
    for name, model, seeds, first in models:
        runs = bench.runs(records, seeds, first)
        responses = bench.respond(model, runs)
        for prefix, window in (("", bench), ("screened_", run.screening_bench)):
            arrays[prefix + name] = window.noisy_features(runs, responses).reshape(
                len(records), seeds, -1
            )
    store.save(path, records=records, **described(bench, records), **arrays)


def candidate_path(run, candidate, path, quick=False):
    """Simulate a candidate at the points of its design, beside what was adopted and in its place,
    where it may be there.
    """
    bench, arrays = run.screening_bench, {}
    for tried in run.prepared.beside_or_in_place(candidate):
        found = simulate_path(
            bench, tried, candidate.design(quick), run.prepared.scales, run.records
        )
        if found is not None:
            arrays |= {
                tried.alone * store.ALONE + name: value
                for name, value in store.path_arrays(found).items()
            }
    store.save(path, **arrays) if arrays else store.save_empty(path)


def screening(run, path, quick=False):
    """Rank all candidates, find the threshold from null seeds, and write who is to be simulated
    directly: {finalists: {name: unit}, ...}.
    """
    if run.refused:
        write_text(
            json.dumps({"finalists": {}, "threshold": None, "null_gains": [], "ranked": []}), path
        )
        return
    bench, null, paths = run.screening_bench, run.screening_null, run.screened_paths
    measured = bench.measured_features[null.records]
    paths = {candidate: path for candidate, path in paths.items() if run.prepared.room(candidate)}
    ranked = naming.screen(bench, null, measured, paths)
    explained = naming.explained(bench, null, null.mean, measured, False)
    chosen = naming.finalists(
        ranked, explained, QUICK_FINALISTS if quick else priors.FINALISTS, run.screened_elsewhere
    )
    starts = {row.candidate.name: row.unit.tolist() for row in chosen}
    gains = naming.null_gains(bench, null, paths)
    write_text(
        json.dumps(
            {
                "finalists": starts,
                "threshold": naming.threshold(gains),
                "null_gains": gains.tolist(),
                "ranked": [
                    {"name": row.candidate.name, "score": row.score, "unit": row.unit.tolist()}
                    for row in ranked
                ],
            },
            indent=1,
        ),
        path,
    )


QUICK_FINALISTS, QUICK_ROUNDS, QUICK_SEEDS = 3, 4, 4


def least_gain(name, chosen):
    """Return the gain of log likelihood below which a closer look at a candidate is not worth its
    runs; chosen: content of the file that named it.

    A pair must be better than the best single effect by what a second effect must add; a finalist
    not far behind the best of the other effects, as they were screened.
    """
    if "pairs" in chosen:
        return chosen["least"] + (
            second.least_added(chosen["least"], chosen["threshold"]) if "+" in name else 0.0
        )
    effects = {part.split("@")[0] for part in name.split("+")}
    others = [
        (row["score"], row["name"].split("@")[0])
        for row in chosen["ranked"]
        if row["name"].split("@")[0] not in effects
    ]
    if not others:
        return -np.inf
    score, first = max(others)
    return max(
        (ALIAS_LOSING if effects & set(EFFECTS[first].aliases) else LOSING) * score,
        naming.LEAST_GAIN,
    )


def finalist(run, name, chosen, path, quick=False):
    """Refine one finalist by direct simulation, or a pair from its start; chosen: content of the
    file that named it.
    """
    given = (
        None
        if chosen.get("nuisance") is None
        else Nuisance(**{key: np.array(value) for key, value in chosen["nuisance"].items()})
    )
    bench = run.bench.corrected_by(given)
    null = run.null
    paths = run.paths
    sizes = run.prepared.scales
    candidate, measured = candidate_named(name), bench.measured_features[null.records]
    unit = np.array(chosen["pairs" if "pairs" in chosen else "finalists"][name])
    least = least_gain(name, chosen)
    fit = naming.fit_mask(bench, null)
    known = paths.get(candidate) if isinstance(candidate, Candidate) else None
    if known is None:
        known = started(bench, null, candidate, unit, sizes)
    elif not run.simulated_here(candidate):
        # an adopted effect changes what the candidate does: how it looks where a bank has no such
        # effect tells little
        known = own(
            bench,
            null,
            measured,
            candidate,
            known,
            unit,
            sizes,
            fit,
            starts=STARTS if run.prepared.adopted is None else 1 + len(known.parameters),
        )
        least *= longer(
            bench,
            null,
            measured,
            known,
            next(row["score"] for row in chosen["ranked"] if row["name"] == name),
        )
    if known is None:
        store.save_empty(path)
        return
    single, seeds = isinstance(candidate, Candidate), QUICK_SEEDS if quick else priors.FINAL_SEEDS
    leads = single and leading(candidate, chosen)
    places = (
        [
            other
            for other in other_places(candidate, bench.values)
            if other.name not in run.prepared.screened
        ]
        if single
        else []
    )
    if places and not quick and gains_of(bench, null, measured, known).max() > PLACED_FROM * least:
        candidate, known = placed(bench, null, measured, candidate, known, places, sizes, fit)
    found = None
    if single and not quick and bench.nonlinear_low and not bench.modes_told:
        found = begun_beside(bench, null, measured, candidate, known, sizes, fit, least, seeds)
    if found is None:
        found = refine(
            bench,
            null,
            measured,
            candidate,
            known,
            sizes,
            fit,
            rounds=QUICK_ROUNDS if quick else ROUNDS,
            least=least,
            seeds=seeds,
        )
    if (
        found is not None
        and not quick
        and looked_for_elsewhere(bench, null, measured, found, leads, least)
    ):
        found = at_another_place(bench, null, measured, found, sizes, fit, least)
    if found is not None and not quick and bench.nonlinear_low:
        found = found if given is None else charged(found, given, run.bench.nuisance)
        found = refined_beside(run.bench, null, measured, found, sizes, fit, least, seeds)
    if found is not None and not quick:
        found = unknowns_free(run.bench, null, measured, found, sizes)
    if found is not None and not single:
        found = with_parts_beside(run.bench, null, measured, found, sizes)
        if (
            idle(found, chosen["threshold"])
            and gain_of_part(bench, null, measured, found) > chosen["least"]
        ):
            # one of the two explains it where its own search never was: it is looked at closely
            # there, and no pair is left
            candidate, unit = found.candidate.parts(found.unit)[int(np.argmax(found.parts))]
            known = started(bench, null, candidate, unit, sizes, first_seed=9000)
            found = refine(
                bench,
                null,
                measured,
                candidate,
                known,
                sizes,
                fit,
                least=chosen["least"],
                seeds=seeds,
                first_seed=10000,
            )
            found = (
                found
                if found is None or given is None
                else charged(found, given, run.bench.nuisance)
            )
            found = (
                found if found is None else unknowns_free(run.bench, null, measured, found, sizes)
            )
    store.save_empty(path) if found is None else store.save(path, **store.finalist_arrays(found))


def looked_for_elsewhere(bench, null, measured, found, leads, least):
    """Return whether other places of a Finalist are worth their runs: it leaves something, and
    leads, or is a pair that adds enough to count.
    """
    own = found.own(null)
    adds = (
        isinstance(found.candidate, Pair)
        and gains_of(bench, null, measured, found.path, own).max() > least
    )
    return (leads or adds) and second.needed(naming.explained(bench, own, found.mean, measured))


def at_another_place(bench, null, measured, found, sizes, fit, least):
    """Return the Finalist that explains more: the one found, or the same effect at the place that
    comes nearest.
    """
    near = placed_again(bench, null, measured, found, sizes, fit)
    other = (
        None
        if near is None
        else refine(bench, null, measured, *near, sizes, fit, least=least, first_seed=16000)
    )
    return found if other is None or other.total < found.total else other


def leading(candidate, chosen):
    """Return whether a candidate is the best of a screening, or of an effect that looks like it:
    where it sits is looked at again.
    """
    if not chosen.get("ranked"):
        return False
    first = candidate_named(chosen["ranked"][0]["name"])
    return candidate.name == first.name or candidate.effect_id in first.effect.aliases


def longer(bench, null, measured, path, screened):
    """Return by how much gains grow from what was screened (a candidate's score) to what is
    compared (its Path there): 1 to LONGER.
    """
    if path is None or screened <= 0.0:
        return 1.0
    return float(np.clip(gains_of(bench, null, measured, path).max() / screened, 1.0, LONGER))


LOSING = (
    0.7  # of the gain of the best other candidate: below it a closer look is not worth its runs
)
ALIAS_LOSING = (
    0.35  # the same for its aliases: to name one alone is to say that it is not the other
)
LONGER = 3.0


def known_finalists(files):
    """Return [Finalist] of files, one of each name: an effect that was screened at two places may
    have ended at one.
    """
    arrays = [store.load(file) for file in files]
    return best_of_each([store.finalist_of(row) for row in arrays if row is not None])


def best_of_each(found):
    """Return [Finalist], of each name the one that explains most."""
    return list(
        {
            row.candidate.name: row
            for row in sorted(found, key=lambda row: row.scores.sum() + row.low)
        }.values()
    )


def ordered(bench, null, found):
    """Return ([Finalist] best first, totals {name: (all, fit, held-out)}); before one that leaves
    something comes one not told apart from it that leaves nothing.
    """
    measured = bench.measured_features[null.records]
    totals = naming.totals(bench, null, measured, found)
    found = sorted(found, key=lambda row: -totals[row.candidate.name][0])
    singles = [row for row in found if isinstance(row.candidate, Candidate)]
    left = {
        row.candidate.name: second.needed(
            naming.explained(bench, row.own(null), row.mean, measured)
        )
        for row in singles
    }
    if singles and left[singles[0].candidate.name]:
        near = naming.not_told_apart(
            {name: totals[name] for name in left}, singles[0].candidate.name
        )
        enough = next(
            (row for row in singles if row.candidate.name in near and not left[row.candidate.name]),
            None,
        )
        found = found if enough is None else [enough, *(row for row in found if row is not enough)]
    return found, totals


def pairs(run, files, screened, path, quick=False):
    """Write the pairs to simulate, {pairs: {name: unit}, least, threshold, nuisance of the best
    single effect}: none where one effect explains the measurement, or none is found at all.
    """
    out = {}
    least = None
    found = known_finalists(files)
    threshold = screened["threshold"]
    nuisance = None
    if quick or not found:
        write_text(json.dumps({"pairs": out, "least": None, "threshold": threshold}), path)
        return
    bench, null, paths = run.bench, run.null, run.paths
    found, totals = ordered(bench, null, found)
    if totals[found[0].candidate.name][0] > threshold:
        measured = bench.measured_features[null.records]
        if second.needed(naming.explained(bench, found[0].own(null), found[0].mean, measured)):
            # by as few seeds as the pairs' own runs, and with no nuisances free, as they are
            # searched: what is judged otherwise scores higher
            own = null.freed(found[0].free[:SEARCHED]).scattered(
                pair_deviations(null, found[0].path, found[0].unit, found[0].candidate.periodic)
            )
            least = float(gains_of(bench, null, measured, found[0].path, own).max())
            # an effect at one support alone comes before a second effect
            out = {
                other.name: found[0].unit.tolist()
                for other in elsewhere(found[0].candidate, bench.values)
            }
            nuisance = found[0].nuisance
            beside = (
                second.pairs(
                    bench.corrected_by(nuisance), null, measured, found, paths, run.prepared
                )
                if run.prepared.room(found[0].candidate, more=1)
                else []
            )
            out |= {pair.name: unit.tolist() for pair, unit, gain in beside}
    told = (
        None
        if nuisance is None
        else {name: value.tolist() for name, value in asdict(nuisance).items()}
    )
    write_text(
        json.dumps(
            {"pairs": out, "least": least, "threshold": threshold, "nuisance": told}, indent=1
        ),
        path,
    )
