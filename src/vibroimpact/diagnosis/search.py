"""Forward search: the best effect is added to those found, until none gains on stretches that took
no part.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vibroimpact.campaign.checks.stated import check_row
from vibroimpact.effects.effect import Effect
from vibroimpact.effects.places import arc_length_m
from vibroimpact.effects.registry import EFFECTS

from .bench import (
    Bench,
    counts,
    effective_lines,
    holding_lines,
    log_power,
)
from .catalogue import AT_A_POINT
from .comparison import Comparison
from .constants import NULL_GAIN, needed_gain
from .coordinates import effect_coordinates
from .explanations import Point, Term
from .gauss_newton import SHARES, Fit, fits
from .measurement.usable import Refused
from .nuisances import Nuisances, nuisances_at
from .place_starts import place_terms
from .plate_starts import plate_terms
from .screening import Screened, Screening, gains_of, ranked, screen

RACED, EXCHANGED, FINALISTS = 12, 4, 4
RIVALS_AGAIN = 40  # of the first effect, tried again when a second one is known
SECONDS = 4  # of the starts of a race
VALUES = 4  # at most, from which a fit may begin
SCREENED_RIVALS = 0.1  # of the best gain of a screening, from which other effects are raced
ONE_LAW = 0.01  # of a tube's length: two laws that act nearer are one
ONE_PLACE = 0.05  # of a tube's length: fits that end nearer are one
CONTENDS = 0.6  # of the gain of the best fit, from which others are polished too
RIVALS = 0.3  # of the gain of the best in a race, from which others are finalists
STRONGER = 4.0  # dampers of a race
# Of the gain that one more effect must bring, below which it is not fitted after a race.
PROMISING = 0.4
RACE_PASSES, FINAL_PASSES = 3, 12  # at most
POLISHED, POLISHED_GAIN = 3, 0.01  # times at most, and the gain below which it ends
MOST_EFFECTS = 2
PLATE = "plate_flexibility"
POINT_LAWS = frozenset(AT_A_POINT) - {"added_mass"}


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A fitted explanation.

    gain: of the objective over nothing, in mean log power, on the fitted stretches. apart, error:
    the same on stretches that took no part, with its standard error. change, lines (stretch, band):
    of their log power there, times the number of lines, and that number; None if not known.
    """

    fit: Fit
    gain: float
    apart: float
    error: float
    change: np.ndarray | None = None
    lines: np.ndarray | None = None

    @property
    def point(self) -> Point:
        """Return its Point."""
        return self.fit.point

    @property
    def ids(self) -> tuple[str, ...]:
        """Return the ids of its effects, sorted."""
        return tuple(sorted(self.point.ids))

    @property
    def worth(self) -> float:
        """Return the gain that it counts by: the lower of the gains on the fitted stretches and on
        those that took no part.
        """
        return min(self.apart, self.gain)

    @property
    def sure_gain(self) -> float:
        """Return the least gain over nothing: by two standard errors, or by what a wrong effect
        reaches, if that is less.
        """
        return min(self.apart - min(2.0 * self.error, NULL_GAIN), self.gain)

    def sure_gain_over(self, other: Hypothesis) -> float:
        """Return the gain over another one, less the standard error of their difference apart: of
        two that fit as well, the errors are much alike.
        """
        error = 0.0 if other.point.terms else min(self.error, NULL_GAIN)
        if self.change is not None and other.change is not None and self.lines is not None:
            _, error = jackknife(self.change - other.change, self.lines)
        return min(self.apart - other.apart - error, self.gain - other.gain)


@dataclass(frozen=True, eq=False)
class Search:
    """The hypothesis that nothing is missing, and hypotheses of effects, best first.

    failed: effects without a value that could be run. screened {name of a base: points with one
    effect more, as screened, best first}: the bases are nothing and what got a further effect.
    """

    nothing: Hypothesis
    hypotheses: tuple[Hypothesis, ...]
    failed: tuple[str, ...] = ()
    screened: Mapping[str, tuple[Screened, ...]] = field(default_factory=dict)

    @property
    def other_firsts(self) -> list[Hypothesis]:
        """Return the single effects that gain nearly as much as the best one and have got no second
        one yet, best first.
        """
        singles = [each for each in self.hypotheses if len(each.point.terms) == 1]
        least = max(CONTENDS * singles[0].gain if singles else 0.0, needed_gain(0.0))
        new = (each for each in singles if each.point.name not in self.screened)
        return [each for each in new if each.worth > least]


