"""What the completed model does on records that took no part: fresh runs of it and of the model as
given, beside the measurement.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibroimpact.discrepancy import discrepancy_map as mapping
from vibroimpact.discrepancy import misfit
from vibroimpact.discrepancy.divergence_filter import survivors
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.linear_stage import priors
from vibroimpact.linear_stage.counted_cells import counted
from vibroimpact.linear_stage.workbench import Workbench

from . import constants
from .decision import Chosen

FRESH = 20000  # first seed of the verification: none of the search's
RUNS = 32  # of whole records in all
LEAST_DB = 0.05  # of a floor: less is the scatter of no two runs


@dataclass(frozen=True)
class Verified:
    """Fresh seeds of a model on whole records: features (record, seed, feature); compared (record,
    feature): their mean over what candidates were calibrated on; shown (record, shown seed,
    channel, sample): responses with noise.
    """

    features: np.ndarray
    compared: np.ndarray
    shown: np.ndarray


def verified(whole: Workbench, model: Any, seeds: int, bench: Workbench) -> Verified:
    """Return the Verified of a model on the Workbench of whole records; bench: that of what was
    compared.
    """
    records = len(whole.signals.load)
    runs = whole.runs(range(records), seeds, FRESH)
    responses = whole.respond(model, runs)
    features, compared = (
        window.noisy_features(runs, responses).reshape(records, seeds, -1)
        for window in (whole, bench)
    )
    stayed = survivors(features)
    features, compared = (
        np.take_along_axis(rows, stayed[..., None], axis=1) for rows in (features, compared)
    )
    responses = responses.reshape(records, seeds, *responses.shape[1:])[
        np.arange(records)[:, None], stayed[:, : mapping.SHOWN_SEEDS]
    ]
    noise = np.random.default_rng(11).standard_normal(
        responses.shape, dtype=np.float32
    ) * whole.signals.noise[:, None].astype(np.float32)
    shown = np.where(np.isfinite(whole.signals.force[:, :1])[:, None], responses + noise, np.nan)
    return Verified(features, compared.mean(axis=1), shown)


def misfits(whole: Workbench, before: Verified, after: Verified) -> dict[str, Any]:
    """Return {split: misfit.misfit_of} of what two Verified leave, nothing known where a split has
    no records.
    """
    cells = counted(whole) & _repeat(whole, before) & _repeat(whole, after)
    splits = {
        "fit": whole.signals.fit(),
        "holdout": whole.signals.holdout(),
    }
    return {
        name: (
            misfit.misfit_of(
                whole,
                records,
                cells,
                before.features,
                after.features,
            )
            if len(records)
            else {"before_dB": None, "after_dB": None, "floor_dB": None, "closed_fraction": None}
        )
        for name, records in splits.items()
    }


def _repeat(whole, runs):
    """Return misfit.repeats of a Verified."""
    return misfit.repeats(whole.layout.power(runs.features))


@dataclass(frozen=True)
class Closing:
    """benches: Workbenches of the model as given and of that with what was adopted; before, after:
    Verified of the model as given and of the completed one; misfit {split: row of
    verdict.json}; judged: the split of the records that took no part, "fit" where there are none;
    worse: whether the misfit grows on them or, of what the search chose, on those that it was
    fitted to.
    """

    benches: tuple
    before: Verified
    after: Verified
    misfit: dict
    judged: str
    worse: bool = False

    @property
    def partial(self) -> bool:
        """Return whether the completed model leaves most of the excess on the judged records."""
        return self._closes_less_than(constants.CLOSED)

    @property
    def no_part(self) -> bool:
        """Return whether the completed model leaves so much that what is added is no part of what
        is missing.
        """
        return self.worse or self._closes_less_than(1.0 - priors.EXPLAINED)

    def _closes_less_than(self, wanted):
        share = self.misfit[self.judged]["closed_fraction"]
        return share is not None and share < wanted


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
        rows = misfits(whole, before, before)
        return Closing(benches, before, before, rows, judged_split(rows), True)
    found = _judged(benches, before, after)
    return replace(found, worse=any(misfit.makes_worse(row) for row in found.misfit.values()))


def _judged(benches, before, after):
    """Return the Closing of two Verified."""
    rows = misfits(benches[1], before, after)
    split = judged_split(rows)
    return Closing(benches, before, after, rows, split, misfit.makes_worse(rows[split]))


def telling_record(closed: Closing) -> str | None:
    """Return the name of the held-out record that disagrees most with the completed model of a
    Closing, None where none does by more than chance: an excess over the floor as large as it.

    Where the fitted records show nothing, as they may when contact begins in the others, what is
    missing is looked for with that record, and verified on the rest.
    """
    whole, features = closed.benches[1], closed.after.features
    cells = counted(whole) & _repeat(whole, closed.after)
    most, name = 1.0, None
    for record in whole.signals.holdout():
        row = misfit.misfit_of(whole, np.array([record]), cells, features, features)
        before, floor = float(row["before_dB"] or 0.0), float(row["floor_dB"] or 0.0)
        share = misfit.excess(before, floor) / max(floor, LEAST_DB)
        if share > most:
            most, name = share, whole.signals.record_names[record]
    return name


def judged_split(rows: dict) -> str:
    """Return the split of {split: misfit} that took no part, "fit" where it has no records."""
    return "fit" if rows["holdout"]["before_dB"] is None else "holdout"


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
    rows = misfits(given, before, before)
    return Closing(closed.benches, before, before, rows, judged_split(rows))
