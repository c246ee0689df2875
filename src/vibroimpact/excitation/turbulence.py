"""Turbulence on a tube: its stretches, the independent forces that replace it, its level.

The force per length in one direction has the cross-spectrum S(f) exp(-|s - s'| / correlation
length) between two arc lengths (Axisa, Antunes and Villard 1990; code_aster U4.44.31, section 3.1).
The correlation does not depend on frequency. All integrals of the field therefore share one
spectrum, and the covariance of the forces on the modes (with the joint acceptances of Powell 1958
on its diagonal) is reproduced by independent signals of that spectrum, each with its own shape.
"""

from collections.abc import Callable, Iterator

import numpy as np

from vibroimpact.config.stage_settings import ConfigPart
from vibroimpact.geometry.centreline import SAME_PLACE_M, Centreline, build_centreline
from vibroimpact.geometry.directions import unit_vector
from vibroimpact.geometry.sections import outer_width
from vibroimpact.structure.point_structure import PointStructure
from vibroimpact.structure.tube import TubeStructure

from .correlated_field import POINTS, field_covariance, independent_parts
from .line_force_spectrum import line_force_rms

LEAST_VARIANCE = 1e-4  # of the most driven mode; below it a mode's force is not resolved relatively


def drive_shapes(
    structure: TubeStructure | PointStructure,
    shapes: np.ndarray,
    omega: np.ndarray,
    force: ConfigPart,
) -> np.ndarray:
    """Return (mode, force_channel): shapes of independent forces, per newton of the load.

    The first channel of a direction is the force in that direction summed along the tube; further
    channels hold the rest, as many as force.tolerance asks.

    shapes: (dof, mode) in kg^-1/2.
    omega: (mode,) rad/s, ascending.
    force: section of the configuration, of kind turbulence.

    Raises ValueError when the structure is not a tube, or a stretch is off it.
    """
    if not isinstance(structure, TubeStructure):
        raise ValueError("excitation.kind: turbulence needs a tube (structure.kind u_tube or path)")
    pieces, channels = [], []
    acting = stretches(structure.centreline, force)
    for begin, end, factor in cut_at_nodes(acting, structure.node_arc_length):
        places = begin + (end - begin) * POINTS
        rows = [shapes_at(structure, place, shapes) for place in places]
        pieces.append((begin, end, factor, places, rows))
    for across in directions(structure.centreline, force):
        values = []
        for begin, end, factor, places, rows in pieces:
            along = [across(place) @ row for place, row in zip(places, rows, strict=True)]
            # (point, 1 + mode): the sum along the tube, then the force on each mode
            columns = np.column_stack([np.ones(len(places)), np.array(along)])
            values.append((begin, end, factor * columns))
        covariance = field_covariance(values, force.correlation_length_m)
        covariance /= covariance[0, 0]
        allowed = force.tolerance * _reference(np.diag(covariance)[1:], omega, force.band_Hz[1])
        channels.append(independent_parts(covariance, np.concatenate([[0.0], allowed]))[1:])
    return np.hstack(channels)


def load_of_spectrum(structure: ConfigPart, force: ConfigPart) -> float:
    """Return the load in N that the spectrum of a turbulent force stands for.

    It is the RMS of the force in one direction, summed along the tube.

    structure, force: sections of the configuration.
    """
    pieces = [
        (begin, end, np.full((len(POINTS), 1), factor))
        for begin, end, factor in stretches(build_centreline(structure), force)
    ]
    ((variance,),) = field_covariance(pieces, force.correlation_length_m)
    return float(np.sqrt(variance) * line_force_rms(force, outer_width(structure.section)))


def stretches(line: Centreline, force: ConfigPart) -> list[tuple[float, float, float]]:
    """Return [(begin in m, end in m, factor)] of the arc lengths that the flow acts on, ascending.

    Raises ValueError when a stretch is off the tube.
    """
    if not force.stretches:
        return [(0.0, line.length, 1.0)]
    return sorted(
        (*line.stretch(own.from_m, own.to_m, "excitation.stretches"), own.factor)
        for own in force.stretches
    )


def directions(line: Centreline, force: ConfigPart) -> list[Callable[[float], np.ndarray]]:
    """Return the functions of an arc length in m that give the unit vectors (3,) of the force."""

    def first(place: float) -> np.ndarray:
        tangent, given = line.direction(place), np.asarray(force.direction, dtype=float)
        return unit_vector(given - (given @ tangent) * tangent)

    def second(place: float) -> np.ndarray:
        return unit_vector(np.cross(line.direction(place), first(place)))

    return [first, second] if force.both_directions else [first]


def cut_at_nodes(
    found: list[tuple[float, float, float]], nodes: np.ndarray
) -> Iterator[tuple[float, float, float]]:
    """Yield stretches (begin, end in m, value) cut at the nodes (node,) in m."""
    for begin, end, factor in found:
        inner = nodes[(nodes > begin + SAME_PLACE_M) & (nodes < end - SAME_PLACE_M)]
        ends = [begin, *inner, end]
        for first, last in zip(ends[:-1], ends[1:], strict=True):
            yield float(first), float(last), factor


def shapes_at(structure: TubeStructure, place: float, shapes: np.ndarray) -> np.ndarray:
    """Return (3, mode) the shapes at an arc length in m; the structure does not keep its rows."""
    known = place in structure.rows
    rows = structure.displacement_rows(place)
    if not known:
        del structure.rows[place]
    return rows @ shapes


def _reference(variance: np.ndarray, omega: np.ndarray, highest_Hz: float) -> np.ndarray:
    """Return (mode,) the variance that the tolerance is a share of.

    It is the mode's own variance, but no less than LEAST_VARIANCE of the largest one. Above the
    band it grows by the square of the ratio of static compliances.

    variance: (mode,) of the force on each mode.
    """
    ratio = 2.0 * np.pi * highest_Hz / np.maximum(omega, 1e-300)
    least = LEAST_VARIANCE * variance.max(initial=0.0)
    return np.maximum(variance, least) / np.minimum(ratio, 1.0) ** 4
