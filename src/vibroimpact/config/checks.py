"""The checks between keys of a configuration: geometry, sampling, names, bands.

A check is a generator of Problems whose argument names are the top-level sections it reads, or
parts of them, see _parts. It runs when those sections are valid by themselves, so that a mistake
elsewhere does not hide the others, and if there are such parts.
"""

import inspect
import math
import os
from collections import Counter
from collections.abc import Mapping
from typing import Any

from . import (
    flow_checks,
    geometry_checks,
    initial_checks,
    profile_checks,
    section_checks,
    turbulence_checks,
)
from . import name_checks as names
from .excitation import highest_frequency
from .key_problem import Problem, Problems, value_at
from .stage_settings import ConfigPart

STEPS_PER_EXCITED_PERIOD = 20
# kernels.RATIO, output_filter.LEAST_STAGES and PASS_FRACTION, which only the integration may import
FILTER_RATIO, FILTER_STAGES, FILTER_PASSES = 5, 2, 0.78125
# In rad. The exact scheme has no error in a mode alone; below pi, a mode is not aliased.
LARGEST_OMEGA_STEP = {"newmark": 1.0, "exact": 2.8}
MOST_STEPS_KEPT = 2e6
MOST_SAMPLES = 1e8  # of a record: 0.8 GB for each channel
MOST_CASES = 10**6
LEAST_LOG_STEP = 2e-5  # of loads spaced in logarithm, which are rounded to 6 digits
TOLERANCE = 1e-9


def cross_problems(sections: Mapping[str, Any]) -> list[Problem]:
    """Return the problems between sections, with their values.

    sections: {name: section} of those that are valid by themselves.
    """
    given = {name: section for name, section in sections.items() if section is not None}
    given |= _parts(given)
    given["given"] = given
    problems: list[Problem] = []
    for check in CHECKS:
        wanted = inspect.signature(check).parameters
        if given.keys() >= wanted.keys():
            problems += check(*(given[name] for name in wanted))
    return [
        each if each.value is not None else each._replace(value=value_at(sections, each.place))
        for each in problems
    ]


def _parts(sections: Mapping[str, Any]) -> dict[str, Any]:
    """Return {name: part} of the parts of sections that checks read.

    tube: the structure if it is a tube. line: its centreline, if its bends have directions.
    other: the structure if it is none. names: of the points that the structure has.
    turbulence: the excitation if it is that. A check of several sections, as far as there are any,
    reads `given`: all of them with these parts.
    """
    structure, force = sections.get("structure"), sections.get("excitation")
    parts: dict[str, Any] = {}
    if force is not None and force.kind == "turbulence":
        parts["turbulence"] = force
    if structure is None:
        return parts
    if "points" in sections:
        parts["names"] = names.names_of_points(structure, sections["points"])
    if structure.kind not in names.TUBES:
        return parts | {"other": structure}
    line = geometry_checks.centreline_of(structure)
    return parts | {"tube": structure} | ({} if line is None else {"line": line})


def _repeated_values(grid: ConfigPart) -> Problems:
    loads = grid.load_rms_N
    listed = loads if isinstance(loads, tuple) else ()
    for key, row in (("gap_m", grid.gap_m), ("load_rms_N", listed)):
        for value, times in Counter(row).items():
            if times > 1:
                yield Problem(
                    f"grid.{key}",
                    f"stands {times} times: a value names a case, give each once",
                    value,
                )
    if isinstance(loads, tuple):
        return
    if loads.last <= loads.first and loads.count > 1:
        yield Problem(
            "grid.load_rms_N.last", f"must be above first = {loads.first}, or the count 1"
        )
    elif math.log(loads.last / loads.first) < LEAST_LOG_STEP * (loads.count - 1):
        yield Problem(
            "grid.load_rms_N.count",
            f"loads between {loads.first} and {loads.last} are equal to 6 digits: give fewer",
        )


def _number_of_cases(grid: ConfigPart) -> Problems:
    loads = grid.load_rms_N
    counts = (len(loads) if isinstance(loads, tuple) else loads.count, len(grid.gap_m), grid.seeds)
    if math.prod(counts) > MOST_CASES:
        yield Problem(
            "grid",
            f"loads, gaps and seeds are {math.prod(counts)} cases, at most {MOST_CASES}: split the"
            " study",
            " x ".join(map(str, counts)),
        )


