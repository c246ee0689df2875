"""What a test rig is made of: the tube and everything that an effect may change on it. Plain data,
SI units.
"""

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
    """A support plate: radial gap = gap_factor × nominal (+ gap_rate per second of the campaign,
    relative), centre offset m, laws of the contact (stiffness N/m, damping N s/m, hertz N/m^1.5 are
    totals of the plate, shared by its nodes; hertz > 0 replaces the stiffness), friction (mu;
    bristle of stick_ratio × stiffness, or tanh(v / slip_speed) where slip_speed m/s > 0), profile
    of the hole (lobes or lands, angle rad, depth m, land_half_angle rad), preload N in x and y, a
    mass [kg] on a spring [N/m] where the plate yields, and the tilt of its axis, rad towards x and
    y.
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
    """A local force law between a place of the tube and the ground, or two places; parameters as in
    kernel.element_force.

    component: (3,) direction of the displacement, or "rx" or "ry", the rotation of the place
    "left_root" or "right_root".
    """

    law: str
    place: str
    component: object
    parameters: tuple
    other: str | None = None


@dataclass
class LooseMass:
    """A mass [kg] free within a round clearance [m] inside the tube at a place, wall stiffness N/m
    and damping N s/m.
    """

    place: str
    mass: float
    clearance: float
    stiffness: float = 3.0e5
    damping: float = 8.0


@dataclass
class Rig:
    """The tube with its supports and all that is hidden in it.

    springs: (place, direction, N/m) to ground; dashpots likewise in N s/m; masses: (place, kg);
    root: (N/m, N m/rad) or None, clamped; fluid: (kg/m, N s/m²); drag N s²/m² per metre;
    mode_factor: {mode number from 1: factor of its frequency}; drive_angle rad about the tube's
    axis; unmeasured: (place, direction, RMS relative to the drive's) of a second force.
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
        """The rig with nothing hidden."""
        return cls(tube, [Plate(side, tube.plate_stiffness) for side in ("left", "right")])
