"""Which candidate is chosen, which others explain the tried records as well, and what may be said
of it.
"""

from dataclasses import dataclass

import numpy as np

# of the tried records' squared error: a candidate within it of the best explains them as well
MARGIN_DB = 1.0
# times the cost of the chosen one on what it was fitted to: a candidate above it does not explain
# the records as well
FIT_MARGIN = 2.0
# over the linear model fitted to all levels: below it no local law explains what the levels change
LEAST_GAIN_DB = 6.0
# times the error of the models identified again at every level: below it nothing is missing
LINEAR_ENOUGH = 1.3
MUCH_LEFT, LITTLE_LEFT = (
    0.3,
    0.05,
)  # of the response of the tried records: more left than this is not explained
FLOOR_FACTOR = 2.0  # times what noise and the modes leave in any case
PARTLY = 0.7  # of the error of the tried records: less than this closed is a part only


@dataclass(frozen=True)
class Choice:
    """chosen: name of the candidate; verdict; ambiguity: list of lists of ids; scores {name: dB};
    ids {name: list}; as_good: names of the candidates that explain the tried records as well, the
    chosen one among them; tried: names of those records.
    """

    chosen: str
    verdict: str
    ambiguity: list
    scores: dict
    ids: dict
    as_good: tuple = ()
    tried: tuple = ()


def believed(kind, linear, again, completed, floor):
    """Return the verdict after what is left of the tried records: `none` or `named` only where
    little is left.

    linear, again, completed: RMS relative errors there of the linear model of the lowest level, of
    those identified again and of the completed one; floor: noise, or what the linear model misses
    at the lowest level already.
    """
    if kind == "none" and again > max(MUCH_LEFT, FLOOR_FACTOR * floor):
        return "unknown"
    if kind == "named" and (
        completed > max(LITTLE_LEFT, FLOOR_FACTOR * floor) or completed > (1.0 - PARTLY) * linear
    ):
        return "partly_explained"
    return kind


def score(errors, reference):
    """Return dB: mean squared error of the reference over that of a candidate, (level, channel)
    each; -inf where the candidate has none.
    """
    errors = np.asarray(errors, float)
    return (
        -np.inf
        if not np.isfinite(errors).all()
        else float(10.0 * np.log10(np.mean(np.square(reference)) / np.mean(errors**2)))
    )


def leading(candidates, reference):
    """Return (values of the best candidate by the records it was tried on, {name: score in dB}).

    candidates: values of candidate.run_candidate; reference {level name: (channel,)} errors of the
    linear model.
    """
    scores = {
        each["name"]: score(
            [each["errors"][name] for name in each["tried"]],
            [reference[name] for name in each["tried"]],
        )
        for each in candidates
    }
    return max(candidates, key=lambda each: scores[each["name"]]), scores


def completed_furthest(singles, additions, reference):
    """Return the values of the best single candidate, or of the last of its additions: one law is
    added after the other while it gains more than MARGIN_DB on the records that were tried.
    """
    chosen, scores = leading(singles, reference)
    best = scores[chosen["name"]]
    while True:
        further = [each for each in additions if parent(each["name"]) == chosen["name"]]
        if not further:
            return chosen
        added, scores = leading(further, reference)
        if not scores[added["name"]] > best + MARGIN_DB:
            return chosen
        chosen, best = added, scores[added["name"]]


def parent(name):
    """Return the name of the candidate that an addition "candidate+law.place" was added to."""
    return name.rpartition("+")[0]


def choose(singles, additions, reference, joint, refitted):
    """Return the Choice among single candidates and additions to the best of them.

    reference, joint, refitted {level name: (channel,)}: errors of the linear model of the lowest
    level, of the one fitted to all levels, and of those identified again at every level.
    """
    best = leading(singles, reference)[0]
    tried = best["tried"]
    chosen = completed_furthest(singles, additions, reference)
    scores = leading([*singles, *additions], reference)[1]
    ids = {each["name"]: each["ids"] for each in (*singles, *additions)}
    costs = {
        each["name"]: each["cost"] for each in (*singles, *additions) if each["cost"] is not None
    }
    alike = (
        scores if chosen is not best else [each["name"] for each in singles]
    )  # what a second effect does not improve does not need it
    as_good = [
        name
        for name, value in scores.items()
        if name in alike
        and value >= scores[chosen["name"]] - MARGIN_DB
        and costs.get(name, np.inf) <= FIT_MARGIN * costs[chosen["name"]]
    ]
    ambiguity = [ids[chosen["name"]]]
    ambiguity += [
        ids[name]
        for name in sorted(as_good, key=lambda name: -scores[name])
        if ids[name] not in ambiguity
    ]
    ambiguity = [each for index, each in enumerate(ambiguity) if each not in ambiguity[:index]]
    linear, again = (
        np.mean([np.square(errors[name]) for name in tried]) for errors in (reference, refitted)
    )
    if linear < LINEAR_ENOUGH**2 * again:
        return Choice(chosen["name"], "none", [], scores, ids, tuple(as_good), tuple(tried))
    gain = scores[chosen["name"]] - score(
        [joint[name] for name in tried], [reference[name] for name in tried]
    )
    if gain < LEAST_GAIN_DB:
        return Choice(chosen["name"], "unknown", [], scores, ids, tuple(as_good), tuple(tried))
    common = set(best["ids"]).issubset(set.intersection(*map(set, ambiguity)))
    return Choice(
        chosen["name"],
        "named" if common else "ambiguous",
        ambiguity,
        scores,
        ids,
        tuple(as_good),
        tuple(tried),
    )
