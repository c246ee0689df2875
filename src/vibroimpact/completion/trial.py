"""A completed model on trial: identified modes with local laws at places, its steady response at
every level, and its fit.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.fft import next_fast_len

from vibroimpact.contact.laws import LocalLaws
from vibroimpact.identify.modal_fit import Ridge, channel_scale, pack, unpack
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.steady_response import PeriodicDrive, steady_elements
from vibroimpact.least_squares import differences, minimise
from vibroimpact.reduction.modal_structure import IdentifiedModes, modal_model
from vibroimpact.run_cost import count_simulated

from .local_laws import LAWS

STEPS_PER_CYCLE = 66  # of the highest frequency of the band
DRIVEN_TO = 2.0  # lines of the force that are kept, times the highest frequency of the band
# of the error at the start, per factor of e of a law's positive value from its start: relative,
# because a fixed one holds a law where it began once the error is as small as the ridge
LAW_RIDGE = 0.015
PARTICIPATION_RIDGE = 0.003
SETTLINGS = 4  # steps in which the offsets of levels that were not fitted are found


@dataclass(frozen=True)
class Term:
    """A law (key of LAWS) at a place: row (channel,) the relative displacement over the channels,
    or None for a place that no channel shows.

    There participation (mode,) kg^-1/2 is fitted. values (parameter,) of the law.
    """

    law: str
    place: str
    row: tuple | None
    values: np.ndarray
    participation: np.ndarray | None = None

    def along(self, modes):
        """Return (mode,) the relative displacement per unit modal amplitude."""
        return modes.shapes @ np.array(self.row) if self.row is not None else self.participation


@dataclass(frozen=True, eq=False)
class Trial:
    """modes: IdentifiedModes; terms: tuple of Term; offsets {level name: constant force in the
    force's unit beside the measured one}.

    An amplifier's or a sensor's zero drifts from record to record, and an even law answers to it:
    where the mean of the response counts, each level has an offset of its own, a nuisance that
    brings the mean where it was measured.
    """

    modes: IdentifiedModes
    terms: tuple = ()
    offsets: dict = field(default_factory=dict)

    def model(self):
        """Return (ModalModel, along (mode, element)) with the elements in the order of the
        terms.
        """
        tables = [LAWS[term.law].columns(term.values) for term in self.terms]
        counts = [LAWS[term.law].elements for term in self.terms]
        along = (
            np.repeat(
                np.stack([term.along(self.modes) for term in self.terms], axis=1), counts, axis=1
            )
            if self.terms
            else np.zeros((self.modes.modes, 0))
        )
        laws = LocalLaws.neutral(along.shape[1])
        for table, first, count in zip(tables, np.cumsum([0, *counts[:-1]]), counts, strict=True):
            for column, values in table.items():
                getattr(laws, column)[first : first + count] = values
        return modal_model(self.modes, along, laws), along


@dataclass(frozen=True, eq=False)
class Records:
    """Levels to be predicted over a band, grouped so that a group has one grid of lines; mean:
    whether the mean (line 0) counts.

    emphasis: a level counts in a fit by its relative error times (its response / the largest
    level's) to this power: 0 for all alike.
    """

    levels: tuple
    band_Hz: tuple
    mean: bool = False
    emphasis: float = 0.0
    groups: list = field(init=False)

    def __post_init__(self):
        """Group the levels, at most LANES together, and lay out their forces."""
        keys = {}
        for index, level in enumerate(self.levels):
            keys.setdefault((level.frequency[1], level.frequency.size), []).append(index)
        parts = [
            members[first : first + LANES]
            for members in keys.values()
            for first in range(0, len(members), LANES)
        ]
        object.__setattr__(self, "groups", [(part, *self._drive(part)) for part in parts])

    def _drive(self, part):
        frequency = self.levels[part[0]].frequency
        lines = frequency <= DRIVEN_TO * self.band_Hz[1]
        least = STEPS_PER_CYCLE * self.band_Hz[1] / frequency[1]
        steps = RATIO * next_fast_len(int(np.ceil(max(least, 2 * lines.sum()) / RATIO)))
        drive = PeriodicDrive(
            1.0 / frequency[1], np.array([self.levels[index].force[lines] for index in part]), steps
        )
        return drive, drive.samples()

    def scales(self):
        """Return [(channel, 1)] per level: what an error of the lines is divided by."""
        sizes = [channel_scale(level, self.band_Hz) for level in self.levels]
        largest = np.max(sizes, axis=0)
        return [size * (largest / size) ** self.emphasis for size in sizes]

    def kept(self, level):
        """Return (line,) bool: the lines of a level that count: the excited ones of the band, and
        the mean where it counts.
        """
        kept = level.excited(self.band_Hz)
        return kept | (level.frequency == 0.0) if self.mean else kept

    def predict(self, trial, periods_before=1):
        """Return [(channel, kept line) complex] per level, or None where the trial has no bounded
        motion.
        """
        model, along = trial.model()
        count_simulated(len(self.levels) if along.shape[1] else 0)
        out = [None] * len(self.levels)
        for part, drive, samples in self.groups:
            drive, samples = self.with_offsets(trial, part, drive, samples)
            try:
                pushed = (
                    steady_elements(model, drive, samples, periods_before)[1]
                    if along.shape[1]
                    else None
                )
            except (IntegrationError, ValueError):
                return None
            for lane, index in enumerate(part):
                level = self.levels[index]
                lines = np.flatnonzero(self.kept(level))
                modal = trial.modes.shapes[:, trial.modes.drive, None] * drive.lines[lane, lines]
                if pushed is not None:
                    modal = modal + along @ pushed[:, lane, lines]
                frequency = level.frequency[lines]
                out[index] = trial.modes.sensor_factors(frequency) * (
                    trial.modes.shapes.T @ (trial.modes.receptance(frequency) * modal)
                )
        return out

    def with_offsets(self, trial, part, drive, samples):
        """Return (PeriodicDrive, samples) of a group with the offsets of a Trial."""
        if not trial.offsets:
            return drive, samples
        offset = np.array([trial.offsets.get(self.levels[index].name, 0.0) for index in part])
        lines, samples = drive.lines.copy(), samples.copy()
        lines[:, 0] += offset
        samples[:, 0, : len(part)] += offset
        return replace(drive, lines=lines), samples

    def cost(self, predicted):
        """Return the sum of squares that a fit lowers, without its ridges."""
        return float(
            sum(
                np.sum(np.abs((lines - level.response[:, self.kept(level)]) / scale) ** 2)
                for level, lines, scale in zip(self.levels, predicted, self.scales(), strict=True)
            )
        )

    def errors(self, predicted):
        """Return (level, channel) RMS of measured minus predicted over the RMS measured, over the
        kept lines.
        """
        rows = []
        for level, lines in zip(self.levels, predicted, strict=True):
            kept = self.kept(level)
            weight = np.where(level.frequency[kept] == 0.0, 1.0, 2.0)
            measured = level.response[:, kept]
            rows.append(
                np.sqrt(
                    np.sum(weight * np.abs(lines - measured) ** 2, axis=1)
                    / np.sum(weight * np.abs(measured) ** 2, axis=1)
                )
            )
        return np.array(rows)


def with_offsets(trial, records):
    """Return the trial with offsets that bring the mean response of the drive's channel of every
    level where it was measured.
    """
    if not records.mean:
        return trial
    modes = trial.modes
    flexibility = float(modes.frf(np.zeros(1))[modes.drive, 0].real)
    offsets = {level.name: trial.offsets.get(level.name, 0.0) for level in records.levels}
    for _ in range(SETTLINGS):
        predicted = records.predict(replace(trial, offsets=offsets))
        if predicted is None:
            return trial
        for level, lines in zip(records.levels, predicted, strict=True):
            offsets[level.name] += (
                float((level.response[modes.drive, 0] - lines[modes.drive, 0]).real) / flexibility
            )
    return replace(trial, offsets=offsets)


class Fit:
    """Least squares of a Trial on Records: the relative error of every channel and level, and
    ridges that hold what is not seen.

    values: those of the modes (modal_fit.pack), then for each term its free participation and its
    law's values (logarithms where positive, over their start's size otherwise), then the offset of
    every level where the mean counts.
    """

    def __init__(self, start, records):
        self.start, self.records = start, records
        self.modes_ridge, self.modes_count = Ridge(start.modes), pack(start.modes).size
        self.sizes = [np.maximum(np.abs(term.values), 1.0e-300) for term in start.terms]
        drive = start.modes.shapes[~start.modes.residual, start.modes.drive]
        self.shape_step = 1.0e-3 * np.sqrt(np.mean(drive**2))
        self.counted = records.levels if records.mean else ()
        self.unit = max(abs(level.force[0]) for level in records.levels)
        self.scale = records.scales()
        predicted = records.predict(start)
        self.law_ridge = LAW_RIDGE * (np.sqrt(records.cost(predicted)) if predicted else 1.0)
        self.wanted = [
            level.response[:, records.kept(level)] / scale
            for level, scale in zip(records.levels, self.scale, strict=True)
        ]

    def values(self, trial):
        """Return (value,) of a trial."""
        parts = [pack(trial.modes)]
        for term, size in zip(trial.terms, self.sizes, strict=True):
            positive = self._positive(term)
            parts += [term.participation] if term.row is None else []
            parts.append(np.where(positive, np.log(np.abs(term.values) / size), term.values / size))
        return np.concatenate(
            [*parts, [trial.offsets.get(level.name, 0.0) / self.unit for level in self.counted]]
        )

    def trial(self, values):
        """Return the Trial of values."""
        at, terms = self.modes_count, []
        for term, size in zip(self.start.terms, self.sizes, strict=True):
            participation = None
            if term.row is None:
                participation, at = (
                    values[at : at + self.start.modes.modes],
                    at + self.start.modes.modes,
                )
            own, at = values[at : at + size.size], at + size.size
            terms.append(
                replace(
                    term,
                    participation=participation,
                    values=size
                    * np.where(self._positive(term), np.exp(np.clip(own, -30.0, 30.0)), own),
                )
            )
        offsets = {
            level.name: float(value * self.unit)
            for level, value in zip(self.counted, values[at:], strict=True)
        }
        return Trial(unpack(values[: self.modes_count], self.start.modes), tuple(terms), offsets)

    def error(self, values):
        """Return (residual,) real: relative errors, real and imaginary, then ridges; None where
        there is no bounded motion.
        """
        predicted = self.records.predict(self.trial(values))
        if predicted is None:
            return None
        missed = np.concatenate(
            [
                (lines / scale - wanted).ravel()
                for lines, scale, wanted in zip(predicted, self.scale, self.wanted, strict=True)
            ]
        )
        return np.concatenate(
            [missed.real, missed.imag, self.modes_ridge.error(values), self._ridge(values)]
        )

    def run(self, passes, seconds=np.inf, told=None):
        """Return (Trial, Minimum) from the start."""

        def evaluate(values):
            error = self.error(values)
            return error, differences(self.error, values, error, self._steps())

        minimum = minimise(
            evaluate,
            self.values(self.start),
            passes,
            seconds=seconds,
            told=told,
            error_of=self.error,
        )
        return self.trial(minimum.values), minimum

    def law_places(self):
        """Return [slice] of the values of each term's law."""
        places, at = [], self.modes_count
        for term, size in zip(self.start.terms, self.sizes, strict=True):
            at += self.start.modes.modes if term.row is None else 0
            places.append(slice(at, at + size.size))
            at += size.size
        return places

    def _positive(self, term):
        return np.array([parameter.positive for parameter in LAWS[term.law].parameters])

    def _ridge(self, values):
        begin = self.values(self.start)
        own = []
        for term, place in zip(self.start.terms, self.law_places(), strict=True):
            if term.row is None:
                free = slice(place.start - self.start.modes.modes, place.start)
                own.append(PARTICIPATION_RIDGE * values[free] / np.linalg.norm(term.participation))
            own.append(self.law_ridge * (values[place] - begin[place]) * self._positive(term))
        return np.concatenate([*own, np.zeros(0)])

    def _steps(self):
        count, modes = self.modes_count, self.start.modes
        steps = np.full(self.values(self.start).size, 1.0e-3)
        steps[: modes.modes] = 2.0e-5
        steps[2 * modes.modes : count] = self.shape_step
        for term, place in zip(self.start.terms, self.law_places(), strict=True):
            if term.row is None:
                steps[place.start - modes.modes : place.start] = 1.0e-3 * np.linalg.norm(
                    term.participation
                )
        return steps
