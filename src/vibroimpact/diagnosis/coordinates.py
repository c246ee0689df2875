"""Coordinates of a fit: parameters of effects, their places, and nuisances."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.effects.effect import Parameter
from vibroimpact.effects.places import arc_length_m, between, turned_deg

from .constants import DAMPING_SD, FREQUENCY_SD, GAIN_SD, TURN_SD
from .explanations import Point, Term

NUISANCES = {
    "frequency": FREQUENCY_SD,
    "damping": DAMPING_SD,
    "gain": GAIN_SD,
    "turn": TURN_SD,
}
FARTHEST = 4.0  # sigma of a nuisance
ENDS = (0.02, 0.98)  # of a tube: no effect is sought nearer to its ends
PLACE_SIZE = 0.05  # of its length
DIRECTION_SIZE_DEG = 20.0
STEPS = {
    "log": 0.01,
    "amount": 0.1,
    "signed": 0.05,
    "place": 0.02,
    "direction": 0.1,
    "nuisance": 0.3,
}


@dataclass(frozen=True)
class Coordinate:
    """One number that is fitted, of size one.

    kind: "term", "place", "direction", or a key of NUISANCES. index: of the term, mode or channel.
    parameter: index of the parameter of a term. size: value per unit; log: the coordinate is the
    logarithm of the value over it. low, high: bounds. step: of differences. sd: of a Gaussian
    prior about zero, infinite for none.
    """

    kind: str
    index: int
    size: float
    parameter: int = 0
    log: bool = False
    low: float = -np.inf
    high: float = np.inf
    step: float = 0.1
    sd: float = np.inf

    @property
    def of_effect(self) -> bool:
        """Return whether it belongs to an effect, not to a nuisance."""
        return self.kind not in NUISANCES

    def to_value(self, x: float) -> float:
        """Return the value at a coordinate."""
        return float(self.size * np.exp(x)) if self.log else float(self.size * x)

    def from_value(self, value: float) -> float:
        """Return the coordinate of a value."""
        return float(np.log(value / self.size)) if self.log else float(value / self.size)


def nuisance_coordinates(modes: int, channels: int, turned: bool) -> list[Coordinate]:
    """Return the coordinates of the frequencies and damping of modes, of the gains and, if
    `turned`, of the direction of the force.
    """
    numbers = {"frequency": modes, "damping": modes, "gain": channels, "turn": int(turned)}
    return [
        Coordinate(kind, index, size, low=-FARTHEST, high=FARTHEST, step=STEPS["nuisance"], sd=1.0)
        for kind, size in NUISANCES.items()
        for index in range(numbers[kind])
    ]


def effect_coordinates(terms: Sequence[Term], scales: Mapping[str, float]) -> list[Coordinate]:
    """Return the coordinates of all parameters and places of terms.

    scales: see sizes.sizes_of.
    """
    rows = []
    for number, term in enumerate(terms):
        for index, parameter in enumerate(term.effect.parameters):
            rows.append(_of_parameter(parameter, number, index, scales[parameter.per]))
        rows += _of_place(term, number, scales["tube_length"])
    return rows


def _of_parameter(parameter: Parameter, number: int, index: int, unit: float) -> Coordinate:
    """Return the Coordinate of a parameter whose bounds are multiples of a unit."""
    low, high = parameter.low * unit, parameter.high * unit
    if parameter.log and parameter.neutral == 0.0:  # an amount: nothing at 0
        size = float(np.sqrt(low * high))
        return Coordinate("term", number, size, index, False, 0.0, high / size, STEPS["amount"])
    if parameter.log:
        size = parameter.neutral or float(np.sqrt(low * high))
        first, last = float(np.log(low / size)), float(np.log(high / size))
        return Coordinate("term", number, size, index, True, first, last, STEPS["log"])
    size = 0.2 * max(abs(low), abs(high))
    return Coordinate("term", number, size, index, False, low / size, high / size, STEPS["signed"])


def _of_place(term: Term, number: int, length: float) -> list[Coordinate]:
    """Return the coordinates of the place of a term along a tube and of its direction across it,
    none if the place has a name.
    """
    if arc_length_m(term.location) is None:
        return []
    low, high = (end / PLACE_SIZE for end in ENDS)
    rows = [
        Coordinate("place", number, PLACE_SIZE * length, low=low, high=high, step=STEPS["place"])
    ]
    if turned_deg(term.location) is not None:
        rows.append(Coordinate("direction", number, DIRECTION_SIZE_DEG, step=STEPS["direction"]))
    return rows


def to_vector(point: Point, rows: Sequence[Coordinate]) -> np.ndarray:
    """Return (coordinate,) of a Point."""
    out = []
    for row in rows:
        if row.kind in NUISANCES:
            own = getattr(point, row.kind)
            out.append((own[row.index] if row.index < len(own) else 0.0) / row.size)
            continue
        term = point.terms[row.index]
        places = {"place": arc_length_m, "direction": turned_deg}
        told = places[row.kind](term.location) if row.kind in places else None
        out.append(row.from_value(term.values[row.parameter] if told is None else told))
    return np.array(out, float)


def to_point(x: np.ndarray, rows: Sequence[Coordinate], start: Point) -> Point:
    """Return the Point at coordinates x (coordinate,), with the other values as in `start`."""
    values = [list(term.values) for term in start.terms]
    places: dict[int, dict[str, float]] = {}
    nuisances = {kind: dict(enumerate(getattr(start, kind))) for kind in NUISANCES}
    for coordinate, row in zip(x, rows, strict=True):
        if row.kind in NUISANCES:
            nuisances[row.kind][row.index] = float(row.size * coordinate)
        elif row.kind == "term":
            values[row.index][row.parameter] = row.to_value(coordinate)
        else:
            key = "arc_length_m" if row.kind == "place" else "turned_deg"
            places.setdefault(row.index, {})[key] = row.to_value(coordinate)
    terms = tuple(
        replace(
            term,
            values=tuple(own),
            location=between(**places[number]) if number in places else term.location,
        )
        for number, (term, own) in enumerate(zip(start.terms, values, strict=True))
    )
    filled = {
        kind: tuple(own.get(index, 0.0) for index in range(max(own, default=-1) + 1))
        for kind, own in nuisances.items()
    }
    return Point(terms, **filled)


def bounds(rows: Sequence[Coordinate]) -> tuple[np.ndarray, np.ndarray]:
    """Return (low (coordinate,), high (coordinate,))."""
    return np.array([row.low for row in rows]), np.array([row.high for row in rows])
