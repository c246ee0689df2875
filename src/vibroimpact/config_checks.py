"""The checks between keys of a configuration: geometry, sampling, names, bands.

A check is a generator whose argument names are the top-level sections it reads; it yields a problem as (place, value, text). It runs
when those sections are valid by themselves, so that one mistake elsewhere does not hide the others.
"""

from __future__ import annotations

import inspect
import math
from collections import Counter
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from vibroimpact.centreline import LOCATION_TOLERANCE_M, build_centreline

STEPS_PER_EXCITED_PERIOD = 20
LARGEST_OMEGA_STEP = 1.0
TOLERANCE = 1e-9


def cross_problems(sections):
    """Return a list of (place, value, text), one per problem between the given {name: section} that are valid by themselves."""
    problems = []
    for check in CHECKS:
        names = list(inspect.signature(check).parameters)
        if all(name in sections for name in names):
            problems += check(*(sections[name] for name in names))
    return problems


def _wall(structure):
    section = structure.section
    if section.wall_thickness_m >= section.outer_diameter_m / 2:
        yield ("structure.section.wall_thickness_m", section.wall_thickness_m,
               f"must be below half the outer diameter {section.outer_diameter_m}: both in metres?")


def _path_directions(structure):
    if structure.kind != "path":
        return
    if not np.any(structure.start_direction):
        yield "structure.start_direction", list(structure.start_direction), "is not a direction: give three components that are not all 0"
        return
    tangent = np.array(structure.start_direction) / np.linalg.norm(structure.start_direction)
    for index, segment in enumerate(structure.segments):
        if segment.kind != "bend":
            continue
        toward = np.array(segment.toward) - (np.array(segment.toward) @ tangent) * tangent
        if np.linalg.norm(toward) < 1e-6 * (1 + np.linalg.norm(segment.toward)):
            yield (f"structure.segments[{index}].toward", list(segment.toward),
                   f"is parallel to the tube there: give a direction across the tangent {np.round(tangent, 4).tolist()}")
            return
        angle = math.radians(segment.angle_deg)
        tangent = math.cos(angle) * tangent + math.sin(angle) * toward / np.linalg.norm(toward)


def _centreline(structure):
    """The centreline, or None where its directions are a problem already reported."""
    return None if any(_path_directions(structure)) else build_centreline(structure)


def _off_the_tube(centreline, place, position):
    """Yield a problem when `position` (3,) m is farther from the centreline than the tolerance."""
    arc_length = min((segment.nearest(np.array(position)) for segment in centreline.segments),
                     key=lambda s: np.linalg.norm(centreline.position(s) - position))
    nearest = centreline.position(arc_length)
    distance = float(np.linalg.norm(nearest - position))
    if distance > LOCATION_TOLERANCE_M:
        yield (place, list(position), f"is {distance:.4f} m off the tube (at most {LOCATION_TOLERANCE_M} m): "
               f"the nearest point of the centreline is {np.round(nearest, 4).tolist()} m")


def _points_on_the_tube(structure, points):
    centreline = _centreline(structure)
    for name, position in points.items() if centreline else ():
        yield from _off_the_tube(centreline, f"points.{name}", position)


def _supports_on_the_tube(structure, supports):
    centreline = _centreline(structure)
    taken = []
    for index, support in enumerate(supports if centreline else ()):
        off = list(_off_the_tube(centreline, f"supports[{index}].at_m", support.at_m))
        yield from off
        if off:
            continue
        middle = centreline.locate(support.at_m, support.name)
        segment = centreline.segment_at(middle)
        low, high = middle - support.height_m / 2, middle + support.height_m / 2
        if low < segment.begin - TOLERANCE or high > segment.end + TOLERANCE:
            room = 2 * min(middle - segment.begin, segment.end - middle)
            yield (f"supports[{index}].height_m", support.height_m,
                   f"reaches beyond the segment of the tube that '{support.name}' is on: at most {room:.4g} m there (in metres?)")
        for other, other_low, other_high in taken:
            if low < other_high - TOLERANCE and other_low < high - TOLERANCE:
                yield f"supports[{index}].at_m", list(support.at_m), f"'{support.name}' overlaps '{other}': move one or lower its height_m"
        taken.append((support.name, low, high))


def _support_lists(supports):
    for index, support in enumerate(supports):
        lists = {"stiffness_N_per_m": support.stiffness_N_per_m, "gap_factor": support.gap_factor}
        lists["centre_offset_m"] = support.centre_offset_m if isinstance(support.centre_offset_m[0], tuple) else 0.0
        for key, value in lists.items():
            if isinstance(value, tuple) and len(value) != support.points:
                yield (f"supports[{index}].{key}", list(value),
                       f"has {len(value)} values for {support.points} contact points: give one value, or one per point")


