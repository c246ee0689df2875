"""Identified modes with local laws, and their steady response to the measured forces.

A response that repeats by itself needs no holding: a free periodic run is compared with the records
line by line.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.fft import next_fast_len

from vibroimpact.diagnosis.run_cost import count_simulated
from vibroimpact.identify.modal_fit import channel_scale
from vibroimpact.identify.spectra.periodic_lines import LevelLines
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.kernels.lanes import LANES
from vibroimpact.integration.steady_response import PeriodicDrive, steady_elements
from vibroimpact.reduction.modal_structure import IdentifiedModes, modal_model
from vibroimpact.structure.contact.laws import LocalLaws

from .local_laws import LAWS, LocalLaw

STEPS_PER_CYCLE = 66  # of the highest frequency of the band
DRIVEN_TO = 2.0  # lines of the force that are kept, times the highest frequency of the band
UNBOUNDED = 1.0e9  # relative error that stands for a motion without bounds
SETTLINGS = 4  # steps that find the offsets of levels that were not fitted


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
    """Modes with terms; offsets {level name: constant force added to the measured one}.

    An amplifier's zero drifts from record to record, and an even law responds to it: if the mean of
    the response counts, each level has an offset of its own, which brings the mean to its measured
    value.
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

    @property
    def along(self) -> np.ndarray:
        """Return (mode, element) the relative displacements of the terms' elements in turn."""
        rows = [term.along(self.modes) for term in self.terms for _ in range(term.effect.elements)]
        return np.ascontiguousarray(np.array(rows).reshape(-1, self.modes.modes).T)

    @property
    def laws(self) -> LocalLaws:
        """Return the laws of the terms' elements in turn."""
        laws, last = LocalLaws.neutral(sum(term.effect.elements for term in self.terms)), 0
        for term in self.terms:
            first, last = last, last + term.effect.elements
            for column, values in term.effect.columns(term.values).items():
                getattr(laws, column)[first:last] = values
        return laws

    def holds(self) -> bool:
        """Return whether stiffness is left when all sliders slip and all springs are at their
        limits: without it a run may look steady for a few periods before it diverges.
        """
        along = self.along
        far = np.diag(self.modes.omega**2) + along * self.laws.stiffness @ along.T
        return bool(np.linalg.eigvalsh(far)[0] > 0.0)


