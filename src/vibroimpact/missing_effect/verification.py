"""What the completed model does on records that took no part: fresh runs of it and of the model as
given, beside the measurement.
"""

from dataclasses import dataclass

from vibroimpact.discrepancy.conclusion import Verified, misfits, verified
from vibroimpact.discrepancy.misfit import makes_worse
from vibroimpact.discrepancy.workbench import Workbench
from vibroimpact.integration.contact_convergence import IntegrationError

from .decision import Chosen

RUNS = 32  # of whole records in all


@dataclass(frozen=True)
class Closing:
    """benches: Workbenches of the model as given and of that with what was adopted; before, after:
    Verified of the model as given and of the completed one; misfit {split: row of
    verdict.json}; worse: whether it grows on
    the records that took no part.
    """

    benches: tuple
    before: Verified
    after: Verified
    misfit: dict
    worse: bool = False


def closing(
    given: Workbench,
    whole: Workbench,
    window: Workbench,
    chosen: Chosen | None,
    scales: dict[str, float],
) -> Closing:
    """Return the Closing of a Workbench of the model as given and one with what was adopted, and
    what is Chosen (None: nothing more); window: Workbench of what was compared.
    """
    benches = given, whole
    seeds = max(2, min(8, RUNS // len(whole.signals.load)))
    before = verified(given, given.model(), seeds, window)
    if chosen is None:
        after = before if whole is given else verified(whole, whole.model(), seeds, window)
        return _judged(benches, before, after)
    physical = chosen.candidate.physical(chosen.unit, scales)
    try:
        model = whole.model(whole.variant(chosen.candidate, physical))
        after = verified(whole, model, seeds, window)
    except IntegrationError:
        return Closing(benches, before, before, misfits(whole, before, before), True)
    return _judged(benches, before, after)


def _judged(benches, before, after):
    """Return the Closing of two Verified."""
    rows = misfits(benches[1], before, after)
    split = "holdout" if rows["holdout"]["before_dB"] is not None else "fit"
    return Closing(benches, before, after, rows, makes_worse(rows[split]))


def without_chosen(closed: Closing, window: Workbench) -> Closing:
    """Return a Closing in which nothing more is added than what was adopted; nothing at all where
    that makes the records that took no part worse too; window: see closing.
    """
    given, whole = closed.benches
    before = closed.before
    if whole is not given:
        seeds = before.features.shape[1]
        found = _judged(closed.benches, before, verified(whole, whole.model(), seeds, window))
        if not found.worse:
            return found
    return Closing(closed.benches, before, before, misfits(given, before, before))
