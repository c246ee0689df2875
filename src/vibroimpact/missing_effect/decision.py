"""What is said of the probabilities: named, ambiguous, partly explained, unknown, or none."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.candidates import Candidate, Pair, candidate_named
from vibroimpact.linear_stage.nuisance import Nuisance
from vibroimpact.linear_stage.share_explained import share_explained
from vibroimpact.verdict.content import Conclusion

from . import constants
from .evidence import Fit

Chances = dict[str, float]
Sets = list[tuple[tuple[str, ...], float]]  # ids and the probability of each set
Estimate = Callable[[str], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Chosen:
    """The explanation that completes the model: candidate, unit (parameter,) from 0 to 1 and
    interval (parameter, 2) of 90 %; law_fits: whether its law leaves nothing; probability.
    """

    candidate: Candidate | Pair
    unit: np.ndarray
    interval: np.ndarray
    law_fits: bool
    probability: float
    nuisance: Nuisance | None = None


@dataclass(frozen=True)
class Decision:
    """verdict; chosen: the Chosen, None; ambiguity [[id]] with probabilities (set,); nothing,
    something_else: probabilities that nothing is missing, or something else; rows [(name,
    probability, share of it beside something else)] of explanations, the most probable first;
    linear_ids: what the lowest record told; linear_alone [(ids, probability)]: it and what that
    record cannot tell from it, with nothing beside them; family_alone: what is chosen stands for
    its family, whose laws do not fit.
    """

    verdict: Conclusion
    chosen: Chosen | None
    ambiguity: list
    probabilities: list
    nothing: float
    something_else: float
    rows: list
    linear_ids: tuple = ()
    linear_alone: Sets = field(default_factory=list)
    family_alone: bool = False


def decide(
    chances: Chances,
    fits: dict[str, Fit],
    estimated: Estimate,
    linear: Sets,
    before: float,
    values: int,
    families: Chances,
) -> Decision:
    """Return the Decision of {name: log probability} (probabilities.posterior) and {name: Fit}.

    estimated: what returns (unit, interval) of an explanation's parameters; before: chi-square of
    so many values with nothing added; linear: [(ids, probability)] of what the lowest record told,
    the most probable first, empty where it told nothing: every explanation is beside it, or in its
    place; families {family: probability} that what is missing is like one, the most probable
    first.
    """
    chances = {name: float(np.exp(chance)) for name, chance in chances.items()}
    rows = explanations(chances)
    nothing, other = chances["nothing"], chances["something else"]
    sets = ambiguity_sets(rows, nothing, linear)
    best = rows[0] if rows and rows[0][1] > nothing else None
    chosen = None if best is None or other > 0.5 else chosen_of(best, fits, estimated)
    verdict: Conclusion
    reached, together = smallest(sets)
    if best is None or other > 0.5:
        if linear:
            verdict = "partly_explained" if other > 0.5 else "named"
            reached, together = smallest(linear)
            verdict = "ambiguous" if verdict == "named" and len(together) > 1 else verdict
        else:
            verdict = "unknown" if other > nothing else "none"
    elif reached < constants.NAMED:
        verdict = "partly_explained" if rows[0][1] > 0.5 else "unknown"
        chosen = chosen if verdict == "partly_explained" else None
    elif share_explained(fits[best[0]].left, before, values) < priors.EXPLAINED:
        verdict = "partly_explained"
    else:
        verdict = "named" if len(together) == 1 else "ambiguous"
    family_alone = False
    if verdict == "unknown" and other > 0.5:
        chosen = of_family(rows, fits, estimated, before, families)
        if chosen is not None:
            family_alone, verdict = True, "partly_explained"
            together = [(tuple(chosen.candidate.ids), chosen.probability)]
    told = verdict in ("named", "ambiguous", "partly_explained")
    return Decision(
        verdict,
        chosen,
        [list(ids) for ids, _ in together] if told else [],
        [chance for _, chance in together] if told else [],
        0.0 if linear else nothing,  # else it is that no more is missing
        other,
        rows,
        linear[0][0] if linear else (),
        [(ids, nothing * share) for ids, share in linear],
        family_alone,
    )


def of_family(
    rows: list[tuple[str, float, float]],
    fits: dict[str, Fit],
    estimated: Estimate,
    before: float,
    families: Chances,
) -> Chosen | None:
    """Return the Chosen that stands for the family that what is missing is like: of its laws that
    which leaves least; None where no family is probable enough, or no law of it brings the model
    nearer.
    """
    family = next((name for name, chance in families.items() if chance > constants.NAMED), "")
    own = [
        name
        for name, *_ in rows
        if "+" not in name
        and candidate_named(name).effect.family == family
        and fits[name].left < before
    ]
    if not own:
        return None
    name = min(own, key=lambda name: fits[name].left)
    return Chosen(candidate_named(name), *estimated(name), False, families[family])


def withdrawn_decision(decision: Decision) -> Decision:
    """Return the Decision where what was chosen is not offered: it makes records worse, or hardly
    better. That refutes it, and what is left of the probability is shared by the others: `none`
    where nothing has most of it, else `unknown`, for the others were not verified.
    """
    assert decision.chosen is not None, "else there is nothing to withdraw"
    refuted = decision.chosen.candidate.name
    others = [row for row in decision.rows if row[0] != refuted]
    whole = decision.nothing + decision.something_else + sum(row[1] for row in others)
    out = replace(decision, verdict="unknown", chosen=None, ambiguity=[], probabilities=[])
    if decision.nothing <= 0.5 * whole:
        return out
    return replace(
        out,
        verdict="none",
        nothing=decision.nothing / whole,
        something_else=decision.something_else / whole,
        rows=[(name, chance / whole, beside) for name, chance, beside in others],
    )


def something_else(decision: Decision) -> Decision:
    """Return the Decision where the lowest record is that of another linear structure: what would
    be named beside a wrong model makes up for it.
    """
    return replace(decision, verdict="unknown", nothing=0.0, something_else=1.0)


def partly_decision(decision: Decision) -> Decision:
    """Return the Decision where what was chosen, or adopted, leaves most of what is missing on
    records that took no part.
    """
    sure = decision.verdict in ("named", "ambiguous")
    return replace(decision, verdict="partly_explained") if sure else decision


def explanations(chances: Chances) -> list[tuple[str, float, float]]:
    """Return [(name, probability, share of it beside something else)] of explanations, with or
    without something else, the most probable first.
    """
    both: dict[str, list[float]] = {}
    for name, chance in chances.items():
        if name in ("nothing", "something else"):
            continue
        plain, beside = both.setdefault(name.removesuffix(constants.ELSE), [0.0, 0.0])
        both[name.removesuffix(constants.ELSE)] = (
            [plain, beside + chance] if name.endswith(constants.ELSE) else [plain + chance, beside]
        )
    rows = [
        (name, min(plain + beside, 1.0), beside / max(plain + beside, 1.0e-300))
        for name, (plain, beside) in both.items()
    ]
    return sorted(rows, key=lambda row: -row[1])


def ambiguity_sets(rows: list[tuple[str, float, float]], nothing: float, linear: Sets) -> Sets:
    """Return [(ids, probability)], the most probable first, of sets of ids that explain the
    campaign.
    """
    out: dict[tuple[str, ...], float] = {}
    beside = linear or [((), 1.0)]
    for name, chance, _ in rows:
        candidate = candidate_named(name)
        alike = exactly_alike(candidate)
        for ids, share in [((), 1.0)] if candidate.alone else beside:
            for own in alike:
                key = tuple(sorted({*ids, *own}))
                out[key] = min(out.get(key, 0.0) + chance * share / len(alike), 1.0)
    if linear:
        for ids, share in linear:
            key = tuple(sorted(ids))
            out[key] = min(out.get(key, 0.0) + nothing * share, 1.0)
    return sorted(out.items(), key=lambda row: -row[1])


def exactly_alike(candidate: Candidate | Pair) -> list[list[str]]:
    """Return the sets of ids that no record tells from a candidate, its own first.

    Force and responses scaled alike are clearances scaled, where all of them are: a common gain of
    the chain is not run, and as probable.
    """
    parts = [candidate.first, candidate.second] if isinstance(candidate, Pair) else [candidate]
    own = list(candidate.ids)
    if not any(part.effect_id == "gap" and part.location == "all" for part in parts):
        return [own]
    return [own, ["sensor_gain" if effect == "gap" else effect for effect in own]]


def smallest(sets: Sets) -> tuple[float, Sets]:
    """Return (probability, sets): the fewest that reach constants.NAMED, or that share of what all
    have together where they do not.
    """
    reached, whole = 0.0, sum(chance for _, chance in sets)
    wanted = constants.NAMED * (1.0 if whole >= constants.NAMED else whole)
    out: Sets = []
    for ids, chance in sets:
        if reached >= wanted:
            break
        reached, out = reached + chance, [*out, (ids, chance)]
    return reached, out


def chosen_of(row: tuple[str, float, float], fits: dict[str, Fit], estimated: Estimate) -> Chosen:
    """Return the Chosen of a row of explanations."""
    name, chance, beside = row
    found = fits[name]
    laws = np.exp(found.by_law - found.by_law.max())
    other_law = beside > 0.5 or laws[-1] > laws[:-1].sum()
    return Chosen(candidate_named(name), *estimated(name), not other_law, chance)
