"""The linear stage: frequencies, damping, gains and delays of a low record are read back from its
waveform.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.fft import prev_fast_len

from vibroimpact.campaign.file import CampaignError, Channel, Level, campaign_dataset
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.linear_stage import nuisance as linear
from vibroimpact.linear_stage.modal_lines import ModalLines
from vibroimpact.linear_stage.mode_identification import fit_modes, left
from vibroimpact.linear_stage.workbench import Workbench, corrected_nuisance
from vibroimpact.observation.attached_model import attach, with_channel_points
from vibroimpact.observation.linear_record import LinearRecord
from vibroimpact.observation.simulated_records import Forces, schedule_of, simulate_records

RATE, SECONDS, GAP = 2048.0, 16.0, 2.8886e-4
PLACES = {
    "apex_y": ([0.0, 0.0, 1.0], [0, 1, 0]),
    "bend_y": ([0.2121, 0.0, 0.9121], [0, 1, 0]),
    "leg_y": ([-0.3, 0.0, 0.55], [0, -1, 0]),
    "apex_x": ([0.0, 0.0, 1.0], [1, 0, 0]),
}
FACTORS, DAMPED, GAINS = {0: 1.004, 2: 0.997}, {0: 1.1, 2: 0.9}, np.array([1.03, 0.99, 1.0, 1.0])


def campaign_of(response, force):
    """A campaign of one low and one high record."""
    channels = [
        Channel(name, tuple(point), tuple(direction), "m s-2", "acceleration")
        for name, (point, direction) in PLACES.items()
    ]
    drive = Channel("shaker", (-0.2121, 0.0, 0.9121), (0.0, 1.0, 0.0), "N", "generic")
    return campaign_dataset(
        force,
        response,
        channels,
        [drive],
        [Level("low", GAP), Level("high", GAP)],
        RATE,
        start_up="rest",
    )


@pytest.fixture(scope="module")
def rig(study_config):
    """(Workbench, fit): a record of a tube whose modes, gains and one clock are not the model's,
    with noise.
    """
    samples = int(RATE * SECONDS)
    shape = band_limited_noise(np.random.default_rng(3), samples, RATE, (5.0, 200.0))
    force = np.stack([0.3 * shape, 5.0 * shape])[:, None]
    blank = campaign_of(np.zeros((2, len(PLACES), samples)), force)
    model = attach(study_config, blank)
    modes = np.array(sorted(FACTORS))
    true = linear.corrected(
        model,
        linear.Nuisance(
            modes,
            np.array([FACTORS[m] for m in modes]),
            np.array([DAMPED[m] for m in modes]),
            GAINS,
        ),
    )
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    response = (
        simulate_records(
            true, schedule, Forces(force, schedule), [(0, GAP, 0)], ["acceleration"] * len(PLACES)
        )[0]
        * GAINS[:, None]
    )
    response[1] = np.roll(response[1], 4)
    response = (
        response
        + 0.01
        * np.random.default_rng(4).standard_normal(response.shape)
        * response.std(axis=-1).max()
    )
    bench = Workbench(study_config, campaign_of(np.stack([response, response]), force))
    return bench, bench.measured_fit


def test_frequencies_and_damping_are_read_back(rig):
    bench, fit = rig
    for mode, factor in FACTORS.items():
        place = list(fit.modes).index(mode)
        assert np.exp(fit.log_frequency[place]) == pytest.approx(factor, abs=2e-4)
        assert np.exp(fit.log_damping[place]) == pytest.approx(DAMPED[mode], abs=0.05)


def test_the_rest_is_noise(rig):
    _, fit = rig
    assert fit.residual[[0, 1, 2]].max() < 1.5


def test_gains_are_read_back(rig):
    bench, fit = rig
    shapes = bench.bare.sensor_shapes[fit.modes].T[:3]
    seen = np.abs(shapes) > 0.1 * np.abs(shapes).max(axis=0)
    ratio = np.where(seen, fit.participation[:3] / np.where(seen, shapes, 1.0), np.nan)
    np.testing.assert_allclose(np.nanmean(ratio, axis=1), GAINS[:3], atol=0.006)


def test_channel_delay_is_estimated(rig):
    _, fit = rig
    np.testing.assert_allclose(fit.delay[:3], [0.0, 4.0 / RATE, 0.0], atol=5e-5)


@pytest.mark.parametrize(
    "late",
    [{0: 7.0e-3}, {2: -12.0e-3}, {0: 3.0e-3, 1: 9.0e-3}],
    ids=["7 ms", "12 ms early", "two channels"],
)
def test_large_channel_delay_is_removed_before_the_fit(rig, late):
    """Between its resonances no phase of each mode stands for milliseconds: what the channel leaves
    is no sign that the fit is of another structure.
    """
    bench, fit = rig
    responses = bench.valid(bench.signals.response[bench.signals.lowest]).copy()
    for channel, delay in late.items():
        lines = np.fft.rfft(responses[channel], 2 * responses.shape[1])
        turned = lines * np.exp(
            -2j * np.pi * np.fft.rfftfreq(2 * responses.shape[1], 1.0 / RATE) * delay
        )
        responses[channel] = np.fft.irfft(turned)[: responses.shape[1]]
    found = fit_modes(
        bench.linear_record, responses, bench.bare, bench.signals.kinds, bench.signals.noise_in_band
    )
    expected = fit.delay + np.array([late.get(channel, 0.0) for channel in range(len(PLACES))])
    np.testing.assert_allclose(found.delay[:3], expected[:3], atol=3.0e-5)
    np.testing.assert_allclose(found.log_frequency, fit.log_frequency, atol=3.0e-4)


def test_nuisances_within_priors_are_not_significant(rig):
    bench, fit = rig
    _, _, chi_square, pulls = corrected_nuisance(bench)
    values = linear.difference(
        bench.measured_reading, linear.reading_of_model(bench.bare, fit.modes)
    )[0]
    assert chi_square < 2.0 * len(values)
    assert pulls[list(fit.modes).index(0)] == pytest.approx(np.log(1.004) / 0.003, abs=0.15)


def test_linear_responses_are_those_of_the_integration(rig, study_config):
    """Frequency-domain responses of the modes against the march in time: the same record from rest,
    line by line.
    """
    bench, _ = rig
    record = bench.signals.lowest
    marched = simulate_records(
        bench.bare, bench.schedule, bench.forces, bench.runs([record], 1), bench.signals.kinds
    )[0]
    lines = LinearRecord(bench.signals.force[record], RATE, bench.signals.band_Hz)
    fit = fit_modes(lines, marched, bench.bare, bench.signals.kinds, np.full(len(PLACES), 1e-6))
    assert np.abs(fit.log_frequency).max() < 5e-5 and np.abs(fit.log_damping).max() < 1e-2
    assert fit.share[[0, 1, 2]].max() < 4e-3


def test_what_is_left_where_the_force_drives_no_mode_fitted(rig):
    """All channels count then: a channel said to be elsewhere may see such modes alone."""
    bench, _ = rig
    fit = bench.measured_fit
    undriven = replace(bench.bare, drive_shapes=np.zeros_like(bench.bare.drive_shapes))
    assert left(fit, undriven) == fit.residual.max()


def test_plate_clearances_are_taken_from_the_campaign(study_config):
    force = np.ones((2, 1, 64))
    campaign = campaign_of(np.zeros((2, len(PLACES), 64)), force)
    model = attach(
        study_config,
        campaign.assign(
            support_gap=(("record", "support"), GAP * np.array([[1.0, 1.5], [1.0, 1.5]]))
        ),
    )
    np.testing.assert_allclose(model.gap_factor, np.where(model.support_of_point == 0, 1.0, 1.5))
    with pytest.raises(CampaignError, match="differs from record to record"):
        attach(
            study_config,
            campaign.assign(
                support_gap=(("record", "support"), GAP * np.array([[1.0, 1.5], [1.0, 1.2]]))
            ),
        )
    with pytest.raises(CampaignError, match="3 supports, the model 2"):
        attach(
            study_config, campaign.assign(support_gap=(("record", "support"), np.full((2, 3), GAP)))
        )


def test_modes_far_from_the_model_are_found(study_config):
    samples = int(RATE * SECONDS)
    force = 0.2 * band_limited_noise(np.random.default_rng(5), samples, RATE, (5.0, 200.0))[
        None, None
    ].repeat(2, axis=0)
    blank = campaign_of(np.zeros((2, len(PLACES), samples)), force)
    model = attach(study_config, blank)
    factors = {0: 1.17, 2: 0.88}
    modes = np.array(sorted(factors))
    true = linear.corrected(
        model,
        linear.Nuisance(modes, np.array(list(factors.values())), np.ones(2), np.ones(len(PLACES))),
    )
    schedule = schedule_of(blank, study_config.integration, SECONDS)
    response = simulate_records(
        true, schedule, Forces(force, schedule), [(0, GAP, 0)], ["acceleration"] * len(PLACES)
    )[0]
    noise = 0.01 * response.std(axis=-1).max()
    response = response + noise * np.random.default_rng(6).standard_normal(response.shape)
    record = LinearRecord(force[0], RATE, (5.0, 200.0))
    fit = fit_modes(
        record,
        response,
        model,
        np.array(["acceleration"] * len(PLACES)),
        np.full(len(PLACES), noise * np.sqrt(195.0 / 1024.0)),
    )
    for mode, factor in factors.items():
        assert np.exp(fit.log_frequency[list(fit.modes).index(mode)]) == pytest.approx(
            factor, rel=1e-3
        )
    assert fit.residual[:3].max() < 1.5 and not fit.delay.any()


def test_mass_may_sit_at_a_channel_point(study_config):
    blank = campaign_of(np.zeros((2, len(PLACES), 64)), np.zeros((2, 1, 64)))
    blank["channel_point"][2] = [-0.3, 0.0, 0.533]
    points = with_channel_points(study_config, blank).points
    assert points["leg_y"] == (-0.3, 0.0, 0.533)
    assert set(points) == {*study_config.points, "leg_y", "bend_y"}  # the apex has a name already


def test_channel_named_like_a_point_does_not_move_it(study_config):
    blank = campaign_of(np.zeros((2, len(PLACES), 64)), np.zeros((2, 1, 64)))
    blank["channel_name"][2], blank["channel_point"][2] = "shaker", [-0.3, 0.0, 0.533]
    points = with_channel_points(study_config, blank).points
    assert points["shaker"] == study_config.points["shaker"]
    assert points["at_shaker"] == (-0.3, 0.0, 0.533)


def test_start_up_is_excluded_for_records_under_way(rig, study_config):
    bench, _ = rig
    under_way = Workbench(study_config, bench.campaign.assign_attrs(start_up="stationary"))
    assert bench.settled.all()
    assert np.flatnonzero(under_way.settled)[0] == 4 * RATE == SECONDS * RATE / 4
    assert not np.allclose(under_way.measured_features, bench.measured_features)


def test_participations_follow_frequencies_and_damping(rig):
    """Their slopes are those of the linear least squares, whose frequencies are moved a little."""
    bench, fit = rig
    lines = ModalLines(
        bench.linear_record,
        bench.linear_record.spectra(bench.signals.response[bench.signals.lowest]),
        np.ones((len(PLACES), len(bench.linear_record.lines))),
        bench.bare,
        fit.modes,
        fit.drive,
        bench.signals.kinds,
    )
    seen = fit.participation != 0.0
    logs = np.concatenate([fit.log_frequency, fit.log_damping])
    basis = lines._basis(logs)
    shapes = lines._participations(basis, seen)
    _, slopes = lines._slopes((logs, shapes, basis, None), seen)
    for number in range(len(logs)):
        step = 1.0e-5 * np.eye(len(logs))[number]
        sides = [lines._participations(lines._basis(logs + side), seen) for side in (step, -step)]
        change = (sides[0] - sides[1]) / 2.0e-5
        size = np.abs(slopes[..., number]).max()
        on_time = fit.delay == 0.0  # where the fit leaves little
        np.testing.assert_allclose(slopes[on_time, :, number], change[on_time], atol=0.1 * size)


def test_two_modes_side_by_side_tell_their_sum(rig):
    """Of two modes at nearly one frequency, a channel tells the sum of participations well and the
    difference badly.
    """
    bench, fit = rig
    omega = bench.bare.omega.copy()
    pair = fit.modes[:2]
    omega[pair[1]] = omega[pair[0]] * 1.0005
    model = SimpleNamespace(
        omega=np.sort(omega),
        damping=np.full(len(omega), 1.0),
        sensor_shapes=np.full((len(omega), 1), 0.7),
    )
    modes = np.flatnonzero(np.isin(model.omega, omega[pair]))
    record = bench.linear_record
    drive = np.ones((2, 1))
    basis = record.responses(model.omega[modes], model.damping[modes], drive, "acceleration")
    kinds, weights = ["acceleration"], np.full((1, len(record.lines)), 1.0e3)
    lines = ModalLines(record, basis.sum(axis=0)[None], weights, model, modes, drive, kinds)
    found = lines.fit(np.ones((1, 2), bool), np.ones(1), np.zeros(1), np.zeros(2))
    np.testing.assert_allclose(found.participation, 1.0, rtol=1e-4)
    own = found.joint_covariance[4:, 4:]
    total, difference = (np.array(row) @ own @ np.array(row) for row in ([1, 1], [1, -1]))
    assert difference > 100.0 * total > 0.0


def test_two_planes_at_one_frequency_are_told_apart(rig):
    """The bending planes of a round tube: the model's frequencies are equal, those of the tube are
    0.6 % apart, and force and sensors are skew to both.
    """
    bench, fit = rig
    omega = np.full(2, bench.bare.omega[fit.modes[0]])
    shapes = np.array([[1.0, -0.6, 0.8], [0.5, 0.7, -0.9]])
    model = SimpleNamespace(omega=omega, damping=np.full(2, 4.0), sensor_shapes=shapes)
    record, drive = bench.linear_record, np.array([[0.8], [0.6]])
    apart, turned = np.array([0.004, -0.002]), np.array([1.3, 0.5])
    basis = record.responses(omega * np.exp(apart), model.damping, drive, "acceleration")
    true = shapes.T * turned
    measured = true @ basis
    weights = np.full(measured.shape, 100.0 / np.abs(measured).max())
    kinds = ["acceleration"] * 3
    lines = ModalLines(record, measured, weights, model, np.arange(2), drive, kinds)
    found = lines.fit(np.ones((3, 2), bool), np.ones(3), np.zeros(3), np.zeros(2))
    np.testing.assert_allclose(found.log_frequency, apart, atol=2e-4)
    np.testing.assert_allclose(found.participation, true, rtol=0.05)


def test_a_sensor_that_the_model_says_is_still_is_read(rig):
    """As one across the force is where a spring across the force couples the planes."""
    bench, fit = rig
    omega, record, drive = bench.bare.omega[fit.modes[:1]], bench.linear_record, np.ones((1, 1))
    model = SimpleNamespace(omega=omega, damping=np.full(1, 4.0), sensor_shapes=np.zeros((1, 1)))
    measured = 0.4 * record.responses(omega, model.damping, drive, "acceleration")
    weights = np.full(measured.shape, 100.0 / np.abs(measured).max())
    lines = ModalLines(record, measured, weights, model, np.arange(1), drive, ["acceleration"])
    found = lines.fit(np.ones((1, 1), bool), np.ones(1), np.zeros(1), np.zeros(1))
    np.testing.assert_allclose(found.participation, 0.4, rtol=1e-6)


@pytest.mark.parametrize("from_rest", [True, False])
def test_compared_length_is_quick_to_transform(from_rest):
    force = np.zeros((1, 49157))  # of which the last four fifths are twice a prime, nearly
    record = LinearRecord(force, RATE, (5.0, 276.0), from_rest)
    length = (record.samples - record.first) // record.every
    assert prev_fast_len(length, real=True) == length
    wanted = 1.0 if from_rest else 0.8
    assert 0.97 * wanted < record.every * length / force.shape[-1] <= wanted + 1e-4
