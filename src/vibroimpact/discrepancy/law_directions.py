"""What other laws of an effect change, left free in its likelihood: a joint that slips little by little is the same effect as one that slips at once."""

import numpy as np

from vibroimpact.contraction import IntegrationError
from vibroimpact.discrepancy.features import compressed
from vibroimpact.discrepancy.survivors import of_survivors


def law_directions(bench, candidate, physical, records, first_seed):
    """Return (law, record, compressed feature): what each of a candidate's other laws changes at parameters {name: value}; none where it has none, or is thrown off.

    Which of them a structure obeys, no record tells; what they differ by is marginalised as nuisances are. All runs have the same seeds, several where
    motion with impacts parts two runs.
    """
    nothing, laws = np.zeros((0, len(records), len(bench.layout.kind))), bench.other_laws(candidate, physical)
    if not laws:
        return nothing
    measuring, seeds = candidate.measuring(physical, bench.signals.names), bench.seeds_of_a_batch(records)
    runs = bench.runs(records, seeds, first_seed)

    def mean(values):
        return of_survivors(bench.features(bench.model(values), runs, measuring).reshape(len(records), seeds, -1)).mean(axis=1)

    try:
        here, *there = map(mean, (bench.variant(candidate, physical), *laws))
    except IntegrationError:
        return nothing
    return compressed(np.array(there) - here, bench.layout)