def _names_twice(supports):
    for name, times in Counter(support.name for support in supports).items():
        if times > 1:
            yield "supports", name, f"names {times} supports: give each a name of its own"


def _gaps(structure, grid):
    radius = structure.section.outer_diameter_m / 2
    for index, gap in enumerate(grid.gap_m):
        if gap > radius:
            yield f"grid.gap_m[{index}]", gap, f"is larger than half the diameter, {radius:g} m: give the radial clearance in metres"


def _offsets(structure, supports):
    radius = structure.section.outer_diameter_m / 2
    for index, support in enumerate(supports):
        largest = float(np.max(np.linalg.norm(np.atleast_2d(support.centre_offset_m), axis=1)))
        if largest > radius:
            yield (f"supports[{index}].centre_offset_m", largest, f"is larger than half the diameter, {radius:g} m: in metres?")


def _repeated_values(grid):
    values = {"gap_m": grid.gap_m, "load_rms_N": grid.load_rms_N if isinstance(grid.load_rms_N, tuple) else ()}
    for key, row in values.items():
        for value, times in Counter(row).items():
            if times > 1:
                yield f"grid.{key}", value, f"stands {times} times: a value names a case, give each once"
    loads = grid.load_rms_N
    if not isinstance(loads, tuple) and loads.last <= loads.first and loads.count > 1:
        yield "grid.load_rms_N.last", loads.last, f"must be above first = {loads.first}, or the count 1"


def _known_points(points, excitation, record, identification):
    named = [("excitation.point", excitation.point), ("identification.response_point", identification.response_point),
             ("identification.broadband.point", identification.broadband.point)]
    named += [(f"record.sensors.points[{i}]", name) for i, name in enumerate(record.sensors.points)]
    named += [(f"identification.lscf.references[{i}]", name) for i, name in enumerate(identification.lscf.references)]
    for place, name in named:
        if name not in points:
            close = get_close_matches(name, points, n=1)
            remedy = f"did you mean '{close[0]}'?" if close else f"known are {', '.join(points)}"
            yield place, name, f"is not one of the named points: {remedy}"
        elif place.startswith("identification") and name not in record.sensors.points:
            yield place, name, "is not recorded: add it to record.sensors.points"


def _sensors(record):
    for key, row in (("points", record.sensors.points), ("directions", record.sensors.directions)):
        for name, times in Counter(row).items():
            if times > 1:
                yield f"record.sensors.{key}", name, f"stands {times} times: give each once"
    if record.shape_line.direction not in record.sensors.directions:
        yield ("record.shape_line.direction", record.shape_line.direction,
               f"is not a direction of the sensors: add it to record.sensors.directions {list(record.sensors.directions)}")


def _driven_direction_is_recorded(excitation, record):
    driven = "xyz"[int(np.argmax(np.abs(excitation.direction)))]
    if driven not in record.sensors.directions:
        yield ("record.sensors.directions", list(record.sensors.directions),
               f"lacks '{driven}', the direction of the force, which the identifications need: add it")


def _force(excitation):
    if not np.any(excitation.direction):
        yield "excitation.direction", list(excitation.direction), "is not a direction: give three components that are not all 0"
    if excitation.kind == "measured" and not Path(excitation.file).is_file():
        yield "excitation.file", excitation.file, "is not a file: give its path from the folder where the study is run"


def _overlay(overlay, grid):
    if overlay.campaign is not None and not Path(overlay.campaign).is_file():
        yield "overlay.campaign", overlay.campaign, "is not a file: give its path from the folder where the study is run, or null"
    if overlay.seed < grid.seeds:
        yield "overlay.seed", overlay.seed, f"is a seed of the study, which has 0 to {grid.seeds - 1}: give a larger one"


def _bands_in_order(excitation, identification):
    bands = {"identification.peak_search_Hz": identification.peak_search_Hz, "identification.lscf.band_Hz": identification.lscf.band_Hz,
             "identification.broadband.band_Hz": identification.broadband.band_Hz,
             "identification.stiffness_range_N_per_m": identification.stiffness_range_N_per_m}
    if excitation.kind == "band_limited":
        bands["excitation.band_Hz"] = excitation.band_Hz
    for place, (low, high) in bands.items():
        if low >= high:
            yield place, [low, high], "is not in ascending order: give the lower end first"


