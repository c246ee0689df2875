"""A pair by another law of one of its quantities: a contact's stiffness is linear or Hertz's, and
pairs that differ in that alone are compared where each is at its best.

Proposed from a sum, one law may start where the search never leaves, and lose by that alone: an
obstacle with a soft contact was looked for from half a lobe away, and its twin with Hertz's law,
found where it was, was named alone.
"""

from dataclasses import replace

import numpy as np

from vibroimpact.effects.registry import EFFECTS

from . import naming, priors
from .beside import charged, with_parts_beside
from .candidates import Pair, candidate_named
from .finalists import refine
from .nuisance_directions import unknowns_free
from .path_scores import gains_of
from .screening import simulate_path

ROUNDS = 4


def exchanged(pair, values):
    """Return [(Pair, number of the part)] of a Pair with one of its two effects by another law of
    the same quantity, or as the effect that it is where its limit is never reached: a rod at the
    shaker was told as a spring there that gives way beyond every force it bears. values: of the
    configuration.
    """
    out, parts = [], (pair.first, pair.second)
    for number, (part, rest) in enumerate(zip(parts, parts[::-1], strict=True)):
        others = [
            (name, part.location)
            for name, effect in EFFECTS.items()
            if part.effect.quantity and effect.quantity == part.effect.quantity
        ]
        others += [row for row in [part.effect.unlimited(values, part.location)] if row is not None]
        for other in (
            replace(part, effect_id=name, location=place)
            for name, place in others
            if name not in (part.effect_id, rest.effect_id)
        ):
            out.append((Pair(other, rest) if number == 0 else Pair(rest, other), number))
    return out


def starts(pair, number, found):
    """Return (point, parameter): a Finalist's own with the exchanged part, of that number in a
    Pair, at every point of its design.
    """
    rest = found.candidate.parts(found.unit)[1 - number][1]
    design = (pair.first, pair.second)[number].design()
    return np.array(
        [np.concatenate([point, rest] if number == 0 else [rest, point]) for point in design]
    )


def by_other_laws(bench, null, measured, found, prepared, first_seed=45000):
    """Return [Finalist] of the pair of a Finalist by other laws, searched from where it is; bench:
    with the nuisances of the bare model.
    """
    there, fit, out = bench.corrected_by(found.nuisance), naming.fit_mask(bench, null), []
    screened = {
        candidate_named(name).effect_id for name in prepared.screened
    }  # what was taken out of the catalogue stays out
    least = (
        priors.SAME_QUANTITY * gains_of(there, null, measured, found.path, found.own(null)).max()
    )
    for turn, (pair, number) in enumerate(exchanged(found.candidate, bench.values)):
        if (pair.first, pair.second)[number].effect_id not in screened:
            continue
        seed = first_seed + 10000 * turn
        path = simulate_path(
            there, pair, starts(pair, number, found), prepared.scales, null.records, first_seed=seed
        )
        other = (
            None
            if path is None
            else refine(
                there,
                null,
                measured,
                pair,
                path,
                prepared.scales,
                fit,
                ROUNDS,
                least,
                found.features.shape[1],
                seed + 1000,
            )
        )
        if other is not None:
            other = (
                other if found.nuisance is None else charged(other, found.nuisance, bench.nuisance)
            )
            out.append(
                with_parts_beside(
                    bench,
                    null,
                    measured,
                    unknowns_free(bench, null, measured, other, prepared.scales),
                    prepared.scales,
                )
            )
    return out