@dataclass(frozen=True, eq=False)
class _Benches:
    """The benches of a Comparison, each made once."""

    comparison: Comparison
    screened: Bench
    fitted: Bench
    apart: Bench
    effects: Sequence[Effect]


def search(
    comparison: Comparison,
    most: int = MOST_EFFECTS,
    effects: Sequence[Effect] | None = None,
    log: Callable[[str], None] = lambda text: None,
) -> Search:
    """Return the Search of a Comparison for up to `most` effects at once.

    Raises Refused if the model as given can not be run.
    """
    at = _benches(comparison, effects)
    nothing = _nothing(at)
    log(f"holding force as given, in mean log power: {nothing.fit.lines.size} lines are fitted")
    return _forward(at, Search(nothing, ()), nothing, most, log)


def search_from(
    comparison: Comparison,
    before: Search,
    first: Hypothesis,
    effects: Sequence[Effect] | None = None,
    log: Callable[[str], None] = lambda text: None,
) -> Search:
    """Return a Search with the hypotheses of one more effect in addition to a first one, which
    was not the best: of two effects that hide each other, the best single one may be neither.
    """
    log(f"one more effect in addition to {first.point.name}")
    return _forward(_benches(comparison, effects), before, first, 1, log)


def _benches(comparison: Comparison, effects: Sequence[Effect] | None) -> _Benches:
    """Return the _Benches of a Comparison; effects: all of the catalogue if None."""
    return _Benches(
        comparison,
        comparison.screened(),
        comparison.fitted(),
        comparison.apart(),
        list(EFFECTS.values()) if effects is None else effects,
    )


def _forward(
    at: _Benches, before: Search, base: Hypothesis, most: int, log: Callable[[str], None]
) -> Search:
    """Return a Search with the hypotheses of up to `most` effects in addition to a base."""
    nothing, screened = before.nothing, dict(before.screened)
    found = {each.point.name: each for each in before.hypotheses}
    failed = set(before.failed)
    for _ in range(most):
        about = nuisances_at(at.screened, base.point, at.comparison.nuisances())
        screening = _screened(at, about, screened.get(nothing.point.name, ()))
        screened[base.point.name] = screening.ranked
        failed |= {*screening.failed}
        raced = _race(at, about, screening.ranked)
        if not _promises(about, raced, base):
            break
        new = _kept(at, _finals_of(at, raced[:FINALISTS], screening.ranked, nothing), nothing)
        found |= {each.point.name: each for each in new}
        if not new:
            break
        best = max(new, key=lambda each: each.gain)
        for each in sorted(new, key=lambda each: -each.gain):
            log(f"{each.point.name}: {each.gain:.3f}, apart {each.apart:.3f} ± {each.error:.3f}")
        if best.sure_gain_over(base) < needed_gain(base.worth) or best.gain <= NULL_GAIN:
            break  # what right models reach too is no ground for one more
        if len(best.point.terms) > 1:
            others = _without_one(at, best, nothing, screened[nothing.point.name], log)
            found |= {
                each.point.name: max(each, found.get(each.point.name, each), key=_rated)
                for each in others
            }
            best = max([best, *others], key=_rated)
        base = best
    hypotheses = sorted(found.values(), key=lambda each: -each.gain)
    return Search(nothing, tuple(hypotheses), tuple(sorted(failed)), screened)


def _nothing(at: _Benches) -> Hypothesis:
    """Return the Hypothesis that nothing is missing. Raises Refused if it can not be run."""
    if found := _finals(at, [Point()]):
        return found[0]
    names = [at.comparison.signals.record_names[each.record] for each in at.fitted.stretches]
    sentence = (
        f"The model as given, held to the records {', '.join(map(str, names))}, can not be"
        " integrated: its motion grows without bound, or a contact is too stiff for the step."
        " Check the units of the model and of the records, and integration.steps_per_second."
    )
    raise Refused(sentence, [check_row("model", "refuse", sentence)])


