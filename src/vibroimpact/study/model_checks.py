"""The checks of a study that need its model, before anything runs: structure, basis, step, mesh."""

from __future__ import annotations

from dataclasses import dataclass

from vibroimpact.config.problems import shown
from vibroimpact.config.schema import Basis, Config
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
    condensed = getattr(structure, "condensed", None)
    told = [] if condensed is None else [f"structure.mass: {condensed.told()}"]
    return ModelChecks(tuple(problems), (*told, *mesh_warnings(accuracy)))
