"""Who may be the missing effect: screening scores, the threshold from null seeds, finalists, and
whom the evidence can not tell apart.
"""

from dataclasses import dataclass

import numpy as np

from . import priors
from .candidates import candidate_named
from .features import compressed
from .likelihood import log_likelihood
from .screening import calibrate, direct_scores, linear_score, null_scores


@dataclass(frozen=True)
class Screened:
    """A candidate after screening: score, gain of log likelihood over the null, by the better of
    emulation and its simulated points; unit there.
    """

    candidate: object
    score: float
    unit: np.ndarray


def fit_mask(bench, null):
    """Return (null record,) bool: the records that parameters are fitted to."""
    return np.isin(null.records, bench.signals.fit())


def screen(bench, null, measured, paths):
    """Return [Screened], best first. paths {Candidate: Path}; measured (record, feature) of the
    null's records.
    """
    start, low = null_scores(bench, null, measured), linear_score(bench, None)
    out = []
    for candidate, path in paths.items():
        lows = np.array([linear_score(bench, reading) for reading in path.readings]) - low
        points = (
            np.array([direct_scores(bench, null, measured, mean).sum() for mean in path.features])
            - start.sum()
            + lows
        )
        found = calibrate(bench, null, measured, candidate, path, fit_mask(bench, null))
        emulated = found.scores.sum() - start.sum() + found.low - low
        best = int(np.argmax(points))
        unit = found.unit if emulated > points[best] else path.parameters[best]
        out.append(Screened(candidate, float(max(points[best], emulated)) - cost(candidate), unit))
    return sorted(out, key=lambda row: -row.score)


def cost(candidate):
    """Return what a candidate's parameters beyond the first cost, in log likelihood."""
    return priors.PARAMETER_COST * (len(candidate.effect.parameters) - 1)


def null_gains(bench, null, paths):
    """Return (seed,): the best gain over all candidates' simulated points where each null seed in
    turn plays the measurement.
    """
    residual = np.array(
        [
            compressed(null.features[record] - null.mean[record], bench.layout)
            for record in range(len(null.mean))
        ]
    )
    start = np.array(
        [
            [log_likelihood(row, null.covariance[record])[0] for row in residual[record]]
            for record in range(len(residual))
        ]
    ).sum(axis=0)
    best = np.full(null.seeds, -np.inf)
    low = linear_score(bench, None)
    for candidate, path in paths.items():
        for mean, reading in zip(path.features, path.readings, strict=True):
            if linear_score(bench, reading) < low - 10.0:
                continue
            scores = np.array(
                [
                    direct_scores(bench, null, null.features[:, seed], mean).sum()
                    for seed in range(0, null.seeds, 2)
                ]
            )
            best[::2] = np.maximum(best[::2], scores - start[::2] - cost(candidate))
    return best[np.isfinite(best)]


def threshold(gains):
    """Return the gain that a name must have: the quantile of null gains by a normal law, never less
    than priors.GAIN.
    """
    spread = gains.std(ddof=1) if len(gains) > 1 else 0.0
    return (
        float(max(priors.GAIN, gains.mean() + priors.NULL_SIGMA * spread))
        if len(gains)
        else priors.GAIN
    )


def finalists(screened, explained, count=priors.FINALISTS, elsewhere=False):
    """Return the candidates to simulate directly: the best of each effect, and the aliases of the
    first that came near.

    explained (record,): z of the bare model, see `explained`; where it leaves nothing, only those
    that a closer look may bring to a name; elsewhere: they were screened beside another structure,
    and their scores tell an order at most.
    """
    best = {}
    least = -np.inf if elsewhere else LEAST_GAIN if np.min(explained) > priors.EXPLAINED_Z else 0.0
    for row in screened:
        if row.score > least:
            best.setdefault((row.candidate.effect_id, row.candidate.alone), row)
    chosen = list(best.values())
    chosen = [
        row
        for place, row in enumerate(chosen)
        if place < LEAST_FINALISTS or row.score > NEAR * chosen[0].score
    ][:count]
    if chosen:
        first, known = chosen[0], {(row.candidate.effect_id, row.candidate.alone) for row in chosen}
        # the best of each: where it sits is looked for anew
        far = FAR * first.score if first.score > 0.0 else -np.inf
        chosen += [
            row
            for key, row in best.items()
            if key not in known
            and row.candidate.ids[0] in first.candidate.effect.aliases
            and row.score > far
        ][:2]
    return chosen


