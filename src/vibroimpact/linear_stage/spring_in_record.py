"""A spring and a dashpot between a place and the ground in the lowest record:
along the direction that the force has there, or in any across a tube.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from vibroimpact.config.reading import check_config
from vibroimpact.effects import places
from vibroimpact.observation.attached_model import attach

from . import nuisance as linear
from .effect_fit import LinearChanges
from .linearised import linearised
from .share_explained import share_explained
from .workbench import Workbench

# of the tube's own stiffness: below it a spring is searched linearly, above it in its logarithm
SMALL = 0.01
# arsinh of the stiffness, ln of the damping, in units of the small one's
GRID = (np.linspace(-5.0, 9.0, 15), (-9.0, -5.0, -2.0))
ANGLES = np.deg2rad([-45.0, 0.0, 45.0, 90.0])  # about a tube, from the direction of the force
SEARCHED = 80  # evaluations at most for each angle that is free, from the best point of the grid


@dataclass(frozen=True)
class Spring:
    """The best spring at a place: its angle in rad about a tube from the direction of the force;
    gain: of log likelihood of the lowest record; share: of the chi-square beyond chance that it
    takes away.
    """

    angle: float
    gain: float
    share: float


class SpringInRecord:
    """A spring, of positive or negative stiffness, and a dashpot in the lowest record of a
    Workbench.

    changes: LinearChanges of the Workbench; place: a named point, or one of places.between;
    stiffness: scale in N/m.
    """

    def __init__(
        self, bench: Workbench, changes: LinearChanges, place: str, stiffness: float
    ) -> None:
        values = places.with_place(changes.values, place)
        along = np.array(places.across(values, place))
        self.model = self._attached(bench, values, place, along)
        self.shapes = [self.model.element_shapes[:, -1]]
        tangent = places.direction_at(values, place)
        if tangent is not None:
            turned = self._attached(bench, values, place, np.cross(tangent, along))
            self.shapes.append(turned.element_shapes[:, -1])
        self.measured, self.changes, self.stiffness = bench.measured_reading, changes, stiffness
        self.damping = SMALL * stiffness / self.model.omega[self.model.omega > 0.0][0]
        self.start = linear.reading_of_model(bench.bare, changes.modes)
        self.without = linear.likelihood(self.measured, self.start)

    def _attached(self, bench, values, place, direction):
        element = places.with_element(
            values, "equivalent", place, [float(x) for x in direction], stiffness_N_per_m=1.0
        )
        return attach(check_config(element, "variant of the model"), bench.campaign)

    def along_force(self) -> Spring:
        """Return the best Spring in the direction that the force has there."""
        return self._best([0.0], free=False)

    def in_any_direction(self) -> Spring:
        """Return the best Spring in any direction across a tube."""
        return self._best(ANGLES, free=True)

    def _best(self, angles, free):
        start = min(
            ([first, second, angle] for first in GRID[0] for second in GRID[1] for angle in angles),
            key=self._loss,
        )
        fixed = start[2:] if not free else []
        found = optimize.minimize(
            lambda unit: self._loss([*unit, *fixed]),
            start if free else start[:2],
            method="Nelder-Mead",
            options={"xatol": 0.01, "fatol": 0.3, "maxfev": SEARCHED * (1 + free)},
        )
        unit = [*found.x, *fixed]
        reading = self._reading(unit)
        _, left, _ = linear.likelihood(self.measured, reading, self.start)
        values = len(linear.difference(self.measured, reading, bare=self.start)[0])
        share = share_explained(left, self.without[1], values)
        return Spring(float(unit[2]), -float(found.fun), share)

    def _loss(self, unit):
        """Return how much less likely the record is with (stiffness, damping, angle) of GRID."""
        reading = self._reading(unit)
        if reading is None:
            return np.inf
        return self.without[0] - linear.likelihood(self.measured, reading, self.start)[0]

    def _reading(self, unit):
        """Return the Reading with (stiffness, damping, angle) of GRID; None where the negative
        stiffness makes the structure unstable.
        """
        laws = replace(
            self.model.local_laws,
            stiffness=_last(
                self.model.local_laws.stiffness, SMALL * self.stiffness * np.sinh(unit[0])
            ),
            damping=_last(self.model.local_laws.damping, self.damping * np.exp(unit[1])),
        )
        shapes = np.array(self.model.element_shapes)
        turns = (np.cos(unit[2]), np.sin(unit[2]))
        shapes[:, -1] = sum(turn * shape for turn, shape in zip(turns, self.shapes, strict=False))
        changed = linearised(replace(self.model, local_laws=laws, element_shapes=shapes))
        if np.sum(changed.omega > 0.0) < np.sum(self.model.omega > 0.0):
            return None
        return self.changes.reading_of(changed)


def _last(values, value):
    """Return values (n,) with the last one replaced."""
    return np.append(values[:-1], value)
