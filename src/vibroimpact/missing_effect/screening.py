"""Screening: every explanation is run at a few points, those that may explain the measurement at
more.
"""

from vibroimpact.effects.effect import Values
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.candidates import candidate_named, elsewhere
from vibroimpact.linear_stage.share_explained import share_explained

from .search import LITTLE, Search, telling

MAY = 0.25  # of the chi-square that the best direction takes away
LEAST = 6


def first_explanations(screened: list[str], places: int = 2) -> list[str]:
    """Return the names to begin with: of every effect `places` places at most."""
    by_effect: dict[str, list[str]] = {}
    for name in screened:
        by_effect.setdefault(candidate_named(name).effect_id, []).append(name)
    return [name for names in by_effect.values() for name in names[:places]]


def screen(search: Search, names: list[str], values: Values) -> None:
    """Run every explanation at two points for each parameter, and those that may explain the
    measurement at more; where no direction takes most of it away, also at single supports, where it
    explains most at all of them.
    """
    counts = {name: 2 * len(candidate_named(name).effect.parameters) for name in names}
    search.screen([search.first(name, count) for name, count in counts.items()])
    if not led(search):
        search.screen(
            [
                (other.name, at_all.unit[telling(at_all, search.null.measured)])
                for at_all in (search.trials[name] for name in names)
                if len(at_all.noise)
                for other in elsewhere(at_all.candidate, values)
            ]
        )
    search.learn()
    search.screen([search.first(name) for name in may_explain(search)])
    search.look()


def led(search: Search) -> bool:
    """Return whether the direction of one explanation takes most of the chi-square beyond chance
    away: of that one alone the single supports are looked at, later.
    """
    measured = search.null.measured
    before = float(measured @ measured)
    most = max(search.explains(measured).values(), default=0.0)
    return share_explained(before - most, before, search.null.values) > priors.EXPLAINED


def may_explain(search: Search) -> list[str]:
    """Return the names of explanations whose best direction takes much of the chi-square away, the
    most first; none where little is to be taken away.
    """
    explains = search.explains(search.null.measured)
    order = sorted(explains, key=lambda name: -explains[name])
    return [
        name
        for name in order
        if explains[name] > LITTLE
        and (explains[name] > MAY * explains[order[0]] or name in order[:LEAST])
    ]
