"""The problem that every code is given: the study's stand-in tube, a force, and elastic obstacles
with a gap.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from vibroimpact.config.reading import changed_config, load_config
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.reduction.reduced_model import build_model

CONFIG = "config/study.yaml"
RATE = 51200  # steps per second
STRIDE = 25  # steps between samples that are compared
GAP_M, OUT_OF_REACH_M = 2.8886e-4, 1.0
LOAD_N, NEVER_TOUCHES_N = 20.0, 0.05
LONGEST_S, BAND_HZ, RAMP_S = (
    10.0,
    (5.0, 200.0),
    0.005,
)  # the ramp: at rest, zero force and no acceleration
SENSORS = ("apex.x", "apex.y", "bend_45.y")
SMALL_BASIS = {"basis.free_modes_to_Hz": 3000.0, "basis.constrained_modes_to_Hz": 300.0}
# No residual vectors, whose frequencies reach 130 kHz and set the step of every explicit method.
FREE_MODES = {
    "basis.free_modes_to_Hz": 5150.0,
    "basis.constrained_modes_to_Hz": 1.0,
    "basis.attachment_shapes": False,
}
SEED = 3
IMPERFECTION = 1.0e-6  # offset of the obstacles' centres, of the gap, as in the study


@dataclass(frozen=True, eq=False)
class Problem:
    """A reduced tube (ModalModel) of a Config under a force of load_N RMS, with gap_m to its
    obstacles.
    """

    name: str
    config: object
    model: object
    load_N: float = LOAD_N
    gap_m: float = GAP_M
    imperfection: float = IMPERFECTION

    @property
    def sensor_shapes(self):
        """Return (mode, sensor) shapes of the SENSORS."""
        return self.model.sensor_shapes[
            :, [self.model.sensor_names.index(name) for name in SENSORS]
        ]

    @property
    def offset(self):
        """Return (contact_point, 2) m, the seeded offsets of the obstacles' centres."""
        points = len(self.model.support_of_point)
        return np.random.default_rng(0).uniform(-1.0, 1.0, (points, 2)) * self.imperfection * GAP_M

    def contact_gap(self, touching):
        """Return the gap in m, out of reach unless touching."""
        return self.gap_m if touching else OUT_OF_REACH_M

    def force(self, seconds, seed=SEED, rate=RATE):
        """Return (step + 1,) N at k / rate: the beginning of a seed's record, for RATE a whole
        number of STRIDE steps; `seconds` up to LONGEST_S.
        """
        stride = STRIDE if rate == RATE else 1
        return self.load_N * unit_record(seed, rate)[: stride * round(seconds * rate / stride) + 1]


@cache
def unit_record(seed, rate):
    """Return (step + 1,) band-limited noise at k / rate of about unit RMS, zero at the start,
    LONGEST_S long; another rate is another record.
    """
    steps = round(LONGEST_S * rate)
    noise = band_limited_noise(np.random.default_rng(seed), steps + 1, rate, BAND_HZ)
    return noise * -np.expm1(-((np.arange(steps + 1) / (RAMP_S * rate)) ** 2))


def tube_problem(values=None, kind="modes", path=CONFIG):
    """Return the Problem of a configuration with some dotted keys changed, under LOAD_N, named
    after the kind of its modes and the load.

    The driven point is put exactly at 45 degrees of the bend, where a mesh of finite elements can
    have a node.
    """
    config = load_config(path)
    at = config.structure.bend_radius_m * np.sqrt(0.5)
    drive = [-at, 0.0, config.structure.leg_length_m + at]
    config = changed_config(
        config,
        {f"points.{config.excitation.point}": drive, "points.bend_45": drive, **(values or {})},
    )
    model = build_model(config)
    return Problem(f"{model.modes} {kind}, {LOAD_N:g} N", config, model)


def never_touching(problem):
    """Return the Problem under a load that never reaches the obstacles."""
    return replace(
        problem,
        name=f"{problem.model.modes} modes, {NEVER_TOUCHES_N:g} N, never touches",
        load_N=NEVER_TOUCHES_N,
    )
