"""The parameters of each effect from one number, its amount, and the sizes of the scene.

An amount is a pure number, so that one table serves every geometry. `start` is where tune.py
begins; it stays within `most` times more or less. What the strength is, is measured.
"""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Amount:
    """The amount of an effect.

    parameters: function (amount, Scene) that returns the parameters of the effect.
    start: a strong one. most: the largest that is sound.
    tuned: whether a short record far from the others tells its strength.
    """

    parameters: object
    start: float
    most: float
    tuned: bool = True


def sign(scene):
    """1 or -1, at random."""
    return float(scene.rng.choice([-1.0, 1.0]))


def turned(scene, size):
    """(in plane, out of plane) of a size in a random direction."""
    angle = scene.rng.uniform(0.0, 2.0 * np.pi)
    return float(size * np.cos(angle)), float(size * np.sin(angle))


def at_plates(**parameters):
    """Function (amount, Scene) of parameters {name: function (amount, Scene)} at the plates."""

    def function(a, scene):
        return {name: value(a, scene) for name, value in parameters.items()} | {
            "plates": scene.plates
        }

    return function


def at_place(**parameters):
    """The same at the place and along the direction of the scene."""

    def function(a, scene):
        return {name: value(a, scene) for name, value in parameters.items()} | {
            "place": scene.place,
            "direction": scene.direction,
        }

    return function


def plain(a, scene):
    """The amount itself."""
    return a


def more_or_less(a, scene):
    """1 + a or 1 / (1 + a)."""
    return 1.0 + a if scene.rng.random() < 0.6 else 1.0 / (1.0 + a)


def either_way(a, scene):
    """1 + a or 1 - a."""
    return 1.0 + sign(scene) * a


def angle(a, scene):
    """Angle of the first land, rad."""
    return float(scene.rng.uniform(0.0, np.pi / 2))


def lands(a, scene):
    """3 to 6."""
    return int(scene.rng.integers(3, 7))


def offset(a, scene):
    """A support offset of a gaps."""
    x, y = turned(scene, a * scene.gap)
    return {"offset_x": x, "offset_y": y, "plates": scene.plates}


def dead_load(a, scene):
    """A preload, a times what presses the beam through the gap."""
    x, y = turned(scene, a * scene.gap * scene.sizes.support_stiffness)
    return {"force_x": x, "force_y": y, "plates": scene.plates}


def across_gap(power):
    """a times the beam's stiffness over a power of the gap."""
    return lambda a, scene: a * scene.sizes.stiffness / scene.gap**power


def of_contact(a, scene):
    """N s/m: a times a contact's stiffness over the rate of 1 kHz."""
    return a * scene.contact / 6283.0


def of_speed(factor):
    """m/s: factor times the speed of the lowest mode through the gap."""
    return lambda a, scene: factor * scene.sizes.first * scene.gap


def damping_of_mode(a, scene):
    """N s/m: a times what the lowest mode has."""
    return a * scene.beam.first_damping * scene.sizes.first * scene.mass


def root(a, scene):
    """N m/rad: bending stiffness of a third of the beam over a."""
    return 3.0 * scene.beam.section["EI"] / (scene.beam.length * a)


def middle_time(a, scene):
    """s of the campaign, in the middle of it."""
    return float(scene.rng.uniform(0.35, 0.6) * scene.seconds)


def per_campaign(a, scene):
    """1/s: a or -a over the whole campaign."""
    return (a if scene.rng.random() < 0.6 else -0.5 * a) / scene.seconds


def uniform(low, high):
    """A number between two."""
    return lambda a, scene: float(scene.rng.uniform(low, high))