def _every_step(record: ConfigPart, integration: ConfigPart) -> Problems:
    steps = record.duration_s * integration.steps_per_second
    if record.every_step and steps > MOST_STEPS_KEPT:
        yield Problem(
            "record.every_step",
            f"would keep {steps:.3g} steps of every contact, at most {MOST_STEPS_KEPT:g}:"
            " shorten record.duration_s",
        )
    if record.every_step and integration.start_up_s > 0.0:
        yield Problem(
            "integration.start_up_s",
            "must be 0 if every step is kept: the run starts at its initial state",
        )


def _force(excitation: ConfigPart) -> Problems:
    for index, load in enumerate(getattr(excitation, "distributed", ())):
        if load.from_m == load.to_m:
            yield Problem(
                f"excitation.distributed[{index}].to_m",
                "is from_m again, the load has no length: give the other end of the stretch",
            )
    if excitation.kind == "measured" and not os.path.isfile(excitation.file):
        yield Problem(
            "excitation.file",
            "is not a file: give its path from the folder in which the study is run",
        )


def _overlay(overlay: ConfigPart, grid: ConfigPart) -> Problems:
    if overlay.campaign is not None and not os.path.isfile(overlay.campaign):
        yield Problem(
            "overlay.campaign",
            "is not a file: give its path from the folder in which the study is run, or null",
        )
    if overlay.seed < grid.seeds:
        yield Problem(
            "overlay.seed",
            f"is a seed of the study, which has 0 to {grid.seeds - 1}: give a larger one",
        )


def _bands(identification: ConfigPart) -> dict[str, tuple[float, ...]]:
    """Return {key: (low, high) in Hz} of the bands of the methods."""
    return {
        "peak_search_Hz": identification.peak_search_Hz,
        "lscf.band_Hz": identification.lscf.band_Hz,
        "broadband.band_Hz": identification.broadband.band_Hz,
    }


def _bands_pass_the_filter(record: ConfigPart, identification: ConfigPart) -> Problems:
    passed = FILTER_PASSES * record.sampling_frequency_Hz / 2
    for key, (_, high) in _bands(identification).items():
        if high > passed:
            yield Problem(
                f"identification.{key}",
                f"reaches above {passed:g} Hz, which the output filter passes, {FILTER_PASSES:.2f}"
                " of half record.sampling_frequency_Hz: lower it",
            )


def _bands_are_excited(excitation: ConfigPart, identification: ConfigPart) -> Problems:
    if excitation.kind not in ("band_limited", "turbulence"):
        return
    low, high = excitation.band_Hz
    bands = _bands(identification)
    begin, end = bands.pop("broadband.band_Hz")
    if begin < low - TOLERANCE or end > high + TOLERANCE:
        yield Problem(
            "identification.broadband.band_Hz",
            f"reaches beyond the excited band {[low, high]} Hz: there spectra of a tube and of"
            " its linear equivalent are not comparable",
        )
    for key, (begin, end) in bands.items():
        if end <= low or begin >= high:
            yield Problem(
                f"identification.{key}",
                f"lies outside the excited band {[low, high]} Hz: nothing is seen there",
            )


def _segments(record: ConfigPart, spectra: ConfigPart, identification: ConfigPart) -> Problems:
    if spectra.segment_s > record.duration_s:
        yield Problem(
            "spectra.segment_s",
            f"is longer than the record, {record.duration_s:g} s: shorten the segment or"
            " lengthen record.duration_s",
        )
    samples = spectra.segment_s * record.sampling_frequency_Hz
    if samples < 16:
        yield Problem(
            "spectra.segment_s",
            f"holds only {samples:g} samples: in seconds? give at least 16 samples",
        )


def _bands_resolved(spectra: ConfigPart, identification: ConfigPart) -> Problems:
    for key, (low, high) in _bands(identification).items():
        lines = (high - low) * spectra.segment_s
        if lines < 8:
            yield Problem(
                f"identification.{key}",
                f"holds {lines:.0f} lines of {1 / spectra.segment_s:g} Hz: widen it or lengthen"
                " spectra.segment_s",
            )


def _step_and_force(excitation: ConfigPart, integration: ConfigPart) -> Problems:
    highest = highest_frequency(excitation)
    needed = STEPS_PER_EXCITED_PERIOD * highest
    if integration.steps_per_second < needed:
        yield Problem(
            "integration.steps_per_second",
            f"is fewer than {STEPS_PER_EXCITED_PERIOD} steps per period of the highest excited"
            f" frequency, {highest:g} Hz: give at least {math.ceil(needed)}",
        )


