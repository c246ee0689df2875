"""Bars that press a structure at rest: static forces, with the flexibility of the structure."""

import numpy as np
import pytest

from tests.support.one_mass import one_mass
from tests.support.oscillator import oscillator
from tests.support.straight_path import straight_path
from vibroimpact.config.reading import check_config
from vibroimpact.integration.every_step import integrate_every_step
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.beam_elements import section_beam
from vibroimpact.study.cases import all_cases
from vibroimpact.study.simulation import simulate_cases

LENGTH, PLACE, STIFFNESS = 1.2, 0.8, 2.0e5


def bar(**keys):
    """A bar across a straight tube along z, with one contact point."""
    profile = {"kind": "bars", "normal": [0.0, 1.0, 0.0], "sides": "one"} | keys.pop("profile", {})
    return {
        "name": "bar",
        "at_m": [0.0, 0.0, PLACE],
        "height_m": 0.01,
        "points": 1,
        "stiffness_N_per_m": STIFFNESS,
        "profile": profile,
    } | keys


def cantilever(*supports, **sections):
    """A clamped straight tube with a free end, without a force, recorded at every step."""
    return check_config(
        {
            "study": "bars",
            "structure": straight_path(
                LENGTH,
                [0.0, 0.0, 1.0],
                {"outer_diameter_m": 0.019, "wall_thickness_m": 0.001},
                (2.0e11, 0.3, 8000.0),
                theory="euler_bernoulli",
            ),
            "damping": {"kind": "modal", "other_ratio": 0.0},
            "supports": list(supports),
            "points": {"tip": [0.0, 0.0, LENGTH]},
            "excitation": {"kind": "none"},
            "basis": {"free_modes_to_Hz": 4000.0},
            "integration": {"steps_per_second": 40960, "start_up_s": 0.0, "imperfection": 0.0},
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 1},
            "record": {
                "duration_s": 0.05,
                "every_step": True,
                "sensors": {"points": ["tip"], "directions": ["x", "y"]},
            },
        }
        | sections,
        "bars",
    )


def record_of(config):
    """The record of the one case of a configuration."""
    ((_, record),) = simulate_cases(config, build_model(config), all_cases(config.grid))
    return record


def flexibility(config, place=PLACE, other=PLACE):
    """m/N of a cantilever at a place under a force at another: a² (3 b - a) / 6 EI for a <= b."""
    beam = section_beam(config.structure.section, config.structure.material, "euler_bernoulli")
    near, far = sorted((place, other))
    return near**2 * (3.0 * far - near) / (6.0 * beam.planes[0].bending_stiffness)


def test_interference_presses_through_both_flexibilities():
    """delta = P / k + P a³ / 3 EI."""
    config = cantilever(bar(gap_m=-2.0e-4))
    expected = 2.0e-4 / (1.0 / STIFFNESS + flexibility(config))
    record = record_of(config)
    assert record["contact_force"].values[0, 1] == pytest.approx(-expected, rel=1e-4)
    assert record["contact_displacement"].values[0, 1] == pytest.approx(
        -expected * flexibility(config), rel=1e-4
    )


def test_a_preload_is_the_static_force_of_the_bar():
    """From the first step on, and the same as the interference that it takes."""
    config = cantilever(bar(preload_N=25.0))
    record = record_of(config)
    assert record["contact_force"].values[0, 1] == pytest.approx(-25.0, rel=1e-4)
    assert np.abs(record["contact_force"].values[0, 0]).max() < 1e-9
    depth = 25.0 * (1.0 / STIFFNESS + flexibility(config))
    same = record_of(cantilever(bar(gap_m=-depth)))
    for name in ("contact_force", "contact_displacement"):
        assert record[name].values == pytest.approx(same[name].values, rel=1e-3, abs=1e-9)


