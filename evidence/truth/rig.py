"""A test rig: the tube and everything that an effect may change. Plain data in SI units."""

from dataclasses import dataclass, field

from evidence.truth.geometry import Beam

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
    "self_excited": 9,
    "parametric": 10,
    "breathing": 11,
}
FRICTION_LAWS = {"dahl": 0, "tanh": 1, "lugre": 2, "iwan": 3, "spring_damper": 4}
PROFILES = {"circle": 0, "lands": 1, "lobes": 2}


@dataclass
class Plate:
    """A support plate; stiffness, damping and hertz are totals, shared by its contact nodes.

    gap_factor: radial gap over the nominal one.
    gap_rate: its relative change per s of the campaign.
    offset: of the centre, m.
    stiffness N/m, damping N s/m, hunt_crossley s/m; hertz N/m^1.5 replaces the stiffness where > 0.
    approach_damping: relative rise of the elastic force per rate over the rate at first touch.
    friction: mu, by friction_law. stick_ratio × stiffness is that of its bristles; slip_speed m/s
    belongs to tanh; static_ratio (static over sliding), stribeck_speed m/s and stick_time s
    (damping over stiffness of a bristle) to lugre, the last to spring_damper too.
    loosened: (s of the campaign, s that it takes, relative growth of the gap).
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
    approach_damping: float = 0.0
    friction: float = 0.0
    friction_law: str = "dahl"
    stick_ratio: float = 0.7
    slip_speed: float = 1.0e-3
    static_ratio: float = 1.0
    stribeck_speed: float = 1.0e-3
    stick_time: float = 0.0
    loosened: tuple = (0.0, 1.0, 0.0)
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

    component: (3,) direction of the displacement, "rx" or "ry", the rotation of the place
    "left_root" or "right_root", or "bend_y" or "bend_x", the bending angle at a place.
    parameters: as in kernel.element_force; of "breathing" the compliance of the open crack,
    rad/(N m).
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
class SlidingMass:
    """A mass [kg] that slides on a short rod at a place, along the direction (3,) of the rod.

    limit: N, of the friction of its bore. stick: N/m, of the bristle. centring: N/m, of a spring.
    """

    place: object
    direction: tuple
    mass: float
    limit: float
    stick: float = 3.0e5
    centring: float = 0.0


@dataclass
class Rig:
    """The tube with its supports and hidden effects.

    springs: (place, direction, N/m) to ground.
    masses: (place, kg).
    root: (N/m, N m/rad) of both roots, None for clamped.
    fluid: (kg/m, N s/m²). drag: N s²/m² per metre.
    mode_factor: {mode number from 1: factor of its frequency}.
    drive_direction: (3,) of the force; drive_angle: rad, by which it is turned about the tube's
    axis. on_base: whether no force drives the tube, but an acceleration of all that holds it, along
    drive_direction.
    frequency_drift: relative change of all modal frequencies per s of the campaign.
    unmeasured: (place, direction, RMS relative to the drive) of a second force.
    """

    tube: Beam
    plates: list = field(default_factory=list)
    elements: list = field(default_factory=list)
    loose: list = field(default_factory=list)
    sliders: list = field(default_factory=list)
    springs: list = field(default_factory=list)
    masses: list = field(default_factory=list)
    root: tuple | None = None
    fluid: tuple = (0.0, 0.0)
    drag: float = 0.0
    damping_factor: float = 1.0
    mode_factor: dict = field(default_factory=dict)
    drive_direction: tuple = (0.0, 1.0, 0.0)
    drive_angle: float = 0.0
    on_base: bool = False
    frequency_drift: float = 0.0
    unmeasured: tuple | None = None

    @classmethod
    def bare(cls, tube):
        """The rig without hidden effects."""
        return cls(
            tube,
            [
                Plate(
                    holder.name,
                    holder.stiffness,
                    holder.gap_factor,
                    profile=holder.profile,
                    lobes=holder.lobes,
                    angle=holder.angle,
                )
                for holder in tube.holders
            ],
        )
