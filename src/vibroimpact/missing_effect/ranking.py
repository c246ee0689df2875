"""The rows of ranking.csv: explanations, the most probable first."""

import numpy as np

from vibroimpact.effects.effect import Values
from vibroimpact.linear_stage.candidates import candidate_named
from vibroimpact.linear_stage.prepared import Prepared

from .decision import Decision
from .rows import where
from .search import Search
from .verification import Closing

COLUMNS = (
    "ids",
    "location",
    "fit_score",
    "closed_fraction",
    "tested",
    "probability",
)


def ranking_rows(
    search: Search, prepared: Prepared, decision: Decision, closed: Closing
) -> list[Values]:
    """Return the rows of ranking.csv, the most probable first. closed_fraction is that of the
    misfit on the records that took no part, known of what completes the model alone.
    """
    prefix = [] if prepared.adopted is None else list(decision.linear_ids)
    split = "holdout" if len(search.bench.signals.holdout()) else "fit"
    chosen = None if decision.chosen is None else decision.chosen.candidate.name
    share = closed.misfit[split]["closed_fraction"]
    rows = linear_rows(prepared, decision, share)
    for name, chance, _ in decision.rows:
        trial, found = search.trials[name], search.fits[name]
        candidate = trial.candidate
        rows.append(
            {
                "ids": "+".join([*([] if candidate.alone else prefix), *candidate.ids]),
                "location": where(name),
                # none where it brings the model no nearer
                "fit_score": found.log_evidence if np.isfinite(found.log_evidence) else None,
                "closed_fraction": share if name == chosen else None,
                "tested": trial.refined > 0,
                "probability": chance,
            }
        )
    return sorted(rows, key=lambda row: -row["probability"])


def linear_rows(prepared: Prepared, decision: Decision, closed: float | None) -> list[Values]:
    """Return the rows of ranking.csv of what the lowest record told, with nothing beside it, and of
    what it cannot tell from that; closed: the share that the completed model closes.
    """
    if prepared.adopted is None:
        return []
    rows, name = [], prepared.adopted["name"]
    for ids, chance in decision.linear_alone:
        adopted = list(ids) == sorted(candidate_named(name).ids)
        rows.append(
            {
                "ids": "+".join(ids),
                "location": where(name) if adopted else "",
                # evidence is counted from the model with what was adopted
                "fit_score": 0.0 if adopted else None,
                "closed_fraction": closed if adopted and decision.chosen is None else None,
                "tested": adopted,
                "probability": chance,
            }
        )
    return rows