def _rated(hypothesis: Hypothesis) -> float:
    """Return the gain of a Hypothesis less the gain that each of its effects must bring."""
    return hypothesis.worth - len(hypothesis.point.terms) * needed_gain(hypothesis.worth)


def _promises(about: Nuisances, raced: Sequence[Screened], base: Hypothesis) -> bool:
    """Return whether one more effect may gain enough, by its gain in a race; about: the base."""
    lines = effective_lines(about.bench, about.lines)
    gain = max((each.gain for each in raced), default=0.0) / lines
    return gain > PROMISING * needed_gain(base.worth)


def _screened(at: _Benches, about: Nuisances, before: Sequence[Screened]) -> Screening:
    """Return the Screening of the effects that a base lacks, in addition to its own. None is added
    twice: two of one kind at neighbouring places are one at a place not tried.

    about: the base. before: effects screened in addition to nothing; empty in the first screening.
    """
    base, known = about.base, {term.effect_id for term in about.base.terms}
    others = [effect for effect in at.effects if effect.id not in known]
    own = at.comparison
    wanted = any(effect.id == PLATE for effect in others)
    demanded = plate_terms(own, at.screened, base) if wanted else []
    demanded += place_terms(own, at.screened, base, others)
    return screen(about, others, own, demanded, before)


def _race(
    at: _Benches, about: Nuisances, screened: Sequence[Screened], most: int = RACED
) -> list[Screened]:
    """Return the best screened points after some passes of Gauss-Newton, best first, one of each
    effect and place. Stronger dampers widen the basin in which these find the right place.

    about: the base, which lacks their last term. most: number of effects in the race.
    """
    starts = _starts(at, screened, most)
    strong = replace(at.screened, strength=STRONGER * at.screened.strength)
    sizes = at.comparison.sizes
    rows = [[*effect_coordinates(own.terms, sizes), *about.rows] for own in starts]
    known = nuisances_at(strong, about.base, about.rows).columns
    ends = fits(strong, list(zip(starts, rows, strict=True)), RACE_PASSES, known, SHARES)
    points = [*starts, *(own.point for own in ends)]
    raced = [
        Screened(*pair)
        for pair in zip(points, map(float, gains_of(about, points)), strict=True)
        if not at.comparison.within_priors(pair[0].terms[-1])
        and not one_law(pair[0].terms, sizes["tube_length"])
    ]
    raced.sort(key=lambda each: -each.gain)
    kept: list[Screened] = []
    for each in raced:
        term, length = each.point.terms[-1], sizes["tube_length"]
        new = not any(_alike(term, own.point.terms[-1], length) for own in kept)
        if new and each.gain >= RIVALS * raced[0].gain:
            kept.append(each)
    return kept


def _starts(at: _Benches, screened: Sequence[Screened], most: int) -> list[Point]:
    """Return the Points that a race begins from: the best of each of `most` effects, and another
    place or another value but the size, of SECONDS that gain much. Many effects look alike until
    they are fitted, as all that takes the force off a support does: one of them would fill the
    race. And the right place may look second best, if there is a second effect.
    """
    outside = (
        each.gain for each in screened if not at.comparison.within_priors(each.point.terms[-1])
    )
    best = next(outside, 0.0)
    firsts: dict[str, Point] = {}
    seconds: dict[str, Point] = {}
    for each in screened:
        term = each.point.terms[-1]
        first = firsts.get(term.effect_id)
        if not np.isfinite(each.gain):
            continue
        if first is None and each.gain >= SCREENED_RIVALS * best:
            firsts[term.effect_id] = each.point
        elif first is not None and each.gain >= CONTENDS * best:
            known = first.terms[-1]
            if (term.name, *term.values[1:]) != (known.name, *known.values[1:]):
                seconds.setdefault(term.effect_id, each.point)
    return [*firsts.values()][:most] + [*seconds.values()][:SECONDS]