def test_two_bars_carry_their_preloads_together():
    """Each yields to the force of the other: u = -(C_11 P_1 n_1 + C_12 P_2 n_2)."""
    second = bar(
        name="second",
        at_m=[0.0, 0.0, 0.5],
        preload_N=10.0,
        profile={"normal": [0.5, np.sqrt(0.75), 0.0]},
    )
    config = cantilever(bar(preload_N=25.0), second)
    record = record_of(config)
    force = record["contact_force"].values[..., 100]
    assert force[0] == pytest.approx([0.0, -25.0], abs=2e-3)
    assert force[1] == pytest.approx([-5.0, -10.0 * np.sqrt(0.75)], abs=2e-3)
    own, across = flexibility(config), flexibility(config, PLACE, 0.5)
    assert record["contact_displacement"].values[0, :, 100] == pytest.approx(
        [-5.0 * across, -25.0 * own - 10.0 * np.sqrt(0.75) * across], rel=1e-3
    )


def test_a_dead_load_adds_to_the_preload_of_a_bar_on_a_plate():
    """P + F C_ct / (C_cc + 1 / k + 1 / k_plate): the bar stays in contact, as a spring."""
    plate = {"mass_kg": 0.5, "stiffness_N_per_m": 4.0e5}
    push = {"point": "tip", "direction": [0.0, 1.0, 0.0], "force_N": 3.0}
    excitation = {
        "kind": "band_limited",
        "point": "tip",
        "direction": [0.0, 1.0, 0.0],
        "band_Hz": [5.0, 200.0],
        "constant": [push],
    }
    config = cantilever(
        bar(preload_N=25.0, plate=plate),
        excitation=excitation,
        grid={"load_rms_N": [1.0e-9], "gap_m": [1.0e-3], "seeds": 1},
    )
    soft = flexibility(config) + 1.0 / STIFFNESS + 1.0 / 4.0e5
    expected = 25.0 + 3.0 * flexibility(config, PLACE, LENGTH) / soft
    force = record_of(config)["contact_force"].values[0, 1]
    assert force == pytest.approx(-expected, rel=1e-3)


def test_a_record_of_a_pressed_tube_is_silent():
    """The run starts from static equilibrium: a start-up is needed for the output filter alone."""
    config = cantilever(
        bar(preload_N=25.0, points=3),
        record={
            "duration_s": 0.125,
            "sensors": {"points": ["tip"], "directions": ["x", "y"]},
            "keep_time_series": True,
        },
        spectra={"segment_s": 0.125},
        integration={"start_up_s": 0.0625, "imperfection": 0.0},
    )
    record = record_of(config)
    assert record["rms_force"].values == pytest.approx([25.0], rel=1e-3)
    assert np.abs(record["acceleration"].values).max() < 1e-2
    assert record["support_force"].values[0, 1] == pytest.approx(25.0, rel=1e-3)


def test_a_pressed_pair_is_a_spring_of_both_bars():
    """Neither bar lifts off: omega² = (K + 2 k) / m, and at rest the pair pushes nowhere."""
    stop = {"point": "mass", "stiffness_N_per_m": 1.0e5, "preload_N": 50.0, "name": "pair"}
    config = check_config(
        one_mass(
            5.0e4,
            damping={"kind": "modal", "other_ratio": 0.0},
            supports=[stop | {"profile": {"kind": "bars", "angle_deg": 0.0}}],
            initial={"displacement_m": {"mass": {"x": 1.0e-4}}},
            excitation={"kind": "none"},
            integration={"steps_per_second": 100000, "start_up_s": 0.0, "imperfection": 0.0},
            record={"duration_s": 0.05, "every_step": True},
        ),
        "pair",
    )
    record = record_of(config)
    expected = 1.0e-4 * np.cos(np.sqrt(2.5e5) * record["step_time"].values)
    assert record["contact_displacement"].values[0, 0] == pytest.approx(expected, abs=1e-7)