GROWN = (
    3.0  # times its screening score at most is the gain of a candidate that was looked at closely
)
LEAST_GAIN = priors.GAIN / GROWN  # less never grows to a name
LEAST_FINALISTS, NEAR, FAR = (
    3,
    0.5,
    0.2,
)  # shares of the best screening score: nearer ones are all simulated, aliases also when farther


def totals(bench, null, measured, found):
    """Return {name: (gain in all, gain on fit records and the lowest, gain on held-out records)} of
    Finalists over the null.
    """
    start = null_scores(bench, null, measured)
    low = linear_score(bench, None)
    fit = fit_mask(bench, null)
    out = {}
    for row in found:
        gain = row.scores - start
        on_fit = float(gain[fit].sum() + row.low - low) - cost(row.candidate)
        out[row.candidate.name] = (
            on_fit + float(gain[~fit].sum()),
            on_fit,
            float(gain[~fit].sum()),
        )
    return out


def chi_squares(bench, null, mean, measured, changed=True):
    """Return (record,) the chi-square of measured features under means (record, feature); changed:
    what they change of the null's may differ as two laws do.
    """
    change = compressed(mean - null.mean, bench.layout)
    residual = compressed(measured - mean, bench.layout)
    return np.array(
        [
            log_likelihood(
                residual[record],
                null.covariance[record],
                *((change[record], null.groups) if changed else ()),
            )[1]
            for record in range(len(mean))
        ]
    )


def explained(bench, null, mean, measured, changed=True):
    """Return (record,) z: how far the chi-square of measured features under means (record, feature)
    is above its expectation, in sigmas, negative.

    The covariance holds seeds and what two codes differ by, so the expectation is the number of
    features; SPREAD widens its sigma for what is not Gaussian. Far below 0: something is missing.
    """
    size = mean.shape[1]
    return (size - chi_squares(bench, null, mean, measured, changed)) / (
        SPREAD * np.sqrt(2.0 * size)
    )


def bare_explained(bench, null, measured):
    """Return (record,) z of the bare model as `explained`, in sigmas of its own seeds where these
    scatter more.
    """
    return (measured.shape[1] - chi_squares(bench, null, null.mean, measured, False)) / bare_spread(
        null
    )


def bare_spread(null):
    """Return (record,): one sigma of a record's chi-square where nothing is missing, from how far
    seeds lie from the others, SPREAD at least.

    Where impacts are rare or motion across the force just starts, single runs lie far off: 16 seeds
    of one model at 3 N have 152 to 534 for 270 features.
    """
    return np.maximum(
        SPREAD * np.sqrt(2.0 * null.mean.shape[1]), null.left_out().std(axis=1, ddof=1)
    )


SPREAD = 1.25  # right models of the development campaigns: 205 to 300 for 270 features


def not_told_apart(total, best, sufficient=frozenset(), added=None):
    """Return the names whose total gain is too near the best's: within AMBIGUOUS. An alias of the
    catalogue, of a pair's with the other effect the same, also within ALIAS_AMBIGUOUS, and wherever
    it leaves nothing to be explained (sufficient: names of those that do not): two laws of one kind
    differ by less than two codes of one law. Laws of one quantity where they lose no more than the
    rest of SAME_QUANTITY of what it gains, of a pair's effect added {id: gain} beside the other:
    which of them another code, with other contact points, comes nearer to is no property of the
    structure.
    """
    first, out = candidate_named(best), []
    added = {first.effect_id: total[best][0]} if added is None else added
    for name, (gain, _, _) in total.items():
        other = candidate_named(name)
        one, two = _exchanged(first, other)
        alias = one and ({*two.ids} & {*one.effect.aliases} or {*one.ids} & {*two.effect.aliases})
        near = gain > total[best][0] - (priors.ALIAS_AMBIGUOUS if alias else priors.AMBIGUOUS) or (
            alias and name in sufficient
        )
        same = one and one.effect.quantity and one.effect.quantity == two.effect.quantity
        same = same and total[best][0] - gain < (1.0 - priors.SAME_QUANTITY) * added.get(
            one.effect_id, 0.0
        )
        if sorted(other.ids) != sorted(first.ids) and (near or same):
            out.append(name)
    return out


def _exchanged(first, other):
    """Return the (Candidate, Candidate) by which two answers differ, (None, None) where that is
    more than one effect.
    """
    one, two = ([candidate for candidate, _ in row.parts(())] for row in (first, other))
    left = (
        [row for row in one if row.ids not in [same.ids for same in two]],
        [row for row in two if row.ids not in [same.ids for same in one]],
    )
    return tuple(row[0] for row in left) if [*map(len, left)] == [1, 1] else (None, None)