def _finals_of(
    at: _Benches,
    raced: Sequence[Screened],
    screened: Sequence[Screened],
    nothing: Hypothesis,
) -> list[Hypothesis]:
    """Return the Hypotheses of raced points. Each fit begins from the raced point or from another
    value that gained nearly as much in screening, whichever is best on the stretches that are
    fitted: the lowest load is among these, and shows a linear structure best.
    """
    length, chosen = at.comparison.sizes["tube_length"], []
    for each in raced:
        term, least = each.point.terms[-1], CONTENDS * each.gain
        others = (own for own in screened if own.gain >= least)
        alike = [own.point for own in others if _alike(own.point.terms[-1], term, length)]
        chosen.append([each.point, *alike[:VALUES]])
    about = _nuisances(at, [each.point for each in raced])
    if about is None:
        return []
    gains = iter(gains_of(about, [point for own in chosen for point in own]))
    best = [int(np.argmax([next(gains) for _ in own])) for own in chosen]
    starts = [own[number] for own, number in zip(chosen, best, strict=True)]
    return _finals(at, starts, nothing, about=about)


def _alike(one: Term, other: Term, length: float) -> bool:
    """Return whether two terms are one effect at one place; length: of the tube, m."""
    first, second = arc_length_m(one.location), arc_length_m(other.location)
    if one.effect_id != other.effect_id or first is None or second is None:
        return (one.effect_id, one.location) == (other.effect_id, other.location)
    return abs(first - second) < ONE_PLACE * length


def one_law(terms: Sequence[Term], length: float) -> bool:
    """Return whether the last of terms is a law at the place of another one on a tube of a length
    in m: the two are one law, of a form that the catalogue has not.
    """
    *others, last = terms
    at = arc_length_m(last.location)
    if at is None or last.effect_id not in POINT_LAWS:
        return False
    places = (arc_length_m(own.location) for own in others if own.effect_id in POINT_LAWS)
    return any(place is not None and abs(place - at) < ONE_LAW * length for place in places)


def _finals(
    at: _Benches,
    points: Sequence[Point],
    nothing: Hypothesis | None = None,
    polished: bool = True,
    about: Nuisances | None = None,
) -> list[Hypothesis]:
    """Return the Hypotheses of points, fitted with all nuisances.

    about: the point where their columns are taken, the first one that runs if None. polished: the
    best fit, and fits that gain nearly as much, take new columns at their ends, as long as that
    helps.
    """
    about = about or _nuisances(at, points)
    found = [] if about is None else _fitted(at, points, about.columns)
    if found and polished:
        best = min(each.objective for each in found)
        spare = 0.0 if nothing is None else max(nothing.fit.objective - best, 0.0)
        least = best + (1.0 - CONTENDS) * spare
        promise = PROMISING * needed_gain(0.0) * effective_lines(at.fitted, found[0].lines)
        if nothing is None or spare > promise:
            found = [_polished(at, each) if each.objective <= least else each for each in found]
    return _hypotheses(at, found, nothing)


def _nuisances(at: _Benches, points: Sequence[Point]) -> Nuisances | None:
    """Return the Nuisances about the first of points that can be run, None if none can."""
    for point in points:
        about = nuisances_at(at.fitted, point, at.comparison.nuisances())
        if np.isfinite(about.lines).all():
            return about
    return None


def _fitted(at: _Benches, points: Sequence[Point], known: np.ndarray) -> list[Fit]:
    """Return the Fits of the effects of points and of the nuisances, whose columns are known."""
    names, sizes = at.comparison.structure.names, at.comparison.sizes
    starts = [point.with_own_gains(names) for point in points]
    rows = [[*effect_coordinates(own.terms, sizes), *at.comparison.nuisances()] for own in starts]
    return fits(at.fitted, list(zip(starts, rows, strict=True)), FINAL_PASSES, known)


