"""Least squares of a Trial on its records, and the intervals of the values of its laws."""

from dataclasses import replace
from typing import Any

import numpy as np

from vibroimpact.diagnosis.verdict.content import NINETY_SD
from vibroimpact.identify.least_squares import minimise_by_differences
from vibroimpact.identify.modal_fit import Ridge, pack, unpack

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


class Fitted:
    """A Trial at the end of its fit from a start, after at most `passes` passes; called `point` as
    in every fit.

    The relative error of every channel and level is lowered, with ridges that hold unseen values.
    The values (value,) are those of the modes (modal_fit.pack), then for each term its free
    participation and its law's values over their start (logarithms if positive), then the offset of
    every level if the mean counts. cost: the sum of squares, with the ridges. Raises ValueError if
    the start has no bounded motion.
    """

    def __init__(self, start: Trial, records: Records, passes: int):
        self._start, self._records, self._ridge = start, records, Ridge(start.modes)
        cost = records.cost(start)
        if not np.isfinite(cost):
            raise ValueError(f"{start.name}: no bounded motion at some level.")
        law_ridge, modes, count = LAW_RIDGE * np.sqrt(cost), start.modes, start.modes.modes
        begin, steps, held = [pack(modes)], [np.full(pack(modes).size, STEP)], []
        steps[0][:count] = FREQUENCY_STEP
        drive = modes.shapes[~modes.residual, modes.drive]
        steps[0][2 * count :] = STEP * np.sqrt(np.mean(drive**2))
        # the slices (participation, law) of each term; the former may be empty
        self._places: list[tuple[slice, slice]] = []
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
            self._places.append((slice(first, law), slice(law, law + positive.size)))
        self._counted = [level.name for level in records.levels if records.mean]
        self._unit = max(abs(level.force[0]) for level in records.levels) or 1.0
        offsets = [start.offsets.get(name, 0.0) / self._unit for name in self._counted]
        self._held = np.concatenate(held, axis=1)  # ridge, and size, of the values of terms
        self._minimum = minimise_by_differences(
            self._error,
            np.concatenate([*begin, offsets]),
            np.concatenate([*steps, np.full(len(offsets), STEP)]),
            passes,
        )
        self.point, self.cost = self._trial(self._minimum.values), self._minimum.cost

    def _trial(self, values: np.ndarray) -> Trial:
        """Return the Trial of values (value,)."""
        terms = [
            self._term(term, values[free], values[law])
            for term, (free, law) in zip(self._start.terms, self._places, strict=True)
        ]
        last = values[values.size - len(self._counted) :] * self._unit
        offsets = dict(zip(self._counted, map(float, last), strict=True))
        return Trial(unpack(values, self._start.modes), tuple(terms), offsets)

    def _term(self, term: LocalTerm, free: np.ndarray, law: np.ndarray) -> LocalTerm:
        """Return a term with its participation (mode,) or none, and its law's values."""
        factor = np.where(term.effect.positive, np.exp(np.clip(law, -LARGEST, LARGEST)), law)
        values = np.maximum(np.abs(term.values), 1.0e-300) * factor
        return replace(term, participation=free if free.size else None, values=values)

    def _error(self, values: np.ndarray) -> np.ndarray | None:
        """Return (residual,): relative errors, real and imaginary, then ridges of the modes, of
        participations and of positive values; None if there is no bounded motion.
        """
        predicted = self._records.predict(self._trial(values))
        if predicted is None:
            return None
        missed = np.concatenate([each.ravel() for each in self._records.missed(predicted)])
        first = self._ridge.start.size
        ridge, size = self._held
        held = ridge * values[first : first + size.size] / size
        return np.concatenate([missed.real, missed.imag, self._ridge.error(values), held])

    def estimates(self) -> list[dict[str, dict[str, Any]]]:
        """Return [{name: {value, unit, low, high}}] per term: the values of its law, with 90 %
        intervals by the delta method.

        The error is distortion that the model does not follow, not noise of the records: as in any
        diagnosis a share INDEPENDENT of the lines counts.
        """
        slope, values = self._minimum.slope, self._minimum.values
        counted = max(INDEPENDENT * self._minimum.error.size, 1.0)
        spread = np.linalg.pinv(slope.T @ slope) * self.cost / counted
        out = []
        for index, (term, (_, law)) in enumerate(zip(self.point.terms, self._places, strict=True)):
            told, slopes = term.effect.summary(term.values), []
            for number in range(law.start, law.stop):
                moved = self._trial(values + SMALL * (np.arange(values.size) == number))
                changed = term.effect.summary(moved.terms[index].values)
                slopes.append([(changed[name][0] - told[name][0]) / SMALL for name in told])
            change = np.array(slopes)
            variance = np.einsum("vn,vw,wn->n", change, spread[law, law], change)
            half = NINETY_SD * np.sqrt(np.maximum(variance, 0.0))
            rows = zip(told.items(), half, strict=True)
            out.append(
                {
                    name: {"value": value, "unit": unit, "low": value - by, "high": value + by}
                    for (name, (value, unit)), by in rows
                }
            )
        return out
