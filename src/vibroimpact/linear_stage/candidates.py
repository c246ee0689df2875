"""Candidates for the missing effect: an effect of the catalogue at a location, or two at once, with
normalised parameters; which of them the linear stage fits, and which only simulation can judge.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeAlias, TypeVar

import numpy as np

from vibroimpact.effects import lateral_stinger
from vibroimpact.effects import places as on_structure
from vibroimpact.effects.effect import Effect, Parameter, Values
from vibroimpact.effects.places import ALONG, TURNED
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.observation.sensor_chain import Measuring, measuring_of, places

from . import priors

ALONE = "@alone"
AT_A_POINT = frozenset(
    {
        "added_mass",
        "cubic_stiffness",
        "quadratic_stiffness",
        "saturation_stiffness",
        "coulomb_friction",
        "clearance",
    }
)
# Those of them that act in one direction.
DIRECTED = AT_A_POINT - {"added_mass"}
# On a tube the place of such an effect is one of its parameters, counted from the scale
# SEARCHED_FROM.
PLACE = Parameter(
    "place",
    "m",
    0.0,
    1.0,
    None,
    per="searched_length",
    log=False,
    meaning="distance along the tube from its start",
)
SEARCHED_FROM = "searched_from"
DIRECTION = Parameter(
    "direction",
    "deg",
    -90.0,
    90.0,
    None,
    log=False,
    meaning="angle about the tube's axis from the direction that the force has there",
)
# points at which an effect that acts at a point is screened; the one found is tried at the others
PLACES = 8

# Parameters in SI: {name: value} of a Candidate, a list of two such of a Pair. What takes either
# class passes them on unread.
Physical: TypeAlias = Any


@dataclass(frozen=True)
class Candidate:
    """An effect at a location; its name is effect@location, and effect@location@alone where it
    replaces the linear effect that was adopted. At places.ALONG its place is the last of its
    parameters; at places.TURNED its direction across the tube is the one before.
    """

    effect_id: str
    location: str
    alone: bool = False

    @property
    def name(self) -> str:
        """Return effect@location, or effect@location@alone."""
        return f"{self.effect_id}@{self.location}" + ALONE * self.alone

    @property
    def effect(self) -> Effect:
        """Return the Effect."""
        return _along(self.effect_id, self.turned) if self.along else EFFECTS[self.effect_id]

    @property
    def along(self) -> bool:
        """Return whether the place on a tube is a parameter."""
        return self.location in (ALONG, TURNED)

    @property
    def turned(self) -> bool:
        """Return whether the direction across a tube is a parameter too."""
        return self.location == TURNED

    @property
    def ids(self) -> list[str]:
        """Return [id] as it is reported."""
        return [self.effect.reported]

    def physical(self, unit: np.ndarray, scales: dict[str, float]) -> dict[str, float]:
        """Return {name: value in SI} of normalised parameters unit (parameter,) from 0 to 1."""
        out = {}
        for value, parameter in zip(unit, self.effect.parameters, strict=True):
            low, high = parameter.low, parameter.high
            scaled = low * (high / low) ** value if parameter.log else low + (high - low) * value
            out[parameter.name] = float(scaled * scales[parameter.per])
        sizes = {
            parameter.name: out[parameter.name] / scales[parameter.per]
            for parameter in self.effect.parameters
        }
        out = {
            parameter.name: out[parameter.name] * (sizes[parameter.over] if parameter.over else 1.0)
            for parameter in self.effect.parameters
        }
        if self.along:
            out[PLACE.name] += scales[SEARCHED_FROM]
        return out

    def located(self, unit: np.ndarray, scales: dict[str, float]) -> str:
        """Return the location with normalised parameters unit (parameter,)."""
        if not self.along:
            return self.location
        return _place(self.physical(unit, scales))

    def estimate(
        self, unit: np.ndarray, interval: np.ndarray, scales: dict[str, float]
    ) -> dict[str, tuple[float, ...]]:
        """Return {name: (value, low, high)} in SI of normalised parameters unit (parameter,) and
        their intervals (parameter, 2).

        The features do not scatter with a gain common to force and responses. Its uncertainty
        (priors.GAIN_SD) is therefore added here, in quadrature.
        """
        value, *ends = (
            self.physical(row, scales) for row in (unit, interval[:, 0], interval[:, 1])
        )
        out = {}
        for parameter in self.effect.parameters:
            best, row = value[parameter.name], [end[parameter.name] for end in ends]
            hidden = priors.NINETY_SD * priors.GAIN_SD * abs(parameter.gain_power * best)
            out[parameter.name] = (
                best,
                best - np.hypot(best - min(best, *row), hidden),
                best + np.hypot(max(best, *row) - best, hidden),
            )
        return {name: tuple(map(float, row)) for name, row in out.items()}

    def normalised(self, physical: dict[str, float], scales: dict[str, float]) -> np.ndarray:
        """Return (parameter,) from 0 to 1 of {name: value in SI}."""
        out = []
        for parameter in self.effect.parameters:
            value = physical[parameter.name]
            if self.along and parameter is self.effect.parameters[-1]:
                value -= scales[SEARCHED_FROM]
            value = value / scales[parameter.per]
            low = parameter.low
            high = parameter.high
            if parameter.over:
                value = (
                    value
                    / physical[parameter.over]
                    * scales[
                        next(
                            other.per
                            for other in self.effect.parameters
                            if other.name == parameter.over
                        )
                    ]
                )
            out.append(
                np.log(value / low) / np.log(high / low)
                if parameter.log
                else (value - low) / (high - low)
            )
        return np.array(out)

    def neutral_unit(self, scales: dict[str, float]) -> np.ndarray:
        """Return (parameter,) normalised at which the effect vanishes, NaN in parameters whose
        range does not contain such a value.
        """
        # a range that is searched in its logarithm does not contain 0
        with np.errstate(divide="ignore", invalid="ignore"):
            unit = self.normalised(
                {
                    parameter.name: np.nan if parameter.neutral is None else parameter.neutral
                    for parameter in self.effect.parameters
                },
                scales,
            )
            return np.where((unit >= 0.0) & (unit <= 1.0), unit, np.nan)

    @property
    def signed(self) -> tuple[int, ...]:
        """Return the numbers of the parameters that are as strong with the other sign."""
        return tuple(
            number
            for number, parameter in enumerate(self.effect.parameters)
            if parameter.neutral == 0.0 and parameter.low == -parameter.high
        )

    @property
    def periodic(self) -> tuple[int, ...]:
        """Return the numbers of the parameters that are angles over a whole period."""
        return tuple(
            number
            for number, parameter in enumerate(self.effect.parameters)
            if parameter is DIRECTION
            or (parameter.name == "angle" and self.ids == ["foliate_obstacle"])
        )

    def parts(self, unit: np.ndarray) -> list[tuple[Candidate, np.ndarray]]:
        """Return [(candidate, its parameters)] of unit (parameter,): one entry, a Pair has two."""
        return [(self, np.asarray(unit))]

    def renumbered(self, index_of: Callable[[int], int]) -> Candidate:
        """Return the candidate for a model that numbers its modes otherwise; index_of(index of a
        mode, from 0) gives the index there.
        """
        if self.effect_id != "mode_frequency_error":
            return self
        return replace(self, location=f"mode_{index_of(self.mode) + 1}")

    @property
    def mode(self) -> int:
        """Return the index, from 0, of the mode in a location mode_<number>."""
        return int(self.location.removeprefix("mode_")) - 1

    def variant(self, values: Values, parameters: dict[str, float]) -> Values:
        """Return the configuration in plain values with the effect; unchanged for a fault of the
        measuring chain.
        """
        if self.effect.measured:
            return values
        assert self.effect.apply is not None, "an effect of the model changes its configuration"
        location = _place(parameters) if self.along else self.location
        return self.effect.apply(on_structure.with_place(values, location), parameters, location)

    def measuring(self, parameters: dict[str, float], names: Sequence[str]) -> Measuring | None:
        """Return the Measuring of a fault of the measuring chain, None for an effect of the
        model. names: of the channels.
        """
        return (
            measuring_of(self.effect_id, parameters, self.location, names)
            if self.effect.measured
            else None
        )


@cache
def _along(effect_id, turned):
    """Return the Effect with its place among its parameters, and its direction where turned."""
    effect = EFFECTS[effect_id]
    return replace(effect, parameters=(*effect.parameters, *[DIRECTION] * turned, PLACE))


def _place(physical):
    """Return the location on a tube that {name: value} tells."""
    return on_structure.between(physical[PLACE.name], physical.get(DIRECTION.name))


@dataclass(frozen=True)
class PairEffect:
    """The parameters of two effects together; measured: one of them is a fault of the measuring
    chain.
    """

    parameters: tuple[Parameter, ...]
    measured: bool = False


@dataclass(frozen=True)
class Pair:
    """Two candidates at once, the parameters of the first before those of the second; its name
    joins theirs with a plus.
    """

    first: Candidate
    second: Candidate

    @property
    def name(self) -> str:
        """Return effect@location+effect@location."""
        return f"{self.first.name}+{self.second.name}"

    @property
    def alone(self) -> bool:
        """Return whether the pair replaces what was adopted."""
        return self.first.alone

    @property
    def effect_id(self) -> str:
        """Return both ids."""
        return f"{self.first.effect_id}+{self.second.effect_id}"

    @property
    def ids(self) -> list[str]:
        """Return both ids as they are reported."""
        return self.first.ids + self.second.ids

    @property
    def effect(self) -> PairEffect:
        """Return both effects as one."""
        both = self.first.effect, self.second.effect
        return PairEffect(
            both[0].parameters + both[1].parameters,
            measured=any(effect.measured for effect in both),
        )

    @property
    def split(self) -> int:
        """Return the number of the first one's parameters."""
        return len(self.first.effect.parameters)

    @property
    def signed(self) -> tuple[int, ...]:
        """Return the numbers of the parameters that are as strong with the other sign."""
        return self.first.signed + tuple(number + self.split for number in self.second.signed)

    @property
    def periodic(self) -> tuple[int, ...]:
        """Return the numbers of the parameters that are angles over a whole period."""
        return self.first.periodic + tuple(number + self.split for number in self.second.periodic)

    def neutral_unit(self, scales: dict[str, float]) -> np.ndarray:
        """Return (parameter,) normalised at which both effects vanish."""
        return np.concatenate([self.first.neutral_unit(scales), self.second.neutral_unit(scales)])

    def parts(self, unit: np.ndarray) -> list[tuple[Candidate, np.ndarray]]:
        """Return [(candidate, its parameters)] of unit (parameter,)."""
        return [(self.first, unit[: self.split]), (self.second, unit[self.split :])]

    def physical(self, unit: np.ndarray, scales: dict[str, float]) -> list[dict[str, float]]:
        """Return [{name: value in SI}] of both."""
        return [candidate.physical(part, scales) for candidate, part in self.parts(unit)]

    def renumbered(self, index_of: Callable[[int], int]) -> Pair:
        """Return the pair for a model that numbers its modes otherwise."""
        return Pair(self.first.renumbered(index_of), self.second.renumbered(index_of))

    def variant(self, values: Values, parameters: Sequence[dict[str, float]]) -> Values:
        """Return the configuration in plain values with both effects."""
        return self.second.variant(self.first.variant(values, parameters[0]), parameters[1])

    def measuring(
        self, parameters: Sequence[dict[str, float]], names: Sequence[str]
    ) -> Measuring | None:
        """Return the Measuring of the first of the two that is a fault of the measuring chain, None
        where neither is. names: of the channels.
        """
        return next(
            (
                candidate.measuring(own, names)
                for candidate, own in zip((self.first, self.second), parameters, strict=True)
                if candidate.effect.measured
            ),
            None,
        )


