"""A campaign whose structure is identified from its own records, as a diagnosis needs it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import xarray as xr

from vibroimpact.campaign.signals import transfer_band
from vibroimpact.config.measured_structure import MeasuredStructure
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.identify.spectra.periodic_lines import LevelLines

from ..decision import Decision
from ..free_runs import FreeRuns
from ..measurement.signals import signals_of
from ..measurement.usable import refuse
from ..search import Hypothesis
from .evidence import PERIODS_BEFORE, evidence_of, free_runs, steady_lines
from .fit import Fitted
from .levels import levels_of, naming_split, noise_row
from .linear_models import (
    fit_family,
    linear_errors,
    linear_models,
    ranked_places,
    row_of,
    tried_places,
)
from .records import Rows, along_force, repeating, usable_records
from .search import PASSES, Log, Setting
from .stated import check_mean, check_names, default_band, laws_of, own_units, places_of
from .trial import LocalTerm, Records, Trial
from .updated_model import configuration_text, location

MISSED = 0.5  # of the response of the lowest level: a linear model that misses more is refused
PREDICTION = ("level", "split", "channel", "error_linear", "error_refitted", "error_completed")


@dataclass(frozen=True, eq=False)
class Identified(Setting):
    """A campaign by its levels, in ascending load, and the models identified from it.

    campaign: its usable part. everything: Records of all levels. units: of generic channels, see
    stated.own_units.
    """

    campaign: xr.Dataset
    everything: Records
    units: dict[str, str]

    @property
    def fitted_levels(self) -> list[LevelLines]:
        """Return the levels that are fitted once the laws are chosen."""
        return [level for level in self.everything.levels if level.split == "fit"]

    def completed(self, decision: Decision, rows: Rows) -> Decision:
        """Return the Decision with its best hypothesis fitted to all fitted levels.

        Raises Refused if it has no bounded motion at some level.
        """
        (best, chance), *others = decision.ranked
        records = replace(self.fitted, levels=self.fitted_levels)
        try:
            own = Fitted(cast(Trial, best.point), records, PASSES)
            own.point = self.everything.with_offsets(own.point)
            steady_lines(own.point, self.everything)
        except ValueError as error:
            refuse(str(error), rows)
        best = replace(best, fit=cast(Any, own))
        return replace(decision, ranked=((best, chance), *others))

    def states(self, chosen: Hypothesis | None) -> tuple[Trial, Trial]:
        """Return the model before and after: the modes of the lowest level, and the completed one;
        chosen: None if nothing is completed.
        """
        given = Trial(self.linear.base)
        return given, given if chosen is None else cast(Trial, chosen.point)

    def free_runs(self, chosen: Hypothesis | None) -> FreeRuns:
        """Return the FreeRuns before and after; the band of a mean begins at a hundredth of its
        end.
        """
        low, high = self.everything.band_Hz
        signals = replace(signals_of(self.campaign), band_Hz=(max(low, 0.01 * high), high))
        return free_runs(signals, *self.states(chosen), self.everything)

    def effect_rows(self, hypothesis: Hypothesis) -> list[dict[str, Any]]:
        """Return the rows of `effects` of verdict.json."""
        own, rows = cast(Fitted, hypothesis.fit), []
        for term, told in zip(own.point.terms, own.estimates(), strict=True):
            for each in told.values():
                each["unit"] = self.units.get(each["unit"], each["unit"])
            known = EFFECTS.get(term.effect_id)
            row = {"id": term.effect_id, "family": known.family if known else None}
            rows.append(row | {"location": term.location, "parameters": told})
        return rows

    def model_text(self, trial: Any, sentence: str) -> str:
        """Return the YAML text of the configuration of a Trial."""
        loads = [level.load_rms for level in self.everything.levels]
        return configuration_text(trial, self.places, self.everything.band_Hz, loads, sentence)

    def evidence(self, chosen: Hypothesis | None) -> xr.Dataset:
        """Return the evidence before and after, see evidence.evidence_of; with place_error
        (ranked_place,), and the equivalent stiffness and damping (fitted_level,) of the place of
        the first law, or of the best one: changes against the lowest level.
        """
        places, (before, after) = self.ranking, self.states(chosen)
        out = evidence_of(self.campaign, self.everything, before, after, not self.units)
        place = [*(term.place for term in after.terms if term.place in places), *places][0]
        levels = self.fitted_levels
        family = fit_family(before.modes, places[place].row, levels, self.everything.band_Hz)
        return out.assign_coords(
            ranked_place=list(places), fitted_level=[level.name for level in levels]
        ).assign(
            place_error=("ranked_place", [own.error for own in places.values()], {"units": "1"}),
            stiffness_change=("fitted_level", family.k, {"units": "N/m", "place": place}),
            damping_change=("fitted_level", family.c, {"units": "N s/m", "place": place}),
        )

    def prediction(self, chosen: Hypothesis | None) -> list[dict[str, Any]]:
        """Return the rows of prediction.csv: relative error of the steady response of each level
        and channel by the modes of the lowest level, those identified again, the completed model.
        """
        everything, rows = self.everything, []
        errors = everything.errors(self.states(chosen)[1], PERIODS_BEFORE)
        for level, completed in zip(everything.levels, errors, strict=True):
            linear, again = (
                linear_errors(modes, level, everything.band_Hz)
                for modes in (self.linear.base, self.linear.again[level.name])
            )
            head = _number(level.name), level.split
            for row in zip(self.linear.base.names, linear, again, completed, strict=True):
                rows.append(dict(zip(PREDICTION, (*head, *row), strict=True)))
        return rows


def _number(name: str) -> int | float | str:
    """Return the number in a level's name: 3 of level 3, 100 of 100 mV; the name if it has none."""
    numbers = [float(word) for word in name.split() if word.replace(".", "", 1).isdigit()]
    return name if not numbers else int(numbers[0]) if numbers[0].is_integer() else numbers[0]


