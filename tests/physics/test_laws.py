"""Contact and element laws beyond the elastic circle: closed forms, and what a law may never do."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipk

from tests.support.oscillator import oscillator
from vibroimpact.excitation.random_force import band_limited_noise
from vibroimpact.integration.batch import Schedule, integrate_batch
from vibroimpact.integration.every_step import integrate_every_step
from vibroimpact.structure.contact.laws import ContactLaws, LocalLaws

RATE = 100_000
RUN = {}  # the scheme of the test


@pytest.fixture(autouse=True, params=["newmark", "exact"])
def scheme(request, monkeypatch):
    """Every law under both schemes."""
    monkeypatch.setitem(RUN, "scheme", request.param)


def trace(model, seconds, rate=RATE, gap=1.0):
    """The step-by-step run of one case without a force."""
    points = model.support_of_point.size
    return integrate_every_step(
        model,
        rate,
        round(seconds * rate),
        np.array([gap]),
        np.zeros((points, 2, 1)),
        lambda first, count: np.zeros((count, 1, 1)),
        RUN["scheme"],
    )


def launched(mass=1.0, contact_stiffness=1e6, speed=1.0, **laws):
    """A free mass that leaves the origin towards a flat stop 1 mm away."""
    return oscillator(
        mass,
        0.0,
        contact_stiffness=contact_stiffness,
        lands=[(1.0, 0.0)],
        velocity=(speed, 0.0),
        contact={"gap": 1e-3, **laws},
    )


def rebound(run):
    """Speed after the last contact over the speed before the first, 0 when there is none."""
    u = run.contact_displacement[0, 0, 0]
    return (u[-2] - u[-1]) / (u[1] - u[0])


def test_elastic_stop_returns_the_launch_speed():
    assert rebound(trace(launched(), 0.012)) == pytest.approx(1.0, abs=1e-4)


OMEGA = 1e3  # rad/s, of a mass of 1 kg on a contact stiffness of 1e6 N/m


def restitution(ratio):
    """Speed at which k p + c dp/dt comes back to 0 on the exact motion p'' + 2 zeta w p' + w² p = 0
    from p = 0, p' = 1.
    """
    damped = OMEGA * np.sqrt(1.0 - ratio**2)
    time = np.linspace(0.0, np.pi / damped, 2_000_001)
    decay = np.exp(-ratio * OMEGA * time)
    depth = decay * np.sin(damped * time) / damped
    speed = decay * (np.cos(damped * time) - ratio * OMEGA / damped * np.sin(damped * time))
    ends = np.argmax((OMEGA**2 * depth + 2.0 * ratio * OMEGA * speed)[1:] < 0.0)
    return -speed[ends]


@pytest.mark.parametrize("ratio", [0.05, 0.2, 0.5])
def test_kelvin_voigt_restitution_and_no_pull(ratio):
    run = trace(launched(damping=2.0 * ratio * OMEGA), 0.012, rate=1_000_000)
    assert rebound(run) == pytest.approx(restitution(ratio), abs=2e-3)
    assert run.contact_force.max() == 0.0  # towards the stop never


@pytest.mark.parametrize("ratio", [0.05, 0.2])
def test_damper_of_a_stop_in_few_steps(ratio):
    """Ten steps a contact, in the mean over where in a step the stop is met: the loss of speed."""
    rate = 10.0 * OMEGA / np.pi
    gaps = (4.0 + (np.arange(20) + 0.5) / 20) / rate  # at 1 m/s
    stops = [launched(damping=2.0 * ratio * OMEGA, gap=gap) for gap in gaps]
    speeds = [rebound(trace(stop, 0.012, rate)) for stop in stops]
    assert 1.0 - np.mean(speeds) == pytest.approx(1.0 - restitution(ratio), rel=0.03)


@pytest.mark.parametrize("alpha", [0.05, 0.2, 0.8])
def test_hunt_crossley_restitution(alpha):
    """The exact phase-plane relation: p'' = -w² p (1 + alpha p') integrates to alpha²w²p²/2 = G(v0)
    - G(v), G(v) = alpha v - ln(1 + alpha v).

    So G(-e v0) = G(v0). Source: Hunt and Crossley 1975, linear spring.
    """
    run = trace(launched(hunt_crossley=alpha), 0.015, rate=400_000)
    energy = lambda v: alpha * v - np.log1p(alpha * v)  # noqa: E731
    low, high = 0.0, 1.0
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if energy(-middle) < energy(1.0) else (low, middle)
    assert rebound(run) == pytest.approx(low, abs=1e-3)


def test_hertz_peak_force_and_depth():
    """Energy: 0.4 h p^2.5 = m v²/2."""
    run = trace(launched(hertz=1e8), 0.012)
    depth = (0.5 / 0.4 / 1e8) ** 0.4
    assert run.contact_displacement.max() - 1e-3 == pytest.approx(depth, rel=1e-4)
    assert -run.contact_force.min() == pytest.approx(1e8 * depth**1.5, rel=2e-4)
    assert rebound(run) == pytest.approx(1.0, abs=1e-4)


def test_stops_on_one_side_and_on_both():
    one = trace(launched(), 0.03)
    both = trace(
        replace(
            launched(),
            contact_laws=launched().contact_laws.with_columns(
                land_point=np.array([0, 0]), land_normal=np.array([(1.0, 0.0), (-1.0, 0.0)])
            ),
        ),
        0.03,
    )
    assert one.contact_displacement.min() < -5e-3 and both.contact_displacement.min() > -3e-3
    assert both.contact_force.max() == pytest.approx(
        -both.contact_force.min(), rel=1e-4
    )  # met at the same speed


def sliding(friction, normal=10.0, speed=(0.0, 0.02)):
    """A mass pressed on a flat stop by a dead load, sliding along it."""
    return oscillator(
        1.0,
        0.0,
        contact_stiffness=1e6,
        lands=[(1.0, 0.0)],
        displacement=(normal / 1e6, 0.0),
        velocity=speed,
        dead_load=(normal, 0.0),
        contact={"gap": 0.0, "friction": friction, "stick_stiffness": 1e6},
    )


def test_sliding_mass_stops_after_the_coulomb_distance():
    """v²/(2 mu g) with g = N/m; the elastic stick spring adds at most mu N / k_t."""
    run = trace(sliding(0.2), 0.02)
    rest = run.contact_displacement[0, 0, 1, -200:].mean()
    assert rest == pytest.approx(0.02**2 / (2 * 0.2 * 10.0), abs=2 * 0.2 * 10.0 / 1e6)
    assert run.sliding_work[0, 0] == pytest.approx(
        0.5 * 0.02**2 / 0.2, rel=0.02
    )  # wear work: N times the slip
    assert run.energy["mechanical"][0] + run.energy["stored"][0] < 0.0


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_friction_slows_a_mass_that_circles_in_its_obstacle(friction):
    """The normal force is m v²/R, so v = v0 / (1 + mu v0 t / R), whatever the mass."""
    radius, speed, stiffness = 1e-3, 0.1, 1e7
    start = radius + speed**2 / radius / stiffness
    run = trace(
        oscillator(
            1.0,
            0.0,
            contact_stiffness=stiffness,
            displacement=(start, 0.0),
            velocity=(0.0, speed),
            contact={"gap": radius, "friction": friction, "stick_stiffness": stiffness},
        ),
        0.1,
    )
    travelled = np.hypot(*np.diff(run.contact_displacement[0, 0], axis=-1)).sum()
    assert travelled == pytest.approx(
        radius / friction * np.log1p(friction * speed / radius * run.time[-1]), rel=2e-3
    )


def test_friction_takes_energy_and_gives_none(study_model):
    """In the impacting tube: what the supports took beyond what their springs hold is mu times the
    normal force times the slip.
    """
    laws = study_model.contact_laws.with_columns(
        friction=0.3, stick_stiffness=study_model.contact_stiffness
    )
    rate = 102_400
    steps = round(0.3 * rate)
    force = np.stack(
        [
            100.0 * band_limited_noise(np.random.default_rng(lane), steps + 10, rate, (5.0, 200.0))
            for lane in range(2)
        ],
        -1,
    )[:, None]
    offset = (
        np.random.default_rng(9).uniform(-1e-5, 1e-5, (study_model.support_of_point.size, 2, 2))
        + np.array([7e-5, 0.0])[:, None]
    )
    run = integrate_every_step(
        replace(study_model, contact_laws=laws),
        rate,
        steps,
        np.full(2, 1e-4),
        offset,
        lambda first, count: force[first : first + count],
        RUN["scheme"],
    )
    taken = -run.energy["contact_work"] - run.energy["stored"]
    slid = 0.3 * run.sliding_work.sum(axis=1)
    assert np.all(slid > 0.0) and np.all(np.abs(taken - slid) < 1e-3 * run.energy["input_work"])
    identity = (
        run.energy["mechanical"]
        - run.energy["input_work"]
        + run.energy["dissipated"]
        - run.energy["contact_work"]
    )
    closed = {"newmark": 1e-9, "exact": 1e-5}[
        RUN["scheme"]
    ]  # with the trapezoidal sums of work and damping the exact step is not an identity
    assert np.max(np.abs(identity)) < closed * run.energy["input_work"].max()


def impacting(model):
    """Half a second of the tube under 100 N."""
    schedule = Schedule(51200, 2048, 0.0, 0.5, RUN["scheme"])
    force = np.stack(
        [
            100.0 * band_limited_noise(np.random.default_rng(lane), 51200, 51200, (5.0, 200.0))
            for lane in range(4)
        ],
        -1,
    )[:, None]
    offset = np.random.default_rng(9).uniform(-1e-5, 1e-5, (model.support_of_point.size, 2, 4))
    return integrate_batch(
        model, schedule, np.full(4, 1e-4), offset, lambda first, count: force[first : first + count]
    )


def test_lobes_of_no_depth_are_the_circle(study_model):
    """The general path of the kernel against its fast path, to round-off until impacts amplify
    it.
    """
    lobed = replace(study_model, contact_laws=study_model.contact_laws.with_columns(lobes=4.0))
    plain, special = impacting(study_model), impacting(lobed)
    early = slice(0, 40)  # before impacts amplify the last bits
    scale = np.abs(plain.displacement[..., early]).max()
    assert (
        np.max(np.abs(plain.displacement[..., early] - special.displacement[..., early]))
        < 1e-6 * scale
    )
    assert np.all(special.tally["impacts"] > 0)


@pytest.mark.parametrize(("lobes", "angle"), [(2, 0.3), (4, 0.0), (3, 1.1)])
def test_lobed_obstacle_is_conservative_and_has_its_profile(lobes, angle):
    """Energy is kept in a lobed cup, and a slow push in a direction meets the wall at r(theta)."""
    laws = {"gap": 1e-3, "lobes": lobes, "lobe_depth": 5e-4, "lobe_angle": angle}
    bouncing = trace(
        oscillator(1.0, 0.0, contact_stiffness=1e6, velocity=(0.31, 0.17), contact=laws),
        0.1,
        rate=400_000,
    )
    assert bouncing.contact_force.any()
    assert abs(bouncing.energy["mechanical"][0] + bouncing.energy["stored"][0]) < 2e-5 * 0.5 * (
        0.31**2 + 0.17**2
    )
    u = bouncing.contact_displacement[0, 0]
    wall = 1e-3 + 0.5 * 5e-4 * (1.0 - np.cos(lobes * (np.arctan2(u[1], u[0]) - angle)))
    touching = np.hypot(*bouncing.contact_force[0, 0]) > 0.0
    assert np.array_equal(touching[1:-1], (np.hypot(*u) > wall)[1:-1]) and touching.any()
    # the force is the gradient of k phi²/2, by differences
    step = np.flatnonzero(touching)[touching.sum() // 2]

    def potential(x, y):
        lobe = 2.5e-4 * (1.0 - np.cos(lobes * (np.arctan2(y, x) - angle)))
        return 0.5e6 * (np.hypot(x, y) - 1e-3 - lobe) ** 2

    x, y, h = *u[:, step], 1e-9
    slope = np.array(
        [potential(x + h, y) - potential(x - h, y), potential(x, y + h) - potential(x, y - h)]
    ) / (2 * h)
    assert bouncing.contact_force[0, 0, :, step] == pytest.approx(-slope, rel=1e-4)


def ring_down(**law):
    """A mass on a spring of 10 Hz released at 1 mm, with one local element."""
    return trace(oscillator(1.0, (20 * np.pi) ** 2, displacement=(1e-3, 0.0), element=law), 0.5)


def test_linear_element_shifts_the_frequency():
    u = ring_down(stiffness=3 * (20 * np.pi) ** 2).element_displacement[0, 0]
    crossings = np.flatnonzero(np.diff(np.sign(u))) / RATE
    assert 0.5 / np.diff(crossings).mean() == pytest.approx(20.0, rel=1e-4)


def test_damper_element_decays_as_modal_damping_does():
    by_element = ring_down(damping=2 * 0.02 * 20 * np.pi).element_displacement[0, 0]
    t = np.arange(by_element.size) / RATE
    omega = 20 * np.pi
    exact = (
        1e-3
        * np.exp(-0.02 * omega * t)
        * (
            np.cos(omega * np.sqrt(1 - 4e-4) * t)
            + 0.02 / np.sqrt(1 - 4e-4) * np.sin(omega * np.sqrt(1 - 4e-4) * t)
        )
    )
    assert np.max(np.abs(by_element - exact)) < 1e-6 * 1e-3 * 10


def test_cubic_element_follows_the_duffing_period():
    """Exact period of u'' + w² u + b u³ = 0 at amplitude a: 4 K(m)/sqrt(w² + b a²), m = b a² / (2
    (w² + b a²)).
    """
    w2, b, a = (20 * np.pi) ** 2, 4e9, 1e-3
    u = ring_down(cubic=b).element_displacement[0, 0]
    crossings = np.flatnonzero(np.diff(np.sign(u))) / RATE
    exact = 4.0 * ellipk(b * a**2 / (2 * (w2 + b * a**2))) / np.sqrt(w2 + b * a**2)
    assert 2 * np.diff(crossings).mean() == pytest.approx(exact, rel=2e-4)


def test_quadratic_element_shifts_the_mean():
    """Small even stiffness: the mean of the motion is -q a²/(2 w²) to first order."""
    w2, q = (20 * np.pi) ** 2, 2e4
    u = ring_down(quadratic=q).element_displacement[0, 0]
    assert u.mean() == pytest.approx(-q * 1e-6 / (2 * w2), rel=0.05)


def test_drag_takes_the_energy_of_its_closed_form():
    """Per cycle 8/3 d w² a³ for |v| v drag, small drag."""
    w, d, a = 20 * np.pi, 0.5, 1e-3
    run = ring_down(drag=d)
    assert -run.energy["contact_work"][0] == pytest.approx(
        5 * 8.0 / 3.0 * d * w**2 * a**3, rel=0.01
    )


def test_drag_of_a_circling_motion_is_that_of_its_speed():
    """With its partner: d |v|³ all the way, 2 pi d w² a³ a turn; the axes by themselves would take
    2 x 8/3 d w² a³.
    """
    w, d, a = 20 * np.pi, 0.5, 1e-3
    model = oscillator(1.0, w**2, displacement=(a, 0.0), velocity=(0.0, a * w), element={})
    lost = []
    for partner in ([1, 0], [-1, -1]):
        laws = replace(LocalLaws.neutral(2), drag=np.full(2, d), drag_partner=np.array(partner))
        run = trace(
            replace(
                model, element_shapes=model.sensor_shapes, element_names=("x", "y"), local_laws=laws
            ),
            0.1,
        )
        lost.append(-run.energy["contact_work"][0])
    assert lost == pytest.approx(
        [2.0 * np.pi * d * w**2 * a**3, 16.0 / 3.0 * d * w**2 * a**3], rel=0.01
    )


def test_slider_slide_loses_four_mu_n_per_cycle():
    """Successive extremes fall by 2 f/k (the friction slide of code_aster's SDND100)."""
    run = trace(
        oscillator(
            1.0,
            1e4,
            displacement=(0.85e-3, 0.0),
            element={"stick_stiffness": 4e7, "slip_limit": 1.0},
        ),
        0.2,
    )
    at = [run.element_displacement[0, 0, round(n * np.pi / 100 * RATE)] for n in range(1, 6)]
    assert at == pytest.approx([-6.5e-4, 4.5e-4, -2.5e-4, 0.5e-4, 0.5e-4], abs=0.85e-6)
    assert run.slip_work[0, 0] == pytest.approx(0.5e4 * (0.85e-3**2 - 0.5e-4**2), rel=1e-3)


def test_saturating_spring_is_linear_then_constant():
    run = ring_down(saturation_stiffness=1e4, saturation_limit=3.0)
    u, f = run.element_displacement[0, 0], run.element_force[0, 0]
    assert np.max(np.abs(f + np.clip(1e4 * u, -3.0, 3.0))) < 2e-3
    assert (
        abs(run.energy["mechanical"][0] + run.energy["stored"][0])
        < 1e-5 * 0.5 * (20 * np.pi) ** 2 * 1e-6 + 1e-9
    )


def test_damper_with_a_limit_is_linear_then_dry_friction():
    """Beyond its limit it takes 4 f a per cycle, and successive extremes fall by 2 f/k."""
    run = trace(
        oscillator(
            1.0,
            1e4,
            displacement=(10e-3, 0.0),
            element={"damping": 1e3, "damping_limit": 1.0},
        ),
        0.2,
    )
    f = run.element_force[0, 0]
    at = [run.element_displacement[0, 0, round(n * np.pi / 100 * RATE)] for n in range(1, 6)]
    assert np.abs(f).max() == pytest.approx(1.0)
    assert np.abs(at) == pytest.approx([9.8e-3, 9.6e-3, 9.4e-3, 9.2e-3, 9.0e-3], abs=1e-5)


def test_laws_refuse_impossible_contacts():
    with pytest.raises(ValueError, match="stick_stiffness must be positive if there is friction"):
        ContactLaws.neutral(2).with_columns(friction=0.2)
    with pytest.raises(ValueError, match="damping = .* must be finite and not negative"):
        ContactLaws.neutral(2).with_columns(damping=-1.0)
    with pytest.raises(ValueError, match="names a contact point that is not among 2"):
        ContactLaws.neutral(2).with_columns(
            land_point=np.array([3]), land_normal=np.array([(1.0, 0.0)])
        )
    with pytest.raises(ValueError, match="one per element"):
        replace(LocalLaws.neutral(2), cubic=np.zeros(3))
