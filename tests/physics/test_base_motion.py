"""A structure on a moving base: the model of a campaign against the study's own, against the
independent code, and what sensors show of the base.
"""

import numpy as np
import pytest

from evidence.truth.campaign import Plan, forces
from evidence.truth.campaign import simulate_records as true_records
from vibroimpact.campaign.base_motion import integrated, relative_to_base
from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.campaign.signals import campaign_signals
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.signals import signals_of
from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.diagnosis.measurement.stretches import rates_of
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.identify.linear.responses import frf
from vibroimpact.reduction.reduced_model import build_model

RATE, GAP = 2048.0, 2.8886e-4
APEX, LEG = (0.0, 0.0, 1.0), (-0.3, 0.0, 0.55)
X, Y, SLANTED = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.6, 0.8, 0.0)
NOWHERE = (np.nan,) * 3
UNITS = {"displacement": "m", "velocity": "m s-1", "acceleration": "m s-2"}


def on_base(acceleration, response, channels, direction=Y, **attributes):
    """A campaign of one record on a base with an acceleration (time,)."""
    described = [
        Channel(name, place, way, UNITS[kind], kind) for name, place, way, kind in channels
    ]
    table = Channel("table", NOWHERE, direction, "m s-2", "base_acceleration")
    return campaign_dataset(
        np.asarray(acceleration)[None, None],
        np.asarray(response)[None],
        described,
        [table],
        [Level("only", GAP)],
        RATE,
        **attributes,
    )


def silent(channels, direction=Y):
    return on_base(np.ones(256), np.zeros((len(channels), 256)), channels, direction)


def with_base_motion(config, **changes):
    """The configuration of a study in which the base moves along a slanted direction."""
    values = config.model_dump(mode="json") | changes
    signal = {"kind": "band_limited", "band_Hz": [5.0, 200.0]}
    values["excitation"] = {
        "kind": "base_motion",
        "direction": list(SLANTED),
        "obstacles": "moving",
        "signal": signal,
    }
    values["record"]["sensors"] = {"points": ["apex"], "directions": ["x", "y"]}
    values["identification"] = None
    return check_config(values, "on a base")


@pytest.mark.parametrize("kind", UNITS)
def test_campaign_has_the_transfer_function_of_the_study(study_config, kind):
    """Relative motion per m/s² of the base, of the model of a study whose base moves."""
    study = with_base_motion(study_config)
    model, frequency = build_model(study), np.linspace(5.0, 200.0, 400)
    expected = frf(model, 0.0, 0.0, frequency, model.sensor_shapes, kind)
    channels = [("x", study.points["apex"], X, kind), ("y", study.points["apex"], Y, kind)]
    attached = attach(study_config, silent(channels, SLANTED))
    found = frf(attached, 0.0, 0.0, frequency, attached.sensor_shapes, kind)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


def test_inertia_of_an_added_mass_drives_it_too(study_config):
    """Far below the first mode a base at 1 m/s² bends the tube as a force of minus the mass."""
    place = study_config.points["apex"]
    mass = {"name": "lump", "point": "apex", "mass_kg": 0.7}
    bare, loaded = (
        attach(
            with_base_motion(study_config, masses=masses), silent([("a", place, Y, "displacement")])
        )
        for masses in ([], [mass])
    )
    still = np.array([0.0])
    change = np.subtract(
        *(frf(model, 0.0, 0.0, still, model.sensor_shapes)[0, 0].real for model in (loaded, bare))
    )
    flexibility = np.sum(bare.sensor_shapes[:, 0] ** 2 / bare.omega**2)
    assert change == pytest.approx(-0.7 * flexibility, rel=1e-3)


