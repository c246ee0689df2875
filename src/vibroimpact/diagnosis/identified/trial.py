"""Identified modes with local laws, and their steady response to the measured forces.

What repeats by itself needs no holding: a free periodic run is compared with the records line by
line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.fft import next_fast_len

from vibroimpact.contact.laws import LocalLaws
from vibroimpact.identify.modal_fit import channel_scale
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.steady_response import PeriodicDrive, steady_elements
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.reduction.modal_structure import IdentifiedModes, modal_model
from vibroimpact.run_cost import count_simulated
from vibroimpact.spectra.periodic_lines import LevelLines

from .local_laws import LAWS, LocalLaw

STEPS_PER_CYCLE = 66  # of the highest frequency of the band
DRIVEN_TO = 2.0  # lines of the force that are kept, times the highest frequency of the band
UNBOUNDED = 1.0e9  # relative error that stands for a motion without bounds
SETTLINGS = 4  # steps in which the offsets of levels that were not fitted are found


@dataclass(frozen=True, eq=False)
class LocalTerm:
    """A law (key of LAWS) at a place.

    row (channel,): the relative displacement over the channels; None for a place that no channel
    shows, whose participation (mode,) in kg^-1/2 is fitted. values (parameter,): of the law.
    location: the place in words.
    """

    law: str
    place: str
    row: np.ndarray | None
    values: np.ndarray = field(default_factory=lambda: np.zeros(0))
    participation: np.ndarray | None = None
    location: str = ""

    @property
    def effect(self) -> LocalLaw:
        """Return the law."""
        return LAWS[self.law]

    @property
    def effect_id(self) -> str:
        """Return the id of the law in the catalogue."""
        return self.effect.id

    @property
    def name(self) -> str:
        """Return law@place."""
        return f"{self.law}@{self.place}"

    def along(self, modes: IdentifiedModes) -> np.ndarray:
        """Return (mode,) the relative displacement per unit modal amplitude."""
        return modes.shapes @ self.row if self.participation is None else self.participation


@dataclass(frozen=True, eq=False)
class Trial:
    """Modes with terms; offsets {level name: constant force beside the measured one}.

    An amplifier's zero drifts from record to record, and an even law answers to it: where the mean
    of the response counts, each level has an offset of its own, a nuisance that brings the mean
    where it was measured.
    """

    modes: IdentifiedModes
    terms: tuple[LocalTerm, ...] = ()
    offsets: dict[str, float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Return the names of the terms, joined."""
        return " + ".join(term.name for term in self.terms) or "nothing"

    @property
    def ids(self) -> list[str]:
        """Return the ids of the effects, each once: laws of one kind at two places are one."""
        return sorted({term.effect_id for term in self.terms})

    def beside(self, term: LocalTerm, modes: IdentifiedModes | None = None) -> Trial:
        """Return the Trial with one more term, on its modes or others."""
        return replace(self, modes=modes or self.modes, terms=(*self.terms, term))

    def model(self) -> tuple[ModalModel, np.ndarray]:
        """Return (ModalModel, along (mode, element)), the elements in the order of the terms."""
        counts = [term.effect.elements for term in self.terms]
        columns = [term.along(self.modes) for term in self.terms]
        along = np.repeat(np.array(columns).reshape(-1, self.modes.modes).T, counts, axis=1)
        laws = LocalLaws.neutral(along.shape[1])
        for term, last, count in zip(self.terms, np.cumsum(counts), counts, strict=True):
            for column, values in term.effect.columns(term.values).items():
                getattr(laws, column)[last - count : last] = values
        return modal_model(self.modes, along, laws), along

    def holds(self) -> bool:
        """Return whether stiffness is left where all sliders slip and all springs are at their
        limits.

        Without it a run may look steady for a few periods before it leaves.
        """
        stiffness = [
            term.effect.columns(term.values).get("stiffness", np.zeros(term.effect.elements))
            for term in self.terms
        ]
        if not stiffness:
            return True
        _, along = self.model()
        far = np.diag(self.modes.omega**2) + along * np.concatenate(stiffness) @ along.T
        return bool(np.linalg.eigvalsh(far)[0] > 0.0)


