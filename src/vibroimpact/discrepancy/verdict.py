"""The verdict: what is missing, and whom the evidence can not tell apart."""

from dataclasses import dataclass

import numpy as np

from . import naming, priors
from .candidates import Candidate, Pair, candidate_named
from .misfit import makes_worse
from .scales import clearance
from .second import least_added


@dataclass
class Decision:
    """verdict; chosen: the Finalist that completes the model, None; ambiguity: list of lists of
    ids; totals, explained; threshold.
    """

    verdict: str
    chosen: object
    ambiguity: list
    totals: dict
    explained: np.ndarray
    threshold: float


def decide(bench, null, prepared, found, threshold, p_before):
    """Return the Decision of Finalists and pairs, best first, over the model that holds the adopted
    linear effect, if there is one.
    """
    measured = bench.measured_features[null.records]
    totals = naming.totals(bench, null, measured, found)
    linear = linear_sets(prepared)
    singles = [row for row in found if isinstance(row.candidate, Candidate)]
    doubles = [row for row in found if isinstance(row.candidate, Pair) and not idle(row, threshold)]
    best, rest = singles[0] if singles else None, naming.bare_explained(bench, null, measured)
    named = "named" if len(linear) == 1 else "ambiguous"
    if prepared.adopted is None:
        quiet = p_before > priors.SIGNIFICANT or rest.min() > priors.EXPLAINED_Z
        without = Decision("none" if quiet else "unknown", None, [], totals, rest, threshold)
    else:
        without = Decision(
            named if rest.min() > priors.EXPLAINED_Z else "partly_explained",
            None,
            linear,
            totals,
            rest,
            threshold,
        )
    if best is None or totals[best.candidate.name][0] < threshold:
        return without
    added = (
        min(
            totals[doubles[0].candidate.name][0] - totals[best.candidate.name][0],
            doubles[0].total - doubles[0].parts.max(),
        )
        if doubles
        else 0.0
    )
    second = (
        added > threshold
        and naming.explained(bench, best.own(null), best.mean, measured).min() < priors.EXPLAINED_Z
    )
    if second and added > least_added(totals[best.candidate.name][0], threshold):
        best = doubles[0]
    best = simpler(best, found, totals, prepared)
    left = naming.explained(bench, best.own(null), best.mean, measured)
    alike = doubles if isinstance(best.candidate, Pair) else singles
    sufficient = {
        row.candidate.name
        for row in alike
        if naming.explained(bench, row.own(null), row.mean, measured).min() > priors.EXPLAINED_Z
    }
    together = whole_sets(
        linear,
        local_sets(
            best.candidate,
            totals,
            {row.candidate.name for row in alike},
            sufficient,
            added_by_each(best),
        ),
    )
    share = closure(bench, null, best, measured)
    contradicted = vetoed(
        totals[best.candidate.name], share, beyond_chance(bench, null, measured) > 0.0, threshold
    )
    if left.min() < priors.EXPLAINED_Z or contradicted:
        if share <= priors.PARTLY or (
            contradicted and (prepared.adopted is not None or without.verdict != "unknown")
        ):
            return without  # what the lowest record told, and no more
        if isinstance(
            best.candidate, Pair
        ):  # a pair that does not suffice either is not established over its first effect alone
            together += whole_sets(linear, [(singles[0].candidate.ids, singles[0].candidate.alone)])
        elif second:  # nor is a second effect ruled out
            together += whole_sets(
                linear, [(sorted(doubles[0].candidate.ids), doubles[0].candidate.alone)]
            )
        return Decision("partly_explained", best, together, totals, left, threshold)
    return Decision(
        "named" if len(together) == 1 else "ambiguous", best, together, totals, left, threshold
    )


def refuted(decision, misfit):
    """Return whether an explanation makes the held-out records worse, or a partial one none better;
    misfit {split: {before_dB, after_dB, floor_dB, closed_fraction}}.
    """
    if makes_worse(misfit["holdout"]):
        return True
    shares = [misfit[split]["closed_fraction"] for split in ("fit", "holdout")]
    known = [share for share in shares if share is not None]
    partly = decision.verdict == "partly_explained"
    return partly and bool(known) and max(known) < priors.LEAST_CLOSED


def simpler(best, found, totals, prepared):
    """Return the Finalist of one effect in the place of the adopted one that is as good as the best
    beside it, or the best: fewer effects are the better answer.
    """
    if prepared.adopted is None or best.candidate.alone:
        return best
    spared = priors.PARAMETER_COST * len(prepared.adopted["unit"]) + priors.AMBIGUOUS
    alone = [
        row
        for row in found
        if row.candidate.alone
        and totals[row.candidate.name][0] > totals[best.candidate.name][0] - spared
    ]
    return max(alone, key=lambda row: totals[row.candidate.name][0]) if alone else best


def whole_sets(linear, sets):
    """Return [[ids]]: every set [([ids], alone)] of what contact levels tell, with every linear
    effect [[id]] of the lowest record, or in its place.
    """
    out = [
        sorted({*one, *ids})
        for ids, alone in sets
        for one in ([[]] if alone or not linear else linear)
    ]
    return [list(row) for row in dict.fromkeys(map(tuple, out))]


