"""What channels of each kind show of a structure whose motion is known: an oscillator, a linear
tube, a tube that rests against its support.
"""

from dataclasses import replace

import numpy as np
import pytest

from vibroimpact.campaign.file import Channel, Level, campaign_dataset
from vibroimpact.config.reading import check_config
from vibroimpact.diagnosis.measurement import simulated_records as forward
from vibroimpact.diagnosis.measurement.attached_model import attach
from vibroimpact.diagnosis.measurement.simulated_records import simulate_records
from vibroimpact.diagnosis.measurement.stretches import rates_of
from vibroimpact.excitation.random_force import band_limited_noise

UNITS = {"displacement": "m", "velocity": "m s-1", "acceleration": "m s-2"}
MOTIONS = tuple(UNITS)
APEX, PLATE, DRIVE = (0.0, 0.0, 1.0), (-0.3, 0.0, 0.35), (-0.2121, 0.0, 0.9121)
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
GAP, STIFFNESS = 2.8886e-4, 4.0e6
NO_LOAD = 1.0e-9  # N
ERRORS = (1e-5, 4e-5, 2e-4)  # of displacement, velocity, acceleration: the march, not the filter


def campaign_of(channels, force, rate):
    """A campaign of silent channels under force (time,) at the shaker."""
    drive = Channel("shaker", DRIVE, Y, "N", "generic")
    silent = np.zeros((1, len(channels), len(force)))
    levels = [Level("only", GAP)]
    return campaign_dataset(force[None, None], silent, channels, [drive], levels, rate)


def at_apex(kinds=MOTIONS):
    return [Channel(f"apex {kind}", APEX, Y, UNITS[kind], kind) for kind in kinds]


def recorded(model, campaign, config, gap=np.nan):
    """(channel, time) one run of the campaign's record on a model, by the campaign's own kinds."""
    force = campaign["force"].values.astype(float)
    rate = float(campaign.attrs["sampling_frequency"])
    rates = rates_of(rate, config.integration.steps_per_second)
    schedule = rates.schedule(force.shape[-1] / rate, config.integration.scheme)
    kinds = campaign["channel_kind"].values
    return simulate_records(model, schedule, force, [(0, gap, 0)], kinds)[0]


def of_modes(model, chosen, **values):
    """The model with some of its modes alone."""
    names = ("omega", "damping", "contact_shapes", "drive_shapes", "sensor_shapes", "line_shapes")
    names += ("stress_shapes", "element_shapes", "initial_displacement", "initial_velocity")
    names += ("constant_force", "fluid_shapes")
    return replace(model, **{name: getattr(model, name)[chosen] for name in names} | values)


@pytest.mark.parametrize("rate", [1024.0, 5000.0])
def test_oscillator_in_each_kind_of_motion(study_config, rate):
    """One mode under a harmonic force: 1 / (omega0² - omega² + 2i zeta omega0 omega), times i omega
    for each derivative in time.
    """
    hertz, time = 40.0, np.arange(int(2.0 * rate)) / rate
    force = np.cos(2.0 * np.pi * hertz * time)
    campaign = campaign_of(at_apex(), force, rate)
    whole = attach(study_config, campaign)
    model = of_modes(whole, slice(0, 1), damping=np.array([60.0]))
    omega, late = 2.0 * np.pi * hertz, (time > 1.0) & (time < 1.8)
    waves = np.stack([np.cos(omega * time), -np.sin(omega * time)], axis=1)[late]
    static = model.sensor_shapes[0, 0] * model.drive_shapes[0, 0]
    expected = static / (model.omega[0] ** 2 - omega**2 + 60.0j * omega)
    for order, series in enumerate(recorded(model, campaign, study_config)):
        (real, imaginary), *_ = np.linalg.lstsq(waves, series[late], rcond=None)
        found = complex(real, imaginary) / (1j * omega) ** order
        assert abs(found / expected - 1.0) < 2e-5


