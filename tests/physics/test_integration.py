"""The march through time: limit cases, exact symmetries, energy, and the slow twin."""

from dataclasses import replace

import numpy as np
import pytest

from tests.support.oracle import exact_contact, newmark_contact
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.integration import batch as integrate
from vibroimpact.integration import kernel_layout as layout
from vibroimpact.integration.batch import ENERGY_TERMS, Schedule, integrate_batch
from vibroimpact.integration.contact_convergence import IntegrationError
from vibroimpact.integration.every_step import integrate_every_step
from vibroimpact.integration.kernels.decimation import RATIO
from vibroimpact.integration.kernels.lanes import LANES

GAP = 2.8886e-4
RATE = 51200


def noise(load, seconds, rate=RATE, lanes=LANES, band=(5.0, 200.0)):
    """Force (step, force_channel, lane) of RMS load, a seed per lane."""
    samples = round(seconds * rate)
    return np.stack(
        [
            load * band_limited_noise(np.random.default_rng(lane), samples, rate, band)
            for lane in range(lanes)
        ],
        -1,
    )[:, None]


def march(model, schedule, force, gap=GAP, offset=1e-6, seed=0):
    """Lanes under force (step, force_channel, lane), obstacle centres off by a random fraction of
    the gap.
    """
    lanes = force.shape[-1]
    gap = np.broadcast_to(gap, lanes)
    imperfection = (
        np.random.default_rng(seed).uniform(-1, 1, (model.support_of_point.size, 2, lanes))
        * offset
        * gap
    )
    return (
        integrate_batch(
            model, schedule, gap, imperfection, lambda first, count: force[first : first + count]
        ),
        imperfection,
    )


@pytest.fixture(scope="module")
def short():
    return Schedule(RATE, 2048, 0.0, 0.06)


@pytest.fixture(scope="module")
def impacting(study_model, short):
    """A short run in which every lane hits its supports, and what it was made of."""
    force = noise(200.0, 0.2)
    gap = np.linspace(2e-5, 4e-5, LANES)
    lanes, offset = march(study_model, short, force, gap, offset=0.05)
    assert np.all(lanes.tally["impacts"] > 0)
    return lanes, force, gap, offset


@pytest.mark.parametrize("scheme", ["newmark", "exact"])
@pytest.mark.parametrize("lane", [0, LANES - 1])
def test_agrees_with_the_textbook_scheme(study_model, impacting, lane, scheme, monkeypatch):
    """Contact displacements and forces of every chunk's last step against dense twins with iterated
    contact.
    """
    short = Schedule(RATE, 2048, 0.0, 0.06, scheme)
    twin = {"newmark": newmark_contact, "exact": exact_contact}[scheme]
    _, force, gap, offset = impacting
    seen = []

    class Watched(integrate.Run):
        def account(self, recorded):
            super().account(recorded)
            seen.append(
                (self.done, self.state.row_displacement.copy(), self.state.row_force.copy())
            )

    monkeypatch.setattr(integrate, "Run", Watched)
    monkeypatch.setattr(integrate, "CHUNK_TICKS", 100)
    monkeypatch.setattr(
        layout, "FIXED_POINT_TOLERANCE", 1e-13
    )  # as the twin; impacts amplify any difference
    lanes = integrate_batch(
        study_model, short, gap, offset, lambda first, count: force[first : first + count]
    )
    u, f = twin(
        study_model, gap[lane], offset[:, :, lane], force[: short.steps + 1, :, lane], 1.0 / RATE
    )
    assert len(seen) > 5
    for done, row_displacement, row_force in seen:
        assert np.max(
            np.abs(row_displacement[lanes.contact_rows, lane] - u[done - 1])
        ) < 1e-6 * np.max(np.abs(u))
        assert np.max(np.abs(row_force[lanes.contact_rows, lane] - f[done - 1])) < 1e-6 * np.max(
            np.abs(f)
        )


def assert_same(one, lane, other, lane_of_other, factor=1.0):
    """All that a lane left behind equals that of another lane times factor, bit for bit."""
    assert np.array_equal(one.displacement[lane], factor * other.displacement[lane_of_other])
    assert np.array_equal(one.acceleration[lane], factor * other.acceleration[lane_of_other])
    assert np.array_equal(one.force[lane], factor * other.force[lane_of_other])
    assert np.array_equal(one.energy[lane], factor**2 * other.energy[lane_of_other])
    for name in ("contact_steps", "impacts", "residual"):
        assert np.array_equal(one.tally[name][..., lane], other.tally[name][..., lane_of_other])


@pytest.mark.parametrize("lane", [0, 5])
def test_a_case_does_not_depend_on_its_batch(study_model, short, impacting, lane):
    lanes, force, gap, offset = impacting
    alone = integrate_batch(
        study_model,
        short,
        gap[lane : lane + 1],
        offset[..., lane : lane + 1],
        lambda first, count: force[first : first + count, :, lane : lane + 1],
    )
    assert_same(alone, 0, lanes, lane)


def test_linear_neighbour_lane_changes_no_bit(study_model, short, impacting):
    """Lanes that never touch share their vector with lanes that do; the pass count and the skips
    must not leak.
    """
    lanes, force, gap, offset = impacting
    calm = np.where(np.arange(LANES) % 2 == 0, 1.0, 1e3) * gap
    mixed = integrate_batch(
        study_model, short, calm, offset, lambda first, count: force[first : first + count]
    )
    for lane in range(0, LANES, 2):
        assert_same(mixed, lane, lanes, lane)
    assert np.all(mixed.tally["impacts"][:, 1::2] == 0)


