"""A start for the identification of modes where those of the bare model are too far from those of
the lowest record: the models with linear effects whose spectra come nearest.
"""

from collections.abc import Collection
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np

from vibroimpact.config.reading import ConfigError
from vibroimpact.observation.sensed_motion import of_modes, orders
from vibroimpact.reduction.modal_model import ModalModel

from . import priors
from .candidates import Pair, linear_candidates, unit_grid
from .effect_fit import LinearChanges
from .linearised import matched
from .modal_fit import ModalFit
from .mode_identification import fit_modes, left
from .nuisance import Nuisance, corrected
from .workbench import Workbench

BANDS_PER_OCTAVE = 8
# a larger difference of a band counts as so much: two peaks at different frequencies do not match,
# however sharp both are
FARTHEST_DB = 12.0
# points along each parameter, by the number of parameters: of one effect, of a second one
GRID = ({1: 7, 2: 5, 3: 4}, {1: 5, 2: 3, 3: 3})
BEGUN = 3  # models from which the fit is begun
# of all frequencies: those of tubes of another length or section
FACTORS = np.geomspace(1.0 / 1.5, 1.5, 41)

Ranked = tuple[float, Any, np.ndarray, ModalModel]  # distance, Candidate or Pair, unit, model


def fit_from_nearest(
    bench: Workbench, changes: LinearChanges, scales: dict[str, float], held: Collection[str]
) -> tuple[ModalFit, list[tuple[Pair, np.ndarray]]]:
    """Return (ModalFit, [(Pair, unit (parameter,))]): the fit of the lowest record of a Workbench,
    relative to its bare model, begun from the linear effects whose spectra come nearest, and the
    pairs among these. The Workbench's own fit where none of them leads to a better one.

    First all frequencies times a factor are tried, as those of another length or section are; then
    one effect, and two where one does not lead to a fit. changes: LinearChanges of the
    Workbench; scales: see Candidate.physical; held: see candidates.linear_candidates.
    """
    spectra = BandSpectra(bench)
    singles = [
        candidate
        for candidate in linear_candidates(
            bench.values, bench.signals.names, held, bench.measured_fit.modes
        )
        if not candidate.effect.measured
    ]
    pairs: list[tuple[Pair, np.ndarray]] = []
    known: list[Ranked] = []
    least, best = left(bench.measured_fit, bench.bare), bench.measured_fit
    remains, found = begun_from_factor(bench, spectra)
    if found is not None and remains < least:
        least, best = remains, found
    if least < priors.LINEAR_RESIDUAL:
        return best, pairs
    for second in (False, True):
        tried: list[Any] = (
            singles
            if not second
            else [
                Pair(known[0][1], other)
                for other in singles
                if other.effect_id != known[0][1].effect_id
            ]
        )
        ranked = []
        for candidate in tried:
            count = len((candidate.second if second else candidate).effect.parameters)
            for unit in unit_grid(count, GRID[second][count]):
                unit = np.concatenate([known[0][2], unit]) if second else unit
                try:
                    model = changes.model(candidate, candidate.physical(unit, scales))
                except ConfigError:
                    continue  # no valid configuration has so much of it
                ranked.append((spectra.distance(model), candidate, unit, model))
        if not ranked:
            break
        ranked.sort(key=lambda row: row[0])
        known = known or ranked
        for _, candidate, unit, model in islice(_different(ranked), BEGUN):
            pairs += [(candidate, unit)] * second
            remains, found = begun_from(bench, model)
            if found is not None and remains < least:
                least, best = remains, found
        if least < priors.LINEAR_RESIDUAL:
            break
    return best, pairs


def begun_from_factor(bench: Workbench, spectra: "BandSpectra") -> tuple[float, ModalFit | None]:
    """Return begun_from the bare model with all frequencies times the factor whose spectra come
    nearest; its modes are those of the bare model.
    """
    models = [(factor, _scaled(bench.bare, factor)) for factor in FACTORS]
    factor, model = min(models, key=lambda one: spectra.distance(one[1]))
    remains, found = _from(bench, model)
    if found is None:
        return np.inf, None
    return remains, replace(found, log_frequency=found.log_frequency + np.log(factor))


def _scaled(model, factor):
    """Return a ModalModel with all frequencies times a factor and the same damping ratios."""
    return replace(model, omega=model.omega * factor, damping=model.damping * factor)


