"""Strain gauges in a campaign: read with accelerometers in one fit, weighed among themselves, and
left out where no model tells them.
"""

import numpy as np
import pytest

from tests.sound_campaign import sound_campaign
from vibroimpact.campaign.file import Channel, Level, campaign_dataset, write_campaign
from vibroimpact.completion.own_records import own_records
from vibroimpact.config.reading import check_config
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage.counted_cells import counted
from vibroimpact.linear_stage.driven_channels import driven_channels
from vibroimpact.linear_stage.linear_analysis import largest_motion, mixed_up, motion_of_strains
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach, with_channel_points
from vibroimpact.observation.comparable import channel_rows, strain_rows
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records
from vibroimpact.observation.strain import as_displacements, gauges_of

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
X, Y, Z = np.eye(3)
APEX, BEND, LEG, DRIVE = (0, 0, 1.0), (0.2121, 0, 0.9121), (-0.3, 0, 0.3), (-0.2121, 0, 0.9121)
SI = {"m s-2": 1.0, "um/m": 1e-6}
CHANNELS = (
    ("apex a", APEX, Y, "acceleration"),
    ("bend a", BEND, Y, "acceleration"),
    ("leg y", LEG, Y, "strain"),
    ("root y", (-0.3, 0, 0.05), Y, "strain"),
    ("leg x", LEG, X, "strain"),
)
STRAINS = np.array([kind == "strain" for *_, kind in CHANNELS])
FACTORS, DAMPED = {0: 1.004, 2: 0.997}, {0: 1.1, 2: 0.9}


def campaign_of(response, force, channels=CHANNELS):
    """A campaign of one low and one high record; response in SI."""
    described = [
        Channel(*row[:3], "um/m" if row[3] == "strain" else "m s-2", row[3]) for row in channels
    ]
    scale = np.array([SI[channel.units] for channel in described])
    drive = Channel("shaker", DRIVE, Y, "N", "generic")
    levels = [Level("low", GAP), Level("high", GAP)]
    return campaign_dataset(
        force, response / scale[:, None], described, [drive], levels, RATE, start_up="rest"
    )


def rig_of(config, chosen):
    """Workbench of a tube whose modes are not the model's, by some of the CHANNELS."""
    channels = [CHANNELS[number] for number in chosen]
    samples = int(RATE * SECONDS)
    shape = band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0))
    force = np.stack([0.3 * shape, 5.0 * shape])[:, None]
    blank = campaign_of(np.zeros((2, len(channels), samples)), force, channels)
    modes = np.array(sorted(FACTORS))
    told = linear.Nuisance(
        modes,
        np.array([FACTORS[mode] for mode in modes]),
        np.array([DAMPED[mode] for mode in modes]),
        np.ones(len(channels)),
    )
    schedule = schedule_of(blank, config.integration, SECONDS)
    model = linear.corrected(attach(config, blank), told)
    kinds = blank["channel_kind"].values
    true = simulate_records(model, schedule, Forces(force, schedule), [(0, GAP, 0)], kinds)[0]
    size = true.std(axis=-1)
    for family in (kinds == "strain", kinds != "strain"):
        size[family] = size[family].max(initial=0.0)
    noise = 0.005 * size[:, None] * np.random.default_rng(4).standard_normal(true.shape)
    response = np.stack([true + noise, 10.0 * (true + noise)])
    return Workbench(config, campaign_of(response, force, channels))


@pytest.fixture(scope="module")
def rig(study_config):
    return rig_of(study_config, range(len(CHANNELS)))


def told(bench):
    fit = bench.measured_fit
    for mode, factor in FACTORS.items():
        place = list(fit.modes).index(mode)
        assert np.exp(fit.log_frequency[place]) == pytest.approx(factor, abs=3e-4)
        assert np.exp(fit.log_damping[place]) == pytest.approx(DAMPED[mode], abs=0.05)
    assert fit.residual.max() < 1.5 and not fit.delay.any()


def test_modes_are_read_from_both_together(rig):
    told(rig)


def test_modes_are_read_from_strains_alone(study_config):
    bench = rig_of(study_config, [2, 3])
    told(bench)
    assert largest_motion(bench.signals) == 0.0
    assert bench.linear_stage


