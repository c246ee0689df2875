"""The amount of each effect: its parameters from one number, and ranges for "medium" and "strong".

The strength of an effect is the excess of the misfit over its floor on the hold-out record
(strength.py): medium is 1 to 3 floors, strong 3 or more. The ranges were measured with `python -m
vibroimpact_truth calibrate` on the stand-in tube, 20 s, default levels. A draw takes an amount
within the range and states the strength that results. Where there is no second range, no amount
below breaking is strong.
"""

from dataclasses import dataclass

import numpy as np

TUBE_PLACES = ("apex", "bend45_right", "left_leg_upper", "right_leg_upper")


@dataclass(frozen=True)
class Amount:
    """The amounts of an effect.

    parameters: function (amount, rng) that returns the parameters of the effect.
    medium, strong: ranges of the amount; strong is None where there is none.
    """

    parameters: object
    medium: tuple
    strong: tuple | None


def sign(rng):
    """1 or -1, at random."""
    return float(rng.choice([-1.0, 1.0]))


def place(rng):
    """A place of the tube, at random."""
    return str(rng.choice(TUBE_PLACES))


def axis(rng):
    """ "y" in most cases, as the drive is along y, else "x"."""
    return "y" if rng.random() < 0.8 else "x"


def offset(a, rng):
    """A support offset of a [m] in a random direction."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return {"offset_x": float(a * np.cos(angle)), "offset_y": float(a * np.sin(angle))}


def dead_load(a, rng):
    """A preload of a [N] in a random direction."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return {"force_x": float(a * np.cos(angle)), "force_y": float(a * np.sin(angle))}


AMOUNTS = {
    "gap": Amount(
        lambda a, rng: {"factor": 1.0 + a if rng.random() < 0.6 else 1.0 / (1.0 + a)},
        (0.2, 0.45),
        (0.7, 1.0),
    ),
    "contact_stiffness": Amount(lambda a, rng: {"factor": 1.0 / a}, (3.5, 6.0), (9.0, 20.0)),
    "contact_damping": Amount(lambda a, rng: {"damping": a}, (90.0, 220.0), (330.0, 900.0)),
    "hunt_crossley": Amount(lambda a, rng: {"alpha": a}, (1.0, 4.0), (6.0, 20.0)),
    "hertz": Amount(lambda a, rng: {"coefficient": a}, (1.3e7, 2.2e7), (3.0e6, 8.0e6)),
    "dry_friction": Amount(lambda a, rng: {"mu": a}, (0.05, 0.12), (0.2, 0.5)),
    "support_offset": Amount(offset, (9.0e-5, 2.0e-4), (2.6e-4, 4.0e-4)),
    "foliate_obstacle": Amount(
        lambda a, rng: {"depth": a, "angle": rng.uniform(0.0, np.pi / 2), "lobes": 4},
        (3.0e-5, 8.0e-5),
        (1.2e-4, 4.0e-4),
    ),
    "preload": Amount(dead_load, (8.0, 16.0), (22.0, 40.0)),
    "plate_flexibility": Amount(
        lambda a, rng: {"stiffness": 4.0e6 / a, "mass": rng.uniform(0.3, 0.8)},
        (1.2, 2.5),
        (5.0, 20.0),
    ),
    "root_stiffness": Amount(
        lambda a, rng: {"translation": 1.0e8, "rotation": 1.0e5 / a}, (8.0, 20.0), (80.0, 250.0)
    ),
    "modal_damping": Amount(lambda a, rng: {"factor": a}, (1.8, 3.0), (6.0, 10.0)),
    "mode_frequency_error": Amount(
        lambda a, rng: {"mode": int(rng.integers(1, 6)), "factor": 1.0 + sign(rng) * a},
        (0.08, 0.14),
        (0.18, 0.25),
    ),
    "added_mass": Amount(lambda a, rng: {"mass": a, "place": place(rng)}, (0.1, 0.22), (0.35, 0.6)),
    "lateral_stinger": Amount(
        lambda a, rng: {"stiffness": a, "damping": 0.0, "direction": "y"},
        (1.8e3, 3.0e3),
        (4.5e3, 1.0e4),
    ),
    "fluid_added_mass_damping": Amount(
        lambda a, rng: {"mass": a, "damping": 40.0 * a}, (0.03, 0.06), (0.1, 0.25)
    ),
    "cubic_stiffness": Amount(
        lambda a, rng: {"stiffness": a, "place": place(rng), "direction": "y"},
        (6.0e10, 1.5e11),
        (4.0e11, 1.5e12),
    ),
    "quadratic_stiffness": Amount(
        lambda a, rng: {"stiffness": sign(rng) * a, "place": "apex", "direction": "y"},
        (6.0e5, 1.2e6),
        None,
    ),
    "saturation_stiffness": Amount(
        lambda a, rng: {"stiffness": a, "limit": 4.0e-4 * a, "place": place(rng), "direction": "y"},
        (2.5e4, 4.0e4),
        (6.0e4, 2.0e5),
    ),
    "quadratic_drag": Amount(lambda a, rng: {"drag": a}, (6.0, 14.0), (30.0, 200.0)),
    "coulomb_friction": Amount(
        lambda a, rng: {"force": a, "place": place(rng), "direction": "y"}, (1.8, 3.0), (4.0, 9.0)
    ),
    "clearance": Amount(
        lambda a, rng: {"half_gap": 4.0e-4, "stiffness": a, "place": "apex", "direction": "y"},
        (1.5e3, 3.5e3),
        (8.0e3, 6.0e4),
    ),
    "force_misalignment": Amount(lambda a, rng: {"angle": sign(rng) * a}, (0.2, 0.4), (0.55, 0.9)),
    "loose_mass": Amount(
        lambda a, rng: {"mass": a, "clearance": rng.uniform(1e-4, 4e-4), "place": place(rng)},
        (0.04, 0.12),
        (0.2, 0.5),
    ),
    "hysteretic_root": Amount(
        lambda a, rng: {"stiffness": 1.0e4, "limit": a, "rotation": 1.2e4}, (0.1, 0.2), (0.3, 0.8)
    ),
    "drifting_gap": Amount(
        lambda a, rng: {"rate": a if rng.random() < 0.6 else -0.6 * a}, (0.006, 0.01), (0.012, 0.02)
    ),
    "one_sided_stop": Amount(
        lambda a, rng: {"stiffness": a, "distance": rng.uniform(5e-5, 3e-4), "place": place(rng)},
        (3.0e4, 1.0e5),
        (2.0e5, 6.0e5),
    ),
    "unmeasured_force": Amount(
        lambda a, rng: {"rms": a, "place": place(rng), "direction": axis(rng)},
        (0.4, 0.7),
        (1.2, 2.0),
    ),
    "tilted_plate": Amount(
        lambda a, rng: {"slope": sign(rng) * a, "plates": "both"}, (0.002, 0.005), (0.007, 0.015)
    ),
}
