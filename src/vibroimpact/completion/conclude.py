"""The end of a completion: the chosen candidate fitted to all fitted levels, predicted everywhere,
and told as a verdict.
"""

import numpy as np
from scipy.stats import chi2

from vibroimpact.config.measured_structure import ELSEWHERE
from vibroimpact.run_cost import Meter, total_cost, with_cost
from vibroimpact.spectra.periodic_lines import line_power
from vibroimpact.verdict.content import WITH_AMBIGUITY_SET, WITH_EFFECTS, Verdict
from vibroimpact.verdict.misfit import makes_worse

from .candidate import further_additions
from .intervals import told_parameters
from .levels import levels_of
from .linear_models import linear_errors
from .local_laws import LAWS
from .misfit import CALIBRATION_DB, disagreement, misfit_summary, regions
from .naming import believed, choose
from .record_checks import check_periods
from .store import modes_of, trial_of, trial_values
from .trial import Fit, Records, with_offsets
from .updated_model import is_relative

PASSES = 15
PERIODS_BEFORE = 4  # before the period that is compared: the transient is gone
SPLITS = ("fit", "holdout")


def conclude(campaign, study, linear, singles, additions, told=print, checks=(), provenance=None):
    """Return (Verdict, rows of prediction.csv, completed {chosen, trial, choice}) of a campaign
    from its candidates' values.

    checks: rows of what was checked before; provenance: see provenance.verdict_origin.
    """
    meter = Meter("verdict")
    levels, names, _ = levels_of(campaign)
    reference, joint, again = (
        {
            level.name: linear_errors(modes, level, study.band_Hz)
            for level in levels
            for modes in [_modes(linear, which, level)]
        }
        for which in ("base", "joint", "refitted")
    )
    additions = further_additions(campaign, study, linear, singles, additions, told)
    choice = choose(singles, additions, reference, joint, again)
    chosen = next(each for each in (*singles, *additions) if each["name"] == choice.chosen)
    fitted = Records(
        tuple(level for level in levels if level.split == "fit"),
        study.band_Hz,
        study.mean,
        study.emphasis,
    )
    fit = Fit(trial_of(chosen["trial"]), fitted)
    trial, minimum = fit.run(PASSES, told=lambda done, cost: told(f"final pass {done}: {cost:.5g}"))
    everything = Records(tuple(levels), study.band_Hz, study.mean)
    trial = with_offsets(trial, everything)
    predicted = everything.predict(trial, PERIODS_BEFORE)
    if predicted is None:
        raise ValueError(
            f"{choice.chosen}: the completed model has no bounded motion at some level that it was"
            " not fitted to: leave that level out"
        )
    lines = [everything.kept(level) & (level.frequency > 0.0) for level in levels]
    completed = [
        part[:, line[everything.kept(level)]]
        for part, line, level in zip(predicted, lines, levels, strict=True)
    ]
    errors = [
        _relative(part, level.response[:, line])
        for part, line, level in zip(completed, lines, levels, strict=True)
    ]
    rows = [
        {
            "level": _number(level.name),
            "split": level.split,
            "channel": channel,
            "error_linear": float(reference[level.name][index]),
            "error_refitted": float(again[level.name][index]),
            "error_completed": float(errors[place][index]),
        }
        for place, level in enumerate(levels)
        for index, channel in enumerate(names)
    ]
    alone = Records(tuple(levels), study.band_Hz)
    before = [
        modes_of(linear["base"]).frf(level.frequency[line]) * level.force[line]
        for line, level in zip(lines, levels, strict=True)
    ]
    left = [
        _rms([each[name] for name in choice.tried]) for each in (reference, again, chosen["errors"])
    ]
    tried = [level for level in levels if level.name in choice.tried]
    kind = believed(
        choice.verdict,
        *left,
        np.hypot(
            _floor(levels, reference, study.band_Hz),
            left[0] * _unsettled(tried, modes_of(linear["base"])),
        ),
    )
    effects = _effects(study, choice, told_parameters(fit, minimum, trial), trial)
    verdict = _verdict(choice, kind, alone, before, completed, effects, trial)
    verdict |= _withdrawn(verdict, effects)
    verdict["checks"] = [*checks, *check_periods(levels, names, study.band_Hz)]
    verdict |= with_cost(total_cost([], meter.read()))
    if provenance is not None:
        verdict["provenance"] = provenance
    return (
        Verdict.from_values(verdict),
        rows,
        {
            "chosen": choice.chosen,
            "trial": trial_values(trial),
            "scores": choice.scores,
            "ids": choice.ids,
        },
    )