def test_shapes_of_strains_are_those_of_the_model(rig):
    """Participations of strain gauges are the model's, whose nuisances stay within their priors."""
    fit, own = rig.measured_fit, rig.bare.sensor_shapes[rig.measured_fit.modes].T
    large = np.abs(own[2:4]) > 0.2 * np.abs(own[2:4]).max(axis=0)
    np.testing.assert_allclose(fit.participation[2:4][large], own[2:4][large], rtol=0.02)
    _, _, chi_square, pulls = corrected_nuisance(rig)
    assert np.abs(pulls).max() < 2.0


def test_each_is_seen_beside_its_like(rig):
    """A factor on all strains, as another unit has, changes nothing of what is compared."""
    reading = rig.measured_reading
    scaled = reading.participation * np.where(STRAINS, 1.0e6, 1.0)[:, None]
    other = type(reading)(
        reading.modes,
        reading.log_frequency,
        reading.log_damping,
        scaled,
        reading.residual,
        reading.gauges,
    )
    np.testing.assert_array_equal(linear.seen_by(other, other), linear.seen_by(reading, reading))
    one, same = (linear.difference(row, row) for row in (reading, other))
    np.testing.assert_allclose(one[2], same[2], rtol=1e-9)


def test_gauge_across_the_motion_is_not_driven(rig):
    assert gauges_of(rig.bare).tolist() == STRAINS.tolist()
    assert driven_channels(rig).tolist() == [True, True, True, True, False]
    alike = np.abs(as_displacements(rig.bare))
    assert 0.01 < alike[:, STRAINS].max() / alike[:, ~STRAINS].max() <= 1.0


def test_weak_strains_count_beside_strong_motions(rig):
    """A strain of 1e-5 is not 40 dB below an acceleration of 1 m/s²: it is another quantity."""
    assert counted(rig)[1, 2:4].mean() > 0.8


def test_motion_that_goes_with_the_strains(rig, study_config):
    """Of the order of what the accelerometers tell of the same record."""
    found = motion_of_strains(rig.signals, study_config.structure)
    assert 0.05 < found / largest_motion(rig.signals) < 20.0


def test_no_gauge_seems_swapped_or_in_another_unit(rig):
    assert mixed_up(rig) == []


def test_a_gauge_has_no_mass_to_be_missing(rig, study_config):
    points = with_channel_points(study_config, rig.campaign).points
    assert "leg_y" not in points and "root_y" not in points


def test_normal_along_the_tube_is_left_out(study_config):
    channels = [CHANNELS[0], ("along", LEG, Z, "strain"), CHANNELS[2]]
    (row,) = strain_rows(study_config, silent(channels))
    assert row["channel"] == "along" and row["level"] == "warn"
    assert "along the tube (cosine 1.00): it is left out" in row["message"]
    assert channel_rows(silent(channels)) == []


def test_gauge_between_axes_of_a_bar_is_left_out(study_config):
    values = study_config.model_dump(mode="json")
    values["structure"]["section"] = {"kind": "rectangle", "sides_m": [0.02, 0.03]}
    bar = check_config(values, "a bar")
    slanted = (np.sqrt(0.5), np.sqrt(0.5), 0.0)
    channels = [CHANNELS[0], ("slanted", LEG, slanted, "strain"), CHANNELS[2]]
    (row,) = strain_rows(bar, silent(channels))
    assert row["channel"] == "slanted" and "cosine 0.71" in row["message"]


def test_measured_modes_leave_strains_out(tmp_path):
    campaign = sound_campaign()
    campaign["channel_kind"].values[2], campaign["channel_units"].values[2] = "strain", "1"
    write_campaign(campaign, tmp_path / "campaign.nc")
    kept, rows, _ = own_records(tmp_path / "campaign.nc")
    assert kept["channel_name"].values.tolist() == ["tip 0", "tip 1"]
    left = [row["channel"] for row in rows if "how a strain follows" in row["message"]]
    assert left == ["tip 2"]


def silent(channels):
    return campaign_of(np.zeros((2, len(channels), 64)), np.ones((2, 1, 64)), channels)
