"""Starts of an effect at a point: the places on a tube where one missing force explains most.

A force f that the model lacks moves the held structure, and the dampers bear

    u = C (1 + i w S' H S C)^-1 i w S' H p f

with p the mode shapes at its place, S those at the sensors, H the receptances of the modes and C
the dampers. For each place the most likely f at each line is a projection of the holding force,
without a run. Two sensors or fewer leave nothing that could contradict a place.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from vibroimpact.config.problems import ConfigError
from vibroimpact.effects.effect import Effect
from vibroimpact.effects.places import between, length_m

from .bench import Bench, compared_frequencies, holding_lines, misfit, whitening
from .catalogue import ACROSS_DEG, AT_A_KNOWN_PLACE, AT_A_POINT, far_terms
from .comparison import Comparison
from .explanations import Point, Term
from .law import receptances

PLACES, KEPT = 24, 3  # along the tube, and those whose effects are tried
APART = 0.08  # of the length of the tube, between two that are tried
DIRECTIONS_DEG = tuple(range(0, 180, 15))  # from the force, about the tube
FEWEST_SENSORS = 3


def place_terms(
    comparison: Comparison, bench: Bench, point: Point, effects: Iterable[Effect]
) -> list[Term]:
    """Return the trials, far from neutral, of effects at a point of the tube, at the KEPT places
    that the holding force of a Point demands.

    bench: of stretches that are held. Raises ConfigError or ValueError if the Point makes no model.
    """
    out: list[Term] = []
    sizes = comparison.sizes
    for place, turned in demanded_places(comparison, bench, point):
        for effect in effects:
            if effect.id not in AT_A_POINT or effect.id == "added_mass":
                continue  # a mass acts in all directions
            one_sided = effect.id == "one_sided_stop"
            for way in (turned, turned + 180.0) if one_sided else (turned or None,):
                out += far_terms(effect, between(place, way), sizes, AT_A_KNOWN_PLACE)
    return out


def demanded_places(
    comparison: Comparison, bench: Bench, point: Point
) -> list[tuple[float, float]]:
    """Return [(arc length in m, angle from the force in degrees)] of at most KEPT places along a
    tube, the one whose force explains most of the holding force first; none if the structure is no
    tube or has too few sensors.
    """
    structure = comparison.structure
    length = length_m(structure.values)
    if length is None or bench.measures_motion.sum() < FEWEST_SENSORS:
        return []
    bench = replace(bench, stretches=tuple(replace(own, hold=1.0) for own in bench.stretches))
    lines = holding_lines(bench, [point])[0]
    if not np.isfinite(lines).all():
        return []
    held = _held(bench, structure.model(point), structure.measuring(point).gain)
    found = []
    for place in length * (np.arange(PLACES) + 0.5) / PLACES:
        try:
            column = [
                _column(bench, held, structure.model(point.beside(_probe(place, turned))))
                for turned in ((0.0, ACROSS_DEG) if comparison.across else (0.0,))
            ]
        except (ConfigError, ValueError):
            continue  # no law can act there
        for turned in DIRECTIONS_DEG if comparison.across else (0.0,):
            share = np.cos(np.deg2rad(turned)), np.sin(np.deg2rad(turned))
            own = sum(part * each for part, each in zip(share, column, strict=False))
            found.append((misfit(bench, _left(bench, lines, own)), float(place), turned))
    kept: list[tuple[float, float]] = []
    for _, place, turned in sorted(found):
        if all(abs(place - known) > APART * length for known, _ in kept):
            kept.append((place, turned))
        if len(kept) == KEPT:
            break
    return kept


def _probe(place: float, turned: float) -> Term:
    """Return a Term that marks a place and a direction, and does nothing."""
    return Term("cubic_stiffness", between(place, turned or None), (1.0e-6,))


def _held(bench, model, gain):
    """Return (line, sensor, sensor): the holding force per free velocity of the sensors, times the
    gains of their channels.
    """
    frequency = compared_frequencies(bench)
    shapes = model.sensor_shapes * (model.frequencies < bench.held_below_Hz)[:, None]
    strength = np.where(bench.measures_motion, bench.strength, 0.0)
    own = np.einsum(
        "ms,lm,mt->lst", shapes, receptances(model, frequency), shapes, optimize=True
    ) * (2j * np.pi * frequency[:, None, None])
    free = np.linalg.inv(np.eye(len(strength)) + own * strength)
    return (gain * strength)[:, None] * free


def _column(bench, held, model):
    """Return (channel, line): the holding force per force at the last element of a model."""
    frequency = compared_frequencies(bench)
    moved = (receptances(model, frequency) * model.element_shapes[:, -1]) @ model.sensor_shapes
    return np.einsum("lst,lt->sl", held, moved)  # a factor by line, as of velocity, is in the force


def _left(bench, lines, column):
    """Return (stretch, channel, line): lines without the most likely force, given its column."""
    weight = whitening(bench, lines)
    white = weight * column
    size = np.sum(np.abs(white) ** 2, axis=1, keepdims=True)
    force = np.sum(white.conj() * weight * lines, axis=1, keepdims=True)
    return lines - column * force / np.where(size > 0.0, size, 1.0)
