"""What a user's completion leaves: the verdict by the contract, whatever came of it, with the
prediction and a model that runs.
"""

import numpy as np

from vibroimpact.records import write_table, write_text
from vibroimpact.run_cost import with_cost
from vibroimpact.spectra.periodic_lines import PeriodError
from vibroimpact.verdict.content import Verdict, not_testable
from vibroimpact.verdict.file import write_verdict
from vibroimpact.verdict.misfit import not_offered

from .conclude import conclude
from .levels import levels_of
from .linear_models import linear_errors
from .misfit import regions
from .store import modes_of, trial_values, write_values
from .trial import Records, Trial
from .updated_model import write_configuration

PREDICTION = ("level", "split", "channel", "error_linear", "error_refitted", "error_completed")


def outcome(campaign, study, prepared, linear, singles, additions, provenance, told=print):
    """Return (Verdict, rows of prediction.csv, completed or None) of a user's campaign; prepared:
    values of prepare.prepared.

    completed is None where no linear model stands either.
    """
    if prepared["refused"]:
        return _refused(campaign, study, prepared, linear, prepared["refused"], provenance)
    try:
        return conclude(
            campaign, study, linear, singles, additions, told, prepared["checks"], provenance
        )
    except ValueError as error:
        return _refused(campaign, study, prepared, linear, str(error), provenance)


def write_outcome(told, campaign, study, files, cost):
    """Write an outcome: files has the paths verdict, prediction, completed and model. Without a
    linear model the last two say so. cost: of all jobs, as cost.total_cost returns it.
    """
    verdict, rows, completed = told
    verdict = Verdict.from_values(verdict.to_values() | with_cost(cost))
    write_table(rows, files.prediction, PREDICTION)
    write_values(completed or {}, files.completed)
    if verdict.withdrawn is not None:
        write_text(not_offered(verdict.withdrawn.to_values()), files.model)
    elif completed:
        write_configuration(completed, campaign, study, files.model)
    else:
        write_text(
            "# There is no model: the campaign could not be tested, see verdict.json.\n",
            files.model,
        )
    write_verdict(verdict, files.verdict)


def _refused(campaign, study, prepared, linear, sentence, provenance):
    """The outcome not_testable: where a linear model stands, with the map of what it misses and its
    prediction, level by level.
    """
    checks = list(prepared["checks"])
    if sentence not in " ".join(row["message"] for row in checks if row["level"] == "refuse"):
        checks.append(
            {
                "check": "linear model",
                "level": "refuse",
                "record": None,
                "channel": None,
                "message": sentence,
            }
        )
    if not linear:
        return not_testable(checks, provenance), _nothing(campaign), None
    levels, names, _ = levels_of(campaign)
    base, records = modes_of(linear["base"]), Records(tuple(levels), study.band_Hz)
    before = [
        base.frf(level.frequency[records.kept(level)]) * level.force[records.kept(level)]
        for level in levels
    ]
    rows = []
    for level in levels:
        first = linear_errors(base, level, study.band_Hz)
        again = linear_errors(modes_of(linear["refitted"][level.name]), level, study.band_Hz)
        rows += [
            {
                "level": level.name,
                "split": level.split,
                "channel": name,
                "error_linear": float(first[index]),
                "error_refitted": float(again[index]),
                "error_completed": np.nan,
            }
            for index, name in enumerate(names)
        ]
    return (
        not_testable(checks, provenance, regions=regions(records, before, names)),
        rows,
        {
            "chosen": "the linear model alone",
            "trial": trial_values(Trial(base)),
            "scores": {},
            "ids": {},
        },
    )


def _nothing(campaign):
    """Rows without errors, for a campaign whose records have no lines."""
    if campaign is None:
        return []
    try:
        levels, names, _ = levels_of(campaign)
    except (PeriodError, ValueError):
        return []
    return [
        {
            "level": level.name,
            "split": level.split,
            "channel": name,
            "error_linear": np.nan,
            "error_refitted": np.nan,
            "error_completed": np.nan,
        }
        for level in levels
        for name in names
    ]
