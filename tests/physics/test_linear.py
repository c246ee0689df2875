"""The linear tube with an equivalent support: published damping ratios, dense solutions, limits,
inverses.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import optimize

from evidence.validation.prediction.responses import synthesise_records
from vibroimpact.config.reading import load_config
from vibroimpact.identify.equivalent_support import equivalent_support
from vibroimpact.identify.linear import responses
from vibroimpact.identify.linear.family import LinearFamily, driven_modes
from vibroimpact.identify.linear.modes import first_mode_shape, natural_frequencies
from vibroimpact.identify.linear.poles import first_pole, frequency_of
from vibroimpact.identify.linear.responses import frf
from vibroimpact.reduction.reduced_model import build_model

STUDY = load_config(Path(__file__).resolve().parents[2] / "config" / "study.yaml")
# k N/m per support: (frequency Hz, damping ratio) of the first mode at c = 0
FIRST_BY_STIFFNESS = {
    1.0: (15.97, 1.50e-2),
    1.0e4: (16.78, 1.43e-2),
    1.0e5: (20.96, 1.14e-2),
    1.0e6: (26.71, 0.895e-2),
    4.0e6: (27.99, 0.853e-2),
}
SUPPORTS = [(0.0, 0.0), (1.0e3, 1.0), (1.0e5, 62.0), (1.0e5, -5.0), (4.0e6, 9000.0), (1.0e5, 1.0e4)]


@pytest.fixture(scope="module")
def model():
    """Return the study's ModalModel."""
    return build_model(STUDY)


@pytest.fixture(scope="module")
def skew(model):
    """Return the study's model driven along (1, 1, 0) and with in-plane output seen: both planes
    respond.
    """
    drive = model.drive_shapes + model.sensor_shapes[:, [model.sensor_names.index("bend_45.x")]]
    return replace(model, drive_shapes=drive)


def dense_matrices(model, k, c):
    """Return (damping, stiffness), each (mode, mode), assembled point by point from the definition
    of the equivalent support.
    """
    support = np.zeros((model.modes, model.modes))
    for point, weight in enumerate(model.contact_weight):
        for direction in range(2):
            shape = model.contact_shapes[:, point, direction]
            support += weight * np.outer(shape, shape)
    return np.diag(model.damping) + c * support, np.diag(model.omega**2) + k * support


def dense_response(model, k, c, frequency):
    """Return (mode, frequency) complex modal response per N of the drive, one dense solution per
    frequency in Hz.
    """
    damping, stiffness = dense_matrices(model, k, c)
    columns = []
    for omega in 2.0 * np.pi * np.asarray(frequency):
        dynamic = stiffness - omega**2 * np.eye(model.modes) + 1j * omega * damping
        columns.append(np.linalg.solve(dynamic, model.drive_shapes[:, 0]))
    return np.array(columns).T


def dense_poles(model, k, c):
    """Return the poles with positive imaginary part, by rising magnitude, of the modes the drive
    along y moves.
    """
    damping, stiffness = dense_matrices(model, k, c)
    moved = np.flatnonzero(model.drive_shapes[:, 0])
    damping, stiffness = damping[np.ix_(moved, moved)], stiffness[np.ix_(moved, moved)]
    poles = np.linalg.eigvals(
        np.block([[np.zeros_like(damping), np.eye(len(moved))], [-stiffness, -damping]])
    )
    poles = poles[poles.imag > 0.0]
    return poles[np.argsort(np.abs(poles))]


@pytest.mark.parametrize("k", FIRST_BY_STIFFNESS)
def test_first_damping_ratio_falls_with_the_support_stiffness(model, k):
    pole = first_pole(model, k, 0.0)
    frequency, ratio = FIRST_BY_STIFFNESS[k]
    assert abs(pole) / (2.0 * np.pi) == pytest.approx(frequency, rel=1e-3)
    assert -pole.real / abs(pole) == pytest.approx(ratio, rel=4e-3)  # the table has three digits


@pytest.mark.parametrize(
    "k, about, c", [(1.0e5, 62.0, 62.0), (1.0e6, 1000.0, 1018.0), (4.0e6, 9000.0, 10016.0)]
)
def test_support_damping_that_doubles_the_damping_ratio(model, k, about, c):
    """The prototypes' values are "about"; the last is what a straight line from c = 0 gives, the
    curve bends 11 % away from it.
    """

    def ratio(pole):
        return -pole.real / abs(pole)

    alone = ratio(first_pole(model, k, 0.0))
    doubling = optimize.brentq(
        lambda damping: ratio(first_pole(model, k, damping)) - 2.0 * alone, 0.5 * c, 2.0 * c
    )
    assert doubling == pytest.approx(c, rel=2e-3)
    assert ratio(dense_poles(model, k, c)[0]) == pytest.approx(2.0 * alone, rel=2e-3)
    assert about == pytest.approx(c, rel=0.12)