def test_plate_that_rides_on_the_base_is_driven_by_it(study_config):
    """A plate alone is an oscillator on the base: its static relative displacement is -a/omega²."""
    values = study_config.model_dump(mode="json")
    for support in values["supports"]:
        support["plate"] = {"mass_kg": 0.5, "stiffness_N_per_m": 5.0e5, "damping_ratio": 0.01}
    model = attach(
        with_base_motion(check_config(values, "plates")), silent([("a", APEX, Y, "displacement")])
    )
    plates = np.flatnonzero(~np.any(model.sensor_shapes != 0.0, axis=1) & (model.omega < 1001.0))
    plates = [mode for mode in plates if np.isclose(model.omega[mode], 1000.0)]
    # the contact sees the tube less the plate
    moved = -model.contact_shapes[plates] * model.drive_shapes[plates, :1, None] / 1.0e6
    along = model.contact_directions[model.support_of_point == 0][0] @ Y
    found = moved[:, model.support_of_point == 0].sum(axis=0)[0]
    np.testing.assert_allclose(found, -along / 1.0e6, atol=1e-15)


def test_records_agree_with_the_independent_code(study_config):
    """Absolute accelerations and velocities of a tube on a base that the other code made."""
    kinds = ("acceleration", "velocity", "displacement")
    plan = Plan(
        (5,),
        channels=tuple(("apex", "y", kind) for kind in kinds),
        levels=((0.1, 1.3, "fit"),),
        duration=4.0,
        on_base=True,
        gain_scatter=0.0,
        frequency_scatter=0.0,
        damping_scatter=0.0,
    )
    force = forces(plan)
    absolute = true_records(plan, force)[0][0]
    channels = [(kind, APEX, Y, kind) for kind in kinds]
    campaign = on_base(force[0], absolute, channels, start_up="rest")
    measured = signals_of(campaign).response[0]
    rates = rates_of(
        float(campaign.attrs["sampling_frequency"]), study_config.integration.steps_per_second
    )
    schedule = rates.schedule(4.0, study_config.integration.scheme)
    model = attach(study_config, campaign)
    simulated = simulate_records(model, schedule, force[:, None], [(0, GAP, 0)], kinds)
    inner = slice(2048, -512)
    for own, other in zip(simulated[0], measured, strict=True):
        apart = own[inner] - other[inner]
        # what the two codes differ by; the velocity of the base from rest has a mean
        assert np.std(apart - apart.mean()) < 0.04 * np.std(other[inner])


@pytest.mark.parametrize("direction", [Y, SLANTED])
def test_what_rides_on_the_base_shows_no_relative_motion(direction):
    """Sensors on a rigid block that moves with the base, and one that is fixed to the base."""
    samples = 8192
    acceleration = band_limited_noise(np.random.default_rng(2), samples, RATE, (5.0, 200.0))
    acceleration *= np.sin(np.pi * np.arange(samples) / samples) ** 2
    omega = 2.0 * np.pi * np.fft.rfftfreq(samples, 1.0 / RATE)
    velocity = np.fft.irfft(
        np.fft.rfft(acceleration) / np.where(omega > 0.0, 1j * omega, np.inf), samples
    )
    down = tuple(-np.array(Y))
    channels = [
        ("along", APEX, Y, "acceleration"),
        ("against", APEX, down, "acceleration"),
        ("speed", LEG, Y, "velocity"),
        ("moved", LEG, Y, "displacement"),
    ]
    cosine = direction[1]
    shown = [cosine * acceleration, -cosine * acceleration, cosine * velocity, acceleration]
    signals = campaign_signals(on_base(acceleration, shown, channels, direction))
    relative = relative_to_base(signals).response[0]
    size = np.std(np.array(shown), axis=1)
    assert np.std(relative[:2], axis=1).max() < 1e-6 * size[0]
    assert np.std(relative[2]) < 0.01 * size[2]
    np.testing.assert_array_equal(relative[3], signals.response[0][3])


def test_integral_of_a_sine_is_its_cosine():
    time = np.arange(8192) / RATE
    found = integrated(np.cos(2.0 * np.pi * 20.0 * time), RATE, 5.0)
    expected = np.sin(2.0 * np.pi * 20.0 * time) / (2.0 * np.pi * 20.0)
    inner = slice(2048, -2048)
    assert np.abs(found - expected)[inner].max() < 0.01 * expected.max()