def _bands_below_nyquist(record, identification):
    nyquist = record.sampling_frequency_Hz / 2
    bands = {"peak_search_Hz": identification.peak_search_Hz, "lscf.band_Hz": identification.lscf.band_Hz,
             "broadband.band_Hz": identification.broadband.band_Hz}
    for key, (low, high) in bands.items():
        if high > nyquist:
            yield f"identification.{key}", [low, high], f"reaches above half the sampling frequency, {nyquist:g} Hz: lower it"


def _broadband_is_excited(excitation, identification):
    if excitation.kind != "band_limited":
        return
    low, high = excitation.band_Hz
    asked = identification.broadband.band_Hz
    if asked[0] < low - TOLERANCE or asked[1] > high + TOLERANCE:
        yield ("identification.broadband.band_Hz", list(asked),
               f"reaches beyond the excited band {[low, high]} Hz, where spectra of a tube and of its linear equivalent are not comparable")


def _main_peak_is_excited(excitation, identification):
    if excitation.kind != "band_limited":
        return
    low, high = excitation.band_Hz
    for key, asked in (("peak_search_Hz", identification.peak_search_Hz), ("lscf.band_Hz", identification.lscf.band_Hz)):
        if asked[1] <= low or asked[0] >= high:
            yield f"identification.{key}", list(asked), f"lies outside the excited band {[low, high]} Hz: nothing is seen there"


def _segments(record, spectra):
    if spectra.segment_s > record.duration_s:
        yield ("spectra.segment_s", spectra.segment_s,
               f"is longer than the record, {record.duration_s:g} s: shorten the segment or lengthen record.duration_s")
    samples = spectra.segment_s * record.sampling_frequency_Hz
    if samples < 16:
        yield "spectra.segment_s", spectra.segment_s, f"holds only {samples:g} samples: in seconds? give at least 16 samples"


def _bands_resolved(spectra, identification):
    bands = {"peak_search_Hz": identification.peak_search_Hz, "lscf.band_Hz": identification.lscf.band_Hz,
             "broadband.band_Hz": identification.broadband.band_Hz}
    for key, (low, high) in bands.items():
        lines = (high - low) * spectra.segment_s
        if 0 < lines < 8:
            yield (f"identification.{key}", [low, high],
                   f"holds {lines:.0f} lines of {1 / spectra.segment_s:g} Hz: widen it or lengthen spectra.segment_s")


def _step_and_force(excitation, integration):
    highest = excitation.band_Hz[1] if excitation.kind == "band_limited" else (excitation.sampling_frequency_Hz or 0) / 2
    needed = STEPS_PER_EXCITED_PERIOD * highest
    if integration.steps_per_second < needed:
        yield ("integration.steps_per_second", integration.steps_per_second,
               f"is fewer than {STEPS_PER_EXCITED_PERIOD} steps per period of the highest excited frequency, {highest:g} Hz: "
               f"give at least {math.ceil(needed)}")


def _step_and_modes(basis, integration):
    omega_step = 2 * math.pi * basis.free_modes_to_Hz / integration.steps_per_second
    if omega_step > LARGEST_OMEGA_STEP:
        yield ("integration.steps_per_second", integration.steps_per_second,
               f"gives omega x step = {omega_step:.3g} for free modes to {basis.free_modes_to_Hz:g} Hz, at most {LARGEST_OMEGA_STEP:g}: give at least "
               f"{math.ceil(2 * math.pi * basis.free_modes_to_Hz / LARGEST_OMEGA_STEP)} or keep fewer free modes")


def _step_and_samples(integration, record):
    ratio = integration.steps_per_second / record.sampling_frequency_Hz
    if ratio < 1 or abs(ratio - round(ratio)) > TOLERANCE:
        nearest = max(1, round(ratio)) * record.sampling_frequency_Hz
        yield ("integration.steps_per_second", integration.steps_per_second,
               f"must be a whole multiple of record.sampling_frequency_Hz = {record.sampling_frequency_Hz:g}: {nearest:g} is near")


def _whole_samples(record, integration):
    for place, duration in (("record.duration_s", record.duration_s), ("integration.start_up_s", integration.start_up_s)):
        samples = duration * record.sampling_frequency_Hz
        if abs(samples - round(samples)) > 1e-6 * max(1.0, samples):
            yield place, duration, f"is {samples:.3f} samples of 1/{record.sampling_frequency_Hz:g} s: give a whole number of samples"


CHECKS = (_wall, _path_directions, _points_on_the_tube, _supports_on_the_tube, _support_lists, _names_twice, _gaps, _offsets,
          _repeated_values, _known_points, _sensors, _driven_direction_is_recorded, _force, _overlay, _bands_in_order, _bands_below_nyquist,
          _broadband_is_excited, _main_peak_is_excited, _segments, _bands_resolved, _step_and_force, _step_and_modes,
          _step_and_samples, _whole_samples)