def _step_and_modes(tube: ConfigPart, basis: ConfigPart, integration: ConfigPart) -> Problems:
    omega_step = 2 * math.pi * basis.free_modes_to_Hz / integration.steps_per_second
    largest = LARGEST_OMEGA_STEP[integration.scheme]
    if omega_step > largest:
        yield Problem(
            "integration.steps_per_second",
            f"gives omega x step = {omega_step:.3g} for free modes to"
            f" {basis.free_modes_to_Hz:g} Hz, at most {largest:g}: give at least"
            f" {math.ceil(2 * math.pi * basis.free_modes_to_Hz / largest)} or keep fewer free"
            " modes",
        )


def _step_and_samples(integration: ConfigPart, record: ConfigPart) -> Problems:
    if record.every_step:
        return
    ratio = integration.steps_per_second / record.sampling_frequency_Hz
    stages = ratio / FILTER_RATIO
    if stages < FILTER_STAGES - TOLERANCE or abs(stages - round(stages)) > TOLERANCE:
        nearest = max(FILTER_STAGES, round(stages)) * FILTER_RATIO * record.sampling_frequency_Hz
        yield Problem(
            "integration.steps_per_second",
            f"must be {FILTER_RATIO} times a whole multiple of record.sampling_frequency_Hz ="
            f" {record.sampling_frequency_Hz:g} (the output filter's first stage divides by"
            f" {FILTER_RATIO}, its second by {FILTER_STAGES} or more): {nearest:g} is near",
        )


def _whole_samples(record: ConfigPart, integration: ConfigPart) -> Problems:
    if record.every_step:
        return
    for place, duration in (
        ("record.duration_s", record.duration_s),
        ("integration.start_up_s", integration.start_up_s),
    ):
        samples = duration * record.sampling_frequency_Hz
        if abs(samples - round(samples)) > 1e-6 * max(1.0, samples):
            yield Problem(
                place,
                f"is {samples:.3f} samples of 1/{record.sampling_frequency_Hz:g} s: give a"
                " whole number of samples",
            )
    samples = record.duration_s * record.sampling_frequency_Hz
    if not 0.5 < samples <= MOST_SAMPLES:
        yield Problem(
            "record.duration_s",
            f"is {samples:.3g} samples of every channel, from 1 to {MOST_SAMPLES:g}: in seconds?",
        )


CHECKS = (
    section_checks.wall,
    section_checks.axes_of_the_section,
    section_checks.enclosed_area,
    section_checks.fluids,
    geometry_checks.path_directions,
    geometry_checks.slender,
    geometry_checks.points_on_the_tube,
    geometry_checks.supports_on_the_tube,
    geometry_checks.gaps,
    geometry_checks.offsets_on_a_tube,
    names.sensors_of_a_tube,
    lambda line, turbulence: turbulence_checks.field(line, turbulence, "excitation"),
    turbulence_checks.points_of_spectrum,
    lambda line, flow: turbulence_checks.field(line, flow, "flow"),
    flow_checks.pitch,
    flow_checks.covered,
    _step_and_modes,
    names.point_supports,
    names.same_stop_twice,
    names.places_of_points,
    turbulence_checks.needs_a_tube,
    flow_checks.acts_along_a_tube,
    section_checks.wall_that_wears,
    section_checks.wear_needs_statistics,
    names.chain_names,
    geometry_checks.support_lists,
    geometry_checks.offsets,
    profile_checks.gaps_of_supports,
    profile_checks.preloads,
    profile_checks.normals,
    names.names_twice,
    _repeated_values,
    _number_of_cases,
    names.named_points,
    names.drag_partners,
    names.identified_points,
    names.identification_needs,
    names.grouped_supports_are_there,
    initial_checks.initial_fields,
    _every_step,
    names.sensors,
    names.driven_direction_is_recorded,
    turbulence_checks.band,
    flow_checks.coupling,
    flow_checks.following,
    _force,
    _overlay,
    _bands_pass_the_filter,
    _bands_are_excited,
    _segments,
    _bands_resolved,
    _step_and_force,
    _step_and_samples,
    _whole_samples,
)