def added_by_each(found):
    """Return {effect id: log likelihood that each effect of a Finalist of a Pair adds to the
    other}, None of a single one.
    """
    if not isinstance(found.candidate, Pair):
        return None
    return {
        found.candidate.first.effect_id: found.total - found.parts[1],
        found.candidate.second.effect_id: found.total - found.parts[0],
    }


def idle(found, threshold):
    """Return whether one of the two effects of a Finalist of a Pair may as well be none: without
    it, the other explains nearly as much.
    """
    return found.total - found.parts.max() < threshold


def linear_sets(prepared):
    """Return [[ids]] of the adopted linear effect, or two, and those that the lowest record can not
    tell from them.
    """
    if prepared.adopted is None:
        return []
    best = candidate_named(prepared.adopted["name"])
    out = [sorted(best.ids)]
    for row in prepared.linear:
        other = candidate_named(row["name"])
        alias = other.effect_id in best.effect.aliases or best.effect_id in other.effect.aliases
        if (
            row["gain"]
            > prepared.adopted["gain"] - (priors.LINEAR_ALIAS if alias else priors.LINEAR_AMBIGUOUS)
            and sorted(other.ids) not in out
        ):
            out.append(sorted(other.ids))
    return out


def local_sets(best, totals, names, sufficient=frozenset(), added=None):
    """Return [([ids], alone)] of what the contact levels can not tell apart, the best first; other
    arguments as of naming.not_told_apart.
    """
    alike = naming.not_told_apart(
        {name: totals[name] for name in names}, best.name, sufficient, added
    )
    out = [
        (sorted(candidate.ids), candidate.alone)
        for candidate in (best, *map(candidate_named, alike))
    ]
    # force and all responses scaled alike are a gap scaled: an exact alias, also beside another
    # effect
    scaled = [
        candidate.ids
        for candidate, _ in best.parts(())
        if candidate.effect_id == "gap" and candidate.location == "all"
    ]
    if scaled:
        out += [
            (sorted({*ids} - {"gap"} | {"sensor_gain"}), alone)
            for ids, alone in out
            if "gap" in ids
        ]
    return out


def beyond_chance(bench, null, measured):
    """Return the squared distance of the measurement from the null beyond that of chance, on all
    records, in units of what seeds and two codes scatter by.
    """
    return float(
        np.sum(naming.chi_squares(bench, null, null.mean, measured, False) - measured.shape[1])
    )


def closure(bench, null, found, measured):
    """Return the share of the distance beyond chance that a Finalist closes, on all records, in
    units of what seeds and two codes scatter by.
    """
    before = beyond_chance(bench, null, measured)
    after = np.sum(
        naming.chi_squares(bench, found.own(null), found.mean, measured) - measured.shape[1]
    )
    return 1.0 - np.sqrt(max(after, 0.0) / before) if before > 0.0 else 0.0


def vetoed(total, share, beyond, threshold):
    """Return whether what was held out contradicts what was fitted: a loss there, or next to
    nothing closed; where nothing is left beyond chance that could be (beyond false), a gain there
    below that of a name (threshold).
    """
    return total[2] < -priors.AMBIGUOUS or (
        share < priors.LEAST_CLOSED if beyond else total[2] < threshold
    )


def effects_of(prepared, decision, model):
    """Return the rows of `effects` of verdict.json; model: the bare one, whose clearances a
    gap_factor multiplies.
    """
    found, rows = [], []
    if prepared.adopted is not None and not (
        decision.chosen is not None and decision.chosen.candidate.alone
    ):
        found.append(
            (
                candidate_named(prepared.adopted["name"]),
                np.array(prepared.adopted["unit"]),
                np.atleast_2d(prepared.adopted["interval"]),
            )
        )
    if decision.chosen is not None:
        found.append((decision.chosen.candidate, decision.chosen.unit, decision.chosen.interval))
    for whole, unit, interval in found:
        ends = zip(whole.parts(interval[:, 0]), whole.parts(interval[:, 1]), strict=True)
        for (candidate, own), ((_, low), (_, high)) in zip(whole.parts(unit), ends, strict=True):
            rows.append(
                _effect(candidate, own, np.stack([low, high], axis=1), prepared.scales, model)
            )
    return rows


def _effect(candidate, unit, interval, sizes, model):
    """Return {id, location, parameters: {name: {value, unit, low, high}}}."""
    estimate = candidate.estimate(unit, interval, sizes)
    parameters = {
        parameter.name: (
            dict(zip(("value", "low", "high"), estimate[parameter.name], strict=True))
            | {"unit": parameter.unit}
        )
        for parameter in candidate.effect.parameters
    }
    nominal = (
        clearance(model, sizes["gap"], candidate.location) if candidate.effect_id == "gap" else None
    )
    if nominal is not None:
        parameters["gap"] = {
            "unit": "m",
            **{key: nominal * parameters["gap_factor"][key] for key in ("value", "low", "high")},
        }
    return {
        "id": candidate.effect.reported,
        "location": candidate.location,
        "parameters": parameters,
    }
