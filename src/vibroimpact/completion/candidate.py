"""One candidate: a law at a place, alone or beside another, fitted to some levels of a campaign and
tried on the others.
"""

from dataclasses import replace

import numpy as np

from .family import fit_family
from .levels import levels_of, naming_split
from .linear_models import base_of, linear_errors
from .local_laws import LAWS, Scales
from .naming import completed_furthest, leading
from .store import modes_of, trial_of, trial_values
from .study import row_of
from .trial import Fit, Records, Term, Trial, with_offsets

PASSES = 9
FIRST_PASSES = 2  # after which the best of the starts is taken
FREE_STARTS = 6  # drawn participations of a place that no channel shows
SEED = 2012


def run_candidate(campaign, study, linear, name, first=None, told=print):
    """Return the values of a candidate "law.place", or of an addition to `first` (values of another
    candidate): its trial, scores, passes.

    errors: (level, channel) relative errors of the levels it was fitted to and tried on, by level
    name.
    """
    levels, names, _ = levels_of(campaign)
    fitted, tried = naming_split(levels)
    records = Records(tuple(fitted), study.band_Hz, study.mean, study.emphasis)
    law, place = name.split(".")
    if first is None:
        start = _alone(
            modes_of(linear["base"]),
            modes_of(linear["joint"]),
            records,
            law,
            place,
            row_of(study, place, names),
        )
    else:
        start = _added(
            trial_of(first["trial"]),
            modes_of(linear["base"]),
            records,
            law,
            place,
            row_of(study, place, names),
        )
    if start is None:
        told("no start value of this law leaves the motion bounded: the candidate is out")
        return _without_fit(base_of(linear), name, first, [*fitted], [*tried], names, law)
    trial, minimum = Fit(start, records).run(
        PASSES, told=lambda done, cost: told(f"pass {done}: {cost:.5g}")
    )
    both = Records((*fitted, *tried), study.band_Hz, study.mean)
    trial = with_offsets(trial, both)
    predicted = both.predict(trial, 3)
    errors = (
        both.errors(predicted) if predicted else np.full((len(both.levels), len(names)), np.nan)
    )
    return {
        "name": f"{first['name']}+{name}" if first else name,
        "ids": sorted({LAWS[term.law].id for term in trial.terms}),
        "places": [term.place for term in trial.terms],
        "trial": trial_values(trial),
        "cost": minimum.cost,
        "passes": minimum.passes,
        "errors": dict(zip([level.name for level in both.levels], errors.tolist(), strict=True)),
        "fitted": [level.name for level in fitted],
        "tried": [level.name for level in tried],
    }


def _without_fit(modes, name, first, fitted, tried, names, law):
    """The values of a candidate that has no bounded motion: the linear model, and errors that are
    not finite.
    """
    ids = sorted({LAWS[law].id, *(first["ids"] if first else ())})
    errors = {level.name: [np.nan] * len(names) for level in (*fitted, *tried)}
    return {
        "name": f"{first['name']}+{name}" if first else name,
        "ids": ids,
        "places": [],
        "trial": trial_values(Trial(modes)),
        "cost": np.nan,
        "passes": 0,
        "errors": errors,
        "fitted": [level.name for level in fitted],
        "tried": [level.name for level in tried],
    }


def run_addition(campaign, study, linear, name, singles):
    """Return the values of "law.place" beside the best of `singles` by the levels they were tried
    on.
    """
    best = leading(singles, _reference(campaign, study, linear))[0]
    return run_candidate(campaign, study, linear, name, best)


def further_additions(campaign, study, linear, singles, additions, told=print):
    """Return the additions, and the study's other laws beside each addition that is chosen.

    A law that hides behind a stronger one shows once that one is there.
    """
    reference, additions = _reference(campaign, study, linear), list(additions)
    while True:
        chosen = completed_furthest(singles, additions, reference)
        if chosen in singles:
            return additions
        tried = {each["name"] for each in additions}
        names = [
            name
            for name in study.additions
            if name not in chosen["name"].split("+") and f"{chosen['name']}+{name}" not in tried
        ]
        if not names:
            return additions
        additions += [run_candidate(campaign, study, linear, name, chosen, told) for name in names]


def _reference(campaign, study, linear):
    """{level name: (channel,)} errors of the linear model of the lowest level."""
    base = modes_of(linear["base"])
    return {
        level.name: linear_errors(base, level, study.band_Hz) for level in levels_of(campaign)[0]
    }