@pytest.mark.parametrize("rate", [1024.0, 2048.0, 5000.0, 8192.0])
def test_linear_tube_by_its_transfer_function(study_config, rate):
    """From rest under a random force, every kind at one place, at any sampling rate."""
    samples = int(4.0 * rate)
    force = band_limited_noise(np.random.default_rng(3), samples, rate, (5.0, 200.0))
    force *= np.minimum(np.arange(samples) / (0.5 * rate), 1.0) ** 2  # band-limited from its start
    campaign = campaign_of(at_apex(), force, rate)
    model = attach(study_config, campaign)
    padded = 8 * samples  # until the least damped mode is at rest again
    omega = 2.0 * np.pi * np.fft.rfftfreq(padded, 1.0 / rate)
    omega = omega[omega < 2.0 * np.pi * 400.0]  # the force holds no more
    modal = (model.drive_shapes @ np.fft.rfft(force, padded)[None, : len(omega)]) / (
        model.omega[:, None] ** 2 - omega**2 + 1j * model.damping[:, None] * omega
    )
    inner = slice(samples // 10, -samples // 10)
    for order, found in enumerate(recorded(model, campaign, study_config)):
        lines = np.zeros(padded // 2 + 1, complex)
        lines[: len(omega)] = (model.sensor_shapes[:, order] @ modal) * (1j * omega) ** order
        exact = np.fft.irfft(lines, padded)[:samples]
        assert np.std((found - exact)[inner]) < ERRORS[order] * np.std(exact[inner])


def test_a_channel_is_its_own_whatever_is_beside_it(study_config):
    force = np.random.default_rng(4).standard_normal(512)
    mixed = campaign_of(at_apex(), force, 2048.0)
    together = recorded(attach(study_config, mixed), mixed, study_config, GAP)
    for number, kind in enumerate(MOTIONS):
        alone = campaign_of(at_apex([kind]), force, 2048.0)
        one = recorded(attach(study_config, alone), alone, study_config, GAP)
        np.testing.assert_array_equal(one[0], together[number])


def test_contact_force_at_rest_is_stiffness_times_penetration(study_config, monkeypatch):
    """Plates moved beyond their clearance push the tube: the load cells read the force on the tube,
    along and against their directions, and in proportion to its cosine.
    """
    monkeypatch.setattr(forward, "IMPERFECTION", 0.0)
    slanted = (np.sqrt(0.5), np.sqrt(0.5), 0.0)
    channels = [
        Channel("tube", PLATE, Y, "m", "displacement"),
        Channel("along", PLATE, Y, "N", "contact_force"),
        Channel("against", PLATE, (0.0, -1.0, 0.0), "N", "contact_force"),
        Channel("slanted", PLATE, slanted, "N", "contact_force"),
        Channel("across", PLATE, X, "N", "contact_force"),
    ]
    campaign = campaign_of(channels, np.full(1024, NO_LOAD), 2048.0)
    values = study_config.model_dump(mode="json")
    for support in values["supports"]:
        support["points"] = 1
    config = check_config(values, "one contact point")
    model = attach(config, campaign)
    moved = np.tile([0.0, 1.3 * GAP], (len(model.support_of_point), 1))
    model = replace(model, centre_offset=moved)
    tube, along, against, slant, across = recorded(model, campaign, config, GAP)[:, 200:800]
    penetration = (1.3 * GAP - tube) - GAP
    assert penetration.min() > 1e-6
    np.testing.assert_allclose(along, STIFFNESS * penetration, rtol=2e-3)
    np.testing.assert_allclose(against, -along, rtol=1e-6)
    np.testing.assert_allclose(slant, np.sqrt(0.5) * along, rtol=1e-4)
    assert np.abs(across).max() < 1e-3 * along.mean()


def test_what_no_model_gives_is_not_simulated(study_config):
    for channel in (
        Channel("gauge", APEX, Y, "1", "generic"),
        Channel("cell", APEX, Y, "N", "contact_force"),
    ):
        campaign = campaign_of([channel], np.full(64, NO_LOAD), 2048.0)
        with pytest.raises(ValueError, match="can not be simulated"):
            recorded(attach(study_config, campaign), campaign, study_config, GAP)
