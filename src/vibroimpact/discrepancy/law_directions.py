"""What other laws of an effect change: a joint that slips little by little is the same effect as
one that slips at once. It is left free in the effect's likelihood, and its estimate's interval
holds what it would be by any of them.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.integration.contact_convergence import IntegrationError

from .features import compressed
from .finalists import SEARCHED
from .naming import fit_mask
from .neighbourhood import box_round, near, offset
from .screening import calibrate
from .survivors import of_survivors

END = 0.01  # of the searched range


def law_directions(bench, candidate, physical, records, first_seed):
    """Return (law, record, compressed feature): what each of a candidate's other laws changes at
    parameters {name: value}; none where it has none, or is thrown off.

    Which of them a structure obeys, no record tells; what they differ by is marginalised as
    nuisances are.
    """
    means = law_means(bench, candidate, physical, records, first_seed)
    return (
        np.zeros((0, len(records), len(bench.layout.kind)))
        if means is None
        else compressed(means[1:] - means[0], bench.layout)
    )


def law_means(bench, candidate, physical, records, first_seed):
    """Return (law, record, feature): the means by a candidate's own law, the first, and by its
    others; None where it has no others, or is thrown off.

    All runs have the same seeds, several where motion with impacts parts two runs.
    """
    laws = bench.other_laws(candidate, physical)
    if not laws:
        return None
    measuring = candidate.measuring(physical, bench.signals.names)
    seeds = bench.seeds_of_a_batch(records)
    runs = bench.runs(records, seeds, first_seed)
    try:
        return np.array(
            [
                of_survivors(
                    bench.features(bench.model(values), runs, measuring).reshape(
                        len(records), seeds, -1
                    )
                ).mean(axis=1)
                for values in (bench.variant(candidate, physical), *laws)
            ]
        )
    except IntegrationError:
        return None


def within_any_law(bench, null, found, scales, first_seed=36000):
    """Return a Finalist whose intervals hold its estimates by any law: the runs by each, in the
    place of the measurement, tell how far its own law reads them off.

    A friction that slips little by little loses less per cycle than one that slips at once, which
    reads it too low. bench: with the nuisances of the bare model.
    """
    candidate, fit = found.candidate, fit_mask(bench, null)
    there = bench.corrected_by(found.nuisance)
    means = law_means(
        there, candidate, candidate.physical(found.unit, scales), null.records, first_seed
    )
    if means is None:
        return found
    searched = replace(found, free=found.free[:SEARCHED]).own(null)
    known = found.path.of(near(found.path, found.unit, candidate.periodic))
    box = box_round(found.unit, candidate.periodic)
    read = [calibrate(there, searched, mean, candidate, known, fit, box).unit for mean in means]
    moved = np.array(
        [
            offset(unit, read[0], candidate.periodic)
            for unit in read
            if not at_end(unit, box, candidate.periodic)
        ]
    )
    if at_end(read[0], box, candidate.periodic) or not len(moved):
        return found
    interval = np.stack(
        [
            found.interval[:, 0] - np.maximum(moved.max(axis=0), 0.0),
            found.interval[:, 1] - np.minimum(moved.min(axis=0), 0.0),
        ],
        axis=1,
    )
    return replace(found, interval=np.clip(interval, 0.0, 1.0))


def at_end(unit, box, periodic):
    """Return whether unit (parameter,) lies at an end of the box (parameter, 2) that it was looked
    for in: no estimate, the emulator does not know.
    """
    ends = np.minimum(unit - box[:, 0], box[:, 1] - unit) < END
    ends[list(periodic)] = False
    return bool(ends.any())
