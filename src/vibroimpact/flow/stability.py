"""The stability of a tube in a flow, with all supports that hold it and without some of them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import chain, combinations
from typing import Any

import numpy as np

from vibroimpact.config.flow import Coupling, Flow
from vibroimpact.config.name_checks import TUBES
from vibroimpact.config.schema import Config
from vibroimpact.excitation.fluid_elastic import fluid_force, outside_fit
from vibroimpact.identify.linear.support_groups import SupportDirection, support_directions

from .along import TubeInFlow, tube_in_flow
from .coupled import (
    Zone,
    contact_stiffness,
    critical_velocity,
    lowest_states,
    oscillations,
    system,
)
from .critical_velocity import connors, mass_damping, tema_factor

MODES = 8  # reported: the lowest of each direction
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
            if row.velocity == velocity
            and len(row.inactive.split("+") if row.inactive else ()) == inactive
        ]
        return max(rows, key=lambda row: row.ratio_high, default=None)


def stability(
    config: Config, stiffness: float | None = None, damping: float = 0.0, inactive: int = 1
) -> Stability:
    """Return the Stability of the tube of a configuration with a section `flow`.

    stiffness: of a support that holds, N/m, along each direction that it acts in; None for its
    contact stiffness. damping: N s/m. inactive: at most so many supports do not hold, in every
    combination.

    Raises NoFlow if the configuration has no flow or no tube.
    """
    return _Held(*_in_flow(config), stiffness, damping).stability(inactive)


def stability_of_states(
    config: Config, states: Mapping[str, tuple[float | None, float]]
) -> dict[str, Stability]:
    """Return {name: Stability} for states {name: (stiffness, damping)} of all supports, as in
    `stability`.
    """
    flow, tube = _in_flow(config)
    return {name: _Held(flow, tube, *own).stability(0) for name, own in states.items()}


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

    def stability(self, inactive: int) -> Stability:
        """Return the Stability with at most `inactive` supports that do not hold."""
        flow, names = self.flow, self.tube.model.support_names
        states = (combinations(names, count) for count in range(min(inactive, len(names)) + 1))
        rows = tuple(row for left_out in chain(*states) for row in self.rows(left_out))
        found = Stability(rows, self.eigenvalues(flow.coupling) if flow.coupling else None)
        worst = filter(None, (found.worst(velocity, 0) for velocity in flow.velocity_m_per_s))
        diameter = self.tube.diameter
        told = (outside_fit(flow.coupling, row.velocity, row.frequency, diameter) for row in worst)
        return replace(found, warnings=tuple(filter(None, told)))

    def matrices(self, inactive: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Return (stiffness, damping), each (mode, mode) in 1/s² and 1/s."""
        model = self.tube.model
        stiff, drag = np.diag(model.omega**2), np.diag(model.damping)
        stiffness = contact_stiffness(model, self.supports)
        for support, own in zip(self.supports, stiffness, strict=True):
            if support.group not in inactive:
                held = own if self.stiffness is None else self.stiffness
                product = support.contact @ support.contact.T
                stiff, drag = stiff + held * product, drag + self.damping * product
        return stiff, drag

    def rows(self, inactive: Sequence[str]) -> Iterator[StabilityRow]:
        """Yield the rows of the lowest modes of each direction at all velocities."""
        stiff, drag = self.matrices(inactive)
        squares, vectors = np.linalg.eigh(stiff)
        along = self.tube.along
        for direction, shapes in self.tube.shapes.items():
            moved = [
                (square, vector, shape)
                for square, vector in zip(squares, vectors.T, strict=True)
                for shape in [vector @ shapes]
                if square > 0.0 and np.sum(along.weight * along.mass * shape**2) >= LEAST_SHARE
            ]
            for number, (square, vector, shape) in enumerate(moved[:MODES], 1):
                omega = float(np.sqrt(square))
                frequency = omega / (2.0 * np.pi)
                ratio = float(vector @ drag @ vector) / (2.0 * omega)
                low, high = self._critical(frequency, ratio)
                mode = "+".join(inactive), number, direction, frequency, ratio
                for velocity in self.flow.velocity_m_per_s:
                    effective = velocity * along.effective(shape)
                    ratios = [effective / end if end > 0.0 else np.inf for end in (high, low)]
                    yield StabilityRow(velocity, *mode, effective, low, high, *ratios)

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
        kept, stiff, drag = lowest_states(*self.matrices(()))
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