def test_a_stop_that_is_touched_leaves_the_preload_as_given():
    """The bar pushes the tube on a stop nearer to the clamped end. The bar has its force; the stop
    takes R = (P C_12 - g) / (C_22 + 1 / k).
    """
    stop = bar(
        name="stop", at_m=[0.0, 0.0, 0.5], gap_m=1.0e-4, profile={"normal": [0.0, -1.0, 0.0]}
    )
    config = cantilever(bar(preload_N=25.0), stop)
    force = record_of(config)["contact_force"].values[:, 1]
    pushed = 25.0 * flexibility(config, PLACE, 0.5) - 1.0e-4
    expected = pushed / (flexibility(config, 0.5, 0.5) + 1.0 / STIFFNESS)
    assert expected > 10.0
    assert force[0] == pytest.approx(-25.0, rel=1e-3)
    assert force[1] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("cubic", [0.0, 2.0e10])
def test_a_spring_beside_the_structure_takes_its_share(cubic):
    """K u + c u³ = P at rest, of a Hertzian contact with h p^1.5 = P."""
    spring = {"name": "spring", "point": "mass", "direction": [1.0, 0.0, 0.0]}
    config = check_config(
        one_mass(
            5.0e4,
            damping={"kind": "modal", "other_ratio": 0.0},
            elements=[spring | {"cubic_N_per_m3": cubic}],
            supports=[
                {
                    "name": "bar",
                    "point": "mass",
                    "stiffness_N_per_m": 1.0e5,
                    "hertz_N_per_m15": 1.0e7,
                    "preload_N": 50.0,
                    "profile": {"kind": "bars", "angle_deg": 180.0, "sides": "one"},
                }
            ],
            excitation={"kind": "none"},
            integration={"steps_per_second": 50000, "start_up_s": 0.0, "imperfection": 0.0},
            record={"duration_s": 0.05, "every_step": True},
        ),
        "spring",
    )
    record = record_of(config)
    u = record["contact_displacement"].values[0, 0]
    assert 5.0e4 * u + cubic * u**3 == pytest.approx(50.0, rel=1e-4)
    assert record["contact_force"].values[0, 0] == pytest.approx(50.0, rel=1e-4)


def test_a_pair_presses_a_structure_that_nothing_else_holds():
    """A bar on one side would push it away, and is refused."""
    loose = cantilever(bar(preload_N=5.0, profile={"sides": "both"}))
    free = loose.structure.model_copy(update={"start": loose.structure.end})
    record = record_of(loose.model_copy(update={"structure": free}))
    assert np.abs(record["contact_displacement"].values).max() < 1e-12
    single = cantilever(bar(preload_N=5.0)).model_copy(update={"structure": free})
    with pytest.raises(ValueError, match="can move freely .* no static equilibrium: hold an end"):
        build_model(single, motion_only=True)


@pytest.mark.parametrize("load", [2.0, 12.0])
def test_friction_of_a_pressed_pair_holds_up_to_its_limit(load):
    """A load across sticks below 2 mu P = 8 N, and slides to (F - 2 mu P) / K above."""
    stiffness, press, friction, contact = 1.0e4, 20.0, 0.2, 1.0e6
    model = oscillator(
        1.0,
        stiffness,
        damping=2.0 * np.sqrt(stiffness),
        contact_stiffness=contact,
        lands=[(1.0, 0.0), (-1.0, 0.0)],
        contact={"gap": -press / contact, "friction": friction, "stick_stiffness": contact},
        dead_load=(0.0, load),
    )
    run = integrate_every_step(
        model,
        100_000,
        60_000,
        np.ones(1),
        np.zeros((1, 2, 1)),
        lambda first, count: np.zeros((count, 1, 1)),
    )
    limit = 2.0 * friction * press
    held = load / (stiffness + 2.0 * contact)
    expected = held if load < limit else (load - limit) / stiffness
    assert run.contact_displacement[0, 0, 1, -1] == pytest.approx(expected, rel=0.02)
