"""A cantilever with a stop as a user's finite-element matrices: Hermite beam elements, two planes.

The other code makes campaigns of the same cantilever.
"""

import numpy as np
import yaml
from scipy import sparse

from evidence.truth.campaign import Plan, make_campaign
from evidence.truth.geometry import Holder, Straight
from evidence.truth.model_file import model_of
from vibroimpact.config.reading import load_config

LENGTH_M, ELEMENTS, STOP = 1.2, 24, "n21"
BEAM = Straight(
    outer_diameter=0.020,
    wall=0.0015,
    length=LENGTH_M,
    axis="z",
    ends=("clamped", "free"),
    drive=0.4,
    first_damping=0.01,
    other_damping=0.006,
    holders=(Holder(name="stop", arc=1.05, height=0.002, stiffness=2.0e6, nodes=1),),
)
CHANNELS = (
    (0.25, "x", "acceleration"),
    (0.6, "y", "acceleration"),
    (0.85, "x", "acceleration"),
    (0.85, "y", "acceleration"),
    (1.2, "y", "displacement"),
    (1.2, "x", "displacement"),
)
LEVELS = (
    (0.12, 1.3, "fit"),
    (0.6, 1.3, "fit"),
    (2.0, 1.3, "fit"),
    (8.0, 1.3, "fit"),
    (8.0, 1.3, "holdout"),
)


def element(length, bending, mass):
    """Stiffness and mass (4, 4) of a beam element, N/m and kg, for deflections and slopes."""
    a = length
    stiffness = [
        [12, 6 * a, -12, 6 * a],
        [6 * a, 4 * a * a, -6 * a, 2 * a * a],
        [-12, -6 * a, 12, -6 * a],
        [6 * a, 2 * a * a, -6 * a, 4 * a * a],
    ]
    inertia = [
        [156, 22 * a, 54, -13 * a],
        [22 * a, 4 * a * a, 13 * a, -3 * a * a],
        [54, 13 * a, 156, -22 * a],
        [-13 * a, -3 * a * a, -22 * a, 4 * a * a],
    ]
    return bending / a**3 * np.array(stiffness), mass * a / 420.0 * np.array(inertia)


def matrices():
    """Mass and stiffness of the clamped beam, x and y in turn; nodes n1 to n24 from the clamp."""
    section, count = BEAM.section, 2 * ELEMENTS + 2
    each = element(LENGTH_M / ELEMENTS, section["EI"], section["mass"])
    whole = np.zeros((2, count, count))
    for number in range(ELEMENTS):
        own = slice(2 * number, 2 * number + 4)
        whole[0, own, own] += each[1]
        whole[1, own, own] += each[0]
    return [sparse.block_diag([one[2:, 2:]] * 2, format="csr") for one in whole]


def plan(seed=(7, 1), effects=(), **changes):
    """The Plan of a campaign of the cantilever."""
    given = {"duration": 16.0, "band": (5.0, 300.0), "noise": 0.005, "levels": LEVELS}
    return Plan(
        seed=seed,
        effects=effects,
        tube=BEAM,
        channels=CHANNELS,
        drive_direction=(0.6, 0.8, 0.0),
        **(given | changes),
    )


def model_values(folder):
    """The configuration with the matrices, written into a folder, in plain values."""
    for name, matrix in zip(("mass", "stiffness"), matrices(), strict=True):
        sparse.save_npz(folder / f"{name}.npz", matrix)
    nodes, step = range(1, ELEMENTS + 1), LENGTH_M / ELEMENTS
    given = model_of(plan())
    return given | {
        "study": "own_matrices",
        "structure": {
            "kind": "matrices",
            "mass": str(folder / "mass.npz"),
            "stiffness": str(folder / "stiffness.npz"),
            "points": {f"n{i}": {"x": 2 * (i - 1), "y": 2 * (ELEMENTS + i - 1)} for i in nodes},
        },
        "points": {f"n{i}": [0.0, 0.0, round(step * i, 6)] for i in nodes},
        "supports": [{"name": "stop", "point": STOP, "stiffness_N_per_m": 2.0e6}],
        "excitation": given["excitation"] | {"point": "n8"},
        "record": {"duration_s": 10.0, "sensors": {"points": ["n5"], "directions": ["x", "y"]}},
    }


def checked(values, folder):
    """The checked Config of plain values."""
    path = folder / "own.yaml"
    path.write_text(yaml.safe_dump(values))
    return load_config(str(path))


def campaign_file(folder, effects=(), **changes):
    """Path of a campaign of the cantilever."""
    path = folder / "campaign.nc"
    make_campaign(plan(effects=effects, **changes), path, twin=False)
    return path
