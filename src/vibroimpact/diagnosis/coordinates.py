"""Coordinates of what is fitted: parameters of effects and nuisances, of size one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vibroimpact.effects.places import arc_length_m, between
from vibroimpact.effects.registry import EFFECTS

from .explanations import Point, Term

FREQUENCY_SD, DAMPING_SD, GAIN_SD = 0.003, 0.15, 0.02
PLACE_SIZE = 0.05  # of the tube's length


@dataclass(frozen=True)
class Coordinate:
    """One number that is fitted.

    kind: "frequency", "damping", "gain" or "term". index: of the mode, channel or term.
    parameter: index of the term's parameter. size: value per unit; log: whether it is the logarithm
    of the value over `size`. low, high: bounds. step: of differences. sd: of the prior about zero.
    """

    kind: str
    index: int
    parameter: int = 0
    size: float = 1.0
    log: bool = False
    low: float = -np.inf
    high: float = np.inf
    step: float = 0.05
    sd: float = 1.0

    def to_value(self, x: float) -> float:
        """Return the value of a coordinate."""
        return float(self.size * np.exp(x)) if self.log else float(self.size * x)

    def from_value(self, value: float) -> float:
        """Return the coordinate of a value."""
        return float(np.log(value / self.size)) if self.log else float(value / self.size)


def nuisances(modes: int, channels: Sequence[int], step: float = 0.3) -> list[Coordinate]:
    """Return the coordinates of the nuisances, in standard deviations of their priors."""
    rows = [
        ("frequency", range(modes), FREQUENCY_SD),
        ("damping", range(modes), DAMPING_SD),
        ("gain", channels, GAIN_SD),
    ]
    return [
        Coordinate(kind, int(index), size=size, low=-4.0, high=4.0, step=step)
        for kind, indices, size in rows
        for index in indices
    ]


def place_of(term: Term, number: int, scales: Mapping[str, float]) -> list[Coordinate]:
    """Return the coordinate of the place of a term along a tube, none where it has a name."""
    if arc_length_m(term.location) is None:
        return []
    length = scales["tube_length"]
    size = PLACE_SIZE * length
    return [
        Coordinate("place", number, 0, size, False, 0.02 / PLACE_SIZE, 0.98 / PLACE_SIZE, 0.1, 1e3)
    ]


def of_term(term: Term, number: int, scales: Mapping[str, float]) -> list[Coordinate]:
    """Return the coordinates of the parameters of the number-th term."""
    out = []
    for index, parameter in enumerate(EFFECTS[term.effect].parameters):
        unit = scales[parameter.per]
        low, high = parameter.low * unit, parameter.high * unit
        if parameter.over:
            pass
        if parameter.neutral == 0.0 and parameter.log:
            size = float(np.sqrt(low * high))
            row = Coordinate("term", number, index, size, False, 0.0, high / size, 0.1, 10.0)
        elif parameter.log:
            size = parameter.neutral or float(np.sqrt(low * high))
            row = Coordinate(
                "term",
                number,
                index,
                size,
                True,
                np.log(low / size),
                np.log(high / size),
                0.03,
                3.0,
            )
        else:
            size = 0.2 * max(abs(low), abs(high))
            row = Coordinate(
                "term", number, index, size, False, low / size, high / size, 0.05, 10.0
            )
        out.append(row)
    return out


def vector(point: Point, rows: Sequence[Coordinate]) -> np.ndarray:
    """Return (coordinate,) of a Point."""
    out = []
    for row in rows:
        if row.kind == "place":
            out.append(row.from_value(arc_length_m(point.terms[row.index].location)))
        elif row.kind == "term":
            out.append(row.from_value(point.terms[row.index].values[row.parameter]))
        else:
            own = getattr(point, row.kind)
            out.append((own[row.index] if row.index < len(own) else 0.0) / row.size)
    return np.array(out)


def point_of(x: np.ndarray, rows: Sequence[Coordinate], start: Point) -> Point:
    """Return the Point of coordinates x; what rows do not hold is as in `start`."""
    terms = [list(term.values) for term in start.terms]
    lists = {kind: list(getattr(start, kind)) for kind in ("frequency", "damping", "gain")}
    moved = {}
    for value, row in zip(x, rows, strict=True):
        if row.kind == "place":
            moved[row.index] = between(row.to_value(value))
        elif row.kind == "term":
            terms[row.index][row.parameter] = row.to_value(value)
        else:
            own = lists[row.kind]
            own.extend([0.0] * (row.index + 1 - len(own)))
            own[row.index] = row.size * value
    return Point(
        tuple(
            replace(term, values=tuple(values), location=moved.get(number, term.location))
            for number, (term, values) in enumerate(zip(start.terms, terms, strict=True))
        ),
        **{kind: tuple(map(float, own)) for kind, own in lists.items()},
    )