@dataclass(frozen=True, eq=False)
class Records:
    """Levels to be predicted over a band.

    mean: whether the mean (line 0) counts. emphasis: a level counts in a fit by its relative error
    times (its response / the largest level's) to this power; 0 for all alike.
    """

    levels: Sequence[LevelLines]
    band_Hz: Sequence[float]
    mean: bool = False
    emphasis: float = 0.0

    @cached_property
    def excited(self) -> list[np.ndarray]:
        """Return [(excited line,)] per level: the numbers of the lines in the band."""
        return [np.flatnonzero(level.excited(self.band_Hz)) for level in self.levels]

    @property
    def frequencies(self) -> list[np.ndarray]:
        """Return [(excited line,)] per level, Hz."""
        rows = zip(self.levels, self.excited, strict=True)
        return [level.frequency[lines] for level, lines in rows]

    @cached_property
    def lines(self) -> list[np.ndarray]:
        """Return [(kept line,)] per level: the excited lines, after the mean if it counts."""
        return [np.append(0, own) for own in self.excited] if self.mean else self.excited

    @cached_property
    def measured(self) -> list[np.ndarray]:
        """Return [(channel, kept line)] per level, the measured response."""
        rows = zip(self.levels, self.lines, strict=True)
        return [level.response[:, lines] for level, lines in rows]

    @cached_property
    def scales(self) -> list[np.ndarray]:
        """Return [(channel, 1)] per level: the divisor of an error of the lines."""
        sizes = [channel_scale(level, self.band_Hz) for level in self.levels]
        largest = np.max(sizes, axis=0)
        return [size * (largest / size) ** self.emphasis for size in sizes]

    @cached_property
    def groups(self) -> list[tuple[list[int], PeriodicDrive, np.ndarray]]:
        """Return [(levels, their drive, its samples)]: at most LANES that share a grid of lines."""
        keys: dict[tuple[float, int], list[int]] = {}
        for index, level in enumerate(self.levels):
            keys.setdefault((level.frequency[1], level.frequency.size), []).append(index)
        out = []
        for part in (
            own[at : at + LANES] for own in keys.values() for at in range(0, len(own), LANES)
        ):
            frequency = self.levels[part[0]].frequency
            lines = frequency <= DRIVEN_TO * self.band_Hz[1]
            least = max(STEPS_PER_CYCLE * self.band_Hz[1] / frequency[1], 2 * lines.sum())
            steps = RATIO * next_fast_len(int(np.ceil(least / RATIO)))
            force = np.array([self.levels[index].force[lines] for index in part])
            drive = PeriodicDrive(1.0 / frequency[1], force, steps)
            out.append((part, drive, drive.samples()))
        return out

    def runs(
        self, trial: Trial, periods_before: int
    ) -> Iterator[tuple[list[int], np.ndarray, np.ndarray, np.ndarray]]:
        """Yield (levels, drive force (level, line), displacements and forces of the elements
        (element, level, line)) of every group, complex amplitudes in N and m.

        Raises IntegrationError or ValueError if a law has no bounded motion.
        """
        model = modal_model(trial.modes, trial.along, trial.laws)
        for part, drive, samples in self.groups:
            if trial.offsets:
                offset = np.array([trial.offsets.get(self.levels[at].name, 0.0) for at in part])
                drive, samples = replace(drive, lines=drive.lines.copy()), samples.copy()
                drive.lines[:, 0] += offset
                samples[:, 0, : len(part)] += offset
            if trial.terms:
                moved, pushed = steady_elements(model, drive, samples, periods_before)
            else:
                moved = pushed = np.zeros((0, *drive.lines.shape))
            yield part, drive.lines, moved, pushed

    def predict(self, trial: Trial, periods_before: int = 1) -> list[np.ndarray] | None:
        """Return [(channel, kept line) complex] per level, None if there is no bounded motion."""
        if not trial.holds():
            return None
        count_simulated(len(self.levels) if trial.terms else 0)
        try:
            runs = list(self.runs(trial, periods_before))
        except (IntegrationError, ValueError):
            return None
        modes, along = trial.modes, trial.along
        out: list[np.ndarray] = [np.zeros(0)] * len(self.levels)
        for part, driven, _, pushed in runs:
            for lane, level in enumerate(part):
                lines = self.lines[level]
                frequency = self.levels[level].frequency[lines]
                modal = modes.shapes[:, modes.drive, None] * driven[lane, lines]
                modal = modal + along @ pushed[:, lane, lines]
                displacement = modes.shapes.T @ (modes.receptance(frequency) * modal)
                out[level] = modes.sensor_factors(frequency) * displacement
        return out

    def missed(self, predicted: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return [(channel, kept line)] per level: predicted minus measured, over the scales."""
        rows = zip(predicted, self.measured, self.scales, strict=True)
        return [(own - measured) / scale for own, measured, scale in rows]

    def cost(self, trial: Trial) -> float:
        """Return the sum of squares that a fit lowers, without its ridges; infinite if the trial
        has no bounded motion.
        """
        predicted = self.predict(trial)
        if predicted is None:
            return np.inf
        return float(sum(np.sum(np.abs(missed) ** 2) for missed in self.missed(predicted)))

    def errors(self, trial: Trial, periods_before: int = 1) -> np.ndarray:
        """Return (level, channel) RMS of measured minus predicted over the RMS measured, the mean
        left out; UNBOUNDED if the trial has no bounded motion.
        """
        predicted = self.predict(trial, periods_before)
        if predicted is None:
            return np.full((len(self.levels), len(self.levels[0].response)), UNBOUNDED)
        first = int(self.mean)
        rows = []
        for own, measured in zip(predicted, self.measured, strict=True):
            missed = np.linalg.norm((own - measured)[:, first:], axis=1)
            rows.append(missed / np.linalg.norm(measured[:, first:], axis=1))
        return np.array(rows)

    def with_offsets(self, trial: Trial) -> Trial:
        """Return a trial with offsets that bring the mean response of the drive's channel to its
        measured value at every level.
        """
        drive = trial.modes.drive
        flexibility = float(trial.modes.frf(np.zeros(1))[drive, 0].real)
        offsets = {level.name: trial.offsets.get(level.name, 0.0) for level in self.levels}
        for _ in range(SETTLINGS if self.mean else 0):
            trial = replace(trial, offsets=dict(offsets))
            predicted = self.predict(trial)
            if predicted is None:
                break
            for level, own in zip(self.levels, predicted, strict=True):
                missed = (level.response[drive, 0] - own[drive, 0]).real
                offsets[level.name] += float(missed) / flexibility
        return trial