def test_natural_frequencies_are_the_dense_ones(model):
    for k in (0.0, 1.0e5, 1.0e9):
        _, stiffness = dense_matrices(model, k, 0.0)
        dense = np.sqrt(np.linalg.eigvalsh(stiffness)) / (2.0 * np.pi)
        assert natural_frequencies(model, k, 8) == pytest.approx(dense[:8], rel=1e-7)
        assert len(natural_frequencies(model, k, 1000)) == model.modes


@pytest.mark.parametrize("k, c", SUPPORTS)
def test_first_pole_is_the_lowest_pole_of_the_dense_problem(model, k, c):
    pole = first_pole(model, k, c)
    assert abs(dense_poles(model, k, c)[0] - pole) < 1e-8 * abs(pole)


def test_very_strong_damper_acts_as_a_clamp(model):
    strong = first_pole(model, 0.0, 1.0e9)
    assert abs(strong) == pytest.approx(abs(first_pole(model, 1.0e12, 0.0)), rel=1e-3)
    weak = [-first_pole(model, 1.0e4, c).real for c in (0.0, 10.0, 100.0)]
    assert weak == sorted(weak)


@pytest.mark.parametrize(
    "k, c",
    [
        (10.0, 0.01),
        (1.0e3, 1.0),
        (1.0e5, 62.0),
        (1.0e5, -5.0),
        (4.0e6, 9000.0),
        (1.0e5, 1.0e4),
        (1.0e8, 0.0),
    ],
)
def test_support_comes_back_from_its_pole(model, k, c):
    back = equivalent_support(driven_modes(model), *frequency_of(first_pole(model, k, c)))
    assert (back.k, back.c) == pytest.approx((k, c), rel=1e-6, abs=1e-6 * k)


def test_no_support_gives_a_pole_above_the_clamped_one(model):
    clamped, _ = frequency_of(first_pole(model, 1.0e12, 0.0))
    assert equivalent_support(driven_modes(model), 1.05 * clamped, 0.005).k == np.inf


def test_support_that_buckles_the_tube_is_refused(model):
    with pytest.raises(ValueError, match="-1e\\+06 N/m the tube has no lowest frequency above 0"):
        first_pole(model, -1.0e6, 0.0)


def test_first_mode_shape_is_the_lowest_driven_eigenvector(model):
    for k in (0.0, 1.0e4, 1.0e6, 1.0e9):
        _, stiffness = dense_matrices(model, k, 0.0)
        moved = np.flatnonzero(model.drive_shapes[:, 0])
        vector = np.linalg.eigh(stiffness[np.ix_(moved, moved)])[1][:, 0]
        expected, shape = model.line_shapes[moved].T @ vector, first_mode_shape(model, k)
        assert shape.max() == np.abs(shape).max()
        assert shape == pytest.approx(
            expected * np.sign(expected @ shape), rel=1e-6, abs=1e-8 * shape.max()
        )


@pytest.mark.parametrize("k, c", SUPPORTS)
@pytest.mark.parametrize("name", ["model", "skew"])
def test_frf_is_the_dense_one(request, name, k, c):
    model = request.getfixturevalue(name)
    frequency = np.array([0.0, 5.0, 15.97, 21.0, 45.0, 90.3, 170.0, 400.0])
    expected = model.sensor_shapes.T @ dense_response(model, k, c, frequency)
    response = frf(model, k, c, frequency, model.sensor_shapes)
    assert np.abs(response - expected).max() < 1e-10 * np.abs(expected).max()
    laplace = 2j * np.pi * frequency
    assert frf(model, k, c, frequency, model.sensor_shapes, "velocity") == pytest.approx(
        response * laplace
    )
    assert frf(model, k, c, frequency, model.sensor_shapes, "acceleration") == pytest.approx(
        response * laplace**2
    )


def test_frf_in_several_chunks_is_the_same(model, monkeypatch):
    frequency = np.linspace(1.0, 60.0, 50)
    whole = frf(model, 1e5, 62.0, frequency, model.sensor_shapes)
    monkeypatch.setattr(responses, "FREQUENCY_CHUNK", 7)
    # A matrix product over another number of rows may round otherwise.
    assert (
        np.abs(frf(model, 1e5, 62.0, frequency, model.sensor_shapes) - whole).max()
        < 1e-12 * np.abs(whole).max()
    )


