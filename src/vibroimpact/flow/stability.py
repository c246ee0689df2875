"""The stability of a tube in a flow, with all supports that hold it and without some of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np

from vibroimpact.config.flow import Coupling, Flow
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.schema import Config
from vibroimpact.excitation.fluid_elastic import fluid_force, outside_fit
from vibroimpact.identify.linear.support_groups import SupportDirection, support_directions

from .along import TubeInFlow, tube_in_flow
from .coupled import Zone, critical_velocity, oscillations, system
from .critical_velocity import connors, mass_damping, tema_factor

MODES = 8  # reported: the lowest of each direction
STATES = 20  # lowest modes that a fluid-elastic force couples
LEAST_SHARE = 0.05  # of a mode's energy in a direction: below, the force does not drive it
VELOCITIES = 41  # of the eigenvalues, from 0 to the highest
# Ends of the names of columns that have a unit.
UNITS = {"frequency": "_Hz"} | dict.fromkeys(
    ("velocity", "effective", "critical_low", "critical_high"), "_m_per_s"
)
SEARCHED = 3.0  # times the highest velocity: up to which eigenvalues are followed


class NoFlow(ValueError):
    """A configuration without a flow across a tube."""


@dataclass(frozen=True)
class StabilityRow:
    """One mode in one flow, in SI units.

    velocity: between the tubes. inactive: supports that do not hold, joined by "+". mode: from 1
    among those that move in the direction. effective: V_eff. critical_low, critical_high: V_c over
    the range of the criterion's constant. ratio_low, ratio_high: V_eff / V_c.
    """

    velocity: float
    inactive: str
    mode: int
    direction: str
    frequency: float
    damping_ratio: float
    effective: float
    critical_low: float
    critical_high: float
    ratio_low: float
    ratio_high: float

    def table_row(self) -> dict[str, Any]:
        """Return the row of stability.csv, its columns named with their units."""
        return {f"{name}{UNITS.get(name, '')}": value for name, value in asdict(self).items()}


@dataclass(frozen=True, eq=False)
class Eigenvalues:
    """Oscillations against velocity, with a fluid-elastic force, all supports holding.

    velocity (velocity,) m/s. frequency, damping_ratio (velocity, mode): Hz. critical: m/s, NaN if
    no eigenvalue grows up to `searched`.
    """

    velocity: np.ndarray
    frequency: np.ndarray
    damping_ratio: np.ndarray
    critical: float
    searched: float


@dataclass(frozen=True, eq=False)
class Stability:
    """The rows of all modes, velocities and states of the supports, and the Eigenvalues of a
    fluid-elastic force if one is given; warnings if that is extrapolated.
    """

    rows: tuple[StabilityRow, ...]
    eigenvalues: Eigenvalues | None = None
    warnings: tuple[str, ...] = ()

    def worst(self, velocity: float, inactive: int) -> StabilityRow | None:
        """Return the row with the largest ratio at a velocity with `inactive` supports not holding;
        None if there are fewer supports.
        """
        rows = [
            row
            for row in self.rows
            if row.velocity == velocity and len(_names(row.inactive)) == inactive
        ]
        return max(rows, key=lambda row: row.ratio_high, default=None)


def _names(joined: str) -> list[str]:
    """Return the names of supports that a row joins."""
    return joined.split("+") if joined else []


def stability(
    config: Config,
    stiffness: float | None = None,
    damping: float = 0.0,
    inactive: int = 1,
) -> Stability:
    """Return the Stability of the tube of a configuration with a section `flow`.

    stiffness: of a support that holds, N/m, along each direction that it acts in; None for its
    contact stiffness. damping: N s/m. inactive: at most so many supports do not hold, in every
    combination.

    Raises NoFlow if the configuration has no flow or no tube.
    """
    flow, tube = _in_flow(config)
    return _stability(_Held(flow, tube, stiffness, damping), inactive)


def stability_of_states(
    config: Config, states: Mapping[str, tuple[float | None, float]]
) -> dict[str, Stability]:
    """Return {name: Stability} for states {name: (stiffness, damping)} of all supports, as in
    `stability`.
    """
    flow, tube = _in_flow(config)
    return {name: _stability(_Held(flow, tube, *own), 0) for name, own in states.items()}


def _in_flow(config: Config) -> tuple[Flow, TubeInFlow]:
    """Return (section flow, TubeInFlow). Raises NoFlow."""
    flow = config.flow
    if flow is None or config.structure.kind not in TUBES:
        raise NoFlow(
            "flow: there is none: give velocity_m_per_s, density_kg_per_m3, direction and criterion"
            if flow is None
            else f"flow: acts along a tube, structure.kind is {config.structure.kind}"
        )
    return flow, tube_in_flow(config, flow)


def _stability(held: _Held, inactive: int) -> Stability:
    """Return the Stability with at most `inactive` supports that do not hold."""
    flow = held.flow
    rows = tuple(row for names in held.states(inactive) for row in held.rows(names))
    found = Stability(rows, held.eigenvalues(flow.coupling) if flow.coupling else None)
    worst = [found.worst(velocity, 0) for velocity in flow.velocity_m_per_s]
    told = [
        outside_fit(flow.coupling, row.velocity, row.frequency, held.tube.diameter)
        for row in worst
        if row is not None
    ]
    return replace(found, warnings=tuple(filter(None, told)))


@dataclass(frozen=True, eq=False)
class _Held:
    """A tube in a flow, and the supports that can hold it."""

    flow: Flow
    tube: TubeInFlow
    stiffness: float | None
    damping: float

    @cached_property
    def supports(self) -> list[SupportDirection]:
        """Return each support in each direction that it acts in."""
        return support_directions(self.tube.model, "each")

    def states(self, most: int) -> Iterator[tuple[str, ...]]:
        """Yield the names of supports that do not hold: none, then every combination."""
        names = self.tube.model.support_names
        for count in range(min(most, len(names)) + 1):
            yield from combinations(names, count)

    def matrices(self, inactive: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Return (stiffness, damping), each (mode, mode) in 1/s² and 1/s."""
        model = self.tube.model
        own = np.bincount(model.support_of_point, model.contact_stiffness)
        stiff, drag = np.diag(model.omega**2), np.diag(model.damping)
        for support in self.supports:
            if support.group in inactive:
                continue
            number = model.support_names.index(support.group)
            held = own[number] if self.stiffness is None else self.stiffness
            product = support.contact @ support.contact.T
            stiff, drag = stiff + held * product, drag + self.damping * product
        return stiff, drag

    def rows(self, inactive: Sequence[str]) -> Iterator[StabilityRow]:
        """Yield the rows of the lowest modes of each direction."""
        stiff, drag = self.matrices(inactive)
        squares, vectors = np.linalg.eigh(stiff)
        along = self.tube.along
        for direction, shapes in self.tube.shapes.items():
            told = 0
            for square, vector in zip(squares, vectors.T, strict=True):
                shape = vector @ shapes
                share = np.sum(along.weight * along.mass * shape**2)
                if square <= 0.0 or share < LEAST_SHARE:
                    continue
                told += 1
                omega = float(np.sqrt(square))
                ratio = float(vector @ drag @ vector) / (2.0 * omega)
                yield from self._of_mode(
                    inactive, (told, direction), omega / (2.0 * np.pi), ratio, shape
                )
                if told == MODES:
                    break

    def _of_mode(
        self,
        inactive: Sequence[str],
        name: tuple[int, str],
        frequency: float,
        ratio: float,
        shape: np.ndarray,
    ) -> Iterator[StabilityRow]:
        """Yield the rows of one mode at all velocities; name: (number, direction)."""
        low, high = self._critical(frequency, ratio)
        unit = self.tube.along.effective(shape)
        for velocity in self.flow.velocity_m_per_s:
            effective = velocity * unit
            yield StabilityRow(
                velocity,
                "+".join(inactive),
                *name,
                frequency,
                ratio,
                effective,
                low,
                high,
                effective / high if high > 0.0 else np.inf,
                effective / low if low > 0.0 else np.inf,
            )

    def _critical(self, frequency: float, ratio: float) -> tuple[float, float]:
        """Return (lowest, highest) V_c in m/s of a mode."""
        along, rule = self.tube.along, self.flow.criterion
        mass, density = along.mean(along.mass), along.mean(along.density)
        if rule.kind == "connors":
            found = [connors(frequency, ratio, mass, density, own) for own in rule.constant]
            return min(found), max(found)
        diameter = self.tube.diameter
        damped = mass_damping(mass, ratio, density, diameter)
        factor = tema_factor(rule.pattern_deg, rule.pitch_m / diameter, damped)
        return (factor * frequency * diameter,) * 2

    def eigenvalues(self, own: Coupling) -> Eigenvalues:
        """Return the Eigenvalues with a fluid-elastic force, all supports holding."""
        stiff, drag = self.matrices(())
        squares, vectors = np.linalg.eigh(stiff)
        kept = vectors[:, :STATES]
        stiff, drag = np.diag(squares[:STATES]), kept.T @ drag @ kept
        zones = [Zone(z.factor, kept.T @ z.overlap @ kept) for z in self.tube.zones()]
        force = fluid_force(own, self.tube.diameter)
        highest = max(self.flow.velocity_m_per_s)
        velocities = np.linspace(0.0, highest, VELOCITIES)
        found = [
            oscillations(system(stiff, drag, force, zones, velocity), MODES)
            for velocity in velocities
        ]
        count = min(len(frequency) for frequency, _ in found)
        critical = critical_velocity(stiff, drag, force, zones, SEARCHED * highest)
        return Eigenvalues(
            velocities,
            np.array([frequency[:count] for frequency, _ in found]),
            np.array([ratio[:count] for _, ratio in found]),
            critical,
            SEARCHED * highest,
        )
