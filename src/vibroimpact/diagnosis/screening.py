"""Screening: every effect of the catalogue at every place, one step from where it does nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vibroimpact.effects import places as on_structure
from vibroimpact.effects.effect import Effect, Values
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.observation.sensor_chain import places as sensor_places

from .coordinates import Coordinate, of_term, point_of, vector
from .explanations import Point, Term
from .fit import TEMPER, Fit, objective, weights_of
from .held import Bench, lines

AT_A_POINT = (
    "added_mass",
    "cubic_stiffness",
    "quadratic_stiffness",
    "saturation_stiffness",
    "coulomb_friction",
    "clearance",
)
PLACES = 8
CHUNK = 64
LEADERS = 12


def EIGHT_WAYS(size):
    """Return eight vectors of a size."""
    return tuple((size * np.cos(a * np.pi / 4), size * np.sin(a * np.pi / 4)) for a in range(8))


# multiples of the scales at which effects without a column where they do nothing are tried
SCANS = {
    "gap": ((0.4,), (0.6,), (0.8,), (1.3,), (1.8,), (3.0,)),
    "contact_stiffness": ((0.1,), (4.0,)),
    "contact_damping": ((1e-3,),),
    "dry_friction": ((0.3,),),
    "support_offset": EIGHT_WAYS(0.6),
    "preload": EIGHT_WAYS(0.8) + EIGHT_WAYS(2.5),
    "hertz": ((0.02,), (0.1,)),
    "plate_flexibility": ((0.05, 0.3), (0.3, 0.3), (2.0, 0.3)),
    "root_stiffness": ((100.0, 3.0), (1e4, 30.0)),
    "saturation_stiffness": ((1.0, 0.3), (4.0, 2.0)),
    "clearance": ((0.1, 10.0), (0.3, 10.0), (0.8, 10.0)),
    "foliate_lands": tuple((a * np.pi / 8,) for a in range(4)),
    "foliate_obstacle": tuple((0.6, a * np.pi / 8) for a in range(4)),
    "foliate_trefoil": tuple((0.6, a * np.pi / 6) for a in range(4)),
    "foliate_hexafoil": tuple((0.6, a * np.pi / 12) for a in range(4)),
}
# those without a column where they do nothing
FAR_ONLY = (
    "hertz",
    "plate_flexibility",
    "root_stiffness",
    "saturation_stiffness",
    "clearance",
    "foliate_lands",
    "foliate_obstacle",
    "foliate_trefoil",
    "foliate_hexafoil",
)
AT_ALL_FIRST = ("foliate_trefoil", "foliate_hexafoil", "hertz")


def locations(values: Values, effect: Effect, names: Sequence[str], modes: int) -> list[str]:
    """Return the places where an effect is screened."""
    if effect.measured:
        return sensor_places(names)
    if "voltage" in effect.needs:
        return []
    if effect.id in AT_A_POINT:
        length = on_structure.length_m(values)
        if length is not None:
            first = values["excitation"].get("point")
            spaced = [on_structure.between(length * (k + 0.5) / PLACES) for k in range(PLACES)]
            return [first, *spaced] if first else spaced
    found = effect.locations(values)
    if effect.id == "mode_frequency_error":
        return found[:modes]
    if effect.id in AT_ALL_FIRST:
        return found[:1]
    return found


@dataclass(frozen=True, eq=False)
class Screened:
    """A Point and how much its objective is better than that of the base."""

    point: Point
    gain: float


def far_terms(effect: Effect, location: str, scales: Mapping[str, float]) -> list[Term]:
    """Return the terms far from where an effect does nothing."""
    names = [parameter.name for parameter in effect.parameters]

    def value(sizes, parameter):
        over = sizes[names.index(parameter.over)] if parameter.over else 1.0
        own = sizes[names.index(parameter.name)]
        return float(own * over * scales[parameter.per])

    return [
        Term(effect.id, location, tuple(value(row, parameter) for parameter in effect.parameters))
        for row in SCANS.get(effect.id, ())
    ]


def neutral_term(effect: Effect, location: str, scales: Mapping[str, float]) -> Term | None:
    """Return the term at which an effect does nothing, None where there is no such."""
    if effect.id in FAR_ONLY:
        return None
    if effect.id == "contact_stiffness":
        return Term(effect.id, location, (scales["contact_stiffness"],))
    return Term(effect.id, location, tuple(float(p.neutral) for p in effect.parameters))


def screen(
    bench: Bench,
    base: Fit,
    effects: Sequence[Effect],
    scales: Mapping[str, float],
    names: Sequence[str],
    modes: int,
) -> list[Screened]:
    """Return Screened of the effects beside the terms of the base, best first."""
    values, number = bench.structure.values, len(base.point.terms)

    def beside(term):
        return Point(
            (*base.point.terms, term), base.point.frequency, base.point.damping, base.point.gain
        )

    scans, columns = [], {}
    wanted = []
    for effect in effects:
        for location in locations(values, effect, names, modes):
            scans += [beside(term) for term in far_terms(effect, location, scales)]
            neutral = neutral_term(effect, location, scales)
            if neutral is not None:
                wanted.append(beside(neutral))
    single = [p for p in wanted if not _sum_of_parts(p.terms[-1], values)]
    moved, owners = [], []
    for point in single:
        rows = of_term(point.terms[-1], number, scales)
        x = vector(point, rows)
        for k, row in enumerate(rows):
            trial = x.copy()
            trial[k] += row.step
            moved.append(point_of(trial, rows, point))
            owners.append((point.terms[-1].name, k, row.step))
    own, weights = base.lines, weights_of(bench, base.lines)
    for first in range(0, len(moved), CHUNK):
        for got, (name, k, step) in zip(
            lines(bench, moved[first : first + CHUNK]), owners[first : first + CHUNK], strict=True
        ):
            columns[name, k] = np.nan_to_num((got - own) * weights / step).ravel()
    predicted = []
    for point in wanted:
        term = point.terms[-1]
        rows = of_term(term, number, scales)
        parts = _parts(term, values)
        A = np.stack(
            [sum(columns[f"{term.effect}@{part}", k] for part in parts) for k in range(len(rows))]
        )
        x, gain = _predicted(bench, A, own, weights, rows, vector(point, rows))
        predicted.append((gain, point_of(x, rows, point)))
    predicted.sort(key=lambda pair: -pair[0])
    trials = scans + [point for _, point in predicted[:LEADERS]]
    before = objective(bench, own, np.zeros(0), [])
    out = []
    for first in range(0, len(trials), CHUNK):
        part = trials[first : first + CHUNK]
        for point, got in zip(part, lines(bench, part), strict=True):
            out.append(Screened(point, before - objective(bench, got, np.zeros(0), [])))
    return sorted(out, key=lambda each: -each.gain)


def _sum_of_parts(term, values):
    """Whether the column of a term is the sum of those at each support."""
    return term.location == "all" and len(_parts(term, values)) > 1


def _parts(term, values):
    """Return the locations whose columns make that of a term."""
    found = (
        EFFECTS[term.effect].locations(values)
        if not EFFECTS[term.effect].measured
        else [term.location]
    )
    if term.location == "all" and len(found) > 1 and term.effect != "modal_damping":
        return found[1:]
    return [term.location]


def _predicted(bench, A, own, weights, rows, start):
    """Return (coordinates, predicted gain) of the best step along weighted columns A."""
    r = (own * weights).ravel()
    H = (A.conj() @ A.T).real.astype(float)
    g = (A.conj() @ r).real.astype(float)
    step = -np.linalg.lstsq(
        H + 1e-6 * np.trace(H) / len(H) * np.eye(len(H)) + 1e-12 * np.eye(len(H)), g, rcond=None
    )[0]
    step = step / max(1.0, np.abs(step).max() / 1.5)
    low, high = np.array([row.low for row in rows]), np.array([row.high for row in rows])
    x = np.clip(start + step, low, high)
    left = own + ((x - start) @ A).reshape(own.shape) / np.where(weights > 0.0, weights, np.inf)
    gain = objective(bench, own, np.zeros(0), []) - objective(bench, left, np.zeros(0), [])
    return x, gain