AMOUNTS = {
    "gap": Amount(at_plates(factor=more_or_less), 0.8, 2.0),
    "contact_stiffness": Amount(at_plates(factor=lambda a, scene: 1.0 / a), 12.0, 60.0),
    "contact_damping": Amount(at_plates(damping=of_contact), 0.9, 3.0),
    "hunt_crossley": Amount(
        at_plates(alpha=lambda a, scene: a / (scene.sizes.first * scene.gap)), 0.3, 1.5
    ),
    "hertz": Amount(
        at_plates(coefficient=lambda a, scene: scene.contact / (5.0 * a * np.sqrt(scene.gap))),
        10.0,
        60.0,
    ),
    "dry_friction": Amount(at_plates(mu=plain), 0.3, 0.7),
    "support_offset": Amount(offset, 0.8, 1.3),
    "foliate_obstacle": Amount(
        at_plates(lobes=lands, depth=lambda a, scene: a * scene.gap, angle=angle), 0.8, 2.5
    ),
    "preload": Amount(dead_load, 1.2, 4.0),
    "plate_flexibility": Amount(
        at_plates(
            stiffness=lambda a, scene: scene.contact / a,
            mass=lambda a, scene: scene.mass * scene.rng.uniform(0.2, 0.5),
        ),
        8.0,
        40.0,
    ),
    "root_stiffness": Amount(
        lambda a, scene: {"translation": 1.0e8, "rotation": root(a, scene)}, 1.5, 6.0
    ),
    "modal_damping": Amount(lambda a, scene: {"factor": 1.0 + a}, 5.0, 12.0),
    "mode_frequency_error": Amount(
        lambda a, scene: {"mode": int(scene.rng.integers(1, 4)), "factor": either_way(a, scene)},
        0.18,
        0.3,
    ),
    "added_mass": Amount(
        lambda a, scene: {"mass": a * scene.mass, "place": scene.place}, 0.25, 0.6
    ),
    "lateral_stinger": Amount(
        lambda a, scene: {
            "stiffness": a * scene.sizes.stiffness,
            "damping": 0.0,
            "direction": scene.drive_direction,
        },
        0.8,
        4.0,
    ),
    "fluid_added_mass_damping": Amount(
        lambda a, scene: {
            "mass": a * scene.beam.section["mass"],
            "damping": 0.4 * scene.sizes.first * a * scene.beam.section["mass"],
        },
        0.25,
        1.0,
    ),
    "cubic_stiffness": Amount(at_place(stiffness=across_gap(2)), 8.0, 60.0),
    "quadratic_stiffness": Amount(
        at_place(stiffness=lambda a, scene: sign(scene) * across_gap(1)(a, scene)), 0.03, 0.06
    ),
    "saturation_stiffness": Amount(
        at_place(
            stiffness=across_gap(0),
            limit=lambda a, scene: 1.4 * a * scene.sizes.stiffness * scene.gap,
        ),
        12.0,
        40.0,
    ),
    "quadratic_drag": Amount(
        lambda a, scene: {
            "drag": a * 2.0 * scene.beam.first_damping * scene.beam.section["mass"] / scene.gap
        },
        1.5,
        10.0,
    ),
    "coulomb_friction": Amount(at_place(force=lambda a, scene: a * scene.load), 0.5, 1.5),
    "clearance": Amount(
        at_place(half_gap=lambda a, scene: 1.4 * scene.gap, stiffness=across_gap(0)), 3.0, 40.0
    ),
    "force_misalignment": Amount(lambda a, scene: {"angle": sign(scene) * a}, 0.7, 1.2),
    "dahl_friction": Amount(at_plates(mu=plain, stick_ratio=uniform(0.05, 0.3)), 0.3, 0.7),
    "velocity_friction": Amount(at_plates(mu=plain, slip_speed=of_speed(0.1)), 0.3, 0.7),
    "lugre_friction": Amount(
        at_plates(
            mu=plain,
            static_ratio=uniform(1.2, 1.8),
            stribeck_speed=of_speed(0.3),
            stick_time=uniform(1.0e-5, 4.0e-5),
        ),
        0.3,
        0.7,
    ),
    "iwan_friction": Amount(at_plates(mu=plain, stick_ratio=uniform(0.2, 0.8)), 0.3, 0.7),
    "spring_damper_friction": Amount(
        at_plates(mu=plain, stick_ratio=uniform(0.1, 0.6), stick_time=uniform(2e-5, 1e-4)), 0.3, 0.7
    ),
    "flores_contact": Amount(at_plates(restitution=lambda a, scene: 1.0 / (1.0 + a)), 1.0, 6.0),
    "lankarani_nikravesh_contact": Amount(
        at_plates(restitution=lambda a, scene: 1.0 / (1.0 + a)), 1.5, 20.0
    ),
    "flat_lands": Amount(at_plates(count=lands, angle=angle), 1.0, 1.0, False),
    "sine_lobes": Amount(
        at_plates(
            count=lands,
            depth=lambda a, scene: a * scene.gap,
            angle=angle,
            land=uniform(0.05, 0.25),
        ),
        0.8,
        2.5,
    ),
    "breathing_crack": Amount(
        lambda a, scene: {
            "place": scene.place,
            "depth": a / (1.0 + a),
            "plane": "y" if abs(scene.direction[1]) > 0.7 else "x",
        },
        8.0,
        60.0,
    ),
    "self_excitation": Amount(at_place(negative=damping_of_mode, speed=of_speed(2.0)), 0.8, 3.0),
    "sliding_mass": Amount(
        at_place(
            mass=lambda a, scene: a * scene.mass,
            limit=lambda a, scene: scene.load * scene.rng.uniform(0.1, 0.4),
        ),
        0.25,
        0.8,
    ),
    "loosening_support": Amount(
        at_plates(at=middle_time, over=uniform(1.0, 4.0), growth=plain), 1.0, 1.0, False
    ),
    "frequency_drift": Amount(lambda a, scene: {"rate": per_campaign(a, scene)}, 0.08, 0.08, False),
    "parametric_stiffness": Amount(
        at_place(
            stiffness=across_gap(0),
            frequency=lambda a, scene: scene.sizes.first / 6.283 * scene.rng.uniform(0.3, 2.5),
            phase=uniform(0.0, 6.28),
        ),
        0.5,
        2.0,
    ),
    "sensor_saturation": Amount(
        lambda a, scene: {"channel": scene.channel, "fraction": 1.0 / a}, 4.0, 12.0
    ),
    "wrong_section": Amount(
        lambda a, scene: {"diameter": either_way(a, scene), "wall": 1.0 + 2.0 * sign(scene) * a},
        0.06,
        0.15,
    ),
    "wrong_length": Amount(lambda a, scene: {"factor": either_way(a, scene)}, 0.06, 0.12),
    "loose_mass": Amount(
        lambda a, scene: {
            "mass": a * scene.mass,
            "clearance": scene.gap * scene.rng.uniform(0.3, 1.2),
            "place": scene.place,
        },
        0.2,
        0.5,
    ),
    "hysteretic_root": Amount(
        lambda a, scene: {
            "rotation": 12.0 * root(1.0, scene),
            "stiffness": 10.0 * root(1.0, scene),
            "limit": scene.load / a,
        },
        20.0,
        80.0,
    ),
    "drifting_gap": Amount(at_plates(rate=per_campaign), 1.2, 1.2, False),
    "one_sided_stop": Amount(
        at_place(
            stiffness=across_gap(0),
            distance=lambda a, scene: scene.gap * scene.rng.uniform(0.2, 1.0),
        ),
        40.0,
        100.0,
    ),
    "unmeasured_force": Amount(at_place(rms=plain), 1.2, 2.5),
    "tilted_plate": Amount(
        at_plates(
            slope=lambda a, scene: sign(scene) * a * scene.gap / scene.beam.holders[0].height,
            direction=lambda a, scene: str(scene.rng.choice(["x", "y"])),
        ),
        1.2,
        3.0,
    ),
}