@pytest.mark.parametrize("power", [-3, 5])
def test_homogeneous_of_degree_one_bit_for_bit(study_model, short, impacting, power):
    lanes, force, gap, offset = impacting
    factor = 2.0**power
    scaled = integrate_batch(
        study_model,
        short,
        factor * gap,
        factor * offset,
        lambda first, count: factor * force[first : first + count],
    )
    for lane in range(LANES):
        assert_same(scaled, lane, lanes, lane, factor)


def test_reversing_the_force_mirrors_the_motion(study_model, short, impacting):
    lanes, force, gap, offset = impacting
    mirrored = integrate_batch(
        study_model, short, gap, -offset, lambda first, count: -force[first : first + count]
    )
    for lane in range(LANES):
        assert_same(mirrored, lane, lanes, lane, -1.0)


def test_linear_below_contact(study_model):
    """A gap never reached changes nothing, and the response is that of the modes alone to
    round-off.
    """
    schedule = Schedule(RATE, 2048, 0.0, 0.2)
    force = noise(0.5, 0.4)
    lanes, _ = march(study_model, schedule, force)
    free, _ = march(study_model, schedule, force, gap=1.0)
    assert np.all(lanes.tally["impacts"] == 0)
    assert np.array_equal(lanes.displacement, free.displacement)
    assert np.all(
        lanes.displacement[
            :, [name.endswith(".x") for name in study_model.sensor_names] + [False] * 27
        ]
        == 0.0
    )
    dt, sensor = 1.0 / RATE, study_model.sensor_names.index("apex.y")
    stiff, drag = (0.5 * dt * study_model.omega) ** 2, 0.5 * dt * study_model.damping
    expected = np.zeros(schedule.steps + 1)
    q = np.zeros(study_model.modes)
    v = np.zeros(study_model.modes)
    for n in range(schedule.steps):
        push = study_model.drive_shapes[:, 0] * (force[n, 0, 0] + force[n + 1, 0, 0])
        new = ((1 - drag - stiff) * v - dt * study_model.omega**2 * q + 0.5 * dt * push) / (
            1 + drag + stiff
        )
        q, v = q + 0.5 * dt * (v + new), new
        expected[n + 1] = study_model.sensor_shapes[:, sensor] @ q
    # state n sits at time (n - 1) dt; away from the ends the band-limited response is its own
    # filtered self
    kept = expected[1 + 25 * np.arange(schedule.samples)][200:-100]
    got = lanes.displacement[0, sensor][200 : schedule.samples - 100]
    assert np.max(np.abs(got - kept)) < 5e-4 * np.max(np.abs(kept))


def residuals(model, rate, load):
    """(identity, potential) energy residuals of every lane at the end, relative to the input
    work.
    """
    lanes, _ = march(model, Schedule(rate, 2048, 0.0, 0.5), noise(load, 1.0, rate))
    terms = dict(zip(ENERGY_TERMS, lanes.energy.transpose(1, 0, 2), strict=True))
    mechanical = terms["kinetic"] + terms["elastic"]
    supplied = terms["input_work"] - terms["dissipated"]
    assert np.all(lanes.tally["impacts"] > 10)
    scale = terms["input_work"][:, -1:]
    exact = np.max(np.abs(mechanical - supplied - terms["contact_work"]) / scale, axis=-1)
    potential = np.max(np.abs(mechanical + terms["contact_potential"] - supplied) / scale, axis=-1)
    return exact, potential


def test_energy_balance_closes_and_converges(study_model):
    """The discrete identity to 1e-9; with the contact's potential energy 3e-3 at the paper's step,
    falling by 3 or more per halving.
    """
    exact, potential = residuals(study_model, RATE, 20.0)
    finer_exact, finer = residuals(study_model, 2 * RATE, 20.0)
    assert max(exact.max(), finer_exact.max()) < 1e-9
    assert potential.max() < 3e-3
    assert potential.mean() > 3.0 * finer.mean()


def test_support_forces_push_back_and_statistics_agree(study_model, impacting):
    """Peak and RMS of the full-rate force bound those of the filtered record; contact fraction and
    impacts are consistent.
    """
    lanes, *_ = impacting
    tally, steps = lanes.tally, lanes.steps
    rms = np.sqrt(tally["square_force"] / steps)
    assert np.all(tally["peak_force"] >= rms)
    assert np.all(
        tally["force_sum"] <= np.sqrt(tally["square_force"] * tally["contact_steps"]) * (1 + 1e-12)
    )  # Cauchy-Schwarz
    assert np.all(tally["impacts"] <= tally["contact_steps"])
    assert np.all(
        tally["impact_velocity_peak"] ** 2 * tally["impacts"]
        >= tally["impact_velocity_square"] * (1 - 1e-12)
    )
    assert np.all(
        tally["force_displacement"][lanes.contact_rows].sum(axis=(0, 1)) < 0.0
    )  # the force opposes the displacement


def test_too_stiff_a_contact_is_refused_before_it_runs(study_model, short):
    stiff = replace(study_model, contact_stiffness=study_model.contact_stiffness * 1e3)
    with pytest.raises(
        IntegrationError,
        match=r"contact stiffness 8e\+08 N/m is too stiff .* raise integration.steps_per_second",
    ):
        march(stiff, short, noise(1.0, 0.2))


def test_divergence_names_time_and_place(study_model, short):
    force = noise(1.0, 0.2)
    force[1000:] = np.nan
    with pytest.raises(
        IntegrationError,
        match=r"diverged at t = 0\.0\d+ s of the record, contact point \d",
    ):
        march(study_model, short, force)


def test_divergence_in_the_last_steps_is_seen(study_model):
    points = len(study_model.support_of_point)
    with pytest.raises(IntegrationError, match="diverged"):
        integrate_every_step(
            study_model,
            81_920,
            RATIO,
            np.ones(1),
            np.zeros((points, 2, 1)),
            lambda first, count: np.full((count, 1, 1), np.nan),
        )