def _alone(base, joint, records, law, place, row):
    """The start of a law by itself: the best of its start values on the modes of the lowest level,
    of the family, or of all levels.
    """
    family = fit_family(base, row, records.levels, records.band_Hz)
    motion = [
        _rms_motion(family, index, level, records) for index, level in enumerate(records.levels)
    ]
    strength = min(
        float(np.max(np.abs(family.k + 1j * _middle(records) * family.c))),
        _softest(family.modes, np.array(row)),
    )
    scales = Scales(strength, min(motion), max(motion), _middle(records))
    trials = [
        Trial(modes, (Term(law, place, row, values),))
        for modes in (base, family.modes, joint)
        for values in LAWS[law].starts(scales)
    ]
    return _best(trials, records)


def _added(first, base, records, law, place, row):
    """The start of a law beside fitted ones: on their modes or those of the lowest level, or, at a
    place that no channel shows, with one of some drawn participations.
    """
    if row is not None:
        along = first.modes.shapes @ np.array(row)
        scales = _scales(first.modes, records, along)
        groups = [
            [
                replace(first, modes=modes, terms=(*first.terms, Term(law, place, row, values)))
                for values in LAWS[law].starts(scales)
            ]
            for modes in (first.modes, base)
        ]
    else:
        groups = [
            [
                replace(first, terms=(*first.terms, Term(law, place, None, values, along)))
                for values in LAWS[law].starts(_scales(first.modes, records, along))[:2]
            ]
            for along in _drawn_participations(first.modes)
        ]
    starts = [_best(group, records) for group in groups]
    # which of them leads further shows after a few passes only
    tried = [Fit(start, records).run(FIRST_PASSES) for start in starts if start is not None]
    return min(tried, key=lambda found: found[1].cost)[0] if tried else None


def _scales(modes, records, along):
    """The Scales of a relative displacement per unit modal amplitude (mode,)."""
    motion = [_rms_of(modes, level, records, along) for level in records.levels]
    return Scales(_strength(modes, along), min(motion), max(motion), _middle(records))


def _drawn_participations(modes):
    """[(mode,)] of either sign, in proportion to the frequency: a spring there makes the same
    relative change of every frequency.
    """
    drawn = np.random.default_rng(SEED)
    size = np.where(modes.residual, 0.0, modes.omega / np.median(modes.omega))
    return [size * drawn.choice([-1.0, 1.0], size.size) for _ in range(FREE_STARTS)]


def _best(trials, records):
    """The trial with the least squared error, None when none has a bounded motion."""
    costs = []
    for trial in trials:
        predicted = records.predict(trial)
        costs.append(np.inf if predicted is None else records.cost(predicted))
    return trials[int(np.argmin(costs))] if np.isfinite(min(costs)) else None


def _softest(modes, row):
    """A quarter of the stiffness in N/m that, taken away along a relative displacement, would leave
    the structure without any there.
    """
    return float(0.25 / np.sum((modes.shapes @ row) ** 2 / modes.omega**2))


def _strength(modes, along):
    """Stiffness in N/m that would change the frequency of the mode with most of this motion by 1
    %.
    """
    own = ~modes.residual & (along != 0.0)
    return float(np.min(0.02 * modes.omega[own] ** 2 / along[own] ** 2))


def _rms_motion(family, index, level, records):
    lines = level.excited(records.band_Hz)
    return float(
        np.sqrt(
            2.0
            * np.sum(
                np.abs(
                    family.motion(level.frequency[lines], family.k[index], family.c[index])
                    * level.force[lines]
                )
                ** 2
            )
        )
    )


def _rms_of(modes, level, records, along):
    """RMS of the linear motion along a participation (mode,)."""
    lines = level.excited(records.band_Hz)
    driven = (along * modes.shapes[:, modes.drive]) @ modes.receptance(level.frequency[lines])
    return float(np.sqrt(2.0 * np.sum(np.abs(driven * level.force[lines]) ** 2)))


def _middle(records):
    """Angular frequency of the middle of the response, rad/s: where half of its power lies below,
    over all channels of the last level.
    """
    level = records.levels[-1]
    lines = np.flatnonzero(level.excited(records.band_Hz))
    power = np.cumsum(np.sum(np.abs(level.response[:, lines]) ** 2, axis=0))
    return float(2.0 * np.pi * level.frequency[lines[np.searchsorted(power, 0.5 * power[-1])]])
