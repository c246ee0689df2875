"""Least squares of a Trial on its records, and the intervals of what is told of its laws."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vibroimpact.identify.modal_fit import Ridge, pack, unpack
from vibroimpact.least_squares import Minimum, differences, minimise

from ..constants import INDEPENDENT
from .trial import Records, Trial

# Of the error at the start, per factor of e of a positive value from its start: a fixed ridge holds
# a law where it began once the error is as small as the ridge.
LAW_RIDGE = 0.015
PARTICIPATION_RIDGE = 0.003
STEP = 1.0e-3  # of differences
FREQUENCY_STEP = 2.0e-5
LARGEST = 30.0  # logarithm of a positive value over its start
NORMAL_90 = 1.645  # sigma: half width of the 90 % interval of a normal law
SMALL = 1.0e-4  # step of derivatives of what is told


@dataclass(frozen=True, eq=False)
class Fitted:
    """A Trial at the end of its fit, named point as that of any fit is."""

    point: Trial
    records: Records
    fit: TrialFit
    minimum: Minimum

    @property
    def cost(self) -> float:
        """Return the sum of squares, ridges among them."""
        return self.minimum.cost


class TrialFit:
    """The relative error of every channel and level as a function of values, with ridges that hold
    what is not seen.

    values: those of the modes (modal_fit.pack), then for each term its free participation and its
    law's values over their start (logarithms where positive), then the offset of every level where
    the mean counts.
    """

    def __init__(self, start: Trial, records: Records):
        self.start, self.records = start, records
        self.ridge, self.count = Ridge(start.modes), start.modes.modes
        self.sizes = [np.maximum(np.abs(term.values), 1.0e-300) for term in start.terms]
        self.counted = records.levels if records.mean else ()
        self.unit = max(abs(level.force[0]) for level in records.levels) or 1.0
        self.scales = records.scales()
        cost = records.cost(records.predict(start))
        self.law_ridge = LAW_RIDGE * (np.sqrt(cost) if np.isfinite(cost) else 1.0)
        self.begin = self.values(start)

    def values(self, trial: Trial) -> np.ndarray:
        """Return (value,) of a trial."""
        parts = [pack(trial.modes)]
        for term, size in zip(trial.terms, self.sizes, strict=True):
            own = np.where(term.effect.positive, np.log(np.abs(term.values) / size), 0.0)
            parts += [] if term.participation is None else [term.participation]
            parts.append(np.where(term.effect.positive, own, term.values / size))
        offsets = [trial.offsets.get(level.name, 0.0) / self.unit for level in self.counted]
        return np.concatenate([*parts, offsets])

    def places(self) -> list[tuple[slice, slice]]:
        """Return [(participation, values of the law)] of each term; the former may be empty."""
        out, at = [], pack(self.start.modes).size
        for term, size in zip(self.start.terms, self.sizes, strict=True):
            law = at + (0 if term.participation is None else self.count)
            out.append((slice(at, law), slice(law, law + size.size)))
            at = law + size.size
        return out

    def trial(self, values: np.ndarray) -> Trial:
        """Return the Trial of values."""
        terms = []
        rows = zip(self.start.terms, self.sizes, self.places(), strict=True)
        for term, size, (free, law) in rows:
            own = np.clip(values[law], -LARGEST, LARGEST)
            terms.append(
                replace(
                    term,
                    participation=None if term.participation is None else values[free],
                    values=size * np.where(term.effect.positive, np.exp(own), values[law]),
                )
            )
        names = [level.name for level in self.counted]
        last = values[values.size - len(names) :] * self.unit
        modes = unpack(values, self.start.modes)
        return Trial(modes, tuple(terms), dict(zip(names, map(float, last), strict=True)))

    def error(self, values: np.ndarray) -> np.ndarray | None:
        """Return (residual,): relative errors, real and imaginary, then ridges; None where there is
        no bounded motion.
        """
        predicted = self.records.predict(self.trial(values))
        if predicted is None:
            return None
        rows = zip(predicted, self.records.levels, self.scales, strict=True)
        missed = np.concatenate(
            [
                ((lines - self.records.measured(level)) / scale).ravel()
                for lines, level, scale in rows
            ]
        )
        return np.concatenate(
            [missed.real, missed.imag, self.ridge.error(values), *self._held(values)]
        )

    def _held(self, values: np.ndarray) -> list[np.ndarray]:
        """Return the ridges of participations and of positive values."""
        out = []
        for term, (free, law) in zip(self.start.terms, self.places(), strict=True):
            if term.participation is not None:
                size = np.linalg.norm(term.participation)
                out.append(PARTICIPATION_RIDGE * values[free] / size)
            away = (values[law] - self.begin[law]) * term.effect.positive
            out.append(self.law_ridge * away)
        return out

    def steps(self) -> np.ndarray:
        """Return (value,) steps of differences."""
        modes = self.start.modes
        steps = np.full(self.begin.size, STEP)
        steps[: self.count] = FREQUENCY_STEP
        drive = modes.shapes[~modes.residual, modes.drive]
        steps[2 * self.count : pack(modes).size] = STEP * np.sqrt(np.mean(drive**2))
        for term, (free, _) in zip(self.start.terms, self.places(), strict=True):
            if term.participation is not None:
                steps[free] = STEP * np.linalg.norm(term.participation)
        return steps


def fitted(start: Trial, records: Records, passes: int) -> Fitted:
    """Return the Fitted of a Trial from a start, after at most so many passes.

    Raises ValueError where the start has no bounded motion.
    """
    fit = TrialFit(start, records)

    def evaluate(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        error = fit.error(values)
        if error is None:
            raise ValueError(f"{start.name}: no bounded motion at some level.")
        return error, differences(fit.error, values, error, fit.steps())

    minimum = minimise(evaluate, fit.begin, passes, error_of=fit.error)
    return Fitted(fit.trial(minimum.values), records, fit, minimum)


def estimates(own: Fitted) -> list[dict[str, dict[str, Any]]]:
    """Return [{name: {value, unit, low, high}}] per term: what is told of its law, with 90 %
    intervals by the delta method.

    The error is distortion that the model does not follow, and not the noise of the records: as in
    any diagnosis a share INDEPENDENT of the lines counts.
    """
    slope, values = own.minimum.slope, own.minimum.values
    counted = max(INDEPENDENT * own.minimum.error.size, 1.0)
    spread = np.linalg.pinv(slope.T @ slope) * own.cost / counted
    out = []
    for index, (term, (_, law)) in enumerate(zip(own.point.terms, own.fit.places(), strict=True)):
        centre = term.effect.summary(term.values)
        slopes = []
        for number in range(law.start, law.stop):
            moved = own.fit.trial(values + SMALL * (np.arange(values.size) == number))
            changed = term.effect.summary(moved.terms[index].values)
            slopes.append([(changed[name][0] - centre[name][0]) / SMALL for name in centre])
        variance = np.einsum("vn,vw,wn->n", np.array(slopes), spread[law, law], np.array(slopes))
        half = NORMAL_90 * np.sqrt(np.maximum(variance, 0.0))
        out.append(
            {
                name: {"value": value, "unit": unit, "low": value - reach, "high": value + reach}
                for (name, (value, unit)), reach in zip(centre.items(), half, strict=True)
            }
        )
    return out
