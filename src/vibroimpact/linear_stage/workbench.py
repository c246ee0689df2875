"""A campaign and the model to compare with it: signals, features of the measurement, the corrected
model, and simulations of any variant of it. All steps of the linear stage and of the search after
it work on a Workbench.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from vibroimpact.config.reading import Config, check_config
from vibroimpact.effects.effect import Values
from vibroimpact.integration.batch import Schedule
from vibroimpact.integration.contact_convergence import (
    CONTRACTION_LIMIT,
    IntegrationError,
    contact_contraction,
)
from vibroimpact.integration.step_stability import LARGEST_GROWTH, step_growth
from vibroimpact.observation.attached_model import attach, with_channel_points
from vibroimpact.observation.features import feature_layout, record_features
from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.observation.moving_base import driven_by_base
from vibroimpact.observation.sensor_chain import Measuring
from vibroimpact.observation.signals import signals_of
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records
from vibroimpact.reduction.modal_model import ModalModel
from vibroimpact.run_cost import count_simulated

from . import nuisance as linear
from .candidates import Candidate, Pair, Physical
from .linearised import linearised
from .modal_fit import ModalFit
from .mode_identification import fit_modes

FINER = (2, 4)  # times the usual steps, where damping or stiffness of the contact needs it
TOUCHES = 0.98  # of the gap: a linear response as large counts as contact
SETTLING_S = 4.0  # after which the transient of a run from rest has decayed
DRAW = 1000000  # seeds from the first of a draw to that of the next

Run = tuple[int, float, int]  # record, gap in m, seed


class Workbench:
    """A checked Config and the campaign Dataset to compare with it, each record cut to longest_s
    where given; draw: number of the draw of seeds.

    bare: the model without corrections. nuisance: its corrections.
    measuring, late: an adopted fault of the measuring chain, and the delays of its channels.
    nonlinear_low: whether the response is nonlinear in the lowest record, though its modes are
    seen. modes_told: whether its modes identify nuisances all the same.
    followed: whether the model contains the effect that shifted the modes. Then resonances are
    looked for from its frequencies alone.
    given, values: the configuration in plain values, as it was and with adopted effects.
    """

    def __init__(
        self,
        config: Config,
        campaign: xr.Dataset,
        longest_s: float | None = None,
        draw: int = 0,
    ) -> None:
        config = driven_by_base(with_channel_points(config, campaign), campaign)
        self.config, self.campaign, self.draw = config, campaign, draw
        self.longest_s = longest_s
        self.signals = signals_of(campaign, longest_s)
        self.bare = attach(config, campaign)
        self.layout = feature_layout(self.signals, campaign["channel_point"].values)
        self.schedule = schedule_of(
            campaign, config.integration, self.signals.force.shape[-1] / self.signals.rate
        )
        self.forces = Forces(self.signals.force, self.schedule)
        self._finer = {(1, self.schedule.scheme): (self.schedule, self.forces)}
        self.nuisance: linear.Nuisance | None = None
        self.measuring: Measuring | None = None
        self.late: Measuring | None = None
        self.nonlinear_low = False
        self.modes_told = True
        self.followed = False
        self.values = self.given = config.model_dump(mode="json")

    def again(self, campaign: xr.Dataset) -> Workbench:
        """Return a Workbench of another campaign Dataset with the same records, with what was
        adopted.
        """
        out = Workbench(self.config, campaign, self.longest_s, self.draw)
        out.measuring, out.late = self.measuring, self.late
        if self.values is not self.given:
            out.rebase(self.values)
        return out

    def corrected_by(self, nuisance: linear.Nuisance | None) -> Workbench:
        """Return a Workbench of the same campaign with the corrections of a Nuisance, which the
        modes of the lowest record identify; itself where it is None.
        """
        if nuisance is None:
            return self
        out = copy(self)
        out.nuisance, out.modes_told = nuisance, True
        return out

    def rebase(self, values: Values) -> None:
        """Replace the configuration of the bare model by another one in plain values, with an
        effect that was found.
        """
        self.values, self.followed = values, True
        self.bare = linearised(attach(check_config(values, "model with an effect"), self.campaign))
        for name in ("measured_fit", "measured_reading", "linear_stage"):
            self.__dict__.pop(name, None)

    def variant(self, candidate: Candidate | Pair, physical: Physical) -> Values:
        """Return the configuration in plain values with a candidate, in addition to what was
        adopted, or instead of it where the candidate is alone.
        """
        return candidate.variant(self._without(candidate), physical)

    def _without(self, candidate):
        """Return the configuration that a candidate changes: as it was where it is alone, else with
        what was adopted.
        """
        return self.given if candidate.alone else self.values

    @property
    def gains(self) -> np.ndarray:
        """Return (channel,): the gains of the nuisance."""
        return np.ones(len(self.signals.names)) if self.nuisance is None else self.nuisance.gain

    @cached_property
    def settled(self) -> np.ndarray:
        """Return (sample,) bool: the samples that are compared. A record that begins in a steady
        state is simulated from rest, and its first seconds are not compared.
        """
        samples = self.signals.force.shape[-1]
        return np.arange(samples) >= (
            0
            if self.signals.from_rest
            else min(round(SETTLING_S * self.signals.rate), samples // 4)
        )

    @cached_property
    def linear_stage(self) -> bool:
        """Return True where the lowest record identifies the linear structure: a mode is seen and
        the bare model does not touch.
        """
        return not self.touches(self.bare) and self.measured_fit is not None

    @property
    def reads_lowest(self) -> bool:
        """Return True where the lowest record is compared by its modes alone, as that of a linear
        structure; else it is compared by its features, as the other records are.
        """
        return self.linear_stage and not self.nonlinear_low

    @cached_property
    def linear_record(self) -> LinearRecord:
        """Return the LinearRecord of the lowest record."""
        record = self.signals.lowest
        return LinearRecord(
            self.valid(self.signals.force[record]),
            self.signals.rate,
            self.signals.band_Hz,
            self.signals.from_rest,
            base=None if self.signals.base is None else self.valid(self.signals.base[record]),
        )

    @cached_property
    def measured_fit(self) -> ModalFit | Any:  # Any, not None: callers look at linear_stage first
        """Return the ModalFit of the lowest measured record, None where no mode is seen."""
        response = self.valid(self.signals.response[self.signals.lowest])
        return fit_modes(
            self.linear_record,
            response,
            self.bare,
            self.signals.kinds,
            self.signals.noise_in_band,
            search=not self.followed,
        )

    @cached_property
    def measured_reading(self) -> linear.Reading:
        """Return the Reading of the lowest measured record."""
        return linear.reading_of_fit(self.measured_fit, self.bare)

    @property
    def bare_reading(self) -> linear.Reading:
        """Return the Reading that the bare model and the measuring chain predict of the modes of
        the lowest record.
        """
        return linear.gained(
            linear.reading_of_model(self.bare, self.measured_fit.modes), self.measuring
        )

    @cached_property
    def measured_features(self) -> np.ndarray:
        """Return (record, feature) of the measurement."""
        out = []
        for record in range(len(self.signals.load)):
            keep = np.isfinite(self.signals.response[record]).all(axis=0) & self.settled
            out.append(
                record_features(
                    self.layout,
                    self.signals.force[record][0, keep],
                    self.signals.response[record][:, keep],
                )
            )
        return np.array(out)

    def model(self, values: Values | None = None) -> ModalModel:
        """Return the attached model of a configuration in plain values, with the nuisance
        corrections.
        """
        if values is None or values is self.values:
            return linear.corrected(self.bare, self.nuisance)
        return linear.corrected(
            attach(check_config(values, "variant of the model"), self.campaign),
            self.nuisance,
            self.bare,
        )

    def touches(self, model: ModalModel) -> bool:
        """Return True where the linear response of a model to the lowest record reaches contact."""
        points = model.contact_shapes.reshape(model.modes, -1)
        if not points.size:
            return False
        record, model = self.linear_record, linearised(model)
        transfer = 1.0 / (
            model.omega[:, None] ** 2
            - record.omega**2
            + 1j * model.damping[:, None] * record.omega
            + 1.0e-9
        )
        modal = (
            np.fft.irfft(
                (model.drive_shapes @ record.spectrum) * transfer,
                record.length // record.every,
                axis=-1,
            )
            / record.every
        )
        largest = np.abs(points.T @ modal).max(axis=-1).reshape(-1, 2).max(axis=1)
        gap = self.signals.gap[self.signals.lowest]
        clearance = np.where(
            np.isnan(model.contact_laws.gap), model.gap_factor * gap, model.contact_laws.gap
        )
        return bool(np.isfinite(gap) and np.any(largest > TOUCHES * clearance))

    def runs(
        self, records: Iterable[int] | np.ndarray, seeds: int, first_seed: int = 0
    ) -> list[Run]:
        """Return [(record, gap, seed)] of `seeds` runs of every record."""
        first = first_seed + DRAW * self.draw
        return [
            (int(record), float(self.signals.gap[record]), first + seed)
            for record in records
            for seed in range(seeds)
        ]

    def noisy_features(self, runs: Sequence[Run], responses: np.ndarray) -> np.ndarray:
        """Return (run, feature) of responses (run, channel, sample) with measuring noise, each cut
        to the valid samples of its record; NaN for a run that diverged.
        """
        out = []
        for (record, _, seed), response in zip(runs, responses, strict=True):
            if np.isnan(response).any():  # the run diverged
                out.append(np.full(len(self.layout.kind), np.nan))
                continue
            keep = np.isfinite(self.signals.force[record][0]) & self.settled
            noise = np.random.default_rng([7, seed, record]).standard_normal(
                (len(self.signals.noise), int(keep.sum())), dtype=np.float32
            )
            noisy = response[:, : keep.size][:, keep] + noise * self.signals.noise[:, None].astype(
                np.float32
            )
            out.append(record_features(self.layout, self.signals.force[record][0, keep], noisy))
        return np.array(out)

    def stepped(self, model: ModalModel) -> tuple[Schedule, Forces]:
        """Return (Schedule, Forces) with as many steps as the contact of a model needs, up to FINER
        times the usual; the usual ones where that is too few.

        Where a damper gains energy in the exact step (integration.step_stability), the finest
        Newmark steps are taken, in which it never does: with steps twice as long, responses at
        1000 N s/m per plate are 3 % off.
        """
        usual, given = self.schedule.steps_per_second, self.schedule.scheme
        tried = [(finer, given) for finer in (1, *FINER)]
        tried += [(FINER[-1], "newmark")]
        for finer, scheme in tried:
            dt = 1.0 / (finer * usual)
            if (
                contact_contraction(model, dt, scheme) < CONTRACTION_LIMIT
                and step_growth(model, dt, scheme) <= LARGEST_GROWTH
            ):
                return self._steps(finer, scheme)
        return self.schedule, self.forces

    def _steps(self, finer, scheme):
        """Return (Schedule, Forces) with so many times the usual steps, of a scheme."""
        if (finer, scheme) not in self._finer:
            steps = finer * self.schedule.steps_per_second
            schedule = replace(self.schedule, steps_per_second=steps, scheme=scheme)
            self._finer[finer, scheme] = schedule, Forces(self.signals.force, schedule)
        return self._finer[finer, scheme]

    def respond(
        self,
        model: ModalModel,
        runs: Sequence[Run],
        measuring: Measuring | None = None,
        finest: bool = False,
    ) -> np.ndarray:
        """Return (run, channel, sample) responses with the gains of the nuisance and the faults of
        the measuring chain (Measuring), relative to the base; finest: with the finest steps,
        whatever the model needs.

        Runs of which one diverges are all marched again with the finest steps: what contact needs
        that dissipates with its indentation is not known before.

        The measuring chain acts on the absolute motion of a structure on a moving base, from which
        the measured motion of the base is subtracted as it is from the measurement.
        """
        if finest:
            schedule, forces = self._steps(FINER[-1], self.schedule.scheme)
        else:
            schedule, forces = self.stepped(model)
        chain = [fault for fault in (self.late, self.measuring, measuring) if fault is not None]
        factor = np.prod([fault.force_gain for fault in chain])
        forces = forces if factor == 1.0 else Forces(self.signals.force / factor, schedule)
        count_simulated(0, len(runs) * schedule.steps * len(model.omega))
        try:
            responses = simulate_records(model, schedule, forces, runs, self.signals.kinds)
        except IntegrationError:
            if finest:
                raise
            return self.respond(model, runs, measuring, finest=True)
        count_simulated(len(runs))
        base = self._base_of(runs, responses.shape[-1])
        if base is not None:
            responses = responses + base / np.float32(factor)
        gain = self.gains
        for fault in chain:
            gain = gain * fault.gain
            responses = fault.delayed(responses, self.signals.rate)
        responses = responses * gain[:, None].astype(np.float32)
        return responses if base is None else responses - base

    def _base_of(self, runs, samples):
        """Return (run, channel, sample) float32: the measured motion of the base in every channel,
        0 beyond a record's valid samples; None where forces drove the structure.
        """
        if self.signals.base is None:
            return None
        own = np.nan_to_num(self.signals.base[[record for record, _, _ in runs]])
        short = max(samples - own.shape[-1], 0)
        return np.pad(own[..., :samples], ((0, 0), (0, 0), (0, short))).astype(np.float32)

    def features(
        self, model: ModalModel, runs: Sequence[Run], measuring: Measuring | None = None
    ) -> np.ndarray:
        """Return (run, feature): the features of runs with measuring noise, each cut to the valid
        samples of its record; NaN for a run that is thrown off with the finest steps too.
        """
        found = self.noisy_features(runs, self.respond(model, runs, measuring))
        if not np.isnan(found).any():
            return found
        return self.noisy_features(runs, self.respond(model, runs, measuring, finest=True))

    @staticmethod
    def valid(values: np.ndarray) -> np.ndarray:
        """Return the samples of (..., sample) at which all are finite."""
        return values[..., np.isfinite(values).all(axis=tuple(range(values.ndim - 1)))]


def corrected_nuisance(
    bench: Workbench,
) -> tuple[linear.Nuisance | None, float, float, np.ndarray]:
    """Return (Nuisance, log likelihood, chi-square, pulls) of the measured lowest record given the
    Reading of the bare model; (None, 0, 0, none) where no mode is seen.
    """
    fit = bench.measured_fit
    if fit is None:
        return None, 0.0, 0.0, np.zeros(0)
    score, chi_square, pulls = linear.likelihood(bench.measured_reading, bench.bare_reading)
    return linear.nuisance_of(pulls, fit.modes, len(bench.signals.names)), score, chi_square, pulls