def begun_from(bench: Workbench, model: ModalModel) -> tuple[float, ModalFit | None]:
    """Return (largest residual over noise, ModalFit relative to the bare model) of the lowest
    record fitted from another model; (inf, None) where it shows no mode of that.
    """
    remains, found = _from(bench, model)
    return remains, found if found is None else translated(found, model, bench.bare)


def _from(bench, model):
    """Return (largest residual over noise, ModalFit relative to a ModalModel) of the lowest record
    fitted from it; (inf, None) where it shows no mode of that.
    """
    record = bench.signals.lowest
    responses = bench.valid(bench.signals.response[record])
    found = fit_modes(
        bench.linear_record,
        responses,
        model,
        bench.signals.kinds,
        bench.signals.noise_in_band,
        search=False,
    )
    return (np.inf, None) if found is None else (left(found, model), found)


def at_modes(model: ModalModel, fit: ModalFit) -> ModalModel:
    """Return a ModalModel with the frequencies and damping of a ModalFit."""
    gain = np.ones(len(fit.participation))
    found = Nuisance(fit.modes, np.exp(fit.log_frequency), np.exp(fit.log_damping), gain)
    return corrected(model, found)


def translated(fit: ModalFit, model: ModalModel, other: ModalModel) -> ModalFit:
    """Return a ModalFit relative to `model` as one relative to another ModalModel: each mode as the
    most similar mode of the other.
    """
    modes = matched(other, np.log(model.omega[fit.modes]) + fit.log_frequency, fit.participation)
    order = np.argsort(modes)
    frequency = fit.log_frequency + np.log(model.omega[fit.modes] / other.omega[modes])
    damping = (
        fit.log_damping
        + np.log(model.damping[fit.modes] / model.omega[fit.modes])
        - np.log(other.damping[modes] / other.omega[modes])
    )
    there = replace(fit, modes=modes, log_frequency=frequency, log_damping=damping)
    return there.of_modes(order)


class BandSpectra:
    """The spectra of the lowest record of a Workbench in narrow bands, to compare with those of
    linear models.
    """

    def __init__(self, bench: Workbench) -> None:
        record, lowest = bench.linear_record, bench.signals.lowest
        self.moves = of_modes(bench.signals.kinds)
        self.frequency, self.force = (
            record.frequency,
            record.spectra(bench.valid(bench.signals.force[lowest])),
        )
        # from displacements to what each channel measures
        self.factor = (2.0 * np.pi * self.frequency) ** orders(bench.signals.kinds[self.moves])[
            :, None
        ]
        octaves = np.log2(self.frequency / self.frequency[0])
        self.starts = np.unique(
            np.searchsorted(octaves, np.arange(0.0, octaves[-1], 1.0 / BANDS_PER_OCTAVE))
        )
        measured = record.spectra(bench.valid(bench.signals.response[lowest])[self.moves])
        self.noise = (bench.signals.noise_in_band[self.moves] ** 2 / len(self.frequency))[
            :, None
        ] * np.diff([*self.starts, len(self.frequency)])
        self.measured = self._bands(measured)

    def distance(self, model: ModalModel) -> float:
        """Return the RMS over bands and channels in dB by which the steady response of a linear
        ModalModel to the measured force differs from the record.
        """
        omega = 2.0 * np.pi * self.frequency
        near = np.flatnonzero(model.omega < 3.0 * omega[-1])
        modal = (model.drive_shapes[near] @ self.force) / (
            model.omega[near, None] ** 2 - omega**2 + 1j * model.damping[near, None] * omega
        )
        response = model.sensor_shapes[near][:, self.moves].T @ modal * self.factor
        difference = 10.0 * np.log10(self.measured / (self._bands(response) + self.noise))
        return float(np.sqrt(np.mean(np.clip(difference, -FARTHEST_DB, FARTHEST_DB) ** 2)))

    def _bands(self, lines):
        return np.add.reduceat(np.abs(lines) ** 2, self.starts, axis=-1)


def _different(ranked):
    """Yield the first row of every candidate in rows (distance, candidate, unit, model)."""
    seen = set()
    for row in ranked:
        if row[1].name not in seen:
            seen.add(row[1].name)
            yield row
