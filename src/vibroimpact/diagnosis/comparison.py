"""A campaign as the model is compared with it: read once, cut to its usable stretches."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vibroimpact.config.problems import ConfigError
from vibroimpact.integration.contact_convergence import contact_contraction
from vibroimpact.reduction.modal_model import ModalModel

from .bench import Bench, holds, with_model_error
from .catalogue import NO_EFFECT, within_priors
from .constants import HOLD_SHARES, LINEAR_HOLD, SCREENED_S, STRENGTH, STRETCH_S
from .coordinates import Coordinate, nuisance_coordinates
from .explanations import TURNED, Structure, Term, seen
from .measurement.signals import Signals
from .measurement.stretches import Rates, Stretch, held_band, rates_of, stretches_of, valid_samples
from .sizes import sizes_of

FITTED, SCREENED, APART = 3, 2, 4  # stretches
ALONG = (6, 24)  # places of a mass along a tube, at least and at most
BEGIN, STARTS = 0.2, 3  # start of the first stretch as a share of the record; stretches of a record
# Of the steps of free runs: held to a measurement, a run forgets the errors of earlier steps. Not
# fewer than make the iteration of contact contract by CONTRACTION.
FEWER_STEPS, CONTRACTION = 0.5, 0.2
LOWEST = 1.5  # of the lowest load over the gap: records at that load
LOST_SHARE = 0.3  # of the strength, for a record that none holds
INSIDE = (1.3, 0.92)  # of the ends of the held band: the band of the lines


@dataclass(frozen=True, eq=False)
class Comparison:
    """Signals of a campaign and a Structure to compare with them.

    with_lost: whether records that do not hold the model are compared all the same. linear: records
    that are held with LINEAR_HOLD of the strength.
    """

    signals: Signals
    structure: Structure
    threads: int = 1
    with_lost: bool = False
    linear: frozenset[int] = frozenset()

    @property
    def _model(self) -> ModalModel:
        """Return the model as given."""
        return self.structure.with_terms(())

    @cached_property
    def rates(self) -> Rates:
        """Return the Rates of held runs, which take fewer steps than free ones."""
        own = self.structure.config.integration
        contraction = contact_contraction(self._model, 1.0 / own.steps_per_second, own.scheme)
        share = np.sqrt(np.nan_to_num(contraction, nan=np.inf) / CONTRACTION)
        steps = own.steps_per_second * float(np.clip(share, FEWER_STEPS, 1.0))
        return rates_of(self.signals.rate, steps, self.structure.decimation, stages=1)

    @cached_property
    def band(self) -> tuple[float, float]:
        """Return the band in which motion is held, Hz."""
        return held_band(self.signals, self.rates, self._first / (2.0 * np.pi))

    @property
    def _first(self) -> float:
        """Return the lowest frequency of the modes that are not rigid motion, rad/s."""
        return float(self._model.omega[self._model.omega > 0.0].min())

    @cached_property
    def sizes(self) -> dict[str, float]:
        """Return the sizes of the structure and its campaign, see sizes.sizes_of."""
        highest = self.by_load(self.signals.fit())[-1]
        (stretch,) = self._cut([(highest, self._starts(highest)[0])], STRETCH_S)
        steps = self.rates.steps_per_second
        return sizes_of(self._model, self.signals, stretch, steps, self.structure.values)

    @property
    def modes(self) -> int:
        """Return the number of modes up to the upper end of the band that are seen."""
        return len(self._seen)

    @property
    def all_modes(self) -> int:
        """Return the number of modes that are seen, in the band and above."""
        return int(seen(self._model).sum())

    @cached_property
    def _seen(self):
        """Return the numbers of the modes of the model as given that are seen in the band."""
        return np.flatnonzero(seen(self._model) & (self._model.frequencies < self.band[1]))

    def within_priors(self, term: Term) -> bool:
        """Return whether a term is no more than a good model is off by anyway; of the linear
        structure also one that leaves every mode in the band near its place.
        """
        if within_priors(term, self.signals.rate, self.sizes):
            return True
        if not term.effect.linear or term.effect.measured or term.effect_id == TURNED:
            return False
        try:
            model = self.structure.with_terms((term,))
        except (ConfigError, ValueError):
            return False
        own = np.flatnonzero(seen(model))[: len(self._seen)]
        if len(own) < len(self._seen):
            return False
        for name, effect in (("omega", "mode_frequency_error"), ("damping", "modal_damping")):
            given, now = getattr(self._model, name)[self._seen], getattr(model, name)[own]
            most = np.exp(NO_EFFECT[effect])
            if np.any((now > most * given) | (given > most * now)):
                return False
        return True

    @property
    def resonant(self) -> frozenset[str]:
        """Return the names of the modes whose resonance is within the lines. A mode above these
        adds flexibility alone: its frequency would stand for any flexibility that is missing.
        """
        inside = self._model.frequencies[self._seen] < INSIDE[1] * self.band[1]
        return frozenset(f"mode_{number + 1}" for number in self._seen[inside])

    def nuisances(self) -> list[Coordinate]:
        """Return the coordinates of the nuisances: of the modes in the band, of all channels and,
        if motion across the force is seen, of its direction.
        """
        return nuisance_coordinates(self.modes, len(self.structure.names), self.across)

    @cached_property
    def across(self) -> bool:
        """Return whether sensors of more than one direction move at the highest load."""
        moving = self._bench(self._fitted).moving[-1, :, 0]
        directions = self._model.sensor_directions[moving]
        return len(directions) > 0 and int(np.linalg.matrix_rank(directions, tol=0.3)) > 1

    @property
    def along(self) -> int:
        """Return the number of places of a mass along a tube: as many as modes up to the end of the
        band, two in each half wave of the highest one.
        """
        return int(np.clip(np.sum(self._model.frequencies < self.band[1]), *ALONG))

    def by_load(self, records: Sequence[int] | np.ndarray) -> list[int]:
        """Return records in the order of their load over the gap."""
        gap = np.nan_to_num(self.signals.gap, nan=1.0)
        return sorted(map(int, records), key=lambda record: self.signals.load[record] / gap[record])

    @cached_property
    def _fitted(self) -> list[tuple[int, float]]:
        """Return (record, start) of the stretches that are fitted."""
        return self._spread(self.signals.fit(), FITTED)

    def fitted(self) -> Bench:
        """Return the Bench that explanations are fitted on: low, middle and high loads."""
        return with_model_error(self._bench(self._fitted))

    def screened(self) -> Bench:
        """Return the Bench of screening: the higher loads."""
        return with_model_error(self._bench(self._fitted[-SCREENED:], SCREENED_S))

    def apart(self) -> Bench:
        """Return the Bench of stretches that took no part: of held-out records, and a late one of
        the highest load that is fitted; late ones alone if no held-out record can be compared.
        """
        late = self._spread(self.signals.fit(), FITTED, self._fitted)
        held_out = self.signals.holdout()
        if any(record in self._holding for record in held_out):
            return with_model_error(self._bench([*self._spread(held_out, APART - 1), *late[-1:]]))
        last = [(record, self._starts(record)[-1]) for record, _ in self._fitted]
        return with_model_error(self._bench(late or last))

    def lowest(self) -> Bench:
        """Return the Bench of the first stretch of each record at the lowest load."""
        size = self.signals.load / np.nan_to_num(self.signals.gap, nan=1.0)
        records = np.flatnonzero(size <= LOWEST * size.min()).tolist()
        return self._bench([(each, self._starts(each)[0]) for each in records], SCREENED_S)

    def led(self, bench: Bench, lead_s: float) -> tuple[tuple[Stretch, ...], float]:
        """Return (the stretches of a Bench with a lead before each, its duration in s): lead_s, or
        less if a record has less before a stretch.
        """
        duration = bench.schedule.duration
        lead = min(lead_s, *(stretch.start_s for stretch in bench.stretches))
        places = [(stretch.record, stretch.start_s - lead) for stretch in bench.stretches]
        return self._cut(places, duration + lead), lead

    @cached_property
    def lost(self) -> tuple[int, ...]:
        """Return the records that do not hold the model as given: their sensors are too few for
        their impacts, and without a hold the lines show nothing.
        """
        return tuple(record for record, (_, held) in enumerate(self._held) if not held)

    def widened(self) -> Comparison:
        """Return the Comparison that takes in the records that do not hold the model."""
        return self._changed(with_lost=True)

    def with_linear(self, records: Iterable[int]) -> Comparison:
        """Return the Comparison that holds some records with LINEAR_HOLD of the strength."""
        return self._changed(linear=frozenset(records))

    def _changed(self, **fields):
        """Return the Comparison with other fields."""
        other = replace(self, **fields)
        object.__setattr__(other, "_held", self._held)  # found once
        return other

    @cached_property
    def _holding(self) -> dict[int, list[float]]:
        """Return {record: starts of its compared stretches, s}, of the records that have any."""
        if self.with_lost:
            return {record: self._starts(record) for record in range(len(self.signals.load))}
        return {record: held for record, (_, held) in enumerate(self._held) if held}

    @cached_property
    def _held(self) -> list[tuple[float, list[float]]]:
        """Return of each record (the strongest of HOLD_SHARES that holds most of its stretches, the
        starts in s of those that it holds).
        """
        starts = [self._starts(record) for record in range(len(self.signals.load))]
        out: list[tuple[float, list[float]]] = [(LOST_SHARE, [])] * len(starts)
        for share in HOLD_SHARES:
            left = [
                (r, at) for r, own in enumerate(starts) for at in own if len(out[r][1]) < len(own)
            ]
            if not left:
                break
            bench = self._bench(left, shares=[share] * len(starts))
            held = [
                place for place, good in zip(left, holds(bench, self.modes), strict=True) if good
            ]
            for record in range(len(starts)):
                own = [at for number, at in held if number == record]
                out[record] = max(out[record], (share, own), key=lambda pair: len(pair[1]))
        return out

    def _starts(self, record: int) -> list[float]:
        """Return the starts of the stretches of a record, s."""
        whole = valid_samples(self.signals, record) / self.signals.rate
        last = max(whole - STRETCH_S - 1.2, 0.0)
        first = (min(BEGIN * whole + number * STRETCH_S, last) for number in range(STARTS))
        return list(dict.fromkeys(map(float, first)))

    def _spread(self, records, count, taken=()):
        """Return [(record, start)]: at most `count` compared stretches of records, from the lowest
        load to the highest, none of `taken`; of the lowest load if no record holds the model.
        """
        left = {
            int(record): [
                at for at in self._holding.get(record, ()) if (int(record), at) not in taken
            ]
            for record in records
        }
        order = [record for record in self.by_load(records) if left[record]]
        if not order and not taken:
            lowest = self.by_load(records)[0]
            order, left[lowest] = [lowest], self._starts(lowest)
        chosen = [order[round(at)] for at in np.linspace(0, len(order) - 1, count)] if order else []
        return [(record, left[record].pop(0)) for record in chosen if left[record]]

    def _cut(self, places, duration_s):
        """Return the stretches at places."""
        where = self.band, self.rates, self.structure.scale
        return tuple(stretches_of(self.signals, places, duration_s, *where))

    def _bench(self, places, duration_s=STRETCH_S, shares=None):
        """Return the Bench of places, its dampers STRENGTH times as strong as the impedance of the
        structure at its sensors: the first frequency over the largest square of a mode shape.

        shares (record,): of that; those that hold the records if None.
        """
        low, high = self.band
        if shares is None:
            shares = [
                LINEAR_HOLD if record in self.linear else share
                for record, (share, _) in enumerate(self._held)
            ]
        scheme = self.structure.config.integration.scheme
        inside = (self._model.omega > 0.0) & (self._model.frequencies < high)
        largest = float(np.max(self._model.sensor_shapes[inside] ** 2))
        stretches = self._cut(list(dict.fromkeys(places)), duration_s)
        return Bench(
            self.structure,
            tuple(replace(own, hold=shares[own.record]) for own in stretches),
            self.rates.schedule(duration_s, scheme),
            (INSIDE[0] * low, INSIDE[1] * high),
            STRENGTH * (self._first / largest),
            self.threads,
            self.band[1],
        )
