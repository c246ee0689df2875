"""The checks of a study that need its model, before anything runs: structure, basis, step, mesh."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count

from vibroimpact.config.problems import shown
from vibroimpact.config.schema import Basis, Config
from vibroimpact.identify.guards import FEWEST_AVERAGES, few_averages
from vibroimpact.integration.contact_convergence import IntegrationError, checked_contraction
from vibroimpact.integration.step_stability import require_stable_step
from vibroimpact.reduction.model_accuracy import (
    ModelAccuracyError,
    mesh_warnings,
    model_accuracy,
    require_accurate,
)
from vibroimpact.reduction.model_effects import runaway, without_effect
from vibroimpact.reduction.reduced_model import (
    MAX_FULL_DOFS,
    build_model,
    full_structure,
    keeps_all_modes,
)
from vibroimpact.spectra.welch import effective_averages

# A larger structure takes minutes to reduce: its job says what is wrong with it.
MOST_DOFS = 3000


@dataclass(frozen=True)
class ModelChecks:
    """What the checks of a model say, in sentences with key, value and remedy.

    problems: why the study can not run.
    warnings: what makes its numbers wrong as they stand.
    """

    problems: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def check_model(config: Config) -> ModelChecks:
    """Return the problems of a study's model: of its files, structure, basis, step and mesh."""
    try:
        structure, _ = full_structure(config)
        if structure.dofs > MOST_DOFS:
            return ModelChecks()
        model = build_model(config)
    except ValueError as error:
        return ModelChecks((str(error),))
    problems, step = [], config.integration
    if keeps_all_modes(structure) and config.basis != Basis():
        problems.append(
            f"basis = {shown(dict(config.basis))} has no effect: a structure with"
            f" {structure.dofs} degrees of freedom keeps all its modes, as every one that is no"
            f" tube does up to {MAX_FULL_DOFS}: leave basis out, or reduce the matrices"
        )
    problems += [*without_effect(model, config.excitation), *runaway(model)]
    try:
        checked_contraction(model, step.steps_per_second, step.scheme)
        require_stable_step(model, step.steps_per_second, step.scheme)
        accuracy = model_accuracy(config)
        require_accurate(accuracy)
    except (IntegrationError, ModelAccuracyError) as error:
        return ModelChecks((*problems, str(error)))
    return ModelChecks(tuple(problems), (*short_record(config), *mesh_warnings(accuracy)))


def short_record(config: Config) -> Iterator[str]:
    """Yield that a record holds too few segments to identify from, and what would do."""
    record, spectra, rate = config.record, config.spectra, config.record.sampling_frequency_Hz
    if config.identification is None:
        return
    few = few_averages(effective_averages(record.duration_s, rate, spectra))
    if not few:
        return
    step = spectra.segment_s * (1.0 - spectra.overlap)
    durations = (spectra.segment_s + more * step for more in count(1))
    enough = next(
        duration
        for duration in durations
        if effective_averages(duration, rate, spectra) >= FEWEST_AVERAGES
    )
    yield (
        f"record.duration_s = {record.duration_s:g} is {record.duration_s / spectra.segment_s:.2g}"
        f" segments of spectra.segment_s = {spectra.segment_s:g} s: {few}, and every estimate is"
        f" flagged: record {math.ceil(enough)} s, or shorten the segment"
    )
