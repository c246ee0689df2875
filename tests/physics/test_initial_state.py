"""A tube that starts with a displacement or a velocity: fields, their energy, what is refused."""

import copy

import numpy as np
import pytest

from tests.support.straight_path import straight_path
from vibroimpact.config.reading import ConfigError, check_config
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.beam_elements import section_beam
from vibroimpact.study.cases import all_cases
from vibroimpact.study.simulation import simulate_cases

LENGTH = 0.8
TUBE = {
    "study": "initial",
    "structure": straight_path(
        LENGTH,
        [0.0, 0.0, 1.0],
        {"outer_diameter_m": 0.014, "wall_thickness_m": 0.002},
        (1.5e11, 0.3, 6000.0),
        theory="euler_bernoulli",
        mesh={"elements_per_span": 40},
    ),
    "damping": {"kind": "modal", "other_ratio": 0.0},
    # without force: it shows the displacement of the tip at every step
    "elements": [{"name": "tip", "point": "tip", "direction": [1.0, 0.0, 0.0]}],
    "points": {"tip": [0.0, 0.0, LENGTH]},
    "excitation": {"kind": "none"},
    "basis": {"free_modes_to_Hz": 5000.0},
    "integration": {"steps_per_second": 50000, "start_up_s": 0.0, "imperfection": 0.0},
    "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
    "record": {
        "duration_s": 0.02,
        "every_step": True,
        "sensors": {"points": ["tip"], "directions": ["x"]},
        "shape_line": {"direction": "x"},
    },
}
TURNING = {"kind": "rigid", "rotation_rad_per_s": [0.0, -3.8, 0.0]}


def tube(start="clamped", **keys):
    """The mapping of the tube with its start held in another way and top-level keys changed."""
    mapping = copy.deepcopy(TUBE) | keys
    mapping["structure"]["start"] = {"kind": start}
    return mapping


def model_of(**keys):
    return build_model(check_config(tube(**keys), "initial"), motion_only=True)


def beam():
    structure = check_config(tube(), "initial").structure
    return section_beam(structure.section, structure.material, "euler_bernoulli")


def places(function, count, key):
    """The values of a field along the tube at evenly spaced places."""
    return {
        "kind": "places",
        "values": [
            {"at_m": [0.0, 0.0, z], key: [function(z), 0.0, 0.0]}
            for z in np.linspace(0.0, LENGTH, count).tolist()
        ],
    }


def test_energy_of_a_turning_beam():
    """m w² L³ / 6 for the velocity w s; nothing is lost, and only the rigid motion moves."""
    model = model_of(start="pinned", initial={"velocity": TURNING})
    energy = 0.5 * np.sum(model.initial_velocity**2)
    assert energy == pytest.approx(beam().mass_per_length * 3.8**2 * LENGTH**3 / 6.0, rel=1e-9)
    assert model.initial_residual[1] < 1e-9
    assert np.abs(model.initial_velocity[model.omega > 0.0]).max() < 1e-9


def test_a_line_through_two_places_is_the_rigid_rotation():
    by_places = {"velocity": places(lambda z: -3.8 * z, 2, "velocity_m_per_s")}
    assert model_of(start="pinned", initial=by_places).initial_velocity == pytest.approx(
        model_of(start="pinned", initial={"velocity": TURNING}).initial_velocity, abs=1e-9
    )


def test_a_rigid_field_turns_about_its_point():
    """v = t + w x (p - c): at the tip and at the middle."""
    field = {
        "kind": "rigid",
        "translation_m_per_s": [0.5, 0.0, 0.2],
        "rotation_rad_per_s": [0.0, 2.0, 0.0],
        "about_m": [0.3, 0.0, 0.4],
    }
    model = model_of(start="free", initial={"velocity": field})
    tip = model.sensor_shapes.T @ model.initial_velocity
    assert tip == pytest.approx([0.5 + 2.0 * (LENGTH - 0.4)], rel=1e-9)
    mass = beam().mass_per_length * LENGTH
    centre = np.array([0.5, 0.2 + 2.0 * 0.3])  # along x and z, at z = 0.4: v_z = 0.2 - w (x - c)
    turning = beam().mass_per_length * LENGTH**3 / 12.0 * 2.0**2
    assert np.sum(model.initial_velocity**2) == pytest.approx(
        mass * centre @ centre + turning, rel=1e-6
    )


def test_a_mode_shape_swings_with_its_frequency():
    """The second bending mode of a cantilever, (4.694 / L)² sqrt(EI / m)."""
    field = {"kind": "mode", "number": 2, "point": "tip", "direction": "x", "amplitude_m": 2.0e-3}
    config = check_config(tube(initial={"displacement": field}), "initial")
    ((_, record),) = simulate_cases(
        config, build_model(config, motion_only=True), all_cases(config.grid)
    )
    omega = (4.694091133 / LENGTH) ** 2 * np.sqrt(
        beam().planes[0].bending_stiffness / beam().mass_per_length
    )
    expected = 2.0e-3 * np.cos(omega * record["step_time"].values)
    assert record["element_displacement"].values[0] == pytest.approx(expected, abs=2e-5)