@pytest.mark.parametrize("name", ["model", "skew"])
def test_the_family_is_the_dense_response_for_every_support(request, name):
    model = request.getfixturevalue(name)
    frequency = np.arange(6.0, 99.0, 7.3)
    shape = model.sensor_shapes[:, [model.sensor_names.index("bend_45.y")]]
    family = LinearFamily(driven_modes(model), frequency).response(shape)
    for k in (0.0, 1.0e3, 1.0e5, 4.0e6, 1.0e9):
        for c in (0.0, 60.0, 9000.0, -5.0):
            expected = np.abs(shape.T @ dense_response(model, k, c, frequency)) ** 2
            assert family.psd(k, c) == pytest.approx(expected, rel=1e-7)


def test_reciprocity_and_limits(model):
    """Swapping drive and sensor changes nothing; k -> 0 and k -> infinity give the free tube and
    the tube held at its supports.
    """
    frequency, apex = np.linspace(5.0, 200.0, 40), model.sensor_names.index("apex.y")
    there = frf(model, 1e5, 62.0, frequency, model.sensor_shapes[:, [apex]])
    swapped = replace(model, drive_shapes=model.sensor_shapes[:, [apex]])
    assert frf(swapped, 1e5, 62.0, frequency, model.drive_shapes) == pytest.approx(there, rel=1e-10)
    free = frf(model, 0.0, 0.0, frequency, model.sensor_shapes)
    assert frf(model, 1e-6, 0.0, frequency, model.sensor_shapes) == pytest.approx(
        free, rel=1e-6, abs=1e-14
    )
    contacts = model.contact_shapes[:, :, 1]
    held = frf(model, 1e13, 0.0, frequency, contacts)
    assert np.abs(held).max() < 1e-5 * np.abs(frf(model, 0.0, 0.0, frequency, contacts)).max()


def test_synthesised_sine_is_the_dense_steady_state(model):
    """A force of 30 whole periods: amplitude and phase at every sensor from one dense solution."""
    rate, cycles, count = 2048.0, 30, 4096
    frequency = cycles * rate / count
    time = np.arange(count) / rate
    force = 2.5 * np.cos(2.0 * np.pi * frequency * time + 0.3)
    expected = model.sensor_shapes.T @ dense_response(model, 1e5, 62.0, [frequency])
    steady = np.real(expected * 2.5 * np.exp(1j * (2.0 * np.pi * frequency * time + 0.3)))
    assert synthesise_records(model, 1e5, 62.0, force) == pytest.approx(
        steady, rel=1e-9, abs=1e-9 * np.abs(steady).max()
    )


def test_synthesised_record_obeys_the_equation_of_motion(model):
    """Differentiated through its spectrum, the modal record of a random force satisfies M a + C v +
    K q = f at every instant.
    """
    rng, count, rate = np.random.default_rng(5), 8192, 2048.0
    lines = np.where(
        np.fft.rfftfreq(count, 1.0 / rate) < 300.0, np.fft.rfft(rng.standard_normal(count)), 0.0
    )
    force = np.fft.irfft(lines, n=count)
    moved = np.flatnonzero(model.drive_shapes[:, 0])
    unit = np.eye(model.modes)[:, moved]
    motion = [
        synthesise_records(model, 1e5, 62.0, force, rate, unit, kind)
        for kind in ("displacement", "velocity", "acceleration")
    ]
    damping, stiffness = (
        matrix[np.ix_(moved, moved)] for matrix in dense_matrices(model, 1e5, 62.0)
    )
    acting = model.drive_shapes[moved] * force
    residual = motion[2] + damping @ motion[1] + stiffness @ motion[0] - acting
    assert np.abs(residual).max() < 1e-7 * np.abs(acting).max()
    laplace = 2j * np.pi * np.fft.rfftfreq(count, 1.0 / rate)
    velocity = np.fft.irfft(np.fft.rfft(motion[0]) * laplace, n=count)
    assert np.abs(velocity - motion[1]).max() < 1e-9 * np.abs(motion[1]).max()


def test_a_drive_that_moves_no_contact_is_refused(model):
    still = replace(model, drive_shapes=np.zeros((model.modes, 1)))
    with pytest.raises(ValueError, match="the force moves no contact point"):
        first_pole(still, 1e5, 0.0)
    assert np.all(frf(still, 1e5, 0.0, [10.0], model.sensor_shapes) == 0.0)