CandidateOrPair = TypeVar("CandidateOrPair", Candidate, Pair)  # one of them, the same throughout


def unit_grid(count: int, points: int) -> np.ndarray:
    """Return (points**count, count): normalised parameters, evenly from 0 to 1 along each of
    `count`.
    """
    return np.stack(
        [
            axis.ravel()
            for axis in np.meshgrid(*[np.linspace(0.0, 1.0, points)] * count, indexing="ij")
        ],
        axis=-1,
    )


def candidate_named(name: str) -> Any:
    """Return the Candidate or Pair of a name; Any, as the name alone says which of them."""
    parts = [_single(part) for part in name.split("+")]
    return parts[0] if len(parts) == 1 else Pair(*parts)


def _single(name):
    """Return the Candidate of a name."""
    return Candidate(*name.removesuffix(ALONE).split("@"), name.endswith(ALONE))


def elsewhere(candidate: Candidate, values: Values) -> list[Candidate]:
    """Return the candidate at each single support where its location is all of them, else none."""
    return (
        [
            replace(candidate, location=place)
            for place in candidate.effect.locations(values)
            if place != candidate.location
        ]
        if candidate.location == "all"
        else []
    )


def other_places(candidate: CandidateOrPair, values: Values) -> list[CandidateOrPair]:
    """Return the candidate at every other location of its effect, where that acts at a point; of a
    Pair the second effect alone is moved, as the place of the first was found before.
    """
    if isinstance(candidate, Pair):
        return [Pair(candidate.first, other) for other in other_places(candidate.second, values)]
    locations = candidate.effect.locations(values)
    return (
        [replace(candidate, location=place) for place in locations if place != candidate.location]
        if candidate.effect_id in AT_A_POINT and candidate.location in locations
        else []
    )