def test_a_static_deflection_has_its_strain_energy():
    """A cantilever bent by a force at its tip, given at nine places: F² L³ / 6 EI."""
    force, stiffness = 40.0, beam().planes[0].bending_stiffness
    field = places(lambda z: force * z**2 * (3 * LENGTH - z) / (6 * stiffness), 9, "displacement_m")
    model = model_of(initial={"displacement": field})
    energy = 0.5 * np.sum((model.omega * model.initial_displacement) ** 2)
    assert energy == pytest.approx(force**2 * LENGTH**3 / (6.0 * stiffness), rel=2e-3)
    assert model.initial_residual[0] < 1e-4


def test_the_initial_state_starts_from_static_equilibrium():
    bar = {
        "name": "bar",
        "at_m": [0.0, 0.0, LENGTH],
        "height_m": 0.01,
        "points": 1,
        "stiffness_N_per_m": 1.0e5,
        "preload_N": 10.0,
        "profile": {"kind": "bars", "normal": [1.0, 0.0, 0.0], "sides": "one"},
    }
    push = {"kind": "mode", "number": 1, "point": "tip", "direction": "x", "amplitude_m": 1.0e-3}
    config = check_config(tube(supports=[bar], initial={"displacement": push}), "initial")
    ((_, record),) = simulate_cases(
        config, build_model(config, motion_only=True), all_cases(config.grid)
    )
    rest = -10.0 * LENGTH**3 / (3.0 * beam().planes[0].bending_stiffness)
    assert record["contact_displacement"].values[0, 0, 0] == pytest.approx(rest + 1.0e-3, rel=1e-3)
    assert record["contact_force"].values[0, 0, 0] == pytest.approx(-110.0, rel=1e-3)


REFUSED = {
    "held end": (
        {"velocity": {"kind": "rigid", "translation_m_per_s": [1.0, 0.0, 0.0]}},
        "initial.velocity: the field moves or turns the start of the tube, which is held",
    ),
    "turned end": (
        {"velocity": TURNING},
        "moves or turns the start of the tube, which is held",
    ),
    "too fine": (
        {"velocity": places(lambda z: z**2 * np.cos(400.0 * z), 161, "velocity_m_per_s")},
        "represent the field with a residual of .* raise basis.free_modes_to_Hz",
    ),
    "no such mode": (
        {
            "velocity": {
                "kind": "mode",
                "number": 50,
                "point": "tip",
                "direction": "x",
                "amplitude_m_per_s": 0.1,
            }
        },
        "initial.velocity.number = 50: .* modes move tip along x",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_field_that_the_tube_can_not_have_is_refused(case):
    initial, message = REFUSED[case]
    with pytest.raises(ValueError, match=message):
        model_of(initial=initial)


MISTAKES = [
    ({"velocity_m_per_s": {"tip": {"x": 1.0}}}, ["initial = 'given'", "give initial.displacement"]),
    (
        {"velocity": {"kind": "mode", "number": 1, "point": "top", "direction": "x",
                      "amplitude_m_per_s": 0.1}},
        ["initial.velocity.point = 'top'", "known are tip"],
    ),
    (
        {"velocity": places(lambda z: z, 5, "velocity_m_per_s") | {"values": [
            {"at_m": [0.0, 0.0, 0.1], "velocity_m_per_s": [0.0, 0.0, 0.0]},
            {"at_m": [0.0, 0.0, LENGTH], "velocity_m_per_s": [1.0, 0.0, 0.0]},
        ]}},
        ["initial.velocity.values[0].at_m", "not the start of the tube", "[0.0, 0.0, 0.0]"],
    ),
    (
        {"displacement": {"kind": "places", "values": [
            {"at_m": [0.0, 0.0, z], "displacement_m": [0.0, 0.0, 0.0]} for z in (0.0, 0.5, 0.3, 0.8)
        ]}},
        ["initial.displacement.values[2].at_m", "not after the place before it"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("initial", "parts"), MISTAKES)
def test_a_wrong_initial_state_is_named_with_its_remedy(initial, parts):
    with pytest.raises(ConfigError) as refusal:
        check_config(tube(initial=initial), "mine")
    assert any(all(part in line for part in parts) for line in refusal.value.problems), (
        refusal.value.problems
    )


def test_a_chain_takes_a_mode_but_no_rigid_field():
    chain = {
        "study": "chain",
        "structure": {
            "kind": "chain",
            "masses": [{"name": "a", "mass_kg": 2.0}, {"name": "b", "mass_kg": 1.0}],
            "springs": [
                {"between": ["ground", "a"], "stiffness_N_per_m": 3.0e3},
                {"between": ["a", "b"], "stiffness_N_per_m": 1.0e3},
            ],
        },
        "damping": {"kind": "modal", "other_ratio": 0.0},
        "excitation": {"kind": "none"},
        "grid": {"load_rms_N": [1.0], "gap_m": [1.0], "seeds": 1},
        "record": {"duration_s": 0.5, "every_step": True},
        "integration": {"start_up_s": 0.0},
    }
    mode = {"kind": "mode", "number": 2, "point": "b", "direction": "x", "amplitude_m": 0.1}
    model = build_model(check_config(chain | {"initial": {"displacement": mode}}, "chain"))
    assert model.initial_displacement[0] == 0.0
    assert model.sensor_shapes[:, 1] @ model.initial_displacement == pytest.approx(0.1)
    with pytest.raises(ConfigError, match="initial.velocity.kind = 'rigid' is for tubes"):
        check_config(chain | {"initial": {"velocity": TURNING}}, "chain")