def _withdrawn(verdict, told):
    """Return what changes of a verdict whose completed model makes the held-out levels worse: it is
    told and not offered. Empty where it makes them better. told: rows of its effects.
    """
    held_out = verdict["misfit"]["holdout"]
    if held_out is None or verdict["verdict"] == "none" or not makes_worse(held_out):
        return {}
    return {
        "verdict": "unknown",
        "effects": [],
        "ambiguity_set": [],
        "next_measurement": None,
        "p_global_after": verdict["p_global_before"],
        "withdrawn": {"effects": told, "misfit": verdict["misfit"]},
        "misfit": {split: _unchanged(row) for split, row in verdict["misfit"].items()},
    }


def _unchanged(row):
    """Return the misfit of the model as given in the place of the completed one's."""
    return row and row | {
        "after_dB": row["before_dB"],
        "closed_fraction": row["closed_fraction"] and 0.0,
    }


def _modes(linear, which, level):
    return modes_of(linear["refitted"][level.name] if which == "refitted" else linear[which])


def _relative(lines, measured):
    """(channel,) RMS of the difference over the RMS measured; lines and measured (channel, line)
    without the mean.
    """
    return np.sqrt(
        np.sum(np.abs(lines - measured) ** 2, axis=1) / np.sum(np.abs(measured) ** 2, axis=1)
    )


def _number(name):
    """The number in a level's name: 3 of level 3, 100 of 100 mV; the name where there is none."""
    numbers = [word for word in name.split() if word.replace(".", "", 1).isdigit()]
    return (
        int(numbers[0])
        if numbers and numbers[0].isdigit()
        else (float(numbers[0]) if numbers else name)
    )


def _rms(errors):
    return float(np.sqrt(np.mean(np.square(np.array(errors, float)))))


def _floor(levels, reference, band_Hz):
    """Relative error that is left in any case: what the linear model misses of the lowest fitted
    level, its noise among it.
    """
    lowest = next(level for level in levels if level.split == "fit")
    lines = lowest.excited(band_Hz)
    noise = np.sqrt(
        line_power(np.nan_to_num(lowest.noise), lowest.frequency, lines)
        / line_power(lowest.response, lowest.frequency, lines)
    )
    return max(_rms(reference[lowest.name]), _rms(noise))


def _unsettled(levels, modes):
    """Share of a change by level that records without period show wrongly: their start is that of a
    force repeated for ever, until it is forgotten.
    """
    own = ~modes.residual
    memory = 1.0 / np.min(modes.damping[own])  # s, in which the energy of a mode falls by e
    return max(
        (
            float(np.sqrt(min(memory * level.frequency[1], 1.0)))
            for level in levels
            if level.periods == 0
        ),
        default=0.0,
    )


def _effects(study, choice, parameters, trial):
    """The rows of effects of the completed model."""
    elsewhere = _places_as_good(choice)
    return [
        {
            "id": LAWS[term.law].id,
            "location": _location(study, term) + elsewhere,
            "parameters": {
                name: each | {"unit": study.unit(each["unit"])} for name, each in told.items()
            },
        }
        for term, told in zip(trial.terms, parameters, strict=True)
    ]


