"""A model without a scale of its own: twice the load at twice the gap is twice the motion."""

import dataclasses

import numpy as np
import pytest

from tests.support.one_mass import one_mass
from vibroimpact import Case, build_model, check_config, simulate_cases
from vibroimpact.equivalent_support import homogeneity
from vibroimpact.equivalent_support.homogeneity import effects_with_a_scale
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws

SUPPORT = {"name": "stop", "point": "mass", "stiffness_N_per_m": 1.0e6}
ELEMENT = {"name": "joint", "point": "mass", "direction": [1.0, 0.0, 0.0]}
PLANES = {"kind": "planes", "normals_deg": [0.0, 180.0]}
LOBES = {"kind": "lobes", "count": 4, "depth_m": 2.0e-4, "angle_deg": 20.0}

# (support's keys, element's keys, constant force, whether the model is homogeneous)
MODELS = {
    "elastic circle": ({}, {}, 0.0, True),
    "contact damping": ({"damping_N_s_per_m": 50.0}, {}, 0.0, True),
    "friction": ({"friction": 0.3}, {}, 0.0, True),
    "flat stops": ({"profile": PLANES}, {}, 0.0, True),
    "linear element": ({}, {"stiffness_N_per_m": 1.0e4, "damping_N_s_per_m": 5.0}, 0.0, True),
    "gap fixed": ({"gap_m": 1.0e-4}, {}, 0.0, False),
    "preload": ({"gap_m": -1.0e-5, "profile": PLANES}, {}, 0.0, False),
    "touching": ({"gap_m": 0.0, "profile": PLANES}, {}, 0.0, True),
    "offset": ({"centre_offset_m": [5.0e-5, 0.0]}, {}, 0.0, False),
    "Hertz": ({"hertz_N_per_m15": 1.0e8}, {}, 0.0, False),
    "Hunt-Crossley": ({"hunt_crossley_s_per_m": 2.0}, {}, 0.0, False),
    "lobes": ({"profile": LOBES}, {}, 0.0, False),
    "unequal stops": ({"profile": PLANES | {"extra_gap_m": [0.0, 5e-5]}}, {}, 0.0, False),
    "cubic": ({}, {"cubic_N_per_m3": 1.0e12}, 0.0, False),
    "quadratic": ({}, {"quadratic_N_per_m2": 1.0e7}, 0.0, False),
    "drag": ({}, {"drag_N_s2_per_m2": 50.0}, 0.0, False),
    "damper limit": ({}, {"damping_N_s_per_m": 50.0, "damping_limit_N": 2.0}, 0.0, False),
    "slider": ({}, {"slip_limit_N": 2.0, "stick_stiffness_N_per_m": 1.0e5}, 0.0, False),
    "saturation": (
        {},
        {"saturation_stiffness_N_per_m": 1.0e5, "saturation_limit_N": 2.0},
        0.0,
        False,
    ),
    "constant force": ({}, {}, 3.0, False),
}


def configuration(support, element, constant):
    """A mass on a spring with a support, shaken by a random force."""
    dead = [{"point": "mass", "direction": [1.0, 0.0, 0.0], "force_N": constant}]
    force = one_mass(63165.0)["excitation"] | {"constant": dead if constant else []}
    values = one_mass(
        63165.0,
        supports=[SUPPORT | support],
        elements=[ELEMENT | element] if element else [],
        excitation=force,
        integration={"start_up_s": 0.5},
        grid={"load_rms_N": [10.0], "gap_m": [1.0e-4], "seeds": 1},
        record={"duration_s": 2.0},
    )
    return check_config(values, "mass")


@pytest.mark.parametrize("name", MODELS)
def test_equal_load_over_gap_is_equal_motion_over_gap(name):
    support, element, constant, homogeneous = MODELS[name]
    config = configuration(support, element, constant)
    model = build_model(config)
    assert (effects_with_a_scale(model) == []) == homogeneous
    cases = [Case(10.0, 1.0e-4, 0), Case(20.0, 2.0e-4, 0)]
    small, large = (
        record["displacement"].values for _, record in simulate_cases(config, model, cases)
    )
    ratio = np.sqrt(np.mean(large**2) / np.mean(small**2))
    if homogeneous:
        assert ratio == pytest.approx(2.0, rel=1e-6)
    else:
        assert abs(ratio - 2.0) > 1e-3


def test_every_term_of_a_force_law_has_been_judged():
    """A new column of the laws must be tried above, and named here or in homogeneity.py."""
    of_degree_one = {
        "contact": {"damping", "friction", "stick_stiffness", "lobes", "lobe_angle"},
        "local": {"stiffness", "damping", "stick_stiffness", "saturation_stiffness"},
    }
    no_force = {"land_point", "land_normal", "drag_partner"}
    for law, name, judged in (
        (ContactLaws, "contact", {"gap", "land_extra_gap", *homogeneity.CONTACT_TERMS}),
        (LocalLaws, "local", {*homogeneity.ELEMENT_TERMS}),
    ):
        columns = {field.name for field in dataclasses.fields(law)}
        assert columns - no_force == judged | of_degree_one[name]