def linear_candidates(
    values: Values, names: Sequence[str], held: Collection[str], modes: Sequence[int] | np.ndarray
) -> list[Candidate]:
    """Return the candidates that the lowest record alone can identify; names: of the channels;
    held: names of what the campaign contains beyond responses; modes: those that were seen, from 0.
    """
    found = []
    for effect in EFFECTS.values():
        if effect.linear and set(effect.needs) <= set(held):
            locations = places(names) if effect.measured else effect.locations(values)
            if effect.id == "mode_frequency_error":
                locations = [f"mode_{mode + 1}" for mode in modes]
            found += [Candidate(effect.id, location) for location in locations]
    return found


def local_candidates(
    values: Values,
    held: Collection[str],
    modes: Collection[int] | np.ndarray | None = None,
) -> list[Candidate]:
    """Return the candidates that only simulation can judge, at the locations to screen first: all
    supports together, a place along a tube, up to PLACES points of another structure.

    modes: those, from 0, that the lowest record shows; None where it does not identify the linear
    structure, so that linear effects are simulated as the others are.
    """
    found = []
    for effect in EFFECTS.values():
        if set(effect.needs) <= set(held) and not effect.measured:
            locations = effect.locations(values)
            if locations and locations[0] == "all":
                locations = locations[:1]
            if effect.id == "mode_frequency_error":
                locations = locations[:UNSEEN_MODES]
            if effect.id in AT_A_POINT:
                on_tube = on_structure.length_m(values) is not None
                locations = [ALONG] if on_tube else spread(locations)
            found += [Candidate(effect.id, location) for location in locations]
    return [
        candidate
        for candidate in found
        if modes is None or not _identified(candidate, modes, values)
    ]


def spread(locations: Sequence[str], count: int = PLACES) -> list[str]:
    """Return at most `count` of the locations, evenly spaced, the first among them."""
    return [
        locations[number]
        for number in np.unique(
            np.round(np.linspace(0, len(locations) - 1, min(count, len(locations)))).astype(int)
        )
    ]


# so many modes, the lowest: an error of the frequency is tried of those that the lowest record does
# not show
UNSEEN_MODES = 6


def _identified(candidate, modes, values):
    """Return whether a lowest record that shows modes (mode,) can identify a candidate: a linear
    effect that does not act across the motion that the force drives.
    """
    if candidate.effect_id == "mode_frequency_error":
        return candidate.mode in modes
    rod = candidate.effect_id == lateral_stinger.EFFECT.id
    across = rod and lateral_stinger.across_force(values, candidate.location)
    return candidate.effect.linear and not across


def not_testable(held: Collection[str]) -> list[str]:
    """Return the ids of the effects that need what the campaign does not contain; held: names of
    what it contains beyond responses.
    """
    return [effect.reported for effect in EFFECTS.values() if not set(effect.needs) <= set(held)]
