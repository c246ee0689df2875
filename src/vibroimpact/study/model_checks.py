"""The checks of a study that need its model, before anything runs: structure, basis, step, mesh."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, count
from typing import Any, cast

import numpy as np

from vibroimpact.config.idle_keys import idle_keys
from vibroimpact.config.problems import shown
from vibroimpact.config.schema import Basis, Config
from vibroimpact.excitation.fluid_elastic import outside_fit
from vibroimpact.geometry.sections import outer_width
from vibroimpact.identify.guards import FEWEST_AVERAGES, few_averages
from vibroimpact.identify.linear.support_groups import reached_supports
from vibroimpact.identify.spectra.welch import driven_axis, effective_averages
from vibroimpact.integration.contact_convergence import IntegrationError, checked_contraction
from vibroimpact.integration.step_stability import require_stable_step
from vibroimpact.reduction.modal_model import ModalModel
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
    point_rows_of,
)

# A larger structure takes minutes to reduce: its job reports its faults.
MOST_DOFS = 3000
STILL = 1.0e-9  # of the largest motion of a sensor: none


@dataclass(frozen=True)
class ModelChecks:
    """The results of the checks of a model, in sentences with key, value and remedy.

    problems: why the study can not run.
    warnings: causes that make its numbers wrong.
    """

    problems: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def check_model(config: Config) -> ModelChecks:
    """Return the problems of a study's model: of its files, structure, basis, step and mesh."""
    problems, step = [*idle_keys(config)], config.integration
    try:
        structure, _ = full_structure(config)
        if structure.dofs > MOST_DOFS:
            return ModelChecks(tuple(problems))
        model = build_model(config)
    except ValueError as error:
        return ModelChecks((*problems, str(error)))
    if keeps_all_modes(structure) and config.basis != Basis():
        problems.append(
            f"basis = {shown(dict(config.basis))} has no effect: a structure with"
            f" {structure.dofs} degrees of freedom keeps all its modes, as every one that is no"
            f" tube does up to {MAX_FULL_DOFS}: leave basis out, or reduce the matrices"
        )
    problems += [*without_effect(model, config.excitation), *runaway(model)]
    problems += [*still_points(config, structure), *too_many_ratios(config, model)]
    problems += [*unseen(config, model), *exchanged(config, model)]
    try:
        checked_contraction(model, step.steps_per_second, step.scheme)
        require_stable_step(model, step.steps_per_second, step.scheme)
        accuracy = model_accuracy(config)
        require_accurate(accuracy)
    except (IntegrationError, ModelAccuracyError) as error:
        return ModelChecks((*problems, str(error)))
    condensed = getattr(structure, "condensed", None)
    told = [] if condensed is None else [f"structure.mass: {condensed.told()}"]
    told += extrapolated(config, model)
    warnings = (*told, *short_record(config), *mesh_warnings(accuracy))
    return ModelChecks(tuple(problems), warnings)


def still_points(config: Config, structure: Any) -> Iterator[str]:
    """Yield a sentence for each mass, and each force after the first, at a point that is held."""
    rows_of, force = point_rows_of(structure, config), config.excitation
    forces = {
        f"excitation.{key}[{index}]": entry
        for key in ("also", "constant")
        for index, entry in enumerate(getattr(force, key, ()))
    }
    masses = {f"masses[{index}]": mass for index, mass in enumerate(config.masses)}
    for place, entry in (masses | forces).items():
        along = np.asarray(getattr(entry, "direction", np.eye(3)))
        if not np.any(along @ rows_of(entry.point)):
            yield (
                f"{place}.point = '{entry.point}' has no effect, nothing moves there: give another"
                " point, or leave it out"
            )


def too_many_ratios(config: Config, model: ModalModel) -> Iterator[str]:
    """Yield that a structure has fewer modes than damping ratios are stated."""
    ratios, modes = getattr(config.damping, "first_ratios", ()), np.count_nonzero(model.omega)
    if len(ratios) > modes and config.damping != Config.model_fields["damping"].get_default():
        yield (
            f"damping.first_ratios = {shown(ratios)} has {len(ratios)} values for {modes} modes:"
            " give one for each of the first modes, at most as many as there are"
        )


def unseen(config: Config, model: ModalModel) -> Iterator[str]:
    """Yield why nothing can be identified: the force moves no support, a mode is undamped, a point
    or the shape line does not move, or two references are at one place.
    """
    wanted = config.identification
    if wanted is None or not hasattr(config.excitation, "direction"):
        return
    try:
        _, modes = reached_supports(model, wanted.groups)
    except ValueError as error:
        yield f"identification: {error}: leave it out, or let the force act across a support"
        return
    undamped = modes[(model.damping[modes] == 0.0) & (model.omega[modes] > 0.0)]
    if undamped.size:
        yield (
            f"damping: {undamped.size} of {modes.size} modes that the force moves have none, the"
            f" first at {model.omega[undamped[0]] / (2.0 * np.pi):.4g} Hz: without contact they"
            " grow without bound, and there is no linear tube to compare with: give ratios above 0"
        )
    axis, line = driven_axis(config.excitation.direction), config.record.shape_line.direction
    shapes = {
        name: model.sensor_shapes[modes, index] for index, name in enumerate(model.sensor_names)
    }
    least = STILL * max(np.abs(shape).max() for shape in shapes.values())
    if np.abs(model.line_shapes[modes]).max() <= least:
        yield (
            f"record.shape_line.direction = '{line}': the force, along {axis}, moves nothing along"
            f" it: give {axis}"
        )
    references = {f"lscf.references[{i}]": name for i, name in enumerate(wanted.lscf.references)}
    places = {"response_point": wanted.response_point, "broadband.point": wanted.broadband.point}
    for place, point in (places | references).items():
        if np.abs(shapes[f"{point}.{axis}"]).max() <= least:
            yield (
                f"identification.{place} = '{point}' does not move along {axis}, the direction of"
                " the force: give a point that does"
            )
    for (_, one), (place, other) in combinations(references.items(), 2):
        apart = np.abs(shapes[f"{one}.{axis}"] - shapes[f"{other}.{axis}"]).max()
        if apart <= least:
            yield (
                f"identification.{place} = '{other}' moves as the reference '{one}' does: give a"
                " point elsewhere, or leave it out"
            )


def exchanged(config: Config, model: ModalModel) -> Iterator[str]:
    """Yield that all modes of a structure given by matrices are below the band of its force."""
    band, highest = getattr(config.excitation, "band_Hz", None), float(model.frequencies.max())
    if config.structure.kind == "matrices" and band is not None and highest < band[0]:
        yield (
            f"structure.mass, structure.stiffness: the highest mode is at {highest:.3g} Hz, below"
            f" the band of the force from {band[0]:g} Hz: exchange the two matrices, or correct"
            " their units"
        )


def extrapolated(config: Config, model: ModalModel) -> Iterator[str]:
    """Yield that the fluid-elastic force is not known at the lowest mode that it moves."""
    moved = np.any(model.fluid_shapes != 0.0, axis=1) & (model.omega > 0.0)
    flow: Any = config.flow
    if not moved.any():
        return
    lowest = float(model.omega[moved].min()) / (2.0 * math.pi)
    width = outer_width(cast(Any, config.structure).section)
    text = outside_fit(flow.coupling, flow.acting_m_per_s, lowest, width)
    if text:
        yield text


def short_record(config: Config) -> Iterator[str]:
    """Yield that a record holds too few segments to identify from, and the remedy."""
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
