"""Each effect does the same to a tube wherever it points: a structure turned with its force, its
supports and its effect has the same receptances.
"""

import numpy as np
import pytest

from tests.support.effect_values import term_at, with_term
from vibroimpact.config.reading import check_config
from vibroimpact.effects.registry import EFFECTS
from vibroimpact.reduction.reduced_model import build_model

TURNED = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # x to y to z to x
AXES = {"along_x": "along_y", "along_y": "along_z", "along_z": "along_x"}
SIZES = {
    "one": 1.0,
    "gap": 1e-4,
    "load": 1.0,
    "displacement": 1e-4,
    "contact_stiffness": 3e6,
    "hertz": 1e8,
    "gap_force": 1.0,
    "mass": 1.0,
    "mass_per_length": 0.5,
    "tube_translation": 1e4,
    "tube_rotation": 1e3,
    "tube_damping": 5.0,
    "tube_length": 2.0,
    "damping_per_length": 5.0,
    "cubic": 1e12,
    "quadratic": 1e8,
    "slowness": 10.0,
    "drag": 10.0,
}
FREQUENCY = np.array([7.0, 33.0, 81.0, 140.0])  # Hz
# turned about z by its definition: a tube on its side has the effect about its own axis
ABOUT_Z = "force_misalignment", "about_z"


def structure(turn):
    """The configuration in plain values of a tube with two supports, turned by `turn` (3, 3)."""

    def at(*place):
        return [float(x) for x in turn @ np.array(place)]

    support = {"height_m": 0.02, "points": 3, "stiffness_N_per_m": 3.0e6}
    values = {
        "study": "turned",
        "structure": {
            "kind": "path",
            "section": {"kind": "tube", "outer_diameter_m": 0.0177, "wall_thickness_m": 0.001},
            "material": {
                "young_modulus_Pa": 2.0e11,
                "poisson_ratio": 0.3,
                "density_kg_per_m3": 8000.0,
            },
            "start_m": at(0, 0, 0),
            "start_direction": at(0, 0, 1),
            "segments": [{"kind": "straight", "length_m": 2.0}],
            "start": {"kind": "clamped"},
            "end": {"kind": "pinned"},
        },
        "supports": [
            {"name": "low", "at_m": at(0, 0, 0.7), **support},
            {"name": "high", "at_m": at(0, 0, 1.4), **support},
        ],
        "points": {"shaker": at(0, 0, 0.3), "span": at(0, 0, 1.1)},
        "excitation": {
            "kind": "band_limited",
            "point": "shaker",
            "direction": at(1, 0, 0),
            "band_Hz": [5, 200],
        },
        "grid": {"load_rms_N": [1.0], "gap_m": [1e-4], "seeds": 1},
        "record": {"sensors": {"points": ["span"], "directions": ["x", "y", "z"]}},
    }
    return check_config(values, "turned").model_dump(mode="json")


def receptances(values):
    """(number,): from the force to itself, to the supports and to the elements."""
    model = build_model(check_config(values, "turned"))
    own = 1.0 / (
        model.omega**2
        - (2.0 * np.pi * FREQUENCY[:, None]) ** 2
        + 2j * np.pi * FREQUENCY[:, None] * model.damping
    )
    rows = [model.drive_shapes, model.element_shapes]
    rows += [
        model.contact_shapes[:, model.support_of_point == number].mean(axis=1)
        for number in range(len(model.support_names))
    ]
    shapes = np.hstack(rows)
    driven = own * model.drive_shapes[:, 0]
    return np.concatenate([(driven @ shapes).ravel(), model.constant_force])


@pytest.mark.parametrize(
    "effect", [each for each in EFFECTS.values() if not each.measured], ids=lambda each: each.id
)
def test_an_effect_turns_with_its_structure(effect):
    upright, lying = structure(np.eye(3)), structure(TURNED)
    places = [at for at in effect.locations(upright) if (effect.id, at) != ABOUT_Z]
    for place in places[:4]:
        turned = AXES.get(place, place)
        assert turned in effect.locations(lying)
        one, other = (
            receptances(with_term(values, term_at(effect.id, own, 0.6, SIZES)))
            for values, own in ((upright, place), (lying, turned))
        )
        np.testing.assert_allclose(other, one, atol=1e-9 * np.abs(one).max())