def identified(
    campaign: xr.Dataset | str | Path, stated: MeasuredStructure, log: Log = lambda text: None
) -> tuple[Identified, Rows]:
    """Return (Identified, rows of all checks) of a campaign Dataset or the path of its file.

    Raises Refused with the reason why no law can be identified, ConfigError for stated channels and
    places that do not exist, and for a mean that the channel at the force does not show.
    """
    usable, rows, measured = usable_records(campaign)
    check_names(stated, usable)
    usable, drive, turned = along_force(usable, measured, stated.drive, rows)
    check_mean(stated, usable, drive)
    # only now: the direction of a turned channel decides whether a pair is a sum or a difference
    places = places_of(stated, usable, measured.channels[drive] if turned else None)
    excited = stated.band_Hz or transfer_band(measured)
    if excited is None:
        refuse("The force excites too few lines: give band_Hz.", rows)
    sensors = measured.kinds, measured.channels, drive
    try:
        levels = levels_of(usable)
        lowest = next((level for level in levels if level.split == "fit"), levels[0])
        band = stated.band_Hz or default_band(lowest, measured.kinds, excited, measured.rate)
        usable, levels = repeating(usable, levels, band, rows)
        linear = linear_models(levels, sensors, band, stated.residual_modes)
        if usable.attrs.get("whole_records", 0):
            levels = levels_of(usable, linear.again, band)
            linear = linear_models(levels, sensors, band, stated.residual_modes)
        named, tried = naming_split(levels)
        ranking = ranked_places(places, linear.base, named, band)
    except ValueError as error:
        text = str(error)
        refuse(f"{text[0].upper()}{text[1:].rstrip('.')}.", rows)
    log("places: " + ", ".join(f"{place} {own.error:.3g}" for place, own in ranking.items()))
    missed = float(np.median(linear_errors(linear.base, named[0], band)))
    if missed > MISSED:
        refuse(
            f"The linear model of {named[0].name} misses {missed:.0%} of the response:"
            " what it lacks can not be told from what a law would add. A lower level, a narrower"
            " band_Hz, or a channel at the force may help.",
            rows,
        )
    rows += [noise_row(level, band) for level in levels]

    def terms(stated: Sequence[str]) -> list[LocalTerm]:
        """Return those that can act: without modal motion at its place a law has no start value."""
        own = (_term(name, places, linear.base.names) for name in stated)
        return [each for each in own if each.row is None or each.place in ranking]

    candidates, additions = map(terms, laws_of(stated, tried_places(ranking)))
    found = Identified(
        *(places, ranking, candidates, additions, linear),
        Records(named, band, stated.mean, stated.emphasis),
        Records(tried, band, stated.mean),
        usable,
        Records(levels, band, stated.mean),
        own_units(usable, drive),
    )
    return found, rows


def _term(name: str, places: dict[str, dict[str, float]], channels: Sequence[str]) -> LocalTerm:
    """Return the term of "law.place", without values; channels: their names."""
    law, _, place = name.partition(".")
    own = places.get(place)
    row = None if own is None else row_of(own, channels)
    return LocalTerm(law, place, row, location=location(place, own))