def _verdict(choice, kind, records, before, after, effects, trial):
    """The verdict but for checks and times."""
    names = trial.modes.names
    first, floor = disagreement(records, before)
    last, _ = disagreement(records, after)
    held = [level.split == "holdout" for level in records.levels]
    parts = {"fit": [not each for each in held], "holdout": held}
    misfit = {
        split: misfit_summary(first[part], last[part], floor[part]) if any(part) else None
        for split, part in parts.items()
    }
    ranking = [
        {
            "ids": choice.ids[name],
            "candidate": name,
            "heldout_score": value if np.isfinite(value) else None,
            "closed_fraction": _closed(value),
        }
        for name, value in sorted(choice.scores.items(), key=lambda item: -item[1])
    ]
    return {
        "verdict": kind,
        "effects": effects if kind in WITH_EFFECTS else [],
        "ambiguity_set": choice.ambiguity if kind in WITH_AMBIGUITY_SET else [],
        "ranking": ranking,
        "next_measurement": _next(kind, choice),
        "broken_invariances": _broken(records, before, trial),
        # where the levels together are within chance, no band of them is marked
        "regions": [] if kind == "none" else regions(records, before, names),
        "misfit": misfit,
        "p_global_before": _p_value(first, floor),
        "p_global_after": _p_value(last, floor),
    }


def _closed(score):
    """Fraction of the tried records' error that is gone, from the score in dB."""
    return float(1.0 - 10.0 ** (-score / 20.0)) if np.isfinite(score) else None


def _location(study, term):
    """Where an effect acts, in words."""
    if term.place == ELSEWHERE:
        return "elsewhere: no channel shows the place; its share in every mode was fitted"
    weights = study.places[term.place]
    ends = [name for name, _ in sorted(weights.items(), key=lambda item: item[1])]
    if not is_relative(weights):
        return f"{term.place}: along " + " ".join(
            f"{weight:+g} {name}" for name, weight in weights.items()
        )
    return (
        f"{term.place}: between {ends[0]} and {ends[1]}"
        if len(ends) == 2
        else f"{term.place}: at {ends[0]}, to the ground"
    )


def _places_as_good(choice):
    """What is said where the same law at another place explains the records as well."""
    place, ids = choice.chosen.partition(".")[2], choice.ids[choice.chosen]
    others = sorted(
        {
            name.partition(".")[2]
            for name in choice.as_good
            if "+" not in name and choice.ids[name] == ids
        }
        - {place}
    )
    return (
        f" (as well explained at {', '.join(others)})"
        if others and "+" not in choice.chosen
        else ""
    )


def _next(kind, choice):
    """The measurement that would tell the members of an ambiguity set apart."""
    if kind == "none" or (kind != "unknown" and len(choice.ambiguity) == 1):
        return None
    if kind == "unknown":
        return "A sensor at more points: no law between the measured points explains the levels."
    several = " and ".join("+".join(ids) for ids in choice.ambiguity)
    return (
        "A slow sine up and down through the peak at two levels, and a static load cycle at the"
        f" place: its loop tells {several} apart."
    )


def _broken(records, before, trial):
    """The invariances that the records break, by name: T2 (shape independent of level), T3 (an even
    law is seen), T5 (friction takes power).
    """
    broken = []
    relative = [
        np.sqrt(
            np.sum(np.abs(lines - level.response[:, records.kept(level)]) ** 2)
            / np.sum(np.abs(level.response[:, records.kept(level)]) ** 2)
        )
        for level, lines in zip(records.levels, before, strict=True)
    ]
    if max(relative[1:]) > 2.0 * relative[0]:
        broken.append("T2 scaling: the response per force changes with the level")
    laws = {LAWS[term.law].id for term in trial.terms}
    broken += (
        ["T3 parity: the mean or even lines change with the level"]
        if "quadratic_stiffness" in laws
        else []
    )
    broken += (
        ["T5 power balance: more power is taken at higher levels"]
        if laws & {"coulomb_friction", "quadratic_drag", "saturation_damping"}
        else []
    )
    return broken


def _p_value(difference, floor):
    """Probability of disagreements this large by noise and calibration alone."""
    known = np.isfinite(difference) & np.isfinite(floor)
    return float(
        chi2.sf(
            np.sum((difference[known] ** 2) / (floor[known] ** 2 + CALIBRATION_DB**2)), known.sum()
        )
    )
