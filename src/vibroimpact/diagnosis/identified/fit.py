"""Least squares of a Trial on its records, and the intervals of the values of its laws."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibroimpact.identify.least_squares import Minimum, minimise_by_differences
from vibroimpact.identify.modal_fit import Ridge, pack, unpack

from ..completed import NINETY_SD
from ..constants import INDEPENDENT
from .trial import LocalTerm, Records, Trial

# Of the error at the start, per factor of e of a positive value from its start: a fixed ridge would
# hold a law at its start once the error is as small as the ridge.
LAW_RIDGE = 0.015
PARTICIPATION_RIDGE = 0.003
STEP = 1.0e-3  # of differences
FREQUENCY_STEP = 2.0e-5
LARGEST = 30.0  # logarithm of a positive value over its start
SMALL = 1.0e-4  # step of derivatives of the reported values


@dataclass(frozen=True, eq=False)
class Fitted:
    """A Trial at the end of its fit; called `point` as in every fit."""

    point: Trial
    fit: TrialFit
    minimum: Minimum

    @property
    def cost(self) -> float:
        """Return the sum of squares, with the ridges."""
        return self.minimum.cost


class TrialFit:
    """The relative error of every channel and level as a function of values, with ridges that hold
    unseen values.

    begin (value,): at the start: those of the modes (modal_fit.pack), then for each term its free
    participation and its law's values over their start (logarithms if positive), then the offset of
    every level if the mean counts. steps (value,): of differences. held (2, value of a term):
    ridge, and the size of the value. places [(participation, law)]: the slices of each term; the
    former may be empty. Raises ValueError if the start has no bounded motion.
    """

    def __init__(self, start: Trial, records: Records):
        self.start, self.records, self.ridge = start, records, Ridge(start.modes)
        cost = records.cost(start)
        if not np.isfinite(cost):
            raise ValueError(f"{start.name}: no bounded motion at some level.")
        law_ridge, modes, count = LAW_RIDGE * np.sqrt(cost), start.modes, start.modes.modes
        begin, steps, held = [pack(modes)], [np.full(pack(modes).size, STEP)], []
        steps[0][:count] = FREQUENCY_STEP
        drive = modes.shapes[~modes.residual, modes.drive]
        steps[0][2 * count :] = STEP * np.sqrt(np.mean(drive**2))
        self.places: list[tuple[slice, slice]] = []
        for term in start.terms:
            first = law = sum(part.size for part in begin)
            if term.participation is not None:
                size, law = np.linalg.norm(term.participation), first + count
                begin.append(term.participation)
                steps.append(np.full(count, STEP * size))
                held.append(np.tile([[PARTICIPATION_RIDGE], [size]], count))
            positive = term.effect.positive
            begin.append(np.where(positive, 0.0, np.sign(term.values)))
            steps.append(np.full(positive.size, STEP))
            held.append(np.array([law_ridge * positive, np.ones(positive.size)]))
            self.places.append((slice(first, law), slice(law, law + positive.size)))
        self.counted = [level.name for level in records.levels if records.mean]
        self.unit = max(abs(level.force[0]) for level in records.levels) or 1.0
        offsets = [start.offsets.get(name, 0.0) / self.unit for name in self.counted]
        self.begin = np.concatenate([*begin, offsets])
        self.steps = np.concatenate([*steps, np.full(len(offsets), STEP)])
        self.held = np.concatenate(held, axis=1)

    def trial(self, values: np.ndarray) -> Trial:
        """Return the Trial of values (value,)."""
        terms = [
            self._term(term, values[free], values[law])
            for term, (free, law) in zip(self.start.terms, self.places, strict=True)
        ]
        last = values[values.size - len(self.counted) :] * self.unit
        offsets = dict(zip(self.counted, map(float, last), strict=True))
        return Trial(unpack(values, self.start.modes), tuple(terms), offsets)

    def _term(self, term: LocalTerm, free: np.ndarray, law: np.ndarray) -> LocalTerm:
        """Return a term with its participation (mode,) or none, and its law's values."""
        factor = np.where(term.effect.positive, np.exp(np.clip(law, -LARGEST, LARGEST)), law)
        values = np.maximum(np.abs(term.values), 1.0e-300) * factor
        return replace(term, participation=free if free.size else None, values=values)

    def error(self, values: np.ndarray) -> np.ndarray | None:
        """Return (residual,): relative errors, real and imaginary, then ridges of the modes, of
        participations and of positive values; None if there is no bounded motion.
        """
        predicted = self.records.predict(self.trial(values))
        if predicted is None:
            return None
        missed = np.concatenate([each.ravel() for each in self.records.missed(predicted)])
        first = self.ridge.start.size
        ridge, size = self.held
        held = ridge * values[first : first + size.size] / size
        return np.concatenate([missed.real, missed.imag, self.ridge.error(values), held])


def fitted(start: Trial, records: Records, passes: int) -> Fitted:
    """Return the Fitted of a Trial from a start, after at most `passes` passes.

    Raises ValueError if the start has no bounded motion.
    """
    fit = TrialFit(start, records)
    minimum = minimise_by_differences(fit.error, fit.begin, fit.steps, passes)
    return Fitted(fit.trial(minimum.values), fit, minimum)


def estimates(own: Fitted) -> list[dict[str, dict[str, Any]]]:
    """Return [{name: {value, unit, low, high}}] per term: the values of its law, with 90 %
    intervals by the delta method.

    The error is distortion that the model does not follow, not noise of the records: as in any
    diagnosis a share INDEPENDENT of the lines counts.
    """
    slope, values = own.minimum.slope, own.minimum.values
    counted = max(INDEPENDENT * own.minimum.error.size, 1.0)
    spread = np.linalg.pinv(slope.T @ slope) * own.cost / counted
    out = []
    for index, (term, (_, law)) in enumerate(zip(own.point.terms, own.fit.places, strict=True)):
        told, slopes = term.effect.summary(term.values), []
        for number in range(law.start, law.stop):
            moved = own.fit.trial(values + SMALL * (np.arange(values.size) == number))
            changed = term.effect.summary(moved.terms[index].values)
            slopes.append([(changed[name][0] - told[name][0]) / SMALL for name in told])
        variance = np.einsum("vn,vw,wn->n", np.array(slopes), spread[law, law], np.array(slopes))
        half = NINETY_SD * np.sqrt(np.maximum(variance, 0.0))
        out.append(
            {
                name: {"value": value, "unit": unit, "low": value - reach, "high": value + reach}
                for (name, (value, unit)), reach in zip(told.items(), half, strict=True)
            }
        )
    return out