def _polished(at: _Benches, found: Fit) -> Fit:
    """Return a Fit from which new columns of the nuisances lead no further."""
    for _ in range(POLISHED):
        about = _nuisances(at, [found.point])
        again = found if about is None else _fitted(at, [found.point], about.columns)[0]
        settled = found.objective - again.objective < POLISHED_GAIN * effective_lines(
            at.fitted, again.lines
        )
        found = again
        if settled:
            break
    return found


def _hypotheses(at: _Benches, found: Sequence[Fit], nothing: Hypothesis | None) -> list[Hypothesis]:
    """Return the Hypotheses of Fits, compared with nothing."""
    if nothing is None:
        return [Hypothesis(own, 0.0, 0.0, 0.0) for own in found]
    before, *after = holding_lines(at.apart, [nothing.point, *(own.point for own in found)])
    out = []
    for own, lines in zip(found, after, strict=True):
        gain = (nothing.fit.objective - own.objective) / effective_lines(at.fitted, own.lines)
        change = changes(at.apart, before, lines)
        out.append(Hypothesis(own, gain, *jackknife(*change), *change))
    return out


def changes(bench: Bench, before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return (change, lines) of a Hypothesis, from lines before and after."""
    number = counts(bench, before)
    change = np.sum(number * (log_power(bench, before) - log_power(bench, after)), axis=1)
    return change, number.sum(axis=1).astype(float)


def jackknife(change: np.ndarray, lines: np.ndarray) -> tuple[float, float]:
    """Return (gain, standard error) in mean log power, by leaving out each stretch and band.

    change, lines (stretch, band): see Hypothesis.
    """
    if not np.isfinite(change).all():
        return -np.inf, np.inf
    left_out = ((change.sum() - change) / (lines.sum() - lines)).ravel()
    error = np.sqrt((left_out.size - 1) * left_out.var())
    return float(change.sum() / lines.sum()), float(error)


def _without_one(
    at: _Benches,
    best: Hypothesis,
    nothing: Hypothesis,
    screened: Sequence[Screened],
    log: Callable[[str], None],
) -> list[Hypothesis]:
    """Return Hypotheses in which the first effect of the best is dropped or, if that costs too
    much, exchanged: it was chosen before the others were known, and may stand for another one, or
    for itself at another place. And one in which the last is dropped: it may have helped the fit of
    the others alone.

    screened: effects in addition to nothing, best first: the rivals of the first effect, which are
    tried again in addition to the others.
    """
    base = replace(best.point, terms=best.point.terms[1:])
    out = _kept(at, _finals(at, [base], nothing, polished=False), nothing)
    if not out or best.apart - out[0].apart >= needed_gain(out[0].apart):
        dropped, *left = best.point.terms
        known = {term.effect_id for term in left}
        terms = (each.point.terms[-1] for each in screened)
        rivals = [
            base.beside(term)
            for term in terms
            if term.effect_id not in known and term.name != dropped.name
        ]
        about = nuisances_at(at.screened, base, at.comparison.nuisances())
        raced = _race(at, about, ranked(about, rivals[:RIVALS_AGAIN]), EXCHANGED)[:2]
        points = [each.point for each in raced]
        out += _kept(at, _finals(at, points, nothing, polished=False), nothing)
    rest = replace(best.point, terms=best.point.terms[:-1])
    out += _kept(at, _finals(at, [rest], nothing, polished=False), nothing)
    for each in out:
        log(f"without one: {each.point.name}: {each.gain:.3f}, apart {each.apart:.3f}")
    return out


def _kept(at: _Benches, found: Sequence[Hypothesis], nothing: Hypothesis) -> list[Hypothesis]:
    """Return the Hypotheses that could be run and name no law twice, without the effects that are
    within the priors.
    """
    length, out = at.comparison.sizes["tube_length"], []
    for each in found:
        net = zip(each.point.terms, each.point.net_terms, strict=True)
        terms = tuple(term for term, own in net if not at.comparison.within_priors(own))
        if terms and len(terms) < len(each.point.terms):
            [each] = _finals(at, [replace(each.point, terms=terms)], nothing) or [each]
        if terms and np.isfinite(each.gain) and not one_law(terms, length):
            out.append(each)
    return out
