"""A test rig: the tube and everything that an effect may change. Plain data in SI units."""

from dataclasses import dataclass, field

from vibroimpact_truth.geometry import Tube

LAWS = {
    "linear": 0,
    "cubic": 1,
    "quadratic": 2,
    "saturation": 3,
    "coulomb": 4,
    "clearance": 5,
    "bouc_wen": 6,
    "one_sided": 7,
    "drag": 8,
}
PROFILES = {"circle": 0, "lands": 1, "lobes": 2}


@dataclass
class Plate:
    """A support plate; stiffness, damping and hertz are totals, shared by its contact nodes.

    gap_factor: radial gap over the nominal one.
    gap_rate: its relative change per s of the campaign.
    offset: of the centre, m.
    stiffness N/m, damping N s/m, hunt_crossley s/m; hertz N/m^1.5 replaces the stiffness where > 0.
    friction: mu of a bristle of stick_ratio × stiffness, or of tanh(v / slip_speed) where
    slip_speed m/s is > 0.
    profile of the hole: "circle", "lands" or "lobes"; angle rad, depth m, land_half_angle rad.
    preload: N in x and y.
    plate_mass kg on a spring plate_stiffness N/m; rigid where the mass is 0.
    tilt: of the axis, rad towards x and y.
    """

    side: str
    stiffness: float
    gap_factor: float = 1.0
    gap_rate: float = 0.0
    offset: tuple = (0.0, 0.0)
    damping: float = 0.0
    hunt_crossley: float = 0.0
    hertz: float = 0.0
    friction: float = 0.0
    stick_ratio: float = 0.7
    slip_speed: float = 0.0
    profile: str = "circle"
    lobes: int = 4
    depth: float = 0.0
    angle: float = 0.0
    land_half_angle: float = 0.1
    preload: tuple = (0.0, 0.0)
    plate_mass: float = 0.0
    plate_stiffness: float = 0.0
    tilt: tuple = (0.0, 0.0)


@dataclass
class Element:
    """A local force law between a place of the tube and the ground, or between two places.

    component: (3,) direction of the displacement, or "rx" or "ry", the rotation of the place
    "left_root" or "right_root".
    parameters: as in kernel.element_force.
    """

    law: str
    place: str
    component: object
    parameters: tuple
    other: str | None = None


@dataclass
class LooseMass:
    """A mass [kg] free within a round clearance [m] inside the tube at a place.

    stiffness N/m and damping N s/m are those of the wall.
    """

    place: str
    mass: float
    clearance: float
    stiffness: float = 3.0e5
    damping: float = 8.0


@dataclass
class Rig:
    """The tube with its supports and hidden effects.

    springs: (place, direction, N/m) to ground.
    masses: (place, kg).
    root: (N/m, N m/rad) of both roots, None for clamped.
    fluid: (kg/m, N s/m²). drag: N s²/m² per metre.
    mode_factor: {mode number from 1: factor of its frequency}.
    drive_angle: rad, about the tube's axis.
    unmeasured: (place, direction, RMS relative to the drive) of a second force.
    """

    tube: Tube
    plates: list = field(default_factory=list)
    elements: list = field(default_factory=list)
    loose: list = field(default_factory=list)
    springs: list = field(default_factory=list)
    masses: list = field(default_factory=list)
    root: tuple | None = None
    fluid: tuple = (0.0, 0.0)
    drag: float = 0.0
    damping_factor: float = 1.0
    mode_factor: dict = field(default_factory=dict)
    drive_angle: float = 0.0
    unmeasured: tuple | None = None

    @classmethod
    def bare(cls, tube):
        """The rig without hidden effects."""
        return cls(tube, [Plate(side, tube.plate_stiffness) for side in ("left", "right")])