@dataclass(frozen=True, eq=False)
class Records:
    """Levels to be predicted over a band, in groups of at most LANES that share a grid of lines.

    mean: whether the mean (line 0) counts. emphasis: a level counts in a fit by its relative error
    times (its response / the largest level's) to this power; 0 for all alike.
    """

    levels: Sequence[LevelLines]
    band_Hz: Sequence[float]
    mean: bool = False
    emphasis: float = 0.0
    groups: list[tuple[list[int], PeriodicDrive, np.ndarray]] = field(init=False)

    def __post_init__(self) -> None:
        keys: dict[tuple[float, int], list[int]] = {}
        for index, level in enumerate(self.levels):
            keys.setdefault((level.frequency[1], level.frequency.size), []).append(index)
        parts = [own[at : at + LANES] for own in keys.values() for at in range(0, len(own), LANES)]
        drives = [self._drive(part) for part in parts]
        groups = [(part, own, own.samples()) for part, own in zip(parts, drives, strict=True)]
        object.__setattr__(self, "groups", groups)

    def _drive(self, part: list[int]) -> PeriodicDrive:
        frequency = self.levels[part[0]].frequency
        lines = frequency <= DRIVEN_TO * self.band_Hz[1]
        least = max(STEPS_PER_CYCLE * self.band_Hz[1] / frequency[1], 2 * lines.sum())
        steps = RATIO * next_fast_len(int(np.ceil(least / RATIO)))
        force = np.array([self.levels[index].force[lines] for index in part])
        return PeriodicDrive(1.0 / frequency[1], force, steps)

    def scales(self) -> list[np.ndarray]:
        """Return [(channel, 1)] per level: what an error of the lines is divided by."""
        sizes = [channel_scale(level, self.band_Hz) for level in self.levels]
        largest = np.max(sizes, axis=0)
        return [size * (largest / size) ** self.emphasis for size in sizes]

    def kept(self, level: LevelLines) -> np.ndarray:
        """Return (line,) bool: the excited lines of the band, and the mean where it counts."""
        kept = level.excited(self.band_Hz)
        return kept | (level.frequency == 0.0) if self.mean else kept

    def measured(self, level: LevelLines) -> np.ndarray:
        """Return (channel, kept line) the measured response."""
        return level.response[:, self.kept(level)]

    def predict(self, trial: Trial, periods_before: int = 1) -> list[np.ndarray] | None:
        """Return [(channel, kept line) complex] per level, None where a trial has no bounded
        motion.
        """
        if not trial.holds():
            return None
        model, along = trial.model()
        count_simulated(len(self.levels) if along.shape[1] else 0)
        out: list[np.ndarray] = [np.zeros(0)] * len(self.levels)
        for part, drive, samples in self.groups:
            drive, samples = self.with_offsets(trial, part, drive, samples)
            pushed = np.zeros((0, len(part), drive.lines.shape[1]))
            if along.shape[1]:
                try:
                    pushed = steady_elements(model, drive, samples, periods_before)[1]
                except (IntegrationError, ValueError):
                    return None
            for lane, index in enumerate(part):
                lines = np.flatnonzero(self.kept(self.levels[index]))
                force = drive.lines[lane, lines], pushed[:, lane, lines]
                frequency = self.levels[index].frequency[lines]
                out[index] = response(trial.modes, along, frequency, *force)
        return out

    def with_offsets(
        self, trial: Trial, part: list[int], drive: PeriodicDrive, samples: np.ndarray
    ) -> tuple[PeriodicDrive, np.ndarray]:
        """Return (PeriodicDrive, samples) of a group with the offsets of a Trial."""
        if not trial.offsets:
            return drive, samples
        offset = np.array([trial.offsets.get(self.levels[index].name, 0.0) for index in part])
        lines, samples = drive.lines.copy(), samples.copy()
        lines[:, 0] += offset
        samples[:, 0, : len(part)] += offset
        return replace(drive, lines=lines), samples

    def cost(self, predicted: Sequence[np.ndarray] | None) -> float:
        """Return the sum of squares that a fit lowers, without its ridges; infinite of None."""
        if predicted is None:
            return np.inf
        rows = zip(self.levels, predicted, self.scales(), strict=True)
        missed = ((lines - self.measured(level)) / scale for level, lines, scale in rows)
        return float(sum(np.sum(np.abs(each) ** 2) for each in missed))

    def errors(self, predicted: Sequence[np.ndarray] | None) -> np.ndarray:
        """Return (level, channel) RMS of measured minus predicted over the RMS measured, the mean
        left out; UNBOUNDED of None.
        """
        if predicted is None:
            return np.full((len(self.levels), len(self.levels[0].response)), UNBOUNDED)
        rows = []
        for level, lines in zip(self.levels, predicted, strict=True):
            varies = level.frequency[self.kept(level)] > 0.0
            measured = self.measured(level)[:, varies]
            missed = np.linalg.norm(lines[:, varies] - measured, axis=1)
            rows.append(missed / np.linalg.norm(measured, axis=1))
        return np.array(rows)


def response(
    modes: IdentifiedModes,
    along: np.ndarray,
    frequency: np.ndarray,
    force: np.ndarray,
    pushed: np.ndarray,
) -> np.ndarray:
    """Return (channel, line) response at frequency (line,) in Hz to the drive's force (line,) and
    the forces pushed (element, line) along (mode, element), N.
    """
    modal = modes.shapes[:, modes.drive, None] * force + along @ pushed
    displacement = modes.shapes.T @ (modes.receptance(frequency) * modal)
    return modes.sensor_factors(frequency) * displacement


def with_offsets(trial: Trial, records: Records) -> Trial:
    """Return the trial with offsets that bring the mean response of the drive's channel of every
    level where it was measured.
    """
    drive = trial.modes.drive
    flexibility = float(trial.modes.frf(np.zeros(1))[drive, 0].real)
    offsets = {level.name: trial.offsets.get(level.name, 0.0) for level in records.levels}
    for _ in range(SETTLINGS if records.mean else 0):
        trial = replace(trial, offsets=dict(offsets))
        predicted = records.predict(trial)
        if predicted is None:
            break
        for level, lines in zip(records.levels, predicted, strict=True):
            missed = (level.response[drive, 0] - lines[drive, 0]).real
            offsets[level.name] += float(missed) / flexibility
    return trial
