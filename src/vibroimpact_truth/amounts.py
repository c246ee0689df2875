"""How much of each effect: parameters from one amount and a random generator, and the amounts that are "medium" and "strong".

Medium and strong are judged by the excess of the misfit over its floor on the hold-out record (strength.py): 1 to 3 floors, and 3 or more. The
two amounts of a row were measured with `python -m vibroimpact_truth calibrate` on the stand-in tube, 20 s, levels as by default; a draw
takes an amount between them and states the strength that came out. A row without a second amount can not be strong below breaking.
"""

from dataclasses import dataclass

import numpy as np

TUBE_PLACES = ("apex", "bend45_right", "left_leg_upper", "right_leg_upper")


@dataclass(frozen=True)
class Amount:
    """parameters(amount, rng) of an effect and the range of amounts that is medium, and that is strong."""

    parameters: object
    medium: tuple
    strong: tuple | None


def sign(rng):
    """1 or -1."""
    return float(rng.choice([-1.0, 1.0]))


def place(rng):
    """A place of the tube."""
    return str(rng.choice(TUBE_PLACES))


def axis(rng):
    """y mostly, as the drive is along y."""
    return "y" if rng.random() < 0.8 else "x"


def offset(a, rng):
    """A support offset of a [m] in some direction."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return {"offset_x": float(a * np.cos(angle)), "offset_y": float(a * np.sin(angle))}


def dead_load(a, rng):
    """A preload of a [N] in some direction."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    return {"force_x": float(a * np.cos(angle)), "force_y": float(a * np.sin(angle))}


AMOUNTS = {
    "gap": Amount(lambda a, rng: {"factor": 1.0 + a if rng.random() < 0.6 else 1.0 / (1.0 + a)}, (0.15, 0.28), (0.40, 0.60)),
    "contact_stiffness": Amount(lambda a, rng: {"factor": 1.0 / a}, (3.0, 6.0), (12.0, 25.0)),
    "contact_damping": Amount(lambda a, rng: {"damping": a}, (100.0, 300.0), (800.0, 2000.0)),
    "hunt_crossley": Amount(lambda a, rng: {"alpha": a}, (2.0, 5.0), (10.0, 30.0)),
    "hertz": Amount(lambda a, rng: {"coefficient": a}, (2.0e7, 5.0e7), (4.0e6, 1.0e7)),
    "dry_friction": Amount(lambda a, rng: {"mu": a}, (0.1, 0.2), (0.3, 0.5)),
    "support_offset": Amount(offset, (8.0e-5, 1.2e-4), (1.6e-4, 2.4e-4)),
    "foliate_obstacle": Amount(lambda a, rng: {"depth": a, "angle": rng.uniform(0.0, np.pi / 2), "lobes": 4}, (1.0e-4, 2.0e-4), (3.0e-4, 6.0e-4)),
    "preload": Amount(dead_load, (3.0, 6.0), (10.0, 20.0)),
    "plate_flexibility": Amount(lambda a, rng: {"stiffness": 4.0e6 / a, "mass": rng.uniform(0.3, 0.8)}, (3.0, 6.0), (12.0, 25.0)),
    "root_stiffness": Amount(lambda a, rng: {"translation": 1.0e8, "rotation": 1.0e5 / a}, (10.0, 20.0), (40.0, 80.0)),
    "modal_damping": Amount(lambda a, rng: {"factor": a}, (1.6, 2.2), (4.0, 6.0)),
    "mode_frequency_error": Amount(lambda a, rng: {"mode": int(rng.integers(1, 6)), "factor": 1.0 + sign(rng) * a}, (0.02, 0.04), (0.08, 0.12)),
    "added_mass": Amount(lambda a, rng: {"mass": a, "place": place(rng)}, (0.03, 0.06), (0.12, 0.25)),
    "lateral_stinger": Amount(lambda a, rng: {"stiffness": a, "damping": 0.0, "direction": "y"}, (5.0e2, 1.5e3), (4.0e3, 1.0e4)),
    "fluid_added_mass_damping": Amount(lambda a, rng: {"mass": a, "damping": 40.0 * a}, (0.03, 0.06), (0.12, 0.25)),
    "cubic_stiffness": Amount(lambda a, rng: {"stiffness": a, "place": place(rng), "direction": "y"}, (5.0e9, 1.5e10), (5.0e10, 2.0e11)),
    "quadratic_stiffness": Amount(lambda a, rng: {"stiffness": sign(rng) * a, "place": place(rng), "direction": "y"}, (2.0e6, 4.0e6), None),
    "saturation_stiffness": Amount(lambda a, rng: {"stiffness": a, "limit": 4.0e-4 * a, "place": place(rng), "direction": "y"}, (3.0e3, 8.0e3), (2.0e4, 5.0e4)),
    "quadratic_drag": Amount(lambda a, rng: {"drag": a}, (20.0, 50.0), (150.0, 400.0)),
    "coulomb_friction": Amount(lambda a, rng: {"force": a, "place": place(rng), "direction": "y"}, (0.7, 1.5), (4.0, 8.0)),
    "clearance": Amount(lambda a, rng: {"half_gap": 4.0e-4, "stiffness": a, "place": "apex", "direction": "y"}, (5.0e3, 1.0e4), (3.0e4, 1.0e5)),
    "force_misalignment": Amount(lambda a, rng: {"angle": sign(rng) * a}, (0.15, 0.3), (0.5, 0.8)),
    "loose_mass": Amount(lambda a, rng: {"mass": a, "clearance": rng.uniform(1e-4, 4e-4), "place": place(rng)}, (0.05, 0.1), (0.2, 0.4)),
    "hysteretic_root": Amount(lambda a, rng: {"stiffness": 8.0e3, "limit": a, "rotation": 1.2e4}, (0.3, 0.6), (0.05, 0.1)),
    "drifting_gap": Amount(lambda a, rng: {"rate": sign(rng) * a}, (0.003, 0.005), (0.008, 0.011)),
    "one_sided_stop": Amount(lambda a, rng: {"stiffness": a, "distance": rng.uniform(2e-4, 6e-4), "place": place(rng)}, (5.0e3, 1.5e4), (5.0e4, 2.0e5)),
    "unmeasured_force": Amount(lambda a, rng: {"rms": a, "place": place(rng), "direction": axis(rng)}, (0.4, 0.7), (1.2, 2.0)),
    "tilted_plate": Amount(lambda a, rng: {"slope": sign(rng) * a, "plates": "both"}, (0.006, 0.01), (0.015, 0.025)),
}
