"""The jobs of a discrepancy run, each from files to a file: null parts, candidates, finalists, pairs."""

import json
from dataclasses import replace

import numpy as np

from vibroimpact.discrepancy import naming, priors, second, store
from vibroimpact.discrepancy.bank import described
from vibroimpact.discrepancy.candidates import Candidate, candidate_named, elsewhere, in_place_of_adopted
from vibroimpact.discrepancy.dag import NULL_PARTS
from vibroimpact.discrepancy.finalists import ROUNDS, own, placed, refine, started
from vibroimpact.discrepancy.null import unseen_damping
from vibroimpact.discrepancy.screening import simulate_path
from vibroimpact.records import read_text, write_text

UNSEEN_SEEDS = 8


def contact_records(bench):
    """Return (record,): those whose features are compared; the lowest one is read by its modes where it can be."""
    records = np.arange(len(bench.signals.load))
    return records[records != bench.signals.lowest] if bench.linear_stage else records


def null_part(run, part, path):
    """Simulate a part of the null's seeds and of those with other damping of unseen modes; the features of what is screened are of the same runs."""
    bench, records = run.bench, contact_records(run.bench)
    each, unseen = priors.NULL_SEEDS // NULL_PARTS, UNSEEN_SEEDS // NULL_PARTS
    arrays = {}
    for name, model, seeds, first in (("features", bench.model(), each, each * part), ("unseen", unseen_damping(bench), unseen, 900 + unseen * part)):
        runs = bench.runs(records, seeds, first)
        responses = bench.respond(model, runs)
        for prefix, window in (("", bench), ("screened_", run.screening_bench)):
            arrays[prefix + name] = window.noisy_features(runs, responses).reshape(len(records), seeds, -1)
    store.save(path, records=records, **described(bench, records), **arrays)


def candidate_path(run, candidate, path, quick=False):
    """Simulate a candidate at the points of its design."""
    bench, arrays = run.screening_bench, {}
    for alone in (False, True) if in_place_of_adopted(run.prepared, candidate) else (False,):
        found = simulate_path(bench, replace(candidate, alone=alone), candidate.design(quick), run.prepared.scales, contact_records(bench))
        if found is not None:
            arrays |= {alone * store.ALONE + name: value for name, value in store.path_arrays(found).items()}
    store.save(path, **arrays) if arrays else store.save_empty(path)


def screening(run, path, quick=False):
    """Rank all candidates, find the threshold from null seeds, and write who is to be simulated directly: {finalists: {name: unit}, ...}."""
    if run.refused:
        write_text(json.dumps({"finalists": {}, "threshold": None, "null_gains": [], "ranked": []}), path)
        return
    bench, null, paths = run.screening_bench, run.screening_null, run.screened_paths
    measured = bench.measured_features[null.records]
    ranked = naming.screen(bench, null, measured, paths)
    chosen = naming.finalists(ranked, QUICK_FINALISTS if quick else priors.FINALISTS)
    starts = {row.candidate.name: row.unit.tolist() for row in chosen}
    gains = naming.null_gains(bench, null, paths)
    write_text(json.dumps({"finalists": starts, "threshold": naming.threshold(gains), "null_gains": gains.tolist(),
                           "ranked": [{"name": row.candidate.name, "score": row.score, "unit": row.unit.tolist()} for row in ranked]}, indent=1), path)  # fmt: skip


QUICK_FINALISTS, QUICK_ROUNDS, QUICK_SEEDS, PAIR_ROUNDS = 3, 1, 4, 3


def rival_of(name, screened):
    """Return the best screening score of the candidates that are not of the name's effects; screened: content of the screening's file."""
    effects = {part.split("@")[0] for part in name.split("+")}
    return max((row["score"] for row in screened["ranked"] if row["name"].split("@")[0] not in effects), default=-np.inf)


def finalist(run, name, unit, path, quick=False, rival=-np.inf):
    """Refine one finalist by direct simulation, or a pair from its start; rival: see finalists.refine."""
    bench, null, paths, sizes = run.bench, run.null, run.paths, run.prepared.scales
    candidate, measured = candidate_named(name), bench.measured_features[null.records]
    fit, known = naming.fit_mask(bench, null), paths.get(candidate) if isinstance(candidate, Candidate) else None
    if known is None:
        known = started(bench, null, candidate, np.array(unit), sizes)
    elif not run.simulated_here:
        known = own(bench, null, measured, candidate, known, np.array(unit), sizes, fit)
    if known is None:
        store.save_empty(path)
        return
    rounds = QUICK_ROUNDS if quick else ROUNDS if isinstance(candidate, Candidate) else PAIR_ROUNDS
    found = refine(bench, null, measured, candidate, known, sizes, fit, rounds=rounds, rival=rival, seeds=QUICK_SEEDS if quick else priors.FINAL_SEEDS)
    if found is not None and isinstance(candidate, Candidate) and not quick:
        other, there = placed(bench, null, measured, candidate, found.path, sizes, fit)
        if other is not candidate:
            found = refine(bench, null, measured, other, there, sizes, fit, rounds=rounds, rival=rival) or found
    store.save_empty(path) if found is None else store.save(path, **store.finalist_arrays(found))


def known_finalists(files):
    """Return [Finalist] of files, one of each name: an effect that was screened at two places may have ended at one."""
    arrays = [store.load(file) for file in files]
    found = [store.finalist_of(row) for row in arrays if row is not None]
    return list({row.candidate.name: row for row in sorted(found, key=lambda row: row.scores.sum() + row.low)}.values())


def ordered(bench, null, found):
    """Return ([Finalist] best first, totals {name: (all, fit, held-out)})."""
    totals = naming.totals(bench, null, bench.measured_features[null.records], found)
    return sorted(found, key=lambda row: -totals[row.candidate.name][0]), totals


def pairs(run, files, screened, path, quick=False):
    """Write the pairs to simulate, {pairs: {name: unit}}: none where one effect explains the measurement, or none is found at all."""
    out, found, threshold = {}, known_finalists(files), screened["threshold"]
    if quick or not found:
        write_text(json.dumps({"pairs": out}), path)
        return
    bench, null, paths = run.bench, run.null, run.paths
    found, totals = ordered(bench, null, found)
    if totals[found[0].candidate.name][0] > threshold:
        measured = bench.measured_features[null.records]
        if second.needed(naming.explained(bench, null, found[0].mean, measured)):
            # an effect at one support alone comes before a second effect
            out = {other.name: found[0].unit.tolist() for other in elsewhere(found[0].candidate, bench.values)}
            out |= {pair.name: unit.tolist() for pair, unit, gain in second.pairs(bench, null, measured, found, paths)}
    write_text(json.dumps({"pairs": out}, indent=1), path)


def read_json(path):
    """Return the content of a JSON file."""
    return json.loads(read_text(path))
